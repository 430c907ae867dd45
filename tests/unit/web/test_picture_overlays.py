"""Where occupancy, goal memory, senses and what is inspected lie in the pictures of the plates, and in which colours."""

from __future__ import annotations

import base64
import io
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.crowded import judged
from tests.unit.web.office_moments import living, tried
from tests.unit.web.pictures import REPORTS, SVG, Picture, circles, corners, drawn, filled, on_map, strokes, words
from web.messages import GoalMemoryLayer, MapLayer, OccupancyLayer, OccupancyPicture
from web.themes import THEMES, Theme
from web.viewer.marks.actors import LIT, NIGHT
from web.viewer.marks.movements import shades
from web.viewer.plates.overlays import occupancy_colours
from web.viewer.primitives.palette import DARK, palette_of
from web.viewer.vector.sheet import EDGE, SHARP, TOP, WIDTH

CELLS_WIDE = WIDTH - 2 * EDGE  # pixels of the pose cells' field
N = 64  # cells each way
PLAIN = fake_snapshot(430, nodes=50)


def colours_at(picture: Picture, at: np.ndarray) -> np.ndarray:
    """(n, 3 or 4) of the embedded image, at (n, 2) pixels of the picture."""
    (image,) = picture.iter(f"{SVG}image")
    file = base64.b64decode(image.get("{http://www.w3.org/1999/xlink}href", "").partition(",")[2])
    pixels = np.asarray(Image.open(io.BytesIO(file)))
    assert pixels.shape[:2] == (int(image.get("height", 0)), int(image.get("width", 0)))
    parts = image.get("transform", "").removeprefix("matrix(").removesuffix(")").split()
    placed = np.array(parts, float).reshape(3, 2).T
    columns, rows = np.floor(np.linalg.solve(placed[:, :2], (at - placed[:, 2]).T)).astype(int)
    return pixels[rows, columns].astype(int)


def cell_at(x: float, y: float) -> np.ndarray:
    return np.array([EDGE + (x + 0.5) / N * CELLS_WIDE, TOP + (1 - (y + 0.5) / N) * CELLS_WIDE])


# ---------------------------------------------------------------- what is laid over the floors


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize("turn", [0.0, 0.7, -2.5])
def test_each_cell_of_the_occupancy_is_where_the_map_has_it_in_the_colour_of_the_stage(
    turn: float, theme: Theme
) -> None:
    probability = np.random.default_rng(3).uniform(0.02, 0.98, (12, 9)).astype(np.float32)
    low, cell_m, palette = np.array([-1.3, -0.4]), 0.25, palette_of(theme)
    met = OccupancyPicture(probability, (low[0], low[1]), cell_m)
    layer = OccupancyLayer(np.full((N, N), 0.5, np.float32), lambda: met)
    snapshot = replace(fake_snapshot(430, nodes=300), map_turn_rad=turn, occupancy=layer)
    ground = np.broadcast_to(np.array(palette.floor, np.uint8), (12, 9, 3))
    wanted = occupancy_colours(probability, ground, palette).reshape(-1, 3)
    picture, cells = drawn("map", snapshot, theme=theme), np.array(list(np.ndindex(12, 9)))[:, ::-1]
    for near in ((0.0, 0.0), (0.45, -0.45)):  # all of a cell has one colour: nothing is blurred
        at, _ = on_map(snapshot, low + (cells + near) * cell_m)
        assert np.array_equal(colours_at(picture, at)[:, :3], wanted)


def test_what_lies_below_the_pose_cells() -> None:
    seconds, cells = np.full((N, N), np.inf, np.float32), np.full((N, N), 0.5, np.float32)
    seconds[5, :20] = np.arange(20)
    cells[40, 10:14] = 0.98
    assert PLAIN.occupancy is not None
    memory = GoalMemoryLayer(9, (0, 5), seconds, 0.5)
    picture = drawn("pose", replace(PLAIN, occupancy=replace(PLAIN.occupancy, cells=cells), goal_memory=memory))
    (image,) = picture.iter(f"{SVG}image")
    assert (image.get("width"), image.get("height")) == (str(N * SHARP), str(N * SHARP))
    looked_at = np.array([cell_at(*at) for at in ((0, 5), (19, 5), (12, 40), (30, 60))])
    near, far, met, nothing = colours_at(picture, looked_at).tolist()
    assert sum(near[:3]) > sum(far[:3])
    assert sum(met[:3]) < sum(DARK.floor)
    assert [near[3], far[3], met[3], nothing[3]] == [255, 255, 255, 0]  # where nothing lies, the grid is seen
    assert circles(picture, DARK.goal) == pytest.approx(cell_at(0, 5)[None], abs=0.11)
    assert "19 s to the goal" in words(picture)
    packet = PLAIN.pose_cells.packets[0]
    (shaft,) = [way for way in strokes(picture, DARK.goal) if np.hypot(*(way[0] - cell_at(packet.x, packet.y))) < 40]
    turn = math.atan2(shaft[0, 1] - shaft[-1, 1], shaft[-1, 0] - shaft[0, 0])
    assert turn == pytest.approx(0.5, abs=0.02)


# ---------------------------------------------------------------- what is inspected


def squares(picture: Picture, x: int, y: int) -> list[Picture]:
    """In the colour of text, around the middle of a cell."""
    opaque = [path for path in filled(picture, DARK.text) if path.get("opacity") is None]
    return [path for path in opaque if np.hypot(*(corners(path).mean(0) - cell_at(x, y))) < 0.11]


