"""The editor's script and daylight in a real Chromium: adding, changing, deleting, refusing, undoing, and the effects."""

from __future__ import annotations

from typing import Any

import orjson
import pytest
from playwright.sync_api import Locator, Page

from tests.e2e.browser import box_of, open_page, until
from tests.e2e.editor import edit, says, world
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


def open_time(page: Page) -> None:
    edit(page)
    page.click("#edit-time")


def row(page: Page, k: int) -> Locator:
    return page.locator("#script-lines li[data-number]").nth(k)


def add_line(page: Page, when: str, what: str, which: str | None = None) -> None:
    page.fill("#script-add .when", when)
    page.select_option("#script-add .what", label=what)
    if which is not None and what == "Daylight":
        page.fill("#script-add .level", which)
    elif which is not None:
        page.select_option("#script-add .which", which)
    page.click("#script-add button")


def lines_are(page: Page, *lines: tuple[float, str, Any]) -> None:
    """The world's script, sorted by time, is this: time, action, name or level."""
    said = """async () => JSON.stringify(((await (await fetch('/api/world')).json()).world.script ?? [])
        .map((line) => [line.at_s, line.do, line.do === 'daylight' ? line.level : line.name])
        .sort((a, b) => a[0] - b[0]))"""
    until(page, f"async (lines) => (await ({said})()) === lines", argument=json_of(lines))


def json_of(lines: object) -> str:
    return orjson.dumps(lines).decode()


def test_lines_are_added_changed_and_deleted_and_happen(program, browser):
    with open_page(browser, program.url, 1440, 900, stage=False) as page:
        open_time(page)
        assert page.is_visible("#script-none")
        add_line(page, "0:05", "Door shuts", "lab")
        says(page, "Added: at 0:05: door shuts lab.")
        add_line(page, "2", "Daylight", "0.3")
        add_line(page, "1:00:00.5", "People go")
        lines_are(page, (2, "daylight", 0.3), (5, "close_door", "lab"), (3600.5, "people_off", ""))
        assert [row(page, k).locator(".when").input_value() for k in range(3)] == ["0:02", "0:05", "1:00:00.5"]

        row(page, 2).locator(".what").select_option("lamp_off")
        lines_are(page, (2, "daylight", 0.3), (5, "close_door", "lab"), (3600.5, "lamp_off", "desk lamp"))
        row(page, 2).locator(".when").fill("1")  # it goes to the top, and the keys stay with it
        row(page, 2).locator(".when").press("Enter")
        lines_are(page, (1, "lamp_off", "desk lamp"), (2, "daylight", 0.3), (5, "close_door", "lab"))
        until(page, "() => document.activeElement.closest('li')?.dataset.at === '1'")
        assert page.evaluate("() => document.activeElement.className") == "when"

        program.command("step", ticks=30)
        until(page, "() => document.querySelector('.now')?.textContent === 'now 0:03'")
        order = "() => [...document.querySelectorAll('#script-lines li')].map((li) => li.className)"
        assert page.evaluate(order) == ["past", "past", "now", ""]
        living = program.state()["living"]
        assert (living["lamps"]["desk lamp"], living["doors"]["lab"]) == (False, 1.0)
        assert living["daylight"] == pytest.approx(0.3)
        program.command("step", ticks=40)
        assert program.state()["living"]["doors"]["lab"] == 0.0
        add_line(page, "0:04", "Door opens", "lab")
        says(page, "That is past; it happens after a restart.")
        program.command("step", ticks=20)
        assert program.state()["living"]["doors"]["lab"] == 0.0

        row(page, 0).locator(".remove").click()
        says(page, "Line deleted")
        page.focus("#plan")
        page.keyboard.press("Control+z")
        page.keyboard.press("Control+z")
        lines_are(page, (1, "lamp_off", "desk lamp"), (2, "daylight", 0.3), (5, "close_door", "lab"))
        page.keyboard.press("Control+y")
        lines_are(
            page, (1, "lamp_off", "desk lamp"), (2, "daylight", 0.3), (4, "open_door", "lab"), (5, "close_door", "lab")
        )


