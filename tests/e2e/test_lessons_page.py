"""Where a lesson's answer is drawn: on the plan, and on the map. All else of lessons is in tests/page."""

from __future__ import annotations

import math

import pytest
from playwright.sync_api import Page, expect

from tests.e2e.browser import box_of, open_page, until

STATE = "(state) => document.getElementById('lesson').dataset.state === state"


def is_in(page: Page, state: str) -> None:
    until(page, STATE, argument=state)


@pytest.mark.long
def test_where_it_ends_is_drawn_on_the_plan(program, browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        page.goto(f"{program.url}docs")
        page.goto(f"{program.url}#lesson=dark")
        is_in(page, "predict")
        assert "#" not in page.url  # loaded again, the page begins nothing
        plan = page.locator(".lesson-plan")
        until(page, "() => document.querySelector('.lesson-plan .walls')?.getAttribute('d')?.length > 40")
        plan.scroll_into_view_if_needed()
        box = box_of(plan)
        page.mouse.click(box["x"] + box["width"] * 0.5, box["y"] + box["height"] * 0.5)
        expect(plan.locator(".said")).to_be_visible()
        first = program.state()["lesson"]["prediction"]
        plan.focus()
        for key in ("ArrowUp", "ArrowUp", "ArrowRight", "Enter"):
            page.keyboard.press(key)
        before = (first["x"], first["y"])
        after = program.wait(lambda state: state["lesson"]["prediction"] != first)["lesson"]["prediction"]
        assert after["x"] > before[0]
        assert after["y"] > before[1]
        page.click("#lesson-show")
        program.command("set_speed", factor=0)
        is_in(page, "compared")
        expect(plan.locator(".was")).to_be_visible()
        outcome = program.state()["lesson"]["outcome"]
        expect(page.locator(".outcome")).to_contain_text(f"{outcome['distance_m']:.1f} m from where it ended")


@pytest.mark.long
def test_where_it_will_believe_to_be_is_drawn_on_the_map_which_lies_as_on_its_plate(program, browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        page.goto(f"{program.url}docs")
        page.goto(f"{program.url}#lesson=believes")
        is_in(page, "predict")
        plan = page.locator(".lesson-plan")
        until(page, "() => document.querySelector('.lesson-plan .walls')?.getAttribute('d')?.length > 40")
        until(page, "() => document.querySelector('.lesson-plan .places')?.getAttribute('d')?.length > 40")
        plan.scroll_into_view_if_needed()
        state = program.state(full=True)
        here, turn = state["estimate"], state["map"]["turn_rad"]
        pin = box_of(plan.locator("circle.robot"))
        page.mouse.click(pin["x"] + pin["width"] / 2, pin["y"] + pin["height"] / 2)
        first = program.wait(lambda state: state["lesson"]["prediction"])["lesson"]["prediction"]
        assert math.dist((first["x"], first["y"]), (here["x"], here["y"])) < 0.1
        plan.focus()
        for key in ("ArrowUp", "ArrowUp", "Enter"):  # up on the page, whichever way the map lies
            page.keyboard.press(key)
        then = program.wait(lambda state: state["lesson"]["prediction"] != first)["lesson"]["prediction"]
        moved = (then["x"] - first["x"], then["y"] - first["y"])
        assert math.remainder(math.atan2(moved[1], moved[0]) + turn - math.pi / 2, math.tau) == pytest.approx(
            0, abs=0.01
        )
        page.click("#lesson-show")
        program.command("set_speed", factor=0)
        is_in(page, "compared")
        expect(plan.locator(".was")).to_be_visible()
        outcome = program.state()["lesson"]["outcome"]
        assert outcome["right"] == (outcome["distance_m"] <= 1.0)
        expect(page.locator(".outcome")).to_contain_text(f"{outcome['distance_m']:.1f} m from where it ended")
