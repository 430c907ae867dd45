"""The picture that stands in the viewer's place: drawn from the snapshot, from the view's own camera, in either theme."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from tests.fake_snapshots import fake_reports, fake_snapshot
from tests.unit.web.crowded import two_brains
from tests.unit.web.doubles import house
from web.messages import GoalMemoryLayer, OccupancyLayer, OccupancyPicture
from web.switches import NAMES
from web.viewer.camera_views import CELLS_AT, MAP_AT, OFFICE_AT, SHEET, VIEWS, Camera, camera_for, seen_by, stands
from web.viewer.fits import SIDE, MapFit, OfficeFit, refit
from web.viewer.picture import UNITS, picture
from web.viewer.plates import map_plate, office_plate, pose_cell_plate
from web.viewer.primitives.palette import BRAINS, DARK, LIGHT, Rgb, mix

pytestmark = pytest.mark.slow


ASPECT = 1.63
PLAIN = fake_snapshot(430)
PLATES = {"office": (office_plate, OFFICE_AT), "map": (map_plate, MAP_AT), "pose": (pose_cell_plate, CELLS_AT)}


def zoomed(camera: Camera) -> float:
    """Units of the picture for one in the camera's plane of sight."""
    return UNITS / 2 / math.tan(camera.fov_rad / 2) / float(np.linalg.norm(camera.look_at - camera.position))


def pinhole(camera: Camera, points: np.ndarray) -> np.ndarray:
    """Where the plain camera sees places, to the right and upwards, in halves of the picture's height."""
    ahead = camera.look_at - camera.position
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    offset = points - camera.position
    seen = np.stack([offset @ right, offset @ np.cross(right, ahead)], -1)
    return seen / (offset @ ahead)[..., None] / math.tan(camera.fov_rad / 2)


def of_colour(svg: str, colour: Rgb) -> np.ndarray:
    """(n, 2) all corners of what has this colour."""
    ink = f"#{bytes(colour).hex()}"
    ways = [part.get("d", "") for part in ET.fromstring(svg).iter() if ink in (part.get("fill"), part.get("stroke"))]
    return np.array(re.findall(r"-?\d+\.\d+", " ".join(ways)), float).reshape(-1, 2)


def test_it_is_a_whole_picture_of_what_stands_there(subtests: pytest.Subtests) -> None:
    for view, aspect in product(VIEWS, (0.46, ASPECT)):
        with subtests.test(view=view, aspect=aspect):
            root = ET.fromstring(picture(PLAIN, view, aspect, DARK, NAMES))
            drawn = [part for part in root.iter() if part.tag.endswith(("path", "circle"))]
            assert len(drawn) > 200
            assert all(math.isfinite(float(n)) for part in drawn for n in re.findall(r"-?[\d.]+", part.get("d", "0")))


def test_the_robot_is_where_the_camera_sees_it() -> None:
    world, truth = PLAIN.world, PLAIN.truth
    assert world is not None
    assert truth is not None
    at = OfficeFit(world.bounds).to_plate(np.array([[truth.x, truth.y]]))[0] + OFFICE_AT
    wanted = pinhole(camera_for("all", ASPECT), np.array([*at, 0.2])) * UNITS / 2 * (1, -1)
    root = ET.fromstring(picture(PLAIN, "all", ASPECT, DARK, NAMES))
    (robot,) = [c for c in root.iter() if c.tag.endswith("circle") and c.get("fill") == f"#{bytes(DARK.robot).hex()}"]
    assert [float(robot.get(name, "nan")) for name in ("cx", "cy")] == pytest.approx(wanted, abs=0.2)


def test_the_plates_fill_the_window_and_stay_in_it(subtests: pytest.Subtests) -> None:
    """Every corner of the plates in view is seen, and two opposite sides are reached, whatever the window's shape."""
    sides = np.array(list(product((-0.5, 0.5), repeat=2)))
    for view, aspect in product(VIEWS, [0.46, 0.75, 1.0, 1.35, 1.63, 2.2, 3.0]):
        with subtests.test(view=view, aspect=aspect):
            corners = []
            for plate, at in (PLATES[name] for name in PLATES if view in ("all", name)):
                width, depth, centre_y = SHEET
                assert plate.ORIGIN[:2] == at
                corners += [(*(at + np.array([0.0, centre_y]) + side * (width, depth)), 0.0) for side in sides]
            x, y = (pinhole(camera_for(view, aspect), np.array(corners)) / (aspect, 1)).T
            assert np.abs([x, y]).max() < 1
            filled = max(np.ptp(x), np.ptp(y) if view in ("office", "map") else 2 * abs(y.min()))
            assert filled > 1.65  # of 2


