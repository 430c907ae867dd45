"""Fingers on the plates, of a phone and of a tablet: a tap sets a goal, a drag turns the camera or carries the robot away, a
pinch comes nearer."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from playwright.sync_api import Page

from sim2d import load_world
from tests.e2e.browser import box_of, eye_of, on_screen, open_page, show, until
from tests.e2e.test_dashboard import robot_on_stage
from tests.patience import PATIENCE_S
from web.viewer.camera_views import camera_for
from web.viewer.fits.map_fit import MapFit, refit
from web.viewer.plates.map_plate import NODE_Z, ORIGIN

STEPS = 12


@pytest.fixture(scope="module")
def driven(program):
    """A minute of exploring: a map to tap on."""
    program.command("reset", seed=5)
    program.command("set_speed", factor=0)
    program.command("resume")
    program.wait(lambda state: state["time_s"] >= 60)
    program.command("pause")
    return program


@pytest.fixture(params=[(390, 844), (1024, 768)], ids=["phone", "tablet"])
def touched(request, driven, browser) -> Iterator[Page]:
    with open_page(browser, driven.url, *request.param, touched=True) as page:
        show(page, "map")
        yield page


def drag(page: Page, *fingers: tuple[tuple[float, float], tuple[float, float]]) -> None:
    """Each finger goes from its start to its end, as Chromium receives it from a touch screen."""
    glass = page.context.new_cdp_session(page)
    ways = np.array([np.linspace(start, end, STEPS) for start, end in fingers])
    for k in range(STEPS):
        points = [{"x": x, "y": y, "id": finger} for finger, (x, y) in enumerate(ways[:, k].tolist())]
        glass.send("Input.dispatchTouchEvent", {"type": "touchMove" if k else "touchStart", "touchPoints": points})
        page.wait_for_timeout(80)
    page.wait_for_timeout(500)
    glass.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


def middle_of(page: Page) -> tuple[float, float]:
    canvas = box_of(page.frame_locator("#stage").locator("canvas").first)
    return canvas["x"] + canvas["width"] / 2, canvas["y"] + canvas["height"] / 2


def await_(page: Page, condition: Callable[[], bool]) -> None:
    for _ in range(int(10 * PATIENCE_S)):
        if condition():
            return
        page.wait_for_timeout(100)
    raise AssertionError("it does not come to pass")


def test_a_tap_on_the_map_sets_a_goal(driven, touched):
    page = touched
    whole = driven.state(full=True)["map"]
    nodes = np.array(whole["xy"])
    node = nodes[len(nodes) // 2]
    x, y = refit(MapFit(), nodes, whole["turn_rad"]).to_plate(node)[0]
    page.touchscreen.tap(*on_screen(page, "map", (ORIGIN[0] + x, ORIGIN[1] + y, ORIGIN[2] + NODE_Z)))
    goal = driven.wait(lambda state: state["goal"] is not None)["goal"]
    assert math.dist((goal["x"], goal["y"]), node) < 0.4
    page.wait_for_selector("#goal:not([hidden])")
    driven.command("cancel_goal")


def test_a_drag_looks_around_and_a_pinch_comes_nearer_and_neither_sets_a_goal(driven, touched):
    page = touched
    before = eye_of(page)
    x, y = middle_of(page)
    drag(page, ((x, y), (x + 90, y + 10)))
    await_(page, lambda: bool(np.linalg.norm(eye_of(page) - before) > 1.0))
    whole = away(page)  # a turn keeps it
    drag(page, ((x - 30, y), (x - 120, y)), ((x + 30, y), (x + 120, y)))
    await_(page, lambda: away(page) < 0.95 * whole)
    near = away(page)
    drag(page, ((x - 120, y), (x - 40, y)), ((x + 120, y), (x + 40, y)))
    await_(page, lambda: away(page) > 1.03 * near)
    assert driven.state()["goal"] is None


def away(page: Page) -> float:
    """How far the camera is from what it looks at while nobody has touched it."""
    canvas = box_of(page.frame_locator("#stage").locator("canvas").first)
    return math.dist(eye_of(page), camera_for("map", canvas["width"] / canvas["height"]).look_at)


def test_a_finger_carries_the_robot_away(driven, touched):
    page = touched
    show(page, "office")
    state = driven.state()
    low_x, low_y, high_x, high_y = load_world(state["world"]).bounds
    here = (state["robot"]["x"], state["robot"]["y"])
    target = max(((low_x + 0.8, low_y + 0.8), (high_x - 0.8, high_y - 0.8)), key=lambda corner: math.dist(corner, here))
    start, end = (on_screen(page, "office", robot_on_stage(state, *place)) for place in (here, target))
    drag(page, (start, end))
    moved = driven.wait(lambda now: math.dist((now["robot"]["x"], now["robot"]["y"]), target) < 0.8)
    assert moved["estimate"] == state["estimate"]
    until(page, "() => document.getElementById('events').textContent.includes('kidnap')")
