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

from tests.fake_snapshots import fake_reports, fake_snapshot
from tests.unit.web.crowded import judged
from tests.unit.web.office_moments import living, tried
from tests.unit.web.read_pictures import SVG, Picture, circles, drawn, ink, on_map, strokes
from web.messages import GoalMemoryLayer, MapLayer, OccupancyLayer, OccupancyPicture, Snapshot
from web.switches import NAMES
from web.themes import THEMES, Theme
from web.viewer.marks.actors import LIT, NIGHT
from web.viewer.marks.movements import shades
from web.viewer.plates.overlays import occupancy_colours
from web.viewer.primitives.palette import DARK, palette_of
from web.viewer.vector.sheet import EDGE, SHARP, TOP, WIDTH

REPORTS = fake_reports()
CELLS_WIDE = WIDTH - 2 * EDGE  # pixels of the pose cells' field
N = 64  # cells each way
PLAIN = fake_snapshot(430, nodes=50)


def image_in(picture: Picture) -> tuple[np.ndarray, np.ndarray]:
    """The embedded pixels, and (2, 3) where they lie."""
    (image,) = picture.iter(f"{SVG}image")
    file = base64.b64decode(image.get("{http://www.w3.org/1999/xlink}href", "").partition(",")[2])
    pixels = np.asarray(Image.open(io.BytesIO(file)))
    assert pixels.shape[:2] == (int(image.get("height", 0)), int(image.get("width", 0)))
    parts = image.get("transform", "").removeprefix("matrix(").removesuffix(")").split()
    return pixels, np.array(parts, float).reshape(3, 2).T


def colour_at(picture: Picture, at: np.ndarray) -> tuple[int, ...]:
    """Of the embedded image, at pixels of the picture."""
    pixels, placed = image_in(picture)
    column, row = np.linalg.solve(placed[:, :2], at - placed[:, 2])
    return tuple(pixels[math.floor(row), math.floor(column)].tolist())


def cell_at(x: float, y: float) -> np.ndarray:
    return np.array([EDGE + (x + 0.5) / N * CELLS_WIDE, TOP + (1 - (y + 0.5) / N) * CELLS_WIDE])


def occupied(shown: Snapshot, probability: np.ndarray, origin: tuple[float, float], cell_m: float) -> Snapshot:
    drawn_map = OccupancyPicture(probability.astype(np.float32), origin, cell_m)
    return replace(shown, occupancy=OccupancyLayer(np.full((N, N), 0.5, np.float32), lambda: drawn_map))


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize("turn", [0.0, 0.7, -2.5])
def test_each_cell_of_the_occupancy_is_where_the_map_has_it_in_the_colour_of_the_stage(
    turn: float, theme: Theme
) -> None:
    probability = np.random.default_rng(3).uniform(0.02, 0.98, (12, 9))
    low, cell_m = np.array([-1.3, -0.4]), 0.25
    plain = replace(fake_snapshot(430, nodes=300), map_turn_rad=turn)
    snapshot, palette = occupied(plain, probability, (low[0], low[1]), cell_m), palette_of(theme)
    ground = np.broadcast_to(np.array(palette.floor, np.uint8), (12, 9, 3))
    wanted = occupancy_colours(probability.astype(np.float32), ground, palette)
    picture = drawn("map", snapshot, theme=theme)
    for row, column in np.ndindex(12, 9):
        for near in ((0.0, 0.0), (0.45, -0.45)):  # all of a cell has one colour: nothing is blurred
            (at,), _ = on_map(snapshot, (low + (np.array([column, row]) + near) * cell_m)[None])
            assert colour_at(picture, at) == tuple(wanted[row, column].tolist())


def test_what_lies_below_the_pose_cells() -> None:
    seconds = np.full((N, N), np.inf, np.float32)
    seconds[5, :20] = np.arange(20)
    cells = np.full((N, N), 0.5, np.float32)
    cells[40, 10:14] = 0.98
    plain = fake_snapshot(430)
    assert plain.occupancy is not None
    snapshot = replace(
        plain, occupancy=replace(plain.occupancy, cells=cells), goal_memory=GoalMemoryLayer(9, (0, 5), seconds, 0.5)
    )
    picture = drawn("pose", snapshot)
    assert image_in(picture)[0].shape == (N * SHARP, N * SHARP, 4)
    near, far, met, nothing = (colour_at(picture, cell_at(*at)) for at in ((0, 5), (19, 5), (12, 40), (30, 60)))
    assert sum(near[:3]) > sum(far[:3])
    assert near[3] == far[3] == met[3] == 255
    assert sum(met[:3]) < sum(DARK.floor)
    assert nothing[3] == 0  # the grid is seen
    assert circles(picture, DARK.goal) == pytest.approx(cell_at(0, 5)[None], abs=0.11)
    assert any(text.text == "19 s to the goal" for text in picture.iter(f"{SVG}text"))
    packet = snapshot.pose_cells.packets[0]
    (shaft,) = [way for way in strokes(picture, DARK.goal) if np.hypot(*(way[0] - cell_at(packet.x, packet.y))) < 40]
    turn = math.atan2(shaft[0, 1] - shaft[-1, 1], shaft[-1, 0] - shaft[0, 0])
    assert turn == pytest.approx(0.5, abs=0.02)


