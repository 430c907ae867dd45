"""The editor's script by keyboard alone: what Tab reaches. All else of it is in tests/page."""

from __future__ import annotations

from typing import Any

import orjson
import pytest
from playwright.sync_api import Page

from tests.e2e.browser import open_page, until
from tests.e2e.program import Program

DOOR = {"name": "lab", "hinge": [8.0, 1.0], "angle_deg": 0, "width": 1.0}
LAMP = {"name": "desk lamp", "x": 5.0, "y": 5.0}


@pytest.fixture
def program(one_program: Program) -> Program:
    """An office with a door and a lamp, at 0:00."""
    one_program.command("reset", world="loop")
    one_program.command("reset", world="office", seed=5)
    steps = [{"do": "add", "list": kind, "item": item} for kind, item in (("doors", DOOR), ("lamps", LAMP))]
    one_program.command("edit_world", steps=steps)
    return one_program


def lines_are(page: Page, *lines: tuple[float, str, Any]) -> None:
    """The world's script, sorted by time, is this: time, action, name or level."""
    said = """async () => JSON.stringify(((await (await fetch('/api/world')).json()).world.script ?? [])
        .map((line) => [line.at_s, line.do, line.do === 'daylight' ? line.level : line.name])
        .sort((a, b) => a[0] - b[0]))"""
    until(page, f"async (lines) => (await ({said})()) === lines", argument=json_of(lines))


def json_of(lines: object) -> str:
    return orjson.dumps(lines).decode()


@pytest.mark.long
def test_the_keyboard_alone_writes_a_line(program, browser):
    with open_page(browser, program.url, 1440, 900, stage=False) as page:
        page.keyboard.press("o")
        until(page, "() => document.querySelector('#plan .outer') !== null")
        page.keyboard.press("c")
        until(page, "() => document.activeElement.id === 'time'")
        for _ in range(2):  # past the cross that closes it
            page.keyboard.press("Tab")
        page.keyboard.type("42")
        page.keyboard.press("Enter")
        lines_are(page, (42, "open_door", "lab"))
        page.keyboard.press("Escape")
        assert page.is_hidden("#time")
