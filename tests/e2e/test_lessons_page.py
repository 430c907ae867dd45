"""Lessons as a teacher gives them: from the list to the comparison, with a class that votes; and running until."""

from __future__ import annotations

import math
import re

import pytest
from playwright.sync_api import Page, expect

from tests.e2e.browser import box_of, open_page, told, until

DEMOS = ["dark", "loop", "twins", "small", "kidnapped", "quicker"]
STATE = "(state) => document.getElementById('lesson').dataset.state === state"


def is_in(page: Page, state: str) -> None:
    until(page, STATE, argument=state)


def choose(page: Page, name: str) -> None:
    page.click("#lessons")
    page.click(f"#lessons-list [data-name={name}]")
    until(page, "(name) => document.querySelector('#lessons-dialog').open === false", argument=name)


def test_a_lesson_from_the_list_to_the_sandbox_with_a_class_that_votes(program, browser) -> None:
    with open_page(browser, program.url, stage=False) as page, browser.new_context() as other:
        choose(page, "packet")
        is_in(page, "predict")
        expect(page.locator("#lesson-title")).to_be_focused()
        expect(page.locator("#lesson-text")).to_contain_text("pose cells")
        expect(page.locator("#lesson-formulas math").first).to_be_visible()
        pupil = other.new_page()
        pupil.goto(f"{program.url}?vote")
        pupil.locator(".option").nth(1).click()
        expect(pupil.locator("#vote-said")).to_contain_text("Your vote counts")
        expect(page.locator(".option .count").nth(1)).to_have_text("1")
        expect(page.locator(".class-votes")).to_have_text("1 vote")
        pupil.locator(".option").nth(0).click()
        expect(page.locator(".option .count").nth(0)).to_have_text("1")  # a voter counts once
        expect(page.locator(".option .count").nth(1)).to_have_text("")
        page.locator(".option").nth(1).click()
        expect(page.locator("#lesson-show")).to_have_text("Let it happen")
        page.click("#lesson-show")
        is_in(page, "showing")
        expect(page.locator("#lesson-watch")).to_contain_text("What to watch")
        expect(page.locator(".views [aria-pressed=true]")).to_have_text("Pose cells")
        program.command("set_speed", factor=0)
        is_in(page, "compared")
        expect(page.locator(".outcome")).to_have_attribute("data-tone", "wrong")
        expect(page.locator(".outcome")).to_contain_text("8 cells on, and 9 layers lower")
        expect(page.locator(".option").nth(0)).to_have_attribute("data-look", "true")
        expect(pupil.locator("#vote-said")).to_contain_text("It came true")
        page.locator(".moments button").last.click()
        end = program.state()["time_s"]
        page.locator(".try button").first.click()
        until(page, "() => document.querySelector('#events').textContent.includes('packet put in')")
        assert program.state()["time_s"] >= end
        page.click("#lessons")
        expect(page.locator("#lessons-list [data-name=packet] .gone-through")).to_be_visible()
        page.click("#lessons-close")
        page.click("#lesson-next")
        expect(page.locator("#lesson-title")).to_have_text("Packets merge and compete")
        page.click("#lesson-leave")
        expect(page.locator("#lesson")).to_be_hidden()


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


@pytest.mark.long
@pytest.mark.parametrize("name", DEMOS)
def test_each_of_the_six_demos_is_three_clicks_from_a_fresh_page(program, browser, name) -> None:
    with open_page(browser, program.url, stage=False, first=True) as page:
        page.click("#lessons")
        page.click(f"#lessons-list [data-name={name}]")
        page.click("#lesson-show")
        is_in(page, "showing")
        assert program.state()["running"]
        page.click("#lesson-leave")