def test_an_experience_its_links_and_its_zone() -> None:
    snapshot = judged(inspected=REPORTS["experience"])
    picture = drawn("map", snapshot)
    middle, _ = on_map(snapshot, snapshot.map.xy[[12]])
    assert circles(picture, DARK.text) == pytest.approx(middle, abs=0.11)
    assert "#12" in [text.text for text in picture.iter(f"{SVG}text")]
    ends, _ = on_map(snapshot, snapshot.map.xy[[12, 13, 11, 12]])
    links = [line for line in strokes(picture, DARK.text) if len(line) == 2]
    assert np.array(links) == pytest.approx(ends.reshape(2, 2, 2), abs=0.11)

    cells = drawn("pose", snapshot)
    (zone,) = [line for line in strokes(cells, DARK.text) if len(line) > 40]
    assert np.hypot(*(zone - cell_at(31.2, 22.1)).T) == pytest.approx(2.5 * CELLS_WIDE / N, abs=0.2)
    for x, y in ((31, 22), (32, 23)):
        assert len(squares(cells, x, y)) > 0


def squares(picture: Picture, x: int, y: int) -> list[Picture]:
    """In the colour of text, around the middle of a cell."""
    found = []
    for path in picture.iter(f"{SVG}path"):
        if path.get("fill") == ink(DARK.text) and path.get("opacity") is None:
            corners = [corner.split() for corner in path.get("d", "M0 0").strip("MZ").split("L")]
            if np.hypot(*(np.array(corners, float).mean(0) - cell_at(x, y))) < 0.11:
                found.append(path)
    return found


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


@pytest.mark.parametrize("kind", ["view", "cell", "why"])
def test_small_rings_at_all_experiences_that_belong_to_it(kind: str) -> None:
    snapshot = judged(inspected=REPORTS[kind])
    wanted, _ = on_map(snapshot, snapshot.map.xy[[12, 40]])
    assert circles(drawn("map", snapshot), DARK.text) == pytest.approx(wanted, abs=0.11)


def test_the_column_of_a_cell() -> None:
    picture = drawn("pose", judged(inspected=REPORTS["cell"]))
    (foot,) = [line for line in strokes(picture, DARK.text) if len(line) == 5]
    assert foot[:4].mean(0) == pytest.approx(cell_at(31, 22), abs=0.11)
    assert np.ptp(foot, axis=0) == pytest.approx(np.full(2, CELLS_WIDE / N), abs=0.21)


def test_echoes_and_movements() -> None:
    snapshot = replace(fake_snapshot(430), movements=tried)
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
    free, blocked = (strokes(picture, colour) for colour in shades(DARK))
    assert (len(free), len(blocked)) == (1, 1)  # at full speed
    off = drawn("office", snapshot, tuple(name for name in NAMES if name != "movements"))
    assert not strokes(off, shades(DARK)[0])


def test_it_is_not_dark_below_a_lamp() -> None:
    layer = living(daylight=0.4)
    picture = drawn("office", replace(PLAIN, living=layer))
    (night,) = [path for path in picture.iter(f"{SVG}path") if path.get("fill") == ink(NIGHT)]
    (mask,) = picture.iter(f"{SVG}mask")
    assert night.get("mask") == f"url(#{mask.get('id')})"
    (pool,) = [path for path in picture.iter(f"{SVG}path") if path.get("fill") == ink(LIT) and path.get("opacity")]
    assert list(mask)[1].get("d") == pool.get("d")
    dark = drawn("office", replace(PLAIN, living=replace(layer, lamps=layer.lamps * (1, 1, 1, 0))))
    assert not list(dark.iter(f"{SVG}mask"))


def test_houses_are_no_desks() -> None:
    world = PLAIN.world
    assert world is not None
    walls = np.array([(1, 1, 2, 1), (2, 1, 2, 2), (2, 2, 1, 2), (1, 2, 1, 1)], np.float32)
    for kind, colour in (("desk", DARK.desk), ("wall", DARK.partition)):
        shown = replace(world, walls=walls, wall_height_m=np.ones(4, np.float32), wall_kind=(kind,) * 4)
        picture = drawn("office", replace(PLAIN, world=shown))
        filled = [path.get("fill") for path in picture.iter(f"{SVG}path") if path.get("fill") != "none"]
        assert filled.count(ink(colour)) == 1


def test_a_robot_that_has_left_the_floor_is_in_the_picture() -> None:
    plain = fake_snapshot(430)
    alone = MapLayer(plain.map.ids[:1], plain.map.xy[:1], plain.map.heading_rad[:1], plain.map.links[:0])
    far = replace(plain, map=alone, estimate=replace(plain.estimate, x=30.0), goal=None)
    picture = drawn("map", far)
    (robot,) = [path for path in picture.iter(f"{SVG}path") if path.get("fill") == ink(DARK.robot)]
    corners = [corner.split() for corner in robot.get("d", "").strip("MZ").split("L")]
    assert (np.array(corners, float)[:, 0] < WIDTH - EDGE).all()
