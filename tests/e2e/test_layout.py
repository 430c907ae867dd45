"""Whatever the page shows, at every size, in both themes: nothing is covered, nothing is cut, all that can be pressed is large
enough for who presses it, the keyboard reaches it, and axe finds nothing."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import replace

import pytest
from playwright.sync_api import Browser, Page, expect

from app.experiments.outcome import Outcome
from app.experiments.store import Store
from app.trials.chosen import chosen_trial
from app.trials.experiment import find_experiment
from app.trials.trial import run_trial
from sim2d import load_world, world_to_json
from tests.e2e.browser import NO_STAGE, PATIENCE_MS, at_each, box_of, calm, on_screen, open_page, turn_theme, until
from tests.e2e.editor import drop, plan_png
from tests.e2e.layout import boxes, findings
from tests.e2e.program import Program
from web.panel.panel import TABS
from web.viewer.camera_views import VIEWS, camera_for, corners_of

SCREENS = [(1280, 720), (1024, 768), (1366, 768), (1920, 1080)]
ENLARGED = [(683, 384), (820, 1180)]  # the panel lies over the plates; the first is 1366 x 768 enlarged twice
PHONES = [(390, 844), (360, 740)]
TABLETS = [(1024, 768), (1366, 1024)]
ON_ITS_SIDE = [(844, 390), (740, 360), (667, 375), (932, 430)]  # a phone


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Program]:
    """With two worlds of one's own and a trial in the store."""
    own, store = tmp_path_factory.mktemp("own"), tmp_path_factory.mktemp("store") / "experiments.sqlite"
    for name, title in (("lab", "My laboratory"), ("school", "A school whose name is long enough for two lines")):
        world = replace(load_world("office"), name=name, title=title)
        (own / f"{name}.json").write_text(world_to_json(world), encoding="utf-8")
    trial = chosen_trial(find_experiment("table"), "ours", ["2 %", "8 x 8"], 7, quick=True)
    result, _ = run_trial(trial)
    with Store(store) as opened:
        opened.add([(trial, Outcome(trial.id, result))])
    kept = {"RATSLAM_WORLDS": str(own), "RATSLAM_EXPERIMENTS": str(store)}
    made = Program("--port", "0", "--seed", "5", "--paused", **kept)
    yield made
    assert made.stop() == 0


State = Callable[[Program, Page], AbstractContextManager[None]]
STATES: list[State] = []


def state(shown: Callable[[Program, Page], Iterator[None]]) -> State:
    """What the page can show; it is shown until the block ends."""
    STATES.append(contextlib.contextmanager(shown))
    return STATES[-1]


def click(page: Page, part: str) -> None:
    """Wherever it is: on a phone in a menu."""
    page.locator(part).first.evaluate("(part) => part.click()")


# ---------------------------------------------------------------- what it can show


@state
def plain(_program: Program, _page: Page) -> Iterator[None]:
    yield


@state
def welcomed(_program: Program, page: Page) -> Iterator[None]:
    click(page, "#help-first")
    expect(page.locator("#first")).to_be_visible()
    yield
    click(page, "#first-close")


@state
def on_the_way(program: Program, page: Page) -> Iterator[None]:
    program.command("set_goal", x=0.0, y=0.0)
    expect(page.locator("#goal")).to_be_visible()
    yield
    program.command("cancel_goal")


@state
def in_the_past(program: Program, page: Page) -> Iterator[None]:
    program.command("seek", tick=100)
    expect(page.locator("#now")).to_be_visible()
    yield
    program.command("back_to_now")


@state
def branched(program: Program, page: Page) -> Iterator[None]:
    program.command("seek", tick=200)
    expect(page.locator("#now")).to_be_visible()
    program.command("go_on_from_here")
    expect(page.locator("#now")).to_be_hidden()
    yield


@state
def stage_by_stage(program: Program, page: Page) -> Iterator[None]:
    program.command("step_stage")
    expect(page.locator("#walk")).to_be_visible()
    yield
    program.command("step", ticks=1)


@state
def compared(program: Program, page: Page) -> Iterator[None]:
    program.command("compare_brains", pair="vision", since="now")
    program.command("step", ticks=20)
    expect(page.locator("#beside-second")).to_contain_text("without vision")
    yield
    program.command("end_comparison")


@state
def presented(_program: Program, page: Page) -> Iterator[None]:
    page.keyboard.press("z")
    yield
    page.keyboard.press("z")


@state
def compared_and_presented(program: Program, page: Page) -> Iterator[None]:
    with compared(program, page), presented(program, page):
        yield


