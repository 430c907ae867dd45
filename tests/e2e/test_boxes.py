"""Whatever the page shows at once, at the usual sizes, enlarged and by touch: nothing is covered, nothing is cut, and all that
can be pressed is large enough for who presses it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.e2e.browser import at_each, box_of, calm, on_screen, open_page
from tests.e2e.program import Program
from web.viewer.camera_views import VIEWS, camera_for, corners_of

# Of a page each, with the panel beside the plates or over them; 683 x 384 is 1366 x 768 enlarged twice.
SIZES = [[(1024, 768), (1280, 720), (1366, 768), (1920, 1080)], [(683, 384), (820, 1180)]]
ON_ITS_SIDE = [(844, 390), (740, 360), (667, 375), (932, 430)]  # a phone
TOUCHED = [[(390, 844), (820, 1180)], [(1024, 768), (1366, 1024)], ON_ITS_SIDE]  # phones and tablets
# Each of these stands alone; what lies in one of them may not cover its neighbours there either.
PARTS = """header, footer, .views, .aids, .hints, #panel, #panel-show, #beside, #lesson, #trial, #first, #situation, #film,
    #walk, #kept, #presenter-bar, .pad, .toast"""
WRONG = """([parts, least]) => {
    const wrong = [], name = (part) => part.id || part.className || part.tagName;
    const shown = (part) => part.checkVisibility({ visibilityProperty: true }) && part.getBoundingClientRect().width > 0;
    const all = [...document.querySelectorAll(parts)].filter(shown);
    const apart = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) <= 0.5
        || Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) <= 0.5;
    const scrolls = getComputedStyle(document.documentElement).overflowY !== "hidden"; // the page as a whole
    const bottom = scrolls ? document.documentElement.scrollHeight : innerHeight;
    for (const [k, part] of all.entries()) {
        const box = part.getBoundingClientRect();
        if (box.left < -0.5 || box.right > innerWidth + 0.5 || box.top < -0.5 || box.bottom > bottom + 0.5)
            wrong.push(`${name(part)} sticks out`);
        for (const other of all.slice(k + 1)) {
            const sheet = part.id === "panel" && innerWidth <= 1000 || other.id === "panel" && innerWidth <= 1000;
            if (!sheet && !part.contains(other) && !other.contains(part) && !apart(box, other.getBoundingClientRect()))
                wrong.push(`${name(part)} and ${name(other)} cover one another`);
        }
    }
    const scrolled = (part) => { // out of sight in something that can be scrolled to it
        for (let up = part.parentElement; up; up = up.parentElement)
            if (/auto|scroll/.test(getComputedStyle(up).overflow)
                && (up.scrollHeight > up.clientHeight || up.scrollWidth > up.clientWidth)) return true;
        return false;
    };
    const pressed = [...document.querySelectorAll("button, select, summary, [role=tab]")].filter(shown);
    for (const part of pressed.filter((part) => !part.closest("#panel, dialog, #timeline"))) {
        const box = part.getBoundingClientRect();
        if (Math.min(box.width, box.height) < least - 0.5)
            wrong.push(`${name(part)} is ${box.width.toFixed(0)} x ${box.height.toFixed(0)}`);
        if (part.tagName !== "SELECT" && part.scrollWidth > part.clientWidth + 1 && getComputedStyle(part).overflow !== "visible")
            wrong.push(`${name(part)} is cut`);
        if (part.matches("#beside-end")) { // it stands first in a line that is scrolled
            const line = part.parentElement.getBoundingClientRect();
            if (box.left < line.left - 0.5 || box.right > line.right + 0.5) wrong.push(`${name(part)} is out of sight`);
        }
        if (scrolled(part)) continue;
        const at = document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2);
        if (at && !part.contains(at) && !at.contains(part) && !at.closest("label")?.contains(part))
            wrong.push(`${name(part)} is beneath ${name(at)}`);
    }
    return wrong; }"""


@pytest.fixture(scope="module")
def program() -> Iterator[Program]:
    made = Program("--port", "0", "--seed", "5", "--paused")
    made.command("step", ticks=300)
    yield made
    assert made.stop() == 0


def plain(_program: Program, _page: Page) -> None:
    pass


def welcomed(_program: Program, page: Page) -> None:
    page.evaluate("() => document.getElementById('help-first').click()")
    expect(page.locator("#first")).to_be_visible()


