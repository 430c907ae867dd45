"""Fingers on the plates, of a phone and of a tablet: a tap sets a goal, a drag turns the camera or carries the robot away, a
pinch comes nearer."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from playwright.sync_api import Page

from sim2d import load_world
from tests.e2e.browser import box_of, camera_of, on_screen, open_page, show, until
from tests.e2e.program import Program
from tests.e2e.test_dashboard import robot_on_stage
from tests.patience import PATIENCE_S
from web.viewer.fits.map_fit import MapFit, refit
from web.viewer.plates.map_plate import NODE_Z, ORIGIN

STEPS = 12


@pytest.fixture(scope="module")
def driven(program):
    """Three quarters of a minute of exploring: a map to tap on."""
    program.command("reset", seed=5)
    program.command("step", ticks=450)  # the same map each time, without a ring: a tap on one would play the loop again
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


def dot(driven: Program) -> tuple[np.ndarray, tuple[float, float, float]]:
    """Where one of the dots is in the map, and in the scene."""
    whole = driven.state(full=True)["map"]
    nodes = np.array(whole["xy"])
    node = nodes[len(nodes) // 2]
    x, y = refit(MapFit(), nodes, whole["turn_rad"]).to_plate(node)[0]
    return node, (ORIGIN[0] + x, ORIGIN[1] + y, ORIGIN[2] + NODE_Z)


def test_a_tap_on_the_map_sets_a_goal(driven, touched):
    page = touched
    node, at = dot(driven)
    page.touchscreen.tap(*on_screen(page, "map", at))
    goal = driven.wait(lambda state: state["goal"] is not None)["goal"]
    assert math.dist((goal["x"], goal["y"]), node) < 0.4
    page.wait_for_selector("#goal:not([hidden])")
    driven.command("cancel_goal")


@pytest.mark.long
def test_a_pinch_comes_nearer_to_what_is_between_the_fingers_and_sets_no_goal(driven, touched):
    page = touched
    _, at = dot(driven)
    thumb, (x, y), whole = on_screen(page, "map", at), middle_of(page), away(page)
    outwards = math.copysign(1.0, x - thumb[0])
    finger = [(thumb[0] + outwards * pixels, thumb[1]) for pixels in (50, 200)]
    drag(page, (thumb, thumb), (finger[0], finger[1]))  # four times as far apart, the thumb on a dot of the map
    await_(page, lambda: math.isclose(away(page), whole / 4, rel_tol=0.01))
    assert math.dist(on_screen(page, camera_of(page), at), thumb) < 3
    drag(page, (thumb, thumb), (finger[1], finger[0]))
    await_(page, lambda: math.isclose(away(page), whole, rel_tol=0.01))
    before = camera_of(page).position
    drag(page, ((x, y), (x + 90, y + 10)))  # one finger turns the camera, also after two have
    await_(page, lambda: bool(np.linalg.norm(camera_of(page).position - before) > 1.0))
    assert math.isclose(away(page), whole, rel_tol=0.01)
    assert driven.state()["goal"] is None


def away(page: Page) -> float:
    """How far the camera is from what it looks at."""
    camera = camera_of(page)
    return math.dist(camera.position, camera.look_at)


@pytest.mark.long
def test_two_fingers_on_the_robot_carry_it_nowhere(driven, touched):
    page = touched
    show(page, "office")
    state = driven.state()
    x, y = on_screen(page, "office", robot_on_stage(state, state["robot"]["x"], state["robot"]["y"]))
    whole = away(page)
    drag(page, ((x, y), (x + 40, y + 40)), ((x + 60, y), (x + 80, y - 40)))
    await_(page, lambda: away(page) < 0.9 * whole)
    assert driven.state()["robot"] == state["robot"]


@pytest.mark.long
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