@pytest.mark.long
def test_what_is_no_time_or_level_is_refused_with_the_reason(program, browser):
    with open_page(browser, program.url, 1440, 900, stage=False) as page:
        open_time(page)
        before = world(page)
        for when, what, which, reason in (
            ("soon", "Door shuts", "lab", "“soon” is no time; write seconds (90), or minutes and seconds (1:30)."),
            ("-4", "Door shuts", "lab", "“-4” is no time"),
            ("1:2:3:4", "People come", None, "“1:2:3:4” is no time"),
            ("2000000", "People come", None, "at_s: got 2000000; input should be less than or equal to 1000000"),
            ("5", "Daylight", "", "is no level; write a number from 0"),
            ("5", "Daylight", "7", "level: got 7; input should be less than or equal to 3"),
        ):
            add_line(page, when, what, which)
            says(page, reason)
            assert page.get_attribute("#plan-status", "class") == "bad"
        assert page.locator("#script-add .what option:disabled").all_text_contents() == [
            "Box appears (no boxes)",
            "Box goes (no boxes)",
        ]
        add_line(page, "9", "Lamp off", "desk lamp")
        says(page, "Added: at 0:09")
        lines_are(page, (9, "lamp_off", "desk lamp"))
        row(page, 0).locator(".when").fill("x")
        row(page, 0).locator(".when").press("Enter")
        says(page, "“x” is no time")
        assert row(page, 0).locator(".when").get_attribute("aria-invalid") == "true"
        row(page, 0).locator(".when").fill("0:08")
        row(page, 0).locator(".when").press("Enter")
        lines_are(page, (8, "lamp_off", "desk lamp"))
        page.keyboard.press("Escape")
        assert page.is_hidden("#time")
        assert page.evaluate("() => document.activeElement.id") == "edit-time"
        assert {**world(page), "script": None} == {**before, "script": None}


@pytest.mark.long
def test_lines_follow_the_thing_that_they_are_about(program, browser):
    with open_page(browser, program.url, 1440, 900, stage=False) as page:
        open_time(page)
        for when in ("5", "7"):
            add_line(page, when, "Door shuts", "lab")
            says(page, f"at 0:0{when}")
        page.click("#time-close")
        box = box_of(page.locator("#plan .sill"))
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        page.fill("#fields [data-key=name]", "kitchen")
        page.press("#fields [data-key=name]", "Enter")
        lines_are(page, (5, "close_door", "kitchen"), (7, "close_door", "kitchen"))
        page.click("#fields .remove")
        says(page, "Door and 2 lines of the script deleted. Ctrl+Z brings it back.")
        lines_are(page)
        assert "doors" not in world(page)
        page.click("#edit-undo")
        lines_are(page, (5, "close_door", "kitchen"), (7, "close_door", "kitchen"))


@pytest.mark.long
def test_the_daylight_is_drawn_by_its_points(program, browser):
    def daylight_is(page: Page, course: object) -> None:
        found = (
            "async (day) => JSON.stringify((await (await fetch('/api/world')).json()).world.daylight ?? null) === day"
        )
        until(page, found, argument=json_of(course))

    def add(page: Page, when: str, level: str) -> None:
        page.fill("#daylight-add .when", when)
        page.fill("#daylight-add .level", level)
        page.click("#daylight-add button")

    with open_page(browser, program.url, 1440, 900, stage=False) as page:
        open_time(page)
        assert page.is_hidden("#daylight-again")
        for when, level in (("0:10", "0.5"), ("0", "1"), ("0:20", "0.25")):
            add(page, when, level)
            says(page, f"Added: daylight {level}")
        daylight_is(page, {"points": [[0, 1], [10, 0.5], [20, 0.25]], "repeat_s": 0})
        assert page.locator("#daylight-curve .point").count() == 3
        add(page, "10", "0.4")
        says(page, "There is a point at 0:10 already; change that one.")
        add(page, "11", "4")
        says(page, "has level 4; must be from 0 to 3")
        program.command("step", ticks=50)
        until(page, "() => document.getElementById('daylight-now').textContent === '0.75'")

        page.fill("#daylight-points li:nth-child(2) .level", "0.1")
        page.press("#daylight-points li:nth-child(2) .level", "Enter")
        daylight_is(page, {"points": [[0, 1], [10, 0.1], [20, 0.25]], "repeat_s": 0})
        page.fill("#daylight-repeat", "0:15")
        page.press("#daylight-repeat", "Enter")
        says(page, "15 s must be 0 or at least the last point's 20 s")
        page.fill("#daylight-repeat", "0:30")
        page.press("#daylight-repeat", "Enter")
        daylight_is(page, {"points": [[0, 1], [10, 0.1], [20, 0.25]], "repeat_s": 30})
        until(page, "() => document.getElementById('daylight-curve').textContent.includes('0:30, then again')")
        for _ in range(3):
            count = page.locator("#daylight-points li").count()
            page.locator("#daylight-points .remove").first.click()
            until(page, "(n) => document.querySelectorAll('#daylight-points li').length === n", argument=count - 1)
        daylight_is(page, None)
        program.command("step", ticks=1)
        until(page, "() => document.getElementById('daylight-now').textContent === '1.00'")
        page.click("#edit-undo")
        daylight_is(page, {"points": [[20, 0.25]], "repeat_s": 30})


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
