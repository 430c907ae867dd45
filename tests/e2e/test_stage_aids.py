"""Beside the view buttons: vision off and on, a camera that goes with the robot; and the names of places as goals."""

from __future__ import annotations

import numpy as np
import pytest
from playwright.sync_api import expect

from sim2d import load_world
from tests.e2e.browser import eye_of, on_screen, open_page, show, told, until
from tests.e2e.fake_engine import fake_program
from tests.e2e.program import Program
from tests.e2e.test_touch import await_
from tests.fake_snapshots import fake_snapshot
from web.messages import Closure
from web.viewer.fits.office_fit import OfficeFit
from web.viewer.marks.place_names import Z
from web.viewer.plates.office_plate import ORIGIN


@pytest.mark.long
def test_vision_goes_off_and_on_by_the_same_click(program: Program, browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        vision = page.locator("#vision")
        expect(vision).to_have_attribute("aria-pressed", "true")
        vision.click()
        expect(vision).to_have_attribute("aria-pressed", "false")
        expect(vision).to_contain_text("Vision off")
        told(page, "Vision is off")
        program.command("step", ticks=20)
        page.get_by_role("tab", name="Senses").click()
        expect(page.locator("#panel-senses .number")).to_have_text("none")  # the local view gets nothing
        page.keyboard.press("i")
        expect(vision).to_have_attribute("aria-pressed", "true")
        program.command("step", ticks=20)
        expect(page.locator("#panel-senses .number")).not_to_have_text("none")


def test_the_camera_goes_with_the_robot_until_a_view_is_asked_for(program: Program, browser) -> None:
    fit = OfficeFit(load_world("office").bounds)
    with open_page(browser, program.url) as page:
        page.click("#follow")
        expect(page.locator("#follow")).to_have_attribute("aria-pressed", "true")

        def above_the_robot() -> bool:
            robot = program.state()["robot"]
            at = fit.to_plate(np.array([[robot["x"], robot["y"]]]))[0] + ORIGIN[:2]
            return abs(eye_of(page)[0] - at[0]) < 0.3  # it looks from the front, so only across

        await_(page, above_the_robot)
        program.command("kidnap", x=8.6, y=1.6, heading_rad=0.0)
        program.command("step", ticks=1)
        await_(page, above_the_robot)
        show(page, "all")
        expect(page.locator("#follow")).to_have_attribute("aria-pressed", "false")


@pytest.mark.long
def test_the_name_of_a_place_is_a_goal_once_the_map_knows_it(program: Program, browser) -> None:
    program.command("pause")
    program.command("reset", seed=5)
    for ticks in (1000, 700):  # it has been in the library by then, and not at the printer
        program.command("step", ticks=ticks)
    places = {place.name: (place.x, place.y) for place in load_world("office").places}
    fit = OfficeFit(load_world("office").bounds)
    with open_page(browser, program.url) as page:
        show(page, "office")

        def press(name: str) -> None:
            x, y = fit.to_plate(np.array([places[name]]))[0] + ORIGIN[:2]
            page.mouse.click(*on_screen(page, "office", (float(x), float(y), Z)))

        press("printer")
        told(page, "the map does not know the printer")
        assert program.state()["goal"] is None
        press("library")
        program.wait(lambda state: state["goal"] is not None)


@pytest.mark.long
def test_a_loop_closure_can_be_played_again(browser) -> None:
    plain = fake_snapshot(40)
    before = plain.map.xy[:50]
    closure = Closure(77, 63.0, 49, 3, plain.map.links[(plain.map.links < 50).all(1)], before, before + 0.5, 0.71)
    with fake_program() as (engine, url), open_page(browser, url) as page:
        expect(page.locator("#replay")).to_be_hidden()
        engine.shown = {"closures": (closure,)}
        expect(page.locator("#replay")).to_be_visible()
        until(page, "() => document.getElementById('replay').title.includes('moved the map by 0.7 m')")
        page.click("#replay")
        page.keyboard.press("r")
        await_(page, lambda: engine.viewer.replayed == [77, 77])
