"""Pictures become worlds: their walls are where they were drawn, and what is no floor is left out."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim2d import FreeSpace, world_from_json, world_to_json
from sim2d.importers import import_world

from .plans import YAML, corners, from_picture, pgm, png, room


@pytest.mark.slow
def test_a_rectangle_gives_its_walls_back() -> None:
    picture = room()
    picture[50:60, 70:100] = 0  # rows count from the top: 60 to 70 pixels above the lower edge
    world = from_picture(picture)
    assert corners(world) == {
        (0.25, 0.25), (7.75, 0.25), (7.75, 5.75), (0.25, 5.75),
        (3.5, 3.0), (5.0, 3.0), (5.0, 3.5), (3.5, 3.5),
    }  # fmt: skip
    assert len(world.walls) == 8
    assert sum(w.outer for w in world.walls) == 4


def test_origin_and_rotation() -> None:
    yaml = YAML.replace("[0, 0, 0]", f"[-3.5, 12.25, {math.pi / 6}]")
    world = import_world("m.yaml", {"m.yaml": yaml.encode(), "plan.pgm": pgm(room())})
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    wanted = [(-3.5 + c * x - s * y, 12.25 + s * x + c * y) for x in (0.25, 7.75) for y in (0.25, 5.75)]
    found = np.array(sorted(corners(world)))
    np.testing.assert_allclose(found, np.array(sorted(wanted)), atol=0.001)
    assert all(FreeSpace(world, 0.22).is_free(p.x, p.y) for p in world.starts)


@pytest.mark.parametrize("suffix", ["pgm", "png"])
def test_picture_formats_and_a_block_list(suffix: str) -> None:
    yaml = YAML.replace("[0, 0, 0]", "\n  - 0.0\n  - 0.0 # along x\n  - 0").replace("plan.pgm", f'"plan.{suffix}"')
    data = {"pgm": pgm, "png": png}[suffix](room())
    world = import_world("m.yaml", {"m.yaml": yaml.encode(), f"plan.{suffix}": data})
    assert corners(world) == corners(from_picture(room()))


def test_negate_and_modes() -> None:
    same = corners(from_picture(room()))
    negated = import_world(
        "m.yaml", {"m.yaml": YAML.replace("negate: 0", "negate: 1").encode(), "plan.pgm": pgm(255 - room())}
    )
    assert corners(negated) == same
    raw = np.where(room() > 0, 0, 100).astype(np.uint8)
    assert corners(import_world("m.yaml", {"m.yaml": (YAML + "mode: raw\n").encode(), "plan.pgm": pgm(raw)})) == same
    veiled = np.full((*room().shape, 4), 255, np.uint8)
    veiled[room() == 0, 3] = 0
    files = {"m.yaml": (YAML.replace("pgm", "png") + "mode: scale\n").encode(), "plan.png": png(veiled)}
    assert corners(import_world("m.yaml", files)) == same


def test_the_unknown_lies_outside() -> None:
    picture = room()
    picture[:, 100:] = 205  # map_server's grey
    world = from_picture(picture)
    assert world.bounds == (0.25, 0.25, 5.0, 5.75)


def test_the_robot_starts_on_the_largest_floor() -> None:
    picture = room()
    picture[:, 40:45] = 0  # a closet of 35 columns and a room of 110
    world = from_picture(picture)
    assert world.bounds[0] == 2.25
    assert all(start.x > 2.25 for start in world.starts)


def test_the_paper_around_a_plan_is_not_its_floor() -> None:
    picture = np.full((300, 400), 255, np.uint8)
    picture[100:220, 100:260] = room()
    world = from_picture(picture)
    assert world.bounds == (5.25, 4.25, 12.75, 9.75)
    open_field = np.full((300, 400), 255, np.uint8)
    open_field[100:110, 100:110] = 0
    assert from_picture(open_field).bounds == (0, 0, 20, 15)


def test_specks_and_slivers_go() -> None:
    picture = room()
    picture[30:32, 30:32] = 0
    picture[60:62, 155:] = 255  # a ray through a window
    assert len(from_picture(picture).walls) == 4
    picture[30:34, 30:34] = 0
    assert len(from_picture(picture).walls) == 8


def test_walls_of_pictures_are_textured_by_seed() -> None:
    first, again, other = from_picture(room()), from_picture(room()), from_picture(room(), seed=1)
    assert first == again != other
    assert corners(first) == corners(other)
    assert sum(len(w.panels) for w in first.walls) >= 0.6 * sum(w.length for w in first.walls)
    seeds = [p.seed for w in first.walls for p in w.panels]
    assert len(set(seeds)) == len(seeds)
    assert world_from_json(world_to_json(first), "copy.json") == first


def test_a_map_of_ten_thousand_walls_loads() -> None:
    """Pillars in rows: 2499 of them and the outline."""
    picture = np.full((1020, 1020), 255, np.uint8)
    for row in range(49):
        for column in range(51):
            picture[14 + 20 * row : 18 + 20 * row, 9 + 20 * column : 13 + 20 * column] = 0
    assert len(from_picture(picture, 0.1).walls) == 4 * 49 * 51 + 4
