"""The living office in a real browser: a click on a door, switches of the Office tab, and what the engine says."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from sim2d import load_world
from tests.e2e.browser import on_screen, open_page, show
from tests.e2e.program import Program
from web.stage.hand import DOOR_Z
from web.stage.office_fit import OfficeFit
from web.stage.office_plate import ORIGIN

WORLD = load_world("living")


@pytest.fixture(scope="module")
def office() -> Iterator[Program]:
    made = Program("--port", "0", "--seed", "5", "--world", "living", "--preset", "ideal")
    yield made
    assert made.stop() == 0


def middle_of(door: int) -> tuple[float, float, float]:
    """On the stage, of a shut leaf, at the height at which a click finds it."""
    leaf = WORLD.doors[door]
    fit = OfficeFit(WORLD.bounds)
    x, y = fit.to_plate(np.array([[leaf.x + 0.5 * leaf.width, leaf.y]]))[0]
    return ORIGIN[0] + x, ORIGIN[1] + y, ORIGIN[2] + DOOR_Z * fit.relief


def turn(page: Page, name: str) -> None:
    """A switch of the Office tab."""
    stage = page.frame_locator("#stage")
    stage.get_by_role("tab", name="Office").click()
    stage.get_by_label(name, exact=True).click()


def test_a_click_on_a_door_opens_and_shuts_it(office: Program, browser: Browser) -> None:
    for name in ("doors", "script", "people"):  # nobody stands in it, nothing else moves it
        office.command("set_parameter", name=f"office.{name}", value=False)
    office.command("set_door", name="laboratory door", open=False)
    office.wait(lambda state: state["living"]["doors"]["laboratory door"] == 0.0, 20)
    with open_page(browser, office.url) as page:
        show(page, "office")
        page.mouse.click(*on_screen(page, "office", middle_of(2)))
        office.wait(lambda state: state["living"]["doors"]["laboratory door"] == 1.0, 20)
        assert office.state()["living"]["doors"]["meeting room door"] == 1.0  # no other moved
        page.frame_locator("#stage").get_by_role("tab", name="Office").click()
        page.frame_locator("#stage").get_by_label("laboratory door", exact=True).click()
        office.wait(lambda state: state["living"]["doors"]["laboratory door"] == 0.0, 20)


def test_people_lamps_and_presets_are_switched_on_the_page(office: Program, browser: Browser) -> None:
    office.command("set_parameter", name="office.people", value=True)
    office.wait(lambda state: state["living"]["people"] == 3, 20)
    with open_page(browser, office.url) as page:
        turn(page, "people")
        office.wait(lambda state: state["living"]["people"] == 0, 10)
        turn(page, "people")
        office.wait(lambda state: state["living"]["people"] >= 1, 10)  # who stands at the robot waits
        turn(page, "hall west")
        office.wait(lambda state: not state["living"]["lamps"]["hall west"], 10)
        assert office.state()["living"]["lamps"]["hall east"]
        stage = page.frame_locator("#stage")
        preset = stage.get_by_label("preset", exact=True)
        assert preset.input_value() == "ideal"
        preset.click()
        stage.get_by_role("option", name="Pioneer 2DXE 2004").click()
        page.get_by_text("preset Pioneer 2DXE 2004").first.wait_for(state="attached", timeout=10_000)


def test_a_field_of_view_that_the_brain_is_told_wrongly_is_said_on_the_page(office: Program, browser: Browser) -> None:
    with open_page(browser, office.url) as page:
        office.command("set_parameter", name="local_view.field_of_view", value=1.2)
        page.locator("#alerts .toast", has_text="robot.camera_fov_rad").wait_for(timeout=10_000)
        office.command("set_parameter", name="local_view.field_of_view", value=float(np.radians(50)))
