"""The living office in a real browser: a click on a door."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from sim2d import load_world
from tests.e2e.browser import on_screen, open_page, show
from tests.e2e.program import Program
from web.viewer.fits.office_fit import OfficeFit
from web.viewer.plates.office_plate import ORIGIN
from web.viewer.pointer import DOOR_Z

WORLD = load_world("living")


STILL = ("office.doors", "office.script", "office.people")  # nobody stands in the door, and nothing else moves it


@pytest.fixture
def office(program: Program) -> Iterator[Program]:
    for name in STILL:
        program.command("set_parameter", name=name, value=False)
    program.command("reset", world="living")
    program.command("resume")
    yield program
    program.command("pause")
    for name in STILL:
        program.command("set_parameter", name=name, value=True)


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
    office.command("set_door", name="laboratory door", open=False)
    office.wait(lambda state: state["living"]["doors"]["laboratory door"] == 0.0)
    with open_page(browser, office.url) as page:
        show(page, "office")
        page.mouse.click(*on_screen(page, "office", middle_of(2)))
        office.wait(lambda state: state["living"]["doors"]["laboratory door"] == 1.0)
        assert office.state()["living"]["doors"]["meeting room door"] == 1.0  # no other door has moved
        turn(page, "laboratory door")
        office.wait(lambda state: state["living"]["doors"]["laboratory door"] == 0.0)
