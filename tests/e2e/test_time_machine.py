"""The timeline as a person uses it: drag it, step, go back to now, go on from there, and look at two branches."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from tests.e2e.browser import box_of, open_page, told, until
from tests.e2e.program import Program


@pytest.fixture(scope="module")
def driven(program: Program) -> Program:
    """A run of a minute with a kidnap in its middle."""
    program.command("step", ticks=300)
    program.command("kidnap")
    program.command("step", ticks=300)
    return program


def drag(page: Page, *times_s: float) -> int:
    """Drag the timeline from one time over the others. The tick that the slider says before it is let go."""
    box = box_of(page.locator("#timeline"))
    end_s = max(60.0, 60.0 * 1.03)
    xs = [box["x"] + 6 + (box["width"] - 12) * time_s / end_s for time_s in times_s]
    y = box["y"] + box["height"] / 2
    page.mouse.move(xs[0], y)
    page.mouse.down()
    for x in xs[1:]:
        page.mouse.move(x, y, steps=5)
    aim = page.get_attribute("#timeline", "aria-valuenow")
    page.mouse.up()
    assert aim is not None
    return round(10 * float(aim))


def shows(page: Page, tick: int) -> None:
    """The page has this moment: a step is counted from what it shows."""
    until(page, f"() => document.querySelector('#timeline').ariaValueText.startsWith('0:{tick / 10:04.1f} ')")


def test_drag_step_and_come_back(driven: Program, browser) -> None:
    before = driven.state()
    with open_page(browser, driven.url, 1280, 800, stage=False) as page:
        aim = drag(page, 50.0, 10.0, 20.0)
        assert 190 <= aim <= 210
        expect(page.locator("#past")).to_be_visible()
        expect(page.locator("#status")).to_contain_text("the past")
        past = driven.wait(lambda state: state["tick"] == aim)  # the last wish of the drag has come true
        assert not past["running"]
        shows(page, aim)
        page.evaluate("() => { for (let k = 0; k < 5; k++) document.querySelector('#tick-back').click(); }")
        driven.wait(lambda state: state["tick"] == past["tick"] - 5)
        page.evaluate("() => { for (let k = 0; k < 4; k++) document.querySelector('#tick-on').click(); }")
        driven.wait(lambda state: state["tick"] == past["tick"] - 1)
        shows(page, past["tick"] - 1)
        page.keyboard.press("l")
        driven.wait(lambda state: state["tick"] == past["tick"] + 9)
        shows(page, past["tick"] + 9)
        page.keyboard.press("]")
        at_kidnap = driven.wait(lambda state: state["tick"] == 300)
        assert at_kidnap["time_s"] == 30.0
        shows(page, 300)
        page.focus("#timeline")
        page.keyboard.press("ArrowLeft")
        driven.wait(lambda state: state["tick"] == 299)
        until(page, "() => document.querySelector('#timeline').ariaValueText.startsWith('0:29.9 of 1:00, the past')")
        page.keyboard.press("k")
        told(page, "This is the past: go on from here, or come back to now")
        page.keyboard.press("n")
        expect(page.locator("#past")).to_be_hidden()
        after = driven.state()
        assert (after["tick"], after["robot"], after["running"]) == (600, before["robot"], False)


def test_go_on_without_the_kidnap_and_compare(driven: Program, browser) -> None:
    with open_page(browser, driven.url, 1280, 800, stage=False) as page:
        page.keyboard.press("v")
        page.get_by_role("button", name="0:30 kidnap").click()
        driven.wait(lambda state: state["tick"] == 300)
        page.keyboard.press("v")
        page.click("#go-on")
        expect(page.locator("#branches [aria-pressed=true]")).to_have_text("2")
        driven.command("step", ticks=100)
        page.get_by_role("button", name="Branches side by side").click()
        expect(page.locator("#compare-words")).to_contain_text("first difference at tick 301")
        expect(page.locator(".branch-side")).to_have_count(2)
        page.keyboard.press("Escape")
        page.get_by_role("button", name="Branch 1, the run as it began").click()
        driven.wait(lambda state: state["tick"] == 600)
