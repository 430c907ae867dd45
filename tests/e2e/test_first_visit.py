"""The first visit: what this is, three things to do, done by doing them; and what a presenter's page looks like."""

from __future__ import annotations

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from tests.e2e.browser import on_screen, open_page, show, until
from tests.e2e.program import Program
from tests.e2e.test_dashboard import Place, node_on_stage
from web.viewer.fits import DEPTH, WIDTH
from web.viewer.plates.map_plate import NODE_Z, ORIGIN

MOST_WORDS = 60
STATES = "() => [...document.querySelectorAll('#first li')].map((row) => row.dataset.state)"


def far_node(program: Program) -> Place:
    """The experience farthest from the robot, on the stage."""
    state = program.state(full=True)
    nodes = np.array(state["map"]["xy"])
    away = np.hypot(*(nodes - [state["estimate"]["x"], state["estimate"]["y"]]).T)
    return node_on_stage(program, nodes[np.argmax(away)], nodes)


def is_done(page: Page, row: int) -> None:
    until(page, f"() => ({STATES})()[{row}] === 'done'")


@pytest.mark.long
def test_a_newcomer_sends_it_and_sees_a_kidnap_through(program: Program, browser: Browser) -> None:
    program.command("reset", seed=23)
    program.command("resume")
    with open_page(browser, program.url, first=True) as page:
        card = page.locator("#first")
        expect(card).to_be_visible()
        assert len(card.inner_text().split()) <= MOST_WORDS
        page.click("#first-explore")
        is_done(page, 0)
        program.command("pause")  # nothing moves while the person aims
        was = program.state()["robot"]
        show(page, "map")
        corner = ORIGIN[0] - 0.42 * WIDTH, ORIGIN[1] + 0.42 * DEPTH, NODE_Z  # of the map, beneath where the card was
        assert page.evaluate("(at) => document.elementFromPoint(...at).id", on_screen(page, "map", corner)) == "stage"
        page.mouse.click(*on_screen(page, "map", far_node(program)))
        until(page, "() => !document.getElementById('goal').hidden")
        page.select_option("#speed", "0")
        page.click("#play")
        is_done(page, 1)
        program.command("kidnap", **was)  # by chance it may be put where it has to search for long
        is_done(page, 2)
        expect(page.locator("#first-end")).to_be_visible()
        page.click("#first-close")
        expect(card).to_be_hidden()
        page.reload()
        page.wait_for_selector("body[data-alive]")
        expect(card).to_be_hidden()
    program.command("pause")  # or it would go on as fast as it can beside all that follows


@pytest.mark.long
def test_a_presenter_has_large_words_no_panel_and_a_light_to_point_with(program: Program, browser: Browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        size = "() => parseFloat(getComputedStyle(document.getElementById('status')).fontSize)"
        before = page.evaluate(size)
        page.keyboard.press("z")
        expect(page.locator("#panel")).to_be_hidden()
        assert page.evaluate(size) > before
        page.keyboard.press("q")
        page.mouse.move(300, 300)
        expect(page.locator("#spot")).to_be_visible()
        until(page, "() => document.getElementById('spot').style.getPropertyValue('--x') === '300px'")
        page.keyboard.press("z")
        expect(page.locator("#panel")).to_be_visible()
        expect(page.locator("#spot")).to_be_hidden()
