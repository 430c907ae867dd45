"""The first visit: what this is, three things to do, done by doing them; and a presenter."""

from __future__ import annotations

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.browser import on_screen, open_page, show, until
from tests.e2e.program import Program
from web.viewer.fits.map_fit import DEPTH, WIDTH, MapFit, refit
from web.viewer.plates.map_plate import NODE_Z, ORIGIN

MOST_WORDS = 60
STATES = "() => [...document.querySelectorAll('#first li')].map((row) => row.dataset.state)"


@pytest.fixture(scope="module")
def fresh():
    made = Program("--port", "0", "--seed", "23")
    yield made
    assert made.stop() == 0


def far_node(program: Program) -> tuple[float, float, float]:
    """The experience farthest from the robot, on the stage."""
    state = program.state(full=True)
    nodes = np.array(state["map"]["xy"])
    away = np.hypot(*(nodes - [state["estimate"]["x"], state["estimate"]["y"]]).T)
    x, y = refit(MapFit(), nodes, state["map"]["turn_rad"]).to_plate(nodes[[np.argmax(away)]])[0]
    return ORIGIN[0] + x, ORIGIN[1] + y, ORIGIN[2] + NODE_Z


def is_done(page: Page, row: int) -> None:
    until(page, f"() => ({STATES})()[{row}] === 'done'")


@pytest.mark.long
def test_a_newcomer_sends_it_and_sees_a_kidnap_through(fresh, browser) -> None:
    with open_page(browser, fresh.url, first=True) as page:
        card = page.locator("#first")
        expect(card).to_be_visible()
        words = page.evaluate("() => document.getElementById('first').innerText.split(/\\s+/).filter(Boolean).length")
        assert words <= MOST_WORDS
        assert page.evaluate(STATES) == ["now", "later", "later"]
        page.click("#first-explore")
        is_done(page, 0)
        until(page, "() => document.getElementById('first-share').hidden")
        fresh.command("pause")  # nothing moves while the person aims
        was = fresh.state()["robot"]
        show(page, "map")
        corner = ORIGIN[0] - 0.42 * WIDTH, ORIGIN[1] + 0.42 * DEPTH, NODE_Z  # of the map, beneath where the card was
        assert page.evaluate("(at) => document.elementFromPoint(...at).id", on_screen(page, "map", corner)) == "stage"
        page.mouse.click(*on_screen(page, "map", far_node(fresh)))
        until(page, "() => !document.getElementById('goal').hidden")
        page.select_option("#speed", "0")
        page.click("#play")
        is_done(page, 1)
        fresh.command("kidnap", **was)  # by chance it may be put where it has to search for long
        is_done(page, 2)
        expect(page.locator("#first-end")).to_be_visible()
        page.click("#first-close")
        expect(card).to_be_hidden()
        page.reload()
        page.wait_for_selector("body[data-alive]")
        expect(card).to_be_hidden()
        page.keyboard.press("?")
        page.click("#help-first")
        expect(card).to_be_visible()
    fresh.command("pause")  # or it would go on as fast as it can beside all that follows
    fresh.command("set_speed", factor=1)


@pytest.mark.long
def test_a_presenter_goes_on_and_back_without_the_panel(fresh, browser) -> None:
    with open_page(browser, fresh.url, stage=False) as page:
        size = "() => parseFloat(getComputedStyle(document.getElementById('status')).fontSize)"
        before = page.evaluate(size)
        page.keyboard.press("z")
        expect(page.locator("#panel")).to_be_hidden()
        assert page.evaluate(size) > before
        shown = page.locator(".views [aria-pressed=true]")
        page.keyboard.press("PageDown")
        page.keyboard.press("PageDown")
        expect(shown).to_have_text("Pose cells")
        page.keyboard.press("PageUp")
        expect(shown).to_have_text("Office")
        page.evaluate("() => document.addEventListener('presenter:next', (event) => event.preventDefault())")
        page.keyboard.press("PageDown")  # somebody else goes through something
        expect(shown).to_have_text("Office")
        page.keyboard.press("q")
        page.mouse.move(300, 300)
        expect(page.locator("#spot")).to_be_visible()
        until(page, "() => document.getElementById('spot').style.getPropertyValue('--x') === '300px'")
        page.keyboard.press("z")
        expect(page.locator("#panel")).to_be_visible()
        expect(page.locator("#spot")).to_be_hidden()
        page.keyboard.press("PageDown")
        expect(shown).to_have_text("Office")