@pytest.mark.long
def test_it_runs_until_something_happens_and_stops_there(program, browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        program.command("reset", world="office", seed=5)
        page.click("#until-open")
        page.click("text=a loop closes")
        told(page, "Stopped at this very tick")
        state = program.state()
        assert not state["running"]
        assert state["until"] is None or state["until"]["state"] == "met"
        page.click("#until-open")
        page.get_by_label("Which place").select_option("printer")
        page.get_by_label("How many packets").fill("3")
        page.get_by_role("button", name="packets compete:").click()
        assert "3 packets compete" in program.wait(lambda state: state["until"]["what"] == "packets")["until"]["words"]
        program.command("pause")
        page.click("#until-open")
        page.get_by_role("button", name="it comes to").click()
        assert "comes to printer" in program.wait(lambda state: state["until"]["what"] == "place")["until"]["words"]
        program.command("pause")
        page.click("#until-open")
        page.click("text=it is at its goal")  # there is none: that is refused
        until(page, "() => [...toasted].length > 1")


@pytest.mark.long
def test_a_symbol_leads_to_its_row_in_tune(program, browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        choose(page, "quicker")
        is_in(page, "predict")
        page.locator("#lesson-formulas .symbols button").first.click()
        expect(page.locator("#panel [role=tab][aria-selected=true]")).to_have_text("Tune")
        rows = page.locator("#panel .knob:visible")
        expect(rows).to_have_count(1)
        expect(rows.locator("input")).to_be_focused()
        expect(rows).to_have_attribute("title", re.compile("moving average"))


@pytest.mark.long
def test_a_clicker_goes_through_a_lesson(program, browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        page.keyboard.press("z")
        page.keyboard.press("c")
        page.click("#lessons-list [data-name=packet]")
        is_in(page, "predict")
        page.locator(".option input").first.check()
        page.keyboard.press("PageDown")  # although a radio button has the focus
        is_in(page, "showing")
        program.command("set_speed", factor=0)
        is_in(page, "compared")
        expect(page.locator(".outcome")).to_have_attribute("data-tone", "right")
        page.keyboard.press("PageUp")
        is_in(page, "predict")
        page.keyboard.press("PageDown")
        program.command("set_speed", factor=0)
        is_in(page, "compared")
        page.keyboard.press("PageDown")
        expect(page.locator("#lesson-title")).to_have_text("Packets merge and compete")


@pytest.mark.long
def test_rounds_are_shown_one_after_the_other(program, browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        choose(page, "merge")
        is_in(page, "predict")
        page.locator(".option").first.click()
        page.click("text=Let it happen")
        is_in(page, "showing")
        program.command("set_speed", factor=0)
        expect(page.locator("#lesson-show")).to_have_text("Show the next round")
        expect(page.locator(".option input").first).to_be_disabled()
        page.click("#lesson-show")
        is_in(page, "showing")
        program.command("set_speed", factor=0)
        is_in(page, "compared")
        expect(page.locator("#lesson-which")).to_contain_text("round 2 of 2")


@pytest.mark.long
def test_a_lesson_that_is_broken_off_says_by_what_and_begins_once_more(program, browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        choose(page, "dark")
        is_in(page, "predict")
        expect(page.locator("#lesson-again")).to_be_hidden()
        page.click("#lesson-show")
        is_in(page, "showing")
        program.command("drive", speed=0.2, yaw_rate=0.0)
        is_in(page, "sandbox")
        expect(page.locator("#lesson-doing")).to_contain_text("Broken off: somebody drove the robot by hand.")
        expect(page.locator("#lesson-again")).to_have_class("go")
        page.click("#lesson-again")
        is_in(page, "predict")
        expect(page.locator("#lesson-doing")).not_to_contain_text("Broken off")
        expect(page.locator("#lesson-again")).not_to_have_class("go")


@pytest.mark.long
def test_the_card_leads_to_inspect_where_that_tells_why(program, browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        choose(page, "snap")
        is_in(page, "predict")
        page.click("#lesson-show")
        is_in(page, "showing")
        program.command("set_speed", factor=0)
        is_in(page, "compared")
        expect(page.locator("#lesson-watch")).to_contain_text("What to watch")
        page.locator("#panel [role=tab]").first.click()
        page.keyboard.press("z")  # presenting, the panel is away
        expect(page.locator("#panel")).to_be_hidden()
        page.click(".outcome button")
        expect(page.locator("#panel [role=tab][aria-selected=true]")).to_have_text("Inspect")
        expect(page.locator("#panel")).to_contain_text("What led to it")
        page.keyboard.press("z")