def test_what_lies_on_the_floors_is_where_the_plates_have_it() -> None:
    """A cell in which something stands, and one from which a way is known; nothing while its switch is off."""
    camera = camera_for("all", ASPECT)
    probability = np.full((6, 8), 0.5, np.float32)
    probability[4, 2] = 0.95
    met = OccupancyPicture(probability, (0.5, -0.5), 0.25)
    seconds = np.full((64, 64), np.inf, np.float32)
    seconds[20, 50] = 0.0
    snapshot = replace(
        PLAIN, occupancy=OccupancyLayer(np.full((64, 64), 0.5, np.float32), lambda: met), goal=None,
        goal_memory=GoalMemoryLayer(9, None, seconds, None),
    )  # fmt: skip
    svg, bare = (picture(snapshot, "all", ASPECT, DARK, on) for on in (NAMES, ()))
    unit = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    cell = (np.array([2, 4]) + unit - 0.5) * 0.25 + (0.5, -0.5)
    fit = refit(MapFit(), snapshot.map.extent_xy, snapshot.map_turn_rad)
    known = (np.array([50, 20]) + unit) / 64 * SIDE - SIDE / 2 + CELLS_AT
    near = tuple(DARK.times(np.zeros(1, np.float32), 1.0)[0].tolist())
    for colour, at in (
        (mix(DARK.floor, DARK.occupied, 0.9), fit.to_plate(cell) + MAP_AT),
        (mix(DARK.floor, near, 0.85), known),
    ):
        seen = seen_by(camera, np.column_stack([at, np.full(4, -0.02)]))[0] * zoomed(camera) * (1, -1)
        assert of_colour(svg, colour) == pytest.approx(seen, abs=0.11)
        assert not len(of_colour(bare, colour))


def test_of_two_brains_each_stands_where_its_plates_do() -> None:
    """The arrows of both, on their own maps by their own fits, and the rims in their colours."""
    snapshot = two_brains()
    assert snapshot.beside is not None
    svg, camera = picture(snapshot, "all", ASPECT, DARK, NAMES), camera_for("all", ASPECT, two=True)
    arrows = of_colour(svg, DARK.robot)
    for brain, at in zip((snapshot, snapshot.beside), stands(office=True, two=True).maps, strict=True):
        fit, pose = refit(MapFit(), brain.map.extent_xy, brain.map_turn_rad), brain.estimate
        c, s = math.cos(pose.heading_rad + fit.turn_rad), math.sin(pose.heading_rad + fit.turn_rad)
        tip = fit.to_plate(np.array([[pose.x, pose.y]])) + at + 0.5 * np.array([c, s])
        seen = seen_by(camera, np.column_stack([tip, [0.22]]))[0][0] * zoomed(camera) * (1, -1)
        assert np.hypot(*(arrows - seen).T).min() < 0.2
    for colour in BRAINS[DARK.dark]:
        assert svg.count(f'stroke="#{bytes(colour).hex()}"') == 2


def test_what_is_inspected_is_ringed() -> None:
    plain = replace(PLAIN, goal=None)
    bare = len(of_colour(picture(plain, "map", 1.5, DARK, NAMES), DARK.text))
    for report, rings, links in (("experience", 1, 2), ("view", 2, 0), ("cell", 2, 0), ("why", 2, 0)):
        told = picture(replace(plain, inspected=fake_reports()[report]), "map", 1.5, DARK, NAMES)
        assert len(of_colour(told, DARK.text)) - bare == 2 * (36 * rings + links)


def test_without_office_or_map_it_is_there_all_the_same() -> None:
    assert "<circle" in picture(replace(PLAIN, world=None, truth=None), "all", 1.5, LIGHT, NAMES)
    few = replace(PLAIN.map, ids=PLAIN.map.ids[:0], xy=PLAIN.map.xy[:0], links=PLAIN.map.links[:0])
    times = replace(PLAIN.times, seconds=PLAIN.times.seconds[:0])
    assert "<path" in picture(replace(PLAIN, map=few, times=times), "map", 1.5, DARK, NAMES)


def test_it_is_served_and_before_the_first_tick_there_is_none() -> None:
    with house() as server:
        answer = server.client.get("/api/stage.svg?view=map&theme=light&aspect=0.5")
        assert answer.status_code == 200
        assert answer.headers["content-type"].startswith("image/svg+xml")
        assert answer.text.startswith("<svg")
        for wrong in ("view=moon", "aspect=0", "aspect=nan", "theme=pink"):
            assert server.client.get(f"/api/stage.svg?{wrong}").status_code == 422
    with house(empty=True) as server:
        assert server.client.get("/api/stage.svg").status_code == 204
