"""The living office in a real browser: a click on a door, switches of the Office tab, and what the engine says."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from sim2d import load_world
from tests.e2e.browser import on_screen, open_page, show, told
from tests.e2e.program import Program
from web.viewer.fits.office_fit import OfficeFit
from web.viewer.plates.office_plate import ORIGIN
from web.viewer.pointer import DOOR_Z

WORLD = load_world("living")


@pytest.fixture(scope="module")
def office() -> Iterator[Program]:
    made = Program("--port", "0", "--seed", "5", "--world", "living", "--preset", "ideal")
    yield made
    assert made.stop() == 0


def middle_of(door: int) -> tuple[float, float, float]:
    """The middle of a shut leaf in the scene, at the height at which a click finds it."""
    leaf = WORLD.doors[door]
    fit = OfficeFit(WORLD.bounds)
    x, y = fit.to_plate(np.array([[leaf.x + 0.5 * leaf.width, leaf.y]]))[0]
    return ORIGIN[0] + x, ORIGIN[1] + y, ORIGIN[2] + DOOR_Z * fit.relief


def turn(page: Page, name: str) -> None:
    """Turn a switch of the Office tab."""
    page.get_by_role("tab", name="Office").click()
    page.get_by_role("tabpanel").get_by_label(name, exact=True).click()


def test_a_click_on_a_door_opens_and_shuts_it(office: Program, browser: Browser) -> None:
    for name in ("doors", "script", "people"):  # so that nobody stands in the door and nothing else moves it
        office.command("set_parameter", name=f"office.{name}", value=False)
    office.command("set_door", name="laboratory door", open=False)
    office.wait(lambda state: state["living"]["doors"]["laboratory door"] == 0.0)
    with open_page(browser, office.url) as page:
        show(page, "office")
        page.mouse.click(*on_screen(page, "office", middle_of(2)))
        office.wait(lambda state: state["living"]["doors"]["laboratory door"] == 1.0)
        assert office.state()["living"]["doors"]["meeting room door"] == 1.0  # no other door has moved
        turn(page, "laboratory door")
        office.wait(lambda state: state["living"]["doors"]["laboratory door"] == 0.0)


def test_people_lamps_and_presets_are_switched_on_the_page(office: Program, browser: Browser) -> None:
    office.command("set_parameter", name="office.people", value=True)
    office.wait(lambda state: state["living"]["people"] == 3)
    with open_page(browser, office.url, stage=False) as page:
        turn(page, "people")
        office.wait(lambda state: state["living"]["people"] == 0)
        turn(page, "people")
        office.wait(lambda state: state["living"]["people"] >= 1)  # a person who meets the robot waits
        turn(page, "hall west")
        office.wait(lambda state: not state["living"]["lamps"]["hall west"])
        assert office.state()["living"]["lamps"]["hall east"]
        preset = page.get_by_label("preset", exact=True)
        expect(preset).to_have_value("ideal")
        preset.select_option("Pioneer 2DXE 2004")
        page.get_by_text("preset Pioneer 2DXE 2004").first.wait_for(state="attached")


@pytest.mark.long
def test_a_field_of_view_that_the_brain_is_told_wrongly_is_said_on_the_page(office: Program, browser: Browser) -> None:
    with open_page(browser, office.url, stage=False) as page:
        office.command("set_parameter", name="local_view.field_of_view", value=1.2)
        told(page, "robot.camera_fov_rad")
        office.command("set_parameter", name="local_view.field_of_view", value=float(np.radians(50)))
