"""The side panel in a real browser, without the plates: what it shows, its controls, its keys, its layout."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.e2e.browser import open_page, told, turn_theme, until
from tests.e2e.program import Program
from web.panel.panel import TABS
from web.viewer.primitives.palette import palette_of

COLOURS = """(canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const seen = new Set();
    for (let k = 0; k < data.length; k += 4) seen.add(data.slice(k, k + 3).join());
    return seen.size; }"""


@pytest.fixture(scope="module")
def walked(program: Program) -> Program:
    """A minute of exploring, paused."""
    program.command("pause")
    program.command("reset", seed=5)
    program.command("step", ticks=600)
    return program


@pytest.fixture(scope="module")
def opened(walked: Program, browser) -> Iterator[Page]:
    with open_page(browser, walked.url, stage=False) as page:
        yield page


@pytest.fixture
def page(opened: Page) -> Page:
    """The page with its first tab open, in the dark, whatever was chosen before."""
    if opened.get_attribute("html", "data-theme") != "dark":
        turn_theme(opened)
    show(opened, "Senses")
    opened.evaluate("() => { document.activeElement.blur(); window.toasted.clear(); }")
    return opened


def tab(page: Page, name: str) -> Locator:
    return page.get_by_role("tab", name=name, exact=True)


def show(page: Page, name: str) -> Locator:
    tab(page, name).click()
    return page.get_by_role("tabpanel", name=name)


# ---------------------------------------------------------------- what it shows


def test_pictures_are_drawn_into_canvases(walked: Program, page: Page) -> None:
    panel = page.get_by_role("tabpanel", name="Senses")
    camera = panel.get_by_role("img", name="what the robot's camera sees")
    until(page, f"() => ({COLOURS})(document.querySelector('#panel-senses canvas')) > 20")
    above = panel.get_by_role("img", name="pose cells seen from above")
    assert above.evaluate(COLOURS) > 3  # a packet
    before = camera.evaluate("(canvas) => canvas.toDataURL()")
    for _ in range(20):  # it drives on and sees something else
        walked.command("step")
    until(page, "(was) => document.querySelector('#panel-senses canvas').toDataURL() !== was", argument=before)
    state = walked.state()
    expect(panel).to_contain_text(f"of {state['views']})")


@pytest.mark.long
def test_every_tab_shows_something(page: Page) -> None:
    words = {
        "Senses": "local view cells",
        "Memory": "links of the goal memory",
        "Inspect": "Nothing is chosen",
        "Tick": "of its 100 ms",
        "Truth": "map error, after alignment",
        "Office": "Sets",
        "Tune": "parameters",
    }
    for name in TABS:
        panel = show(page, name)
        if name == "Office":
            expect(panel.get_by_label("preset", exact=True)).to_be_visible()
        else:
            expect(panel).to_contain_text(words[name])
        if name == "Truth":
            expect(panel.locator("canvas")).to_have_count(3)


@pytest.mark.long
def test_plots_follow_the_theme(page: Page) -> None:
    show(page, "Truth")
    canvas = page.locator("#panel-truth canvas").first
    expect(canvas).to_be_visible()
    dark = canvas.evaluate("(canvas) => canvas.toDataURL()")
    turn_theme(page)
    until(page, "(was) => document.querySelector('#panel-truth canvas')?.toDataURL() !== was", argument=dark)


@pytest.mark.long
def test_the_panel_s_colours_are_those_of_the_plates(page: Page) -> None:
    named = "(name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim()"
    for theme in ("dark", "light"):
        if page.get_attribute("html", "data-theme") != theme:
            turn_theme(page)
        palette = palette_of(theme)  # type: ignore[arg-type]
        shown = [page.evaluate(named, f"--packet-{k + 1}") for k in range(4)]
        assert shown == ["#{:02x}{:02x}{:02x}".format(*colour) for colour in palette.packets]


@pytest.mark.long
def test_the_marks_among_the_pose_cells_have_a_legend(page: Page) -> None:
    panel = show(page, "Memory")
    panel.get_by_text("Marks among the pose cells").click()
    expect(panel).to_contain_text("where the winning packet was (start) and where the views brought it (finish)")


@pytest.mark.long
@pytest.mark.parametrize("name", ["Memory", "Inspect"])
def test_words_of_tables_stand_on_one_line(page: Page, name: str) -> None:
    panel = show(page, name)
    if name == "Inspect":
        panel.get_by_role("button", name="experience", exact=True).click()
        expect(panel).to_contain_text("energy now")
    broken = """() => [...document.querySelectorAll("[role=tabpanel]:not([hidden]) th")]
        .filter((cell) => cell.getClientRects().length && cell.clientHeight > 30).map((cell) => cell.textContent)"""
    assert page.evaluate(broken) == []


# ---------------------------------------------------------------- controls


def test_a_parameter_is_found_turned_and_set_back(page: Page) -> None:
    panel = show(page, "Tune")
    panel.get_by_role("searchbox").fill("match threshold")
    expect(panel.get_by_role("status")).to_contain_text("parameter")
    knob = panel.locator(".knob:visible").first
    field = knob.get_by_role("spinbutton")
    was = field.input_value()
    field.fill("7.5")
    field.press("Enter")
    told_of = "() => document.getElementById('events').textContent.includes('match_threshold')"
    until(page, told_of)
    knob.get_by_role("button", name="Back to the default").click()
    expect(field).to_have_value(was)
    expect(knob.get_by_role("button", name="Back to the default")).to_be_hidden()
    field.fill("-3")
    field.press("Enter")
    told(page, "match_threshold")  # why not
    expect(field).to_have_value(was)
    panel.get_by_role("searchbox").fill("no such thing")
    expect(panel.get_by_role("status")).to_have_text("nothing is called “no such thing”")


@pytest.mark.long
def test_what_waits_for_a_reset_says_so(page: Page) -> None:
    panel = show(page, "Tune")
    expect(panel.locator(".knob").nth(50)).to_be_attached()
    panel.get_by_role("searchbox").fill("takes effect at reset")
    assert panel.locator(".knob:visible").count() > 3
    assert panel.locator(".knob:visible").count() == panel.locator(".knob:visible [role=img]").count()


@pytest.mark.long
def test_what_somebody_types_stays_typed(walked: Program, page: Page) -> None:
    panel = show(page, "Tune")
    panel.get_by_role("searchbox").fill("match threshold")
    field = panel.locator(".knob:visible").get_by_role("spinbutton").first
    field.press("Control+a")
    field.press_sequentially("1")
    walked.command("step")
    page.wait_for_timeout(500)
    assert field.input_value() == "1"
    field.press("Escape")


@pytest.mark.long
def test_a_switch_is_on_for_all_who_look(walked: Program, page: Page, browser) -> None:
    mine = show(page, "Memory").get_by_label("Occupancy among the pose cells")
    with open_page(browser, walked.url, stage=False) as other:
        theirs = show(other, "Memory").get_by_label("Occupancy among the pose cells")
        expect(theirs).not_to_be_checked()
        mine.check()
        expect(theirs).to_be_checked()
        theirs.uncheck()
        expect(mine).not_to_be_checked()


@pytest.mark.long
def test_a_key_drives_although_a_switch_has_been_clicked(walked: Program, page: Page) -> None:
    show(page, "Memory").get_by_label("Goal memory").click()
    walked.command("resume")
    page.keyboard.down("ArrowLeft")
    walked.wait(lambda state: state["mode"] == "manual")
    page.keyboard.up("ArrowLeft")
    walked.command("pause")
    page.get_by_label("Goal memory").click()


def test_a_tick_goes_stage_by_stage_from_the_panel(page: Page) -> None:
    panel = show(page, "Tick")
    panel.get_by_role("button", name="next stage").click()
    expect(panel).to_contain_text("Stage 1 of 9")
    panel.get_by_role("button", name="next stage").click()
    expect(panel.locator("[aria-current]")).to_contain_text("View match")
    panel.get_by_role("button", name="back").click()
    expect(panel.locator("[aria-current]")).to_contain_text("Image and odometry")
    panel.get_by_role("button", name="tick", exact=True).click()
    expect(panel).to_contain_text("Press next stage")


# ---------------------------------------------------------------- keys and sizes


def test_arrows_go_from_tab_to_tab(page: Page) -> None:
    tab(page, "Senses").focus()
    for key, name in (
        ("ArrowRight", "Memory"),
        ("End", "Tune"),
        ("ArrowRight", "Senses"),
        ("ArrowLeft", "Tune"),
        ("Home", "Senses"),
    ):
        page.keyboard.press(key)
        expect(tab(page, name)).to_be_focused()
        expect(tab(page, name)).to_have_attribute("aria-selected", "true")
        expect(page.get_by_role("tabpanel", name=name)).to_be_visible()
    in_order = "() => [...document.querySelectorAll('[role=tab]')].filter((tab) => tab.tabIndex === 0).length"
    assert page.evaluate(in_order) == 1
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")  # past the button that hides it
    expect(page.get_by_role("tabpanel", name="Senses")).to_be_focused()
