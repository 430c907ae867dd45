"""The side panel's canvases, colours and lines of words. What its tabs tell and do is in tests/page."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.e2e.browser import open_page, turn_theme, until
from tests.e2e.program import Program
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


# ---------------------------------------------------------------- keys and sizes
