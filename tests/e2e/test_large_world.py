"""Large worlds in the real program and a real browser: more walls than SVG can carry; a robot and names that stay readable."""

from __future__ import annotations

import io
import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Browser, Page

from benchmarks.office import rooms
from sim2d import load_world, world_to_json
from tests import patience
from web.viewer.fits import OfficeFit
from web.viewer.marks.names import Z
from web.viewer.plates.office_plate import ORIGIN

from .browser import eye_of, on_screen, open_page, show, until
from .program import Program

pytestmark = pytest.mark.long

INK = """() => {
    const canvas = document.querySelector("canvas.painted");
    if (!canvas || canvas.hidden || !canvas.width) return 0;
    const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    return pixels.filter((value, k) => k % 4 === 3 && value > 0).length;
}"""
WALLS = 1500


def test_thousands_of_walls_are_drawn_and_edited_while_it_runs(browser: Browser, tmp_path: Path) -> None:
    file = tmp_path / "large.json"
    file.write_text(world_to_json(rooms(WALLS, 10)), encoding="utf-8")
    large = Program("--port", "0", "--seed", "1", "--world", str(file))
    with open_page(browser, large.url, 1440, 900) as page:
        page.click("#edit")
        until(page, "() => document.querySelector('#plan .body') !== null")
        until(page, f"() => ({INK})() > 10000")
        assert page.locator("#plan .walls path").count() == 0
        all_of_it = page.evaluate(INK)
        page.evaluate("() => document.documentElement.dataset.theme = 'light'")
        until(page, f"() => Math.abs(({INK})() - {all_of_it}) < {all_of_it // 20}")
        robot = large.state()["robot"]
        item = {"from": [robot["x"] + 0.6, robot["y"]], "to": [robot["x"] + 0.6, robot["y"] + 1.0]}
        large.command("edit_world", steps=[{"do": "add", "list": "walls", "item": item}])
        until(page, "() => document.getElementById('edit-undo').title.startsWith('Undo: wall drawn')")
        for _ in range(12):
            page.click("#edit-closer")
        until(page, f"() => ({INK})() < {all_of_it // 2}")  # what is out of sight is not painted
        tick = large.state()["tick"]
        large.wait(lambda state: state["tick"] > tick + 10)
    assert large.stop() == 0


def around(page: Page, at: tuple[float, float], half: float) -> NDArray[np.int16]:
    """(h, w, 3) the pixels around a place of the page."""
    x, y = at
    clip = {"x": x - half, "y": y - half, "width": 2 * half, "height": 2 * half}
    return np.asarray(Image.open(io.BytesIO(page.screenshot(clip=clip))).convert("RGB"), np.int16)  # type: ignore[arg-type]


def test_in_a_large_world_robot_and_names_can_be_seen_clicked_and_followed(program: Program, browser: Browser) -> None:
    """After four minutes in a world 45 m long, on a plate of ten units."""
    program.command("reset", world="campus", seed=5)
    for ticks in 1000, 1000, 400:
        program.command("step", ticks=ticks)
    world = load_world("campus")
    fit = OfficeFit(world.bounds)

    def on_plate(x: float, y: float, z: float) -> tuple[float, float, float]:
        px, py = fit.to_plate(np.array([[x, y]]))[0] + ORIGIN[:2]
        return float(px), float(py), ORIGIN[2] + z

    robot = program.state()["robot"]
    known = next(place for place in program.places()["named"] if place["why"] is None)
    with open_page(browser, program.url, 1280, 800) as page:
        show(page, "office")
        red, green, blue = np.moveaxis(
            around(page, on_screen(page, "office", on_plate(robot["x"], robot["y"], 0.1)), 20), -1, 0
        )
        orange = (red > green + 60) & (red > blue + 60)
        assert orange.sum() >= 60  # to scale the robot would be five pixels wide

        place = next(place for place in world.places if place.name == known["name"])
        page.mouse.click(*on_screen(page, "office", on_plate(place.x, place.y, Z)))
        goal = program.wait(lambda state: state["goal"] is not None)["goal"]
        assert math.dist((goal["x"], goal["y"]), (known["x"], known["y"])) < 1.0
        until(page, "() => !document.getElementById('goal').hidden")

        whole = eye_of(page)
        at = np.array(on_plate(robot["x"], robot["y"], 0.0))
        page.click("#follow")
        patience.until(
            lambda: page.wait_for_timeout(50) or abs(eye_of(page)[0] - at[0]) < 0.3, "the camera at the robot"
        )
        assert math.dist(eye_of(page), at) < 0.5 * math.dist(whole, at)  # so near that the rooms around it can be seen
