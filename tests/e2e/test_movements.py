"""The robot's candidate movements in a real browser: a switch of the panel draws them on the floor of the office."""

from __future__ import annotations

import cv2
import numpy as np
from playwright.sync_api import Browser, Page

from sim2d import load_world
from tests import patience
from tests.e2e.browser import on_screen, open_page, show
from tests.e2e.program import Program
from web.viewer.fits.office_fit import OfficeFit
from web.viewer.plates.office_plate import ORIGIN

NEAR_PX = 90


def around(page: Page, robot: dict[str, float]) -> np.ndarray:
    """The picture around the robot, (h, w, 3)."""
    shot = cv2.imdecode(np.frombuffer(page.screenshot(), np.uint8), cv2.IMREAD_COLOR)
    assert shot is not None
    x, y = OfficeFit(load_world().bounds).to_plate(np.array([[robot["x"], robot["y"]]]))[0]
    column, row = on_screen(page, "office", (ORIGIN[0] + x, ORIGIN[1] + y, ORIGIN[2]))
    return shot[round(row) - NEAR_PX : round(row) + NEAR_PX, round(column) - NEAR_PX : round(column) + NEAR_PX].astype(
        int
    )


def test_the_candidate_movements_are_drawn_around_the_robot_while_they_are_switched_on(
    program: Program, browser: Browser
) -> None:
    program.command("step", ticks=40)  # it follows the wall, and 6 of 47 movements are blocked
    robot = program.state()["robot"]
    with open_page(browser, program.url) as page:
        show(page, "office")
        page.get_by_role("tab", name="Memory").click()
        switch = page.get_by_label("Candidate movements")
        seen = [around(page, robot)]

        def differs() -> int:
            return int((np.abs(around(page, robot) - seen[-1]).max(2) > 60).sum())

        def stands_still() -> bool:
            seen.append(around(page, robot))
            return differs() == 0

        patience.until(stands_still, "the stage stands still")
        switch.check()
        patience.until(lambda: differs() > 300, "the movements are drawn")
        switch.uncheck()
        patience.until(lambda: differs() < 30, "they are gone")