@state
def with_events_and_a_bookmark(program: Program, page: Page) -> Iterator[None]:
    program.command("kidnap")
    page.click("#bookmark")
    page.get_by_label("Name of the bookmark").press("Enter")
    expect(page.locator("#bookmark-list li")).to_have_count(1)
    yield
    page.locator("#bookmark-list").get_by_role("button", name="Delete").click()
    page.keyboard.press("Escape")


@state
def with_a_menu(_program: Program, page: Page) -> Iterator[None]:
    page.click("#keep summary")
    yield
    page.keyboard.press("Escape")


@state
def with_a_link(_program: Program, page: Page) -> Iterator[None]:
    page.click("#keep summary")
    page.get_by_role("button", name="Link to this moment").click()
    expect(page.locator("#share-dialog")).to_be_visible()
    yield
    page.click("#share-close")


@state
def with_the_menu_of_a_phone(_program: Program, page: Page) -> Iterator[None]:
    narrow = page.locator("#more").is_visible()
    if narrow:
        page.click("#more")
    yield
    if narrow:
        page.click("#more")


@state
def choosing_brains(_program: Program, page: Page) -> Iterator[None]:
    click(page, "[aria-label='Compare brains']")
    yield
    page.keyboard.press("Escape")


def dialog(key: str, filled: str) -> State:
    def shown(_program: Program, page: Page) -> Iterator[None]:
        page.keyboard.press(key)
        page.locator("dialog[open]").locator(filled).first.wait_for()
        yield
        click(page, "dialog[open] .dialog-head [aria-label=Close]")
        expect(page.locator("dialog[open]")).to_have_count(0)

    shown.__name__ = f"the_dialog_of_{key}"
    return state(shown)


HELP, LESSONS, GALLERY = dialog("?", "#keys li"), dialog("c", "#lessons-list button"), dialog("g", ".card")
PLACES = dialog("/", "li")


@state
def trials(_program: Program, page: Page) -> Iterator[None]:
    page.keyboard.press("g")
    page.click(".card[data-name=table] .trials")
    page.wait_for_selector("#one-grid .cell")
    page.get_by_label("2 %, 8 x 8: ").click()
    yield
    page.click("#gallery-close")


def tab(name: str) -> State:
    def shown(program: Program, page: Page) -> Iterator[None]:
        folded = page.get_attribute("body", "data-panels") == "false"
        if folded:
            click(page, "#panels")
        program.command("inspect", experience=3)
        page.get_by_role("tab", name=name, exact=True).click()
        until(page, "() => document.querySelector('[role=tabpanel]:not([hidden])').textContent.length > 20")
        page.evaluate("() => document.querySelectorAll('#panel details').forEach((part) => { part.open = true; })")
        yield
        page.get_by_role("tab", name=TABS[0], exact=True).click()
        program.command("inspect")
        if folded:
            click(page, "#panel .close")

    shown.__name__ = f"the_tab_{name}"
    return state(shown)


IN_TABS = [tab(name) for name in TABS]


@contextlib.contextmanager
def editor(page: Page) -> Iterator[None]:
    click(page, "#edit")
    page.wait_for_selector("#plan .outer")
    yield
    click(page, "#edit-close")


@state
def editing(_program: Program, page: Page) -> Iterator[None]:
    with editor(page):
        yield


@state
def beginning_a_world(_program: Program, page: Page) -> Iterator[None]:
    with editor(page):
        click(page, "#edit-new")
        yield
        page.click("#new-close")


@state
def deleting_a_world(_program: Program, page: Page) -> Iterator[None]:
    with editor(page):
        click(page, "#edit-open")
        page.click("#own-list [aria-label^='Delete A school']")
        yield
        page.click("#delete-dialog [value=keep]")
        page.click("#open-close")


@state
def saving_a_world(_program: Program, page: Page) -> Iterator[None]:
    with editor(page):
        click(page, "#edit-save")
        expect(page.locator("#save-dialog")).to_be_visible()
        yield
        page.click("#save-close")


@state
def measuring_a_plan(_program: Program, page: Page) -> Iterator[None]:
    with editor(page):
        drop(page, ("plan.png", plan_png()))
        until(page, "() => !document.getElementById('open-scale').hidden")
        yield
        page.click("#open-close")


@state
def writing_what_happens_when(program: Program, page: Page) -> Iterator[None]:
    program.command("reset", world="living", seed=5)
    with editor(page):
        click(page, "#edit-time")
        page.locator("#script-lines li").first.wait_for()
        yield
        page.keyboard.press("Escape")


@contextlib.contextmanager
def lesson(program: Program, page: Page) -> Iterator[None]:
    program.command("begin_lesson", name="kidnapped")  # with a loop to be played again
    program.wait(lambda told: told["lesson"] is not None and told["lesson"]["state"] == "predict")
    expect(page.locator("#lesson")).to_have_attribute("data-state", "predict")
    program.command("set_parameter", name="local_view.enabled", value=False)
    expect(page.locator("#replay")).not_to_have_attribute("hidden", "")
    yield
    program.command("set_parameter", name="local_view.enabled", value=True)
    program.command("end_lesson")
    expect(page.locator("#lesson")).to_be_hidden()


