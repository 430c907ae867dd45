"""Fingers on the plates of a phone: a tap is a goal, a drag turns the camera or carries the robot off, a pinch comes nearer."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from sim2d import load_world
from tests import patience
from tests.e2e.browser import box_of, camera_of, on_screen, open_page, show, until
from tests.e2e.program import Program
from tests.e2e.test_dashboard import Place, node_on_stage, place_of, robot_on_stage

STEPS = 12


@pytest.fixture(scope="module")
def page(program: Program, browser: Browser) -> Iterator[Page]:
    """On three quarters of a minute of exploring: a map without a ring, a tap on which would play the loop again."""
    program.command("reset", seed=5)
    program.command("step", ticks=450)
    with open_page(browser, program.url, 390, 844, touched=True) as opened:
        yield opened


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


def away(page: Page) -> float:
    """How far the camera is from what it looks at."""
    page.wait_for_timeout(50)
    camera = camera_of(page)
    return math.dist(camera.position, camera.look_at)


def dot(program: Program) -> tuple[np.ndarray, Place]:
    """Where one of the dots is in the map, and in the scene."""
    nodes = np.array(program.state(full=True)["map"]["xy"])
    node = nodes[len(nodes) // 2]
    return node, node_on_stage(program, node, nodes)


def test_a_tap_on_the_map_sets_a_goal(program: Program, page: Page) -> None:
    show(page, "map")
    node, at = dot(program)
    page.touchscreen.tap(*on_screen(page, "map", at))
    goal = program.wait(lambda state: state["goal"] is not None)["goal"]
    assert math.dist(place_of(goal), node) < 0.4
    page.wait_for_selector("#goal:not([hidden])")
    program.command("cancel_goal")


@pytest.mark.long
def test_a_pinch_comes_nearer_to_what_is_between_the_fingers_and_sets_no_goal(program: Program, page: Page) -> None:
    show(page, "map")
    _, at = dot(program)
    thumb, whole = on_screen(page, "map", at), away(page)
    canvas = box_of(page.frame_locator("#stage").locator("canvas").first)
    x, y = canvas["x"] + canvas["width"] / 2, canvas["y"] + canvas["height"] / 2
    outwards = math.copysign(1.0, x - thumb[0])
    finger = [(thumb[0] + outwards * pixels, thumb[1]) for pixels in (50, 200)]
    drag(page, (thumb, thumb), (finger[0], finger[1]))  # four times as far apart, the thumb on a dot of the map
    patience.until(lambda: math.isclose(away(page), whole / 4, rel_tol=0.01))
    assert math.dist(on_screen(page, camera_of(page), at), thumb) < 3
    drag(page, (thumb, thumb), (finger[1], finger[0]))
    patience.until(lambda: math.isclose(away(page), whole, rel_tol=0.01))
    before = camera_of(page).position
    drag(page, ((x, y), (x + 90, y + 10)))  # one finger turns the camera, also after two have
    patience.until(lambda: page.wait_for_timeout(50) or math.dist(camera_of(page).position, before) > 1.0)
    assert math.isclose(away(page), whole, rel_tol=0.01)
    assert program.state()["goal"] is None


@pytest.mark.long
def test_a_finger_carries_the_robot_away_and_two_do_not(program: Program, page: Page) -> None:
    show(page, "office")
    state = program.state()
    here = place_of(state["robot"])
    x, y = on_screen(page, "office", robot_on_stage(state, *here))
    whole = away(page)
    drag(page, ((x, y), (x + 40, y + 40)), ((x + 60, y), (x + 80, y - 40)))
    patience.until(lambda: away(page) < 0.9 * whole)
    assert program.state()["robot"] == state["robot"]

    show(page, "office")
    low_x, low_y, high_x, high_y = load_world(state["world"]).bounds
    target = max(((low_x + 0.8, low_y + 0.8), (high_x - 0.8, high_y - 0.8)), key=lambda corner: math.dist(corner, here))
    start, end = (on_screen(page, "office", robot_on_stage(state, *place)) for place in (here, target))
    drag(page, (start, end))
    moved = program.wait(lambda now: math.dist(place_of(now["robot"]), target) < 0.8)
    assert moved["estimate"] == state["estimate"]
    until(page, "() => document.getElementById('events').textContent.includes('kidnap')")
