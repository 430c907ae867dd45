"""A drawing of the plates stands in their place until viser has drawn them, and where it cannot."""

from __future__ import annotations

import math
import re
import shutil

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, Route

from tests.e2e.browser import PATIENCE_MS, box_of, on_screen, open_page, told, until
from tests.e2e.program import Program
from tests.e2e.test_dashboard import place_of
from web.viewer.camera_views import MAP_AT, camera_for
from web.viewer.fits import MapFit, refit
from web.viewer.plates.map_plate import NODE_Z

FRAME = re.compile(r"/viser/\?")
LOOK = """() => {
    const root = document.documentElement, drawing = document.getElementById('waiting');
    const one = [...drawing.querySelectorAll('svg')].filter((svg) => svg.getBoundingClientRect().width > 0)[0];
    const sheets = [...one.querySelectorAll('.sheet')], theme = root.dataset.theme;
    const fill = (name) => { root.dataset.theme = name; return getComputedStyle(sheets[0]).fill; };
    const fills = [fill('dark'), fill('light')];
    root.dataset.theme = theme;
    const shown = !drawing.hidden && !drawing.classList.contains('over');
    return [document.getElementById('stage').classList.contains('awake'), shown, sheets.length, ...fills];
}"""
DRAWN = "() => document.querySelector('#waiting .picture').innerHTML"


def is_drawn_anew(page: Page, before: str) -> None:
    until(page, f"(before) => ({DRAWN})() !== before", argument=before)


@pytest.mark.long
def test_a_drawing_stands_there_until_the_first_frame(program: Program, browser: Browser) -> None:
    with browser.new_context(viewport={"width": 1280, "height": 800}) as context:
        page = context.new_page()
        held: list[Route] = []
        page.route(FRAME, lambda route: held.append(route))  # a slow server
        page.goto(program.url, wait_until="commit")
        page.wait_for_selector("body[data-alive]", timeout=PATIENCE_MS)
        for width in (390, 1280):
            page.set_viewport_size({"width": width, "height": 800})
            assert page.evaluate(LOOK) == [False, True, 3, "rgb(24, 32, 41)", "rgb(255, 255, 255)"]
        for route in held:
            route.continue_()
        page.wait_for_selector("#stage.awake", timeout=PATIENCE_MS)
        until(page, "() => document.getElementById('waiting').hidden")


def test_without_webgl_the_drawing_stays_goes_on_and_can_be_clicked(program: Program, browser: Browser) -> None:
    program.command("step", ticks=100)
    blind = browser.browser_type.launch(
        executable_path=shutil.which("chromium"), args=["--disable-3d-apis", "--no-sandbox"], timeout=PATIENCE_MS
    )
    with open_page(blind, program.url, stage=False) as page:
        page.wait_for_selector("#waiting.pictured")
        words = page.inner_text("#waiting .words")
        assert "No WebGL" in words
        assert "hardware acceleration" in words
        before = page.evaluate(DRAWN)
        program.command("step", ticks=20)
        is_drawn_anew(page, before)
        before = page.evaluate(DRAWN)
        page.click("[data-view=map]")
        is_drawn_anew(page, before)
        state = program.state(full=True)
        nodes = np.array(state["map"]["xy"])
        x, y = refit(MapFit(), nodes, state["map"]["turn_rad"]).to_plate(nodes[0])[0]
        box = box_of(page.locator("#waiting"))
        place = (MAP_AT[0] + x, MAP_AT[1] + y, NODE_Z)
        page.mouse.click(*on_screen(page, camera_for("map", box["width"] / box["height"]), place, box))
        goal = program.wait(lambda now: now["goal"] is not None)["goal"]
        assert math.dist(place_of(goal), nodes[0]) < 0.2
        page.mouse.click(box["x"] + 4, box["y"] + box["height"] / 2)
        told(page, "No goal set")
        program.command("cancel_goal")
    blind.close()


CONTEXT = """(what) => {
    const canvas = [...document.getElementById("stage").contentDocument.querySelectorAll("canvas")].find((one) => one.width);
    window.held ??= canvas.getContext("webgl2").getExtension("WEBGL_lose_context");
    held[what]();
}"""


@pytest.mark.long
def test_a_context_that_is_lost_leaves_the_drawing_and_one_that_comes_back_the_stage(
    program: Program, browser: Browser
) -> None:
    with open_page(browser, program.url) as page:
        until(page, "() => document.getElementById('waiting').hidden")
        page.evaluate(CONTEXT, "loseContext")
        page.wait_for_selector("#waiting.pictured:not(.over)")
        assert page.locator("#stage.awake").count() == 0
        assert "taken the graphics away" in page.inner_text("#waiting .words")
        before = page.evaluate(DRAWN)
        program.command("step", ticks=20)
        is_drawn_anew(page, before)
        page.evaluate(CONTEXT, "restoreContext")
        page.wait_for_selector("#stage.awake")
        until(page, "() => document.getElementById('waiting').hidden")
        assert len(page.frame_locator("#stage").locator("canvas").first.screenshot()) > 20_000