@state
def in_a_lesson(program: Program, page: Page) -> Iterator[None]:
    with lesson(program, page):
        yield


@state
def in_a_lesson_before_a_class(program: Program, page: Page) -> Iterator[None]:
    with lesson(program, page), presented(program, page):
        yield


@state
def a_lesson_is_shown(program: Program, page: Page) -> Iterator[None]:
    with lesson(program, page):
        page.click("#lesson-show")
        program.wait(lambda told: told["lesson"]["state"] == "showing")
        program.command("pause")
        expect(page.locator("#lesson")).to_have_attribute("data-state", "showing")
        yield


@state
def a_lesson_is_over(program: Program, page: Page) -> Iterator[None]:
    with lesson(program, page):
        program.command("show_lesson")
        program.command("set_speed", factor=0)
        program.command("resume")
        expect(page.locator("#lesson")).to_have_attribute("data-state", "compared")
        yield
    program.command("pause")


@state
def with_a_trial(program: Program, page: Page) -> Iterator[None]:
    program.command("watch_experiment", experiment="table", engine="ours", quick=True)
    program.command("pause")
    expect(page.locator("#trial")).to_be_visible()
    yield
    program.command("reset", world="office", seed=5)


# ---------------------------------------------------------------- how it looks then


def quiet(page: Page) -> None:
    page.evaluate("() => document.querySelectorAll('.toast').forEach((toast) => toast.remove())")


def begun(program: Program) -> None:
    program.command("reset", world="office", seed=5)
    program.command("step", ticks=300)


LATER = pytest.mark.long


@pytest.mark.parametrize(
    ("sizes", "touched"),
    [
        (SCREENS[:1], False),
        (PHONES[:1], True),
        *(
            pytest.param(*each, marks=LATER)
            for each in ((SCREENS[1:], False), (ENLARGED, False), ([*PHONES[1:], ENLARGED[1]], True))
        ),
        *(pytest.param(sizes, True, marks=LATER) for sizes in (TABLETS, ON_ITS_SIDE)),
    ],
)
def test_nothing_is_covered_cut_or_too_small_and_axe_finds_nothing(
    program: Program, browser: Browser, sizes: list[tuple[int, int]], touched: bool
) -> None:
    """axe looks at each state once, dark on a screen or light on a phone: the next test looks at each in both themes."""
    begun(program)
    light = sizes[0] == PHONES[0]
    with open_page(browser, program.url, *sizes[0], stage=False, touched=touched, light=light) as page:
        wrong: list[str] = []
        for k, shown in enumerate(STATES):
            with shown(program, page):
                quiet(page)
                for size in at_each(page, sizes):
                    wrong += [f"{shown.__name__}, {size}: {each}" for each in boxes(page, touched)]
                if k % 2 == touched:
                    wrong += [f"{shown.__name__}: {each}" for each in findings(page)]
        assert not wrong, "\n".join(wrong)


@LATER
@pytest.mark.parametrize("size", [(1280, 800), (390, 844)])
def test_axe_finds_nothing_in_light_and_dark(program: Program, browser: Browser, size: tuple[int, int]) -> None:
    begun(program)
    with open_page(browser, program.url, *size, stage=False) as page:
        wrong: list[str] = []
        for shown in STATES:
            with shown(program, page):
                for _ in range(2):
                    theme = page.get_attribute("html", "data-theme")
                    wrong += [f"{shown.__name__}, {theme}: {each}" for each in findings(page)]
                    turn_theme(page)
        assert not wrong, "\n".join(wrong)


def test_axe_finds_nothing_on_the_second_screen_in_the_documents_and_before_the_server_has_spoken(
    program: Program, browser: Browser
) -> None:
    wrong: dict[str, list[str]] = {}
    for size in SCREENS[1], PHONES[0]:
        with open_page(browser, f"{program.url}?watch", *size, stage=False) as page:
            wrong[f"watching, {size}"] = [*boxes(page, size[0] < 500), *findings(page)]
    with browser.new_context(viewport={"width": 1440, "height": 900}) as context:
        context.set_default_timeout(PATIENCE_MS)
        page = context.new_page()
        page.goto(f"{program.url}docs")
        page.wait_for_selector("#commands article")
        wrong["the documents"] = findings(page)
        page.select_option("#which", label="pause")
        page.click("text=Send")
        page.wait_for_selector("#answer:has-text('accepted')")
        page.route("**/viser/**", lambda route: route.fulfill(content_type="text/html", body=NO_STAGE))
        page.route_web_socket("**/api/stream**", lambda _socket: None)  # open, and silent
        page.goto(program.url)
        page.wait_for_selector("#panel-senses canvas")
        wrong["before the server has spoken"] = findings(page)
    assert not any(wrong.values()), wrong


