"""Whatever the page shows, at every size, in both themes: nothing is covered, nothing is cut, all that can be pressed is large
enough for who presses it, the keyboard reaches it, and axe finds nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest
from playwright.sync_api import Browser, Page, expect

from app.experiments.store import Outcome, Store
from app.protocol.course import Moment
from app.protocol.experiment import chosen_trial, find_experiment
from app.protocol.trial import Result
from sim2d import load_world, world_to_json
from tests.e2e.browser import NO_STAGE, PATIENCE_MS, at_each, box_of, calm, on_screen, open_page, turn_theme, until
from tests.e2e.editor import drop, plan_png
from tests.e2e.layout import boxes, findings, unreached
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
    scores = {"goals": 3.0, "reached": 1.0, "kidnaps": 0.0, "recovered": 0.0}
    result = Result(trial.id, scores, Moment(61.5, "kitchen: not reached"), 90.0, 1.0, "")
    with Store(store) as opened:
        opened.add([(trial, Outcome(trial.id, result))])
    kept = {"RATSLAM_WORLDS": str(own), "RATSLAM_EXPERIMENTS": str(store)}
    made = Program("--port", "0", "--seed", "5", "--paused", **kept)
    yield made
    assert made.stop() == 0


# ---------------------------------------------------------------- what it can show

Shown = tuple[str, str]  # what the page shows, and the part of it that is new
Journey = Callable[[Program, Page], Iterator[Shown]]


def click(page: Page, part: str) -> None:
    """Wherever it is: on a phone in a menu."""
    page.locator(part).first.evaluate("(part) => part.click()")


def over_the_plates(program: Program, page: Page) -> Iterator[Shown]:
    yield "as it begins", "html"
    click(page, "#help-first")
    expect(page.locator("#first")).to_be_visible()
    yield "a welcome", "#first"
    click(page, "#first-close")
    program.command("seek", tick=200)
    expect(page.locator("#now")).to_be_visible()
    yield "the past", "body"
    program.command("go_on_from_here")
    expect(page.locator("#now")).to_be_hidden()
    program.command("set_goal", x=0.0, y=0.0)
    expect(page.locator("#goal")).to_be_visible()
    yield "a goal, on a branch", "header"
    program.command("cancel_goal")
    program.command("step_stage")
    expect(page.locator("#walk")).to_be_visible()
    yield "a stage of a tick", "#walk"
    program.command("compare_brains", pair="vision", since="now")
    program.command("step", ticks=20)
    expect(page.locator("#beside-second")).to_contain_text("without vision")
    yield "two brains", "main"
    page.keyboard.press("z")
    yield "two brains, presented", "body"
    page.keyboard.press("z")
    program.command("end_comparison")


def lesson(program: Program, page: Page) -> Iterator[Shown]:
    def is_in(state: str) -> None:
        expect(page.locator("#lesson")).to_have_attribute("data-state", state)

    program.command("begin_lesson", name="kidnapped")  # with a loop to be played again
    is_in("predict")
    program.command("set_parameter", name="local_view.enabled", value=False)
    expect(page.locator("#replay")).not_to_have_attribute("hidden", "")
    yield "a lesson", "main"
    page.keyboard.press("z")
    yield "a lesson, presented", "main"
    page.keyboard.press("z")
    program.command("set_parameter", name="local_view.enabled", value=True)
    page.click("#lesson-show")
    is_in("showing")
    program.command("pause")
    yield "a lesson that is shown", "#lesson"
    program.command("set_speed", factor=0)
    program.command("resume")
    is_in("compared")
    yield "a lesson that is over", "#lesson"
    program.command("end_lesson")
    expect(page.locator("#lesson")).to_be_hidden()
    program.command("pause")


def trial(program: Program, page: Page) -> Iterator[Shown]:
    program.command("watch_experiment", experiment="table", engine="ours", quick=True)
    program.command("pause")
    expect(page.locator("#trial")).to_be_visible()
    yield "a trial", "main"
    program.command("reset", world="office", seed=5)


def menus(program: Program, page: Page) -> Iterator[Shown]:
    program.command("kidnap")
    page.click("#bookmark")
    page.get_by_label("Name of the bookmark").press("Enter")
    expect(page.locator("#bookmark-list li")).to_have_count(1)
    yield "events and a bookmark", "#events-box"
    page.locator("#bookmark-list").get_by_role("button", name="Delete").click()
    page.keyboard.press("Escape")
    page.click("#keep summary")
    yield "a menu", "#keep"
    page.keyboard.press("Escape")
    page.click("#keep summary")  # who changes the theme meanwhile closes it, too
    page.get_by_role("button", name="Link to this moment").click()
    expect(page.locator("#share-dialog")).to_be_visible()
    yield "a link", "#share-dialog"
    page.click("#share-close")
    click(page, "[aria-label='Compare brains']")
    yield "a choice of brains", "main"
    page.keyboard.press("Escape")
    if page.locator("#more").is_visible():
        page.click("#more")
        yield "the menu of a phone", "header"
        page.click("#more")


def dialogs(_program: Program, page: Page) -> Iterator[Shown]:
    for key, filled in ("?", "#help-plates li"), ("c", "#lessons-list button"), ("/", "li"), ("g", ".card"):
        page.keyboard.press(key)
        page.locator("dialog[open]").locator(filled).first.wait_for()
        yield f"the dialog of {key}", "dialog[open]"
        if key == "g":
            page.click(".card[data-name=table] .trials")
            page.wait_for_selector("#one-grid .cell")
            page.get_by_label("2 %, 8 x 8: ").click()
            yield "trials", "dialog[open]"
        click(page, "dialog[open] .dialog-head [aria-label=Close]")
        expect(page.locator("dialog[open]")).to_have_count(0)


def tabs(program: Program, page: Page) -> Iterator[Shown]:
    folded = page.get_attribute("body", "data-panels") == "false"
    if folded:
        click(page, "#panels")
    program.command("inspect", experience=3)
    for name in TABS:
        page.get_by_role("tab", name=name, exact=True).click()
        until(page, "() => document.querySelector('[role=tabpanel]:not([hidden])').textContent.length > 20")
        page.evaluate("() => document.querySelectorAll('#panel details').forEach((part) => { part.open = true; })")
        yield f"the tab {name}", "#panel"
    page.get_by_role("tab", name=TABS[0], exact=True).click()
    program.command("inspect")
    if folded:
        click(page, "#panel .close")


def editor(program: Program, page: Page) -> Iterator[Shown]:
    program.command("reset", world="living", seed=5)
    click(page, "#edit")
    page.wait_for_selector("#plan .outer")
    yield "the editor", "#editor"
    click(page, "#edit-new")
    yield "a world that begins", "#new-dialog"
    page.click("#new-close")
    click(page, "#edit-open")
    page.click("#own-list [aria-label^='Delete A school']")
    yield "a world that is deleted", "#delete-dialog"
    page.click("#delete-dialog [value=keep]")
    page.click("#open-close")
    click(page, "#edit-save")
    expect(page.locator("#save-dialog")).to_be_visible()
    yield "a world that is saved", "#save-dialog"
    page.click("#save-close")
    drop(page, ("plan.png", plan_png()))
    until(page, "() => !document.getElementById('open-scale').hidden")
    yield "a plan that is measured", "#open-dialog"
    page.click("#open-close")
    click(page, "#edit-time")
    page.locator("#script-lines li").first.wait_for()
    yield "what happens when", "#editor"
    page.keyboard.press("Escape")
    click(page, "#edit-close")
    program.command("reset", world="office", seed=5)


JOURNEYS: list[Journey] = [over_the_plates, menus, dialogs, tabs, editor, lesson, trial]
TABBED = {"as it begins", "the past", "two brains", "a lesson", "a trial"}


def moments(program: Program, page: Page, journeys: list[Journey] = JOURNEYS) -> Iterator[Shown]:
    """One after the other, each without a toast."""
    program.command("reset", world="office", seed=5)
    program.command("step", ticks=300)
    for journey in journeys:
        for shown in journey(program, page):
            page.evaluate("() => document.querySelectorAll('.toast').forEach((toast) => toast.remove())")
            yield shown


# ---------------------------------------------------------------- how it looks then

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
    """axe looks at what is new in each moment once, dark on a screen or light on a phone: the next test looks at all of it,
    in both themes."""
    light = sizes[0] == PHONES[0]
    with open_page(browser, program.url, *sizes[0], stage=False, touched=touched, light=light) as page:
        wrong: list[str] = []
        for k, (shown, part) in enumerate(moments(program, page)):
            for size in at_each(page, sizes):
                wrong += [f"{shown}, {size}: {each}" for each in boxes(page, touched)]
            if k % 2 == touched:
                wrong += [f"{shown}: {each}" for each in findings(page, part)]
        assert not wrong, "\n".join(wrong)


@LATER
@pytest.mark.parametrize("size", [(1280, 800), (390, 844)])
def test_axe_finds_nothing_in_light_and_dark(program: Program, browser: Browser, size: tuple[int, int]) -> None:
    with open_page(browser, program.url, *size, stage=False) as page:
        wrong: list[str] = []
        for shown, _ in moments(program, page):
            for _ in range(2):
                theme = page.get_attribute("html", "data-theme")
                wrong += [f"{shown}, {theme}: {each}" for each in findings(page)]
                turn_theme(page)
        assert not wrong, "\n".join(wrong)


def test_the_keyboard_reaches_every_control_and_a_page_enlarged_four_times_is_scrolled(
    program: Program, browser: Browser
) -> None:
    """1280 x 1024 at 400 %: half of what is seen at first is the plates', with nothing but the line of views over them. And
    a window that is widened while presenting, as on a projector, shows no panel."""
    with open_page(browser, program.url, 1024, 768, stage=False) as page:
        wrong: list[str] = []
        for shown, _ in moments(program, page, [over_the_plates, lesson, trial]):
            if shown in TABBED:
                wrong += [f"{shown}: Tab does not reach {part}" for part in unreached(page)]
            list(at_each(page, [(320, 256)]))
            stage, views = box_of(page.locator("#stage")), box_of(page.locator(".views"))
            wrong += [f"{shown}: {each}" for each in boxes(page)]
            if stage["height"] < 128 or views["y"] + views["height"] > stage["y"] + 1:
                wrong.append(f"{shown}: too little is left of the plates")
            for size in at_each(page, [(820, 700), (1280, 720)] if shown.endswith("presented") else []):
                expect(page.locator("#panel")).to_be_hidden()
                wrong += [f"{shown}, {size}: {each}" for each in boxes(page)]
            list(at_each(page, [(1024, 768)]))
        assert not wrong, "\n".join(wrong)
        list(at_each(page, [(320, 256)]))
        page.click("#panels")
        expect(page.locator("#panel")).to_be_in_viewport(ratio=0.99)


def test_axe_finds_nothing_on_the_second_screen_in_the_documents_and_before_the_server_has_spoken(
    program: Program, browser: Browser
) -> None:
    """The second screen has nothing that steers."""
    wrong: dict[str, list[str]] = {}
    steers = "header button:visible, header select:enabled:visible, .aids button:visible, footer button:visible"
    looks = {"", None, "theme", "follow", "zoom-out", "zoom-in", "zoom-all", "panels"}
    for size in SCREENS[1], PHONES[0]:
        with open_page(browser, f"{program.url}?watch", *size, stage=False) as page:
            wrong[f"watching, {size}"] = [*boxes(page, size[0] < 500), *findings(page)]
            assert {part.get_attribute("id") for part in page.locator(steers).all()} <= looks, size
    with browser.new_context(viewport={"width": 1440, "height": 900}) as context:
        context.set_default_timeout(PATIENCE_MS)
        context.add_init_script("localStorage.level = 'lab'")
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


A_GAP = 12  # pixels; between what may touch


@LATER
def test_the_rows_of_buttons_leave_the_plates_free(program: Program, browser: Browser) -> None:
    """However many rows they need, in whatever room the lesson and the panel leave: no plate reaches beneath them or is cut."""
    sizes = [(1400, 800), (1280, 720), (1180, 720), (1024, 768), (390, 844)]
    with open_page(browser, program.url, *sizes[0], stage=False) as page:
        wrong: list[str] = []
        for shown, _ in moments(program, page, [lesson, over_the_plates]):
            if shown in ("a lesson", "a lesson, presented", "as it begins"):
                for size in at_each(page, sizes):
                    wrong += [f"{shown}, {size}, {each}" for each in over_plates(page)]
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


@LATER
def test_the_editor_s_bar_is_one_row_saved_or_not(program: Program, browser: Browser) -> None:
    with open_page(browser, program.url, *SCREENS[1], stage=False) as page:
        page.click("#edit")
        page.wait_for_selector("#editor .bar")
        for size in at_each(page, SCREENS[1::-1]):
            bars = set[tuple[float, ...]]()
            for unsaved in ("false", "true"):
                page.evaluate(f"() => {{ document.getElementById('edit-unsaved').hidden = !{unsaved}; }}")
                undo, close, bar = (
                    box_of(page.locator(part)) for part in ("#edit-undo", "#edit-close", "#editor .bar")
                )
                assert undo["y"] < close["y"] + close["height"] / 2 < undo["y"] + undo["height"], size
                assert close["x"] + close["width"] <= bar["x"] + bar["width"], size
                bars.add(tuple(bar.values()))
            assert len(bars) == 1, size