def on_the_way(program: Program, page: Page) -> None:
    page.evaluate("() => document.getElementById('first-close').click()")
    program.command("set_goal", x=0.0, y=0.0)
    expect(page.locator("#goal")).to_be_visible()


def in_the_past(program: Program, page: Page) -> None:
    program.command("seek", tick=100)
    expect(page.locator("#now")).to_be_visible()


def branched(program: Program, page: Page) -> None:
    program.command("seek", tick=200)
    expect(page.locator("#now")).to_be_visible()
    program.command("go_on_from_here")
    expect(page.locator("#now")).to_be_hidden()


def stage_by_stage(program: Program, page: Page) -> None:
    program.command("step_stage")
    expect(page.locator("#walk")).to_be_visible()


def compared(program: Program, page: Page) -> None:
    program.command("compare_brains", pair="vision", since="now")
    program.command("step", ticks=20)
    expect(page.locator("#beside-second")).to_contain_text("without vision")


def presented(_program: Program, page: Page) -> None:
    page.keyboard.press("z")


def in_a_lesson(program: Program, page: Page) -> None:
    page.keyboard.press("z")  # ends presenting
    program.command("begin_lesson", name="snap")  # without vision, and with a loop to be played again
    expect(page.locator("#lesson")).to_have_attribute("data-state", "predict")
    expect(page.locator("#replay")).not_to_have_attribute("hidden", "")


def in_a_lesson_before_a_class(_program: Program, page: Page) -> None:
    page.keyboard.press("z")


def with_a_trial(program: Program, page: Page) -> None:
    page.keyboard.press("z")
    program.command("watch_experiment", experiment="table", engine="ours", quick=True)
    program.command("pause")
    expect(page.locator("#trial")).to_be_visible()


STATES: list[Callable[[Program, Page], None]] = [
    plain, welcomed, on_the_way, in_the_past, branched, compared, presented, stage_by_stage, in_a_lesson,
    in_a_lesson_before_a_class, with_a_trial,
]  # fmt: skip


@pytest.mark.parametrize(
    ("sizes", "touched"),
    [
        (SIZES[0], False),
        (TOUCHED[0], True),
        *(
            pytest.param(*each, marks=pytest.mark.long)
            for each in ((SIZES[1], False), *((s, True) for s in TOUCHED[1:]))
        ),
    ],
)
def test_nothing_is_covered_cut_or_too_small(
    program: Program, browser: Browser, sizes: list[tuple[int, int]], touched: bool
) -> None:
    program.command("reset", world="office", seed=5)
    program.command("step", ticks=300)
    with open_page(browser, program.url, *sizes[0], stage=False, touched=touched) as page:
        page.evaluate("() => document.querySelectorAll('.toast').forEach((toast) => toast.remove())")
        wrong: list[str] = []
        for state in STATES:
            state(program, page)
            for width, height in at_each(page, sizes):
                calm(page)
                found = page.evaluate(WRONG, [PARTS, 44 if touched else 24])
                wrong += [f"{state.__name__}, {width} x {height}: {each}" for each in found]
        assert not wrong, "\n".join(wrong)


def test_enlarged_four_times_the_page_is_scrolled_and_nothing_lies_over_the_plates(
    program: Program, browser: Browser
) -> None:
    """1280 x 1024 at 400 %: half of what is seen at first is the plates', with nothing but the line of views over them."""
    program.command("reset", world="office", seed=5)
    program.command("step", ticks=300)
    with open_page(browser, program.url, 1024, 768, stage=False) as page:
        page.evaluate("() => document.querySelectorAll('.toast').forEach((toast) => toast.remove())")
        for state in STATES:
            page.set_viewport_size({"width": 1024, "height": 768})
            state(program, page)
            list(at_each(page, [(320, 256)]))
            calm(page)
            assert page.evaluate(WRONG, [PARTS, 24]) == [], state.__name__
            stage, views = box_of(page.locator("#stage")), box_of(page.locator(".views"))
            assert stage["height"] >= 128, state.__name__
            assert views["y"] + views["height"] <= stage["y"] + stage["height"] / 3, state.__name__
        assert page.evaluate("() => document.documentElement.scrollWidth") == 320
        page.click("#panels")
        expect(page.locator("#panel")).to_be_in_viewport(ratio=0.99)
        page.click("#panel .close")