def test_an_experience_its_links_and_its_zone() -> None:
    snapshot = judged(inspected=REPORTS["experience"])
    picture, cells = drawn("map", snapshot), drawn("pose", snapshot)
    places, _ = on_map(snapshot, snapshot.map.xy[[12, 13, 11, 12]])
    assert circles(picture, DARK.text) == pytest.approx(places[:1], abs=0.11)
    assert "#12" in words(picture)
    links = [line for line in strokes(picture, DARK.text) if len(line) == 2]
    assert np.array(links) == pytest.approx(places.reshape(2, 2, 2), abs=0.11)
    (zone,) = [line for line in strokes(cells, DARK.text) if len(line) > 40]
    assert np.hypot(*(zone - cell_at(31.2, 22.1)).T) == pytest.approx(2.5 * CELLS_WIDE / N, abs=0.2)
    assert squares(cells, 31, 22)
    assert squares(cells, 32, 23)


@settings(max_examples=25, deadline=None)
@given(x=st.floats(0, N, exclude_max=True), y=st.floats(0, N, exclude_max=True), radius=st.floats(0.5, 6))
def test_a_zone_that_leaves_goes_on_at_the_other_side(x: float, y: float, radius: float) -> None:
    report = replace(REPORTS["experience"], cell=(x, y, 3.0), zone_xy=radius)  # type: ignore[type-var]
    picture = drawn("pose", replace(PLAIN, inspected=report))
    middles = [line[:-1].mean(0) for line in strokes(picture, DARK.text) if len(line) > 40]
    half, field = CELLS_WIDE / 2, np.array([EDGE + CELLS_WIDE / 2, TOP + CELLS_WIDE / 2])
    for at in (cell_at(x + a * N, y + b * N) for a in (-1, 0, 1) for b in (-1, 0, 1)):
        beside = np.hypot(*np.maximum(np.abs(at - field) - half, 0))
        if beside < 0.9 * radius * CELLS_WIDE / N:
            assert min(np.hypot(*(middle - at)) for middle in middles) < 0.5


def test_small_rings_at_all_experiences_that_belong_to_it_and_the_column_of_a_cell() -> None:
    for kind in ("view", "cell", "why"):
        snapshot = judged(inspected=REPORTS[kind])
        wanted, _ = on_map(snapshot, snapshot.map.xy[[12, 40]])
        assert circles(drawn("map", snapshot), DARK.text) == pytest.approx(wanted, abs=0.11)
    (foot,) = [line for line in strokes(drawn("pose", judged(inspected=REPORTS["cell"])), DARK.text) if len(line) == 5]
    assert foot[:4].mean(0) == pytest.approx(cell_at(31, 22), abs=0.11)
    assert np.ptp(foot, axis=0) == pytest.approx(np.full(2, CELLS_WIDE / N), abs=0.21)


# ---------------------------------------------------------------- the office, and the robot


def test_echoes_and_movements() -> None:
    snapshot = replace(PLAIN, movements=tried)
    world, truth = snapshot.world, snapshot.truth
    assert world is not None
    assert truth is not None
    picture = drawn("office", snapshot)
    room = 0.014 * (world.bounds[2] - world.bounds[0])
    x1, x2, y2 = world.bounds[0] - room, world.bounds[2] + room, world.bounds[3] + room
    scale = CELLS_WIDE / (x2 - x1)
    heard = np.isfinite(snapshot.senses.ranges_m)
    angles, far = truth.heading_rad + world.sonar_angles_rad[heard], snapshot.senses.ranges_m[heard]
    echoes = np.column_stack([truth.x + far * np.cos(angles), truth.y + far * np.sin(angles)])
    lines = strokes(picture, DARK.sonar)
    assert len(lines) == heard.sum() > 0
    assert [line[1] for line in lines] == pytest.approx((echoes - (x1, y2)) * (scale, -scale) + (EDGE, TOP), abs=0.11)
    assert [len(strokes(picture, colour)) for colour in shades(DARK)] == [1, 1]  # free and blocked, at full speed


def test_it_is_not_dark_below_a_lamp() -> None:
    layer = living(daylight=0.4)
    picture = drawn("office", replace(PLAIN, living=layer))
    (night,), (mask,) = filled(picture, NIGHT), picture.iter(f"{SVG}mask")
    assert night.get("mask") == f"url(#{mask.get('id')})"
    (pool,) = [path for path in filled(picture, LIT) if path.get("opacity")]
    assert list(mask)[1].get("d") == pool.get("d")
    dark = drawn("office", replace(PLAIN, living=replace(layer, lamps=layer.lamps * (1, 1, 1, 0))))
    assert not list(dark.iter(f"{SVG}mask"))


def test_houses_are_no_desks() -> None:
    assert PLAIN.world is not None
    walls = np.array([(1, 1, 2, 1), (2, 1, 2, 2), (2, 2, 1, 2), (1, 2, 1, 1)], np.float32)
    for kind, colour in (("desk", DARK.desk), ("wall", DARK.partition)):
        shown = replace(PLAIN.world, walls=walls, wall_height_m=np.ones(4, np.float32), wall_kind=(kind,) * 4)
        assert len(filled(drawn("office", replace(PLAIN, world=shown)), colour)) == 1


def test_a_robot_that_has_left_the_floor_is_in_the_picture() -> None:
    alone = MapLayer(PLAIN.map.ids[:1], PLAIN.map.xy[:1], PLAIN.map.heading_rad[:1], PLAIN.map.links[:0])
    far = replace(PLAIN, map=alone, estimate=replace(PLAIN.estimate, x=30.0), goal=None)
    (robot,) = filled(drawn("map", far), DARK.robot)
    assert (corners(robot)[:, 0] < WIDTH - EDGE).all()
