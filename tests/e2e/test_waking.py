"""A drawing of the plates stands in their place until viser has drawn them."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Route

from tests.e2e.browser import PATIENCE_MS, open_page, until
from tests.e2e.program import Program
from tests.e2e.test_touch import await_

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


@pytest.mark.parametrize("width", [1280, 390])
def test_a_drawing_stands_there_until_the_first_frame(program: Program, browser, width) -> None:
    context = browser.new_context(viewport={"width": width, "height": 800})
    page = context.new_page()
    held: list[Route] = []
    page.route(FRAME, lambda route: held.append(route))  # a slow server
    page.goto(program.url, wait_until="commit")
    page.wait_for_selector("body[data-alive]", timeout=PATIENCE_MS)
    assert page.evaluate(LOOK) == [False, True, 3, "rgb(24, 32, 41)", "rgb(255, 255, 255)"]
    for route in held:
        route.continue_()
    page.wait_for_selector("#stage.awake", timeout=PATIENCE_MS)
    until(page, "() => document.getElementById('waiting').hidden")
    picture = page.frame_locator("#stage").locator("canvas").first.screenshot()
    assert len(picture) > 20_000  # an empty canvas compresses to far less
    context.close()


def test_the_page_says_which_tabs_are_open(program: Program, browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        told: list[str] = []
        page.on("websocket", lambda socket: socket.on("framesent", lambda frame: told.append(str(frame))))
        page.reload()
        senses, truth = (f'{{"type":"tabs","names":["{name}"]}}' for name in ("Senses", "Truth"))
        await_(page, lambda: senses in told)
        page.get_by_role("tab", name="Truth").click()
        await_(page, lambda: truth in told)
        page.keyboard.press("p")
        await_(page, lambda: told[-1] == '{"type":"tabs","names":[]}')  # nobody sees what is hidden