CONTROLS = """() => [...document.querySelectorAll("button, select, summary")]
    .filter((part) => part.checkVisibility() && !part.closest(".toast")) // which comes and goes; Escape takes it away
    .filter((part) => part.tabIndex >= 0) // the other tabs of the panel: arrows reach them
    .map((part) => part.id || part.getAttribute("aria-label") || part.textContent)"""
FOCUSED = """() => { const part = document.activeElement;
    return part.id || part.getAttribute("aria-label") || part.textContent; }"""


def test_the_keyboard_reaches_every_control(program: Program, browser: Browser) -> None:
    begun(program)
    with open_page(browser, program.url) as page:
        for shown in plain, in_the_past, compared, in_a_lesson, with_a_trial:
            with shown(program, page):
                wanted, reached = set(page.evaluate(CONTROLS)), set[str]()
                for _ in range(2 * len(wanted)):
                    page.keyboard.press("Tab")
                    reached.add(page.evaluate(FOCUSED))
                    if wanted <= reached:
                        break
                stayed = wanted & set(page.evaluate(CONTROLS))  # a list of views may still be drawn anew
                assert stayed - reached == set(), shown.__name__


OVER_THE_PLATES = [plain, welcomed, on_the_way, in_the_past, branched, compared, presented, stage_by_stage]
OVER_THE_PLATES += [in_a_lesson, in_a_lesson_before_a_class, with_a_trial]


def test_enlarged_four_times_the_page_is_scrolled_and_nothing_lies_over_the_plates(
    program: Program, browser: Browser
) -> None:
    """1280 x 1024 at 400 %: half of what is seen at first is the plates', with nothing but the line of views over them."""
    begun(program)
    with open_page(browser, program.url, 1024, 768, stage=False) as page:
        for shown in OVER_THE_PLATES:
            page.set_viewport_size({"width": 1024, "height": 768})
            with shown(program, page):
                quiet(page)
                list(at_each(page, [(320, 256)]))
                assert boxes(page) == [], shown.__name__
                stage, views = box_of(page.locator("#stage")), box_of(page.locator(".views"))
                assert stage["height"] >= 128, shown.__name__
                assert views["y"] + views["height"] <= stage["y"] + 1, shown.__name__
                page.set_viewport_size({"width": 1024, "height": 768})
        list(at_each(page, [(320, 256)]))
        page.click("#panels")
        expect(page.locator("#panel")).to_be_in_viewport(ratio=0.99)


def test_a_window_that_is_widened_while_presenting_as_on_a_projector_shows_no_panel(
    program: Program, browser: Browser
) -> None:
    with open_page(browser, program.url, 820, 700, stage=False) as page, in_a_lesson_before_a_class(program, page):
        for size in at_each(page, [(820, 700), (1280, 720)]):
            expect(page.locator("#panel")).to_be_hidden()
            quiet(page)
            assert boxes(page) == [], size


A_GAP = 12  # pixels; between what may touch


@LATER
def test_the_rows_of_buttons_leave_the_plates_free(program: Program, browser: Browser) -> None:
    """However many rows they need, in whatever room the lesson and the panel leave: no plate reaches beneath them or is cut."""
    begun(program)
    sizes = [(1400, 800), (1280, 720), (1180, 720), (1024, 768), (390, 844)]
    with open_page(browser, program.url, *sizes[0], stage=False) as page:
        wrong: list[str] = []
        for shown in (plain, presented, in_a_lesson, in_a_lesson_before_a_class):
            with shown(program, page):
                for size in at_each(page, sizes):
                    wrong += [f"{shown.__name__}, {size}, {each}" for each in over_plates(page)]
        assert not wrong, "\n".join(wrong)


def over_plates(page: Page) -> Iterator[str]:
    calm(page)
    canvas, bar = box_of(page.frame_locator("#stage").locator("canvas").first), box_of(page.locator(".stage-bar"))
    for view in VIEWS:
        camera = camera_for(view, canvas["width"] / canvas["height"])
        seen = [on_screen(page, camera, tuple(at), canvas) for at in corners_of(view, True, False)]
        highest, left, right = min(y for _, y in seen), min(x for x, _ in seen), max(x for x, _ in seen)
        if highest < bar["y"] + bar["height"] - A_GAP:
            yield f"{view}: {bar['y'] + bar['height'] - highest:.0f} px beneath the buttons"
        if left < canvas["x"] or right > canvas["x"] + canvas["width"]:
            yield f"{view}: cut at a side"