A_GAP = 12  # pixels; between what may touch


@pytest.mark.long
def test_the_rows_of_buttons_leave_the_plates_free(program: Program, browser: Browser) -> None:
    """However many rows they need, in whatever room the lesson and the panel leave: no plate reaches beneath them or is cut."""
    program.command("reset", world="office", seed=5)
    program.command("step", ticks=300)
    sizes = [(1400, 800), (1280, 720), (1180, 720), (1024, 768), (390, 844)]
    with open_page(browser, program.url, *sizes[0], stage=False) as page:
        wrong: list[str] = []
        for state in (plain, presented, in_a_lesson, in_a_lesson_before_a_class):
            state(program, page)
            for width, height in at_each(page, sizes):
                calm(page)
                canvas = box_of(page.frame_locator("#stage").locator("canvas").first)
                bar = box_of(page.locator(".stage-bar"))
                for view in VIEWS:
                    camera = camera_for(view, canvas["width"] / canvas["height"])
                    seen = [on_screen(page, camera, tuple(at), canvas) for at in corners_of(view, True, False)]
                    highest, left, right = min(y for _, y in seen), min(x for x, _ in seen), max(x for x, _ in seen)
                    where = f"{state.__name__}, {width} x {height}, {view}"
                    if highest < bar["y"] + bar["height"] - A_GAP:
                        wrong.append(f"{where}: {bar['y'] + bar['height'] - highest:.0f} px beneath the buttons")
                    if left < canvas["x"] or right > canvas["x"] + canvas["width"]:
                        wrong.append(f"{where}: cut at a side")
        assert not wrong, "\n".join(wrong)


SMALL = """() => [...document.querySelectorAll("button, select, summary, [role=tab], label.check, .pop a, .option")]
    .filter((part) => part.checkVisibility({ visibilityProperty: true }) && !part.closest(".gone"))
    .map((part) => [part, part.getBoundingClientRect()])
    .filter(([part, { width, height }]) => Math.min(width, height) < 43.5 || part.scrollWidth > part.clientWidth + 1
        && getComputedStyle(part).overflow !== "visible" && getComputedStyle(part).textOverflow !== "ellipsis")
    .map(([part, { width, height }]) => `${part.id || part.textContent || part.ariaLabel}: ${width} x ${height}`)"""


@pytest.mark.long
@pytest.mark.parametrize("size", [(390, 844), (844, 390), (1024, 768)])
def test_all_that_opens_is_large_enough_for_fingers(program: Program, browser: Browser, size: tuple[int, int]) -> None:
    program.command("reset", world="office", seed=5)
    program.command("step", ticks=300)
    program.command("tag", name="the printer")
    with open_page(browser, program.url, *size, stage=False, touched=True) as page:
        wrong: dict[str, str] = {}

        def look(where: str) -> None:
            calm(page)
            for each in page.evaluate(SMALL):
                wrong.setdefault(each, where)

        if min(size) < 500:
            page.click("#panels")
        for tab in page.locator("#panel [role=tab]").all():
            tab.click()
            look(tab.inner_text())
        page.evaluate("() => document.querySelectorAll('#panel details').forEach((part) => (part.open = true))")
        look("all that the panel can unfold")
        if min(size) < 500:
            page.click("#panels")
        for key in "?", "c", "g", "/":
            page.keyboard.press(key)
            expect(page.locator("dialog[open]")).to_have_count(1)
            look(key)
            page.click("dialog[open] .dialog-head [aria-label=Close]")
            expect(page.locator("dialog[open]")).to_have_count(0)
        page.click("#places")  # without a keyboard on the screen, which would cover the list
        expect(page.locator("#places-close")).to_be_focused()
        page.click("#places-close")
        page.keyboard.press("o")
        page.wait_for_selector("#plan .body")
        page.click("#edit-time")
        look("editor")
        page.click("#edit-close")
        page.click("#keep summary")
        look("what can be kept")
        page.keyboard.press("Escape")
        page.click("#bookmark")
        expect(page.locator("#bookmark-list input")).to_be_visible()
        look("events and bookmarks")
        assert not wrong, "\n".join(f"{where}: {each}" for each, where in wrong.items())
