"""Bookmarks as a person uses them: name a moment by a key, go there, name it otherwise, delete it."""

from __future__ import annotations

from playwright.sync_api import Browser, expect

from tests.e2e.browser import open_page
from tests.e2e.program import Program


def test_name_a_moment_and_go_there(program: Program, browser: Browser) -> None:
    program.command("step", ticks=100)
    tick = program.state()["tick"]
    with open_page(browser, program.url, stage=False) as page:
        page.keyboard.press("m")
        field = page.get_by_label("Name of the bookmark")
        expect(field).to_be_focused()
        page.keyboard.type("before the door")  # what stands there is selected
        page.keyboard.press("Enter")
        row = page.locator("#bookmark-list li")
        expect(row).to_contain_text("before the door")
        expect(page.locator("#timeline .bookmark")).to_have_count(1)
        program.command("step", ticks=50)
        page.get_by_role("button", name="before the door", exact=False).first.click()
        program.wait(lambda state: state["tick"] == tick)
        page.get_by_role("button", name="Link to before the door").click()
        expect(page.locator("#share-words")).to_contain_text(f"tick {tick},")
        page.click("#share-close")
        page.get_by_role("button", name="Another name for before the door").click()
        page.keyboard.type("the door")
        page.keyboard.press("Escape")
        expect(row).to_contain_text("before the door")
        expect(page.locator("#events-box")).to_be_visible()
        page.get_by_role("button", name="Delete before the door").click()
        expect(row).to_have_count(0)
        program.command("back_to_now")
