"""Where a lesson's answer is drawn: on the plan, and on the map; and that the card shows no more words than are counted. All else
of lessons is in tests/page."""

from __future__ import annotations

import math

import pytest
from playwright.sync_api import Browser, Page, expect

from app.protocol.lesson import find_lesson
from app.protocol.lesson_card import count_words, words_in_sight
from tests.e2e.browser import box_of, open_page, until
from tests.e2e.program import Program

TEXTS = """() => { const texts = [], walk = document.createTreeWalker(document.getElementById("lesson"), NodeFilter.SHOW_TEXT);
    while (walk.nextNode()) if (walk.currentNode.parentElement.checkVisibility()) texts.push(walk.currentNode.data);
    return texts; }"""
DRAWN = "(part) => document.querySelector(`.lesson-plan .${part}`)?.getAttribute('d')?.length > 40"


def is_in(page: Page, name: str, state: str) -> None:
    expect(page.locator("#lesson")).to_have_attribute("data-state", state)
    shown = page.evaluate(TEXTS)
    assert 10 < count_words(shown) <= words_in_sight(find_lesson(name))[state], shown


@pytest.mark.long
@pytest.mark.parametrize("name", ["dark", "believes"])
def test_where_it_will_be_is_drawn_on_the_plan_and_on_the_map_which_lies_as_on_its_plate(
    program: Program, browser: Browser, name: str
) -> None:
    on_map = name == "believes"
    with open_page(browser, program.url, stage=False) as page:
        plan = page.locator(".lesson-plan")
        page.goto(f"{program.url}docs")
        page.goto(f"{program.url}#lesson={name}")
        expect(page.locator("#lesson-title")).to_have_text(find_lesson(name).title)
        is_in(page, name, "predict")
        assert "#" not in page.url  # loaded again, the page begins nothing
        for part in ("walls", "places") if on_map else ("walls",):
            until(page, DRAWN, argument=part)
        plan.scroll_into_view_if_needed()
        state = program.state(full=True)
        turn_rad = state["map"]["turn_rad"] if on_map else 0.0
        spot = box_of(plan.locator("circle.robot") if on_map else plan)
        page.mouse.click(spot["x"] + spot["width"] / 2, spot["y"] + spot["height"] / 2)
        expect(plan.locator(".said")).to_be_visible()
        first = program.wait(lambda state: state["lesson"]["prediction"])["lesson"]["prediction"]
        here = state["estimate"]
        assert not on_map or math.dist((first["x"], first["y"]), (here["x"], here["y"])) < 0.1
        plan.focus()
        for key in ("ArrowUp", "ArrowUp", "Enter"):  # up on the page, whichever way the map lies
            page.keyboard.press(key)
        then = program.wait(lambda state: state["lesson"]["prediction"] != first)["lesson"]["prediction"]
        moved_rad = math.atan2(then["y"] - first["y"], then["x"] - first["x"]) + turn_rad
        assert math.remainder(moved_rad - math.pi / 2, math.tau) == pytest.approx(0, abs=0.01)
        with open_page(browser, program.url, stage=False) as other:
            other.goto(f"{program.url}docs")
            other.goto(f"{program.url}#lesson={name}")
            expect(other.locator("#lesson-title")).to_have_text(find_lesson(name).title)
            until(other, "() => !location.hash")
            assert program.state()["lesson"]["prediction"] == then  # who opens the link, too, joins the lesson
        page.click("#lesson-show")
        is_in(page, name, "showing")
        program.command("set_speed", factor=0)
        is_in(page, name, "compared")
        expect(plan.locator(".was")).to_be_visible()
        outcome = program.state()["lesson"]["outcome"]
        assert outcome["right"] == (outcome["distance_m"] <= 1.0) or not on_map
        expect(page.locator(".outcome")).to_contain_text(f"{outcome['distance_m']:.1f} m from where it ended")
