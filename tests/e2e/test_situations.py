"""A moment as a person shares it: a link, opened in another browser context and by another program; a file; Python."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.e2e.browser import open_page, told
from tests.e2e.program import Program


def keep(page: Page, words: str) -> None:
    page.click("#keep summary")
    page.get_by_role("button", name=words).click()


def link_from(page: Page, look: Callable[[Page], list[str]] = lambda _page: []) -> str:
    keep(page, "Link to this moment")
    expect(page.locator("#share-dialog")).to_be_visible()
    assert look(page) == []
    link = page.input_value("#share-link")
    expect(page.locator("#share-length")).to_have_text(f"{len(link)} characters")
    page.click("#share-close")
    return link


@pytest.mark.long
def test_a_link_is_opened_elsewhere(program: Program, browser: Browser) -> None:
    program.command("step", ticks=100)
    program.command("kidnap", x=2.0, y=6.0)
    program.command("step", ticks=50)
    with open_page(browser, program.url, stage=False) as page:
        page.context.grant_permissions(["clipboard-read", "clipboard-write"])
        page.get_by_role("tab", name="Memory").click()
        page.click("[data-view=pose]")
        link = link_from(page)
        told(page, f"The link: copied, {len(link)} characters.")
        assert page.evaluate("() => navigator.clipboard.readText()") == link
        state_hash = page.evaluate("() => document.querySelector('#share-python').value").split('"')[-4]
    other = Program("--port", "0", "--paused", NUMBA_NUM_THREADS="1", OMP_NUM_THREADS="1")
    try:
        with open_page(browser, other.url, light=True, stage=False) as page:
            page.goto("about:blank")
            page.goto(link.replace(program.url, other.url))
            note = page.locator("#situation")
            expect(note).to_have_attribute("data-state", "same")
            expect(note).to_contain_text(f"The same, bit for bit: state hash {state_hash[:12]} at tick 150.")
            expect(page.get_by_role("tab", name="Memory")).to_have_attribute("aria-selected", "true")
            expect(page.locator("[data-view=pose]")).to_have_attribute("aria-pressed", "true")
            assert page.url == other.url  # a reload changes nothing
            state = other.state()
            assert (state["tick"], state["robot"]) == (150, program.state()["robot"])
            page.click("#situation-close")
            expect(note).to_be_hidden()
    finally:
        assert other.stop() == 0


@pytest.mark.long
def test_a_file_is_saved_and_dropped(program: Program, browser: Browser, tmp_path: Path) -> None:
    program.command("step", ticks=20)
    tick = program.state()["tick"]
    with open_page(browser, program.url, stage=False) as page:
        with page.expect_download() as loading:
            keep(page, "Save this situation to a file")
        file = tmp_path / loading.value.suggested_filename
        loading.value.save_as(file)
        assert file.name == f"office-seed5-0m{tick / 10:04.1f}s.situation.json"
        assert json.loads(file.read_text())["tick"] == tick
        program.command("step", ticks=30)
        page.set_input_files("#open-files", file)
        expect(page.locator("#situation")).to_have_attribute("data-state", "same")
        assert program.state()["tick"] == tick
        expect(page.locator("#open-dialog")).to_be_hidden()


@pytest.mark.long
def test_the_command_line_opens_it(program: Program, browser: Browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        link = link_from(page)
    tick = program.state()["tick"]
    other = Program("--port", "0", "--situation", link)
    try:
        with open_page(browser, other.url, stage=False) as page:
            expect(page.locator("#situation")).to_have_attribute("data-state", "same")
        assert other.state()["tick"] == tick
    finally:
        assert other.stop() == 0
