"""How much of the page is in sight: little at first, more when it is asked for, and never a thing that cannot be reached."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from tests.e2e.browser import on_screen, open_page
from tests.e2e.layout import IN_SIGHT
from tests.e2e.program import Program
from web.viewer.camera_views import CELLS_AT

pytestmark = pytest.mark.long

MOST = 18
GONE = """(level) => [...document.querySelectorAll("[data-from]")].filter((part) => part.dataset.from === level
    && getComputedStyle(part).display === "none" && !part.hidden && !part.matches("[data-shows-panel]"))
    .map((part) => part.id || part.textContent)"""


def level(page: Page) -> str:
    return page.evaluate("() => document.body.dataset.level")


def test_at_first_there_is_little_in_sight_and_one_step_further_is_all(fake, browser) -> None:
    with open_page(browser, fake[1], 1280, 720, first=True, stage=False) as page:
        controls, _ = page.evaluate(IN_SIGHT)
        assert len(controls) <= MOST, controls
        expect(page.locator("#panel")).to_be_hidden()
        page.click("#level-explore")
        expect(page.locator("#panel")).to_be_visible()
        assert page.evaluate(GONE, "explore") == []
        expect(page.locator("#tab-tune")).to_be_hidden()
        page.click("#level-lab")
        assert page.evaluate(GONE, "explore") + page.evaluate(GONE, "lab") == []
        page.click("#tab-tune")
        page.click("#level-explore")
        expect(page.locator("#tab-senses")).to_have_attribute("aria-selected", "true")  # the open one has gone
        page.reload()
        page.wait_for_selector("body[data-alive]")
        assert level(page) == "explore"


def test_what_is_asked_for_brings_its_level_and_the_choice_stays(program: Program, browser) -> None:
    program.command("pause")
    program.command("step", ticks=100)
    with open_page(browser, program.url, 1280, 720, level="watch") as page:
        page.keyboard.press("p")
        expect(page.locator("#panel")).to_be_visible()
        assert level(page) == "explore"
        page.click("#level-watch")
        expect(page.locator("#panel")).to_be_hidden()
        program.command("inspect", experience=0)  # somebody else does
        program.command("step", ticks=100)
        seconds = int(program.state()["time_s"])
        expect(page.locator("#clock")).to_have_text(f"{seconds // 60}:{seconds % 60:02d}")
        assert level(page) == "watch"
        page.mouse.click(*on_screen(page, "all", (CELLS_AT[0] - 3.0, CELLS_AT[1] - 3.0, 0.0)))
        expect(page.locator("#tab-inspect")).to_have_attribute("aria-selected", "true")
        assert level(page) == "lab"
        page.reload()
        page.wait_for_selector("body[data-alive]")
        assert level(page) == "watch"
