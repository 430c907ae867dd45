"""The share of the floor that a path has covered, as it grows."""

from __future__ import annotations

import numpy as np
import pytest

from app.evaluation import Coverage
from sim2d import FreeSpace, load_world

from .worlds import room

PATH = np.stack([np.linspace(0.5, 3.5, 200), np.linspace(0.5, 1.5, 200)], axis=1)


def test_a_growing_path_covers_what_the_whole_of_it_covers() -> None:
    floor, grows = FreeSpace(room(start=(1.0, 1.0, 0.0)), 0.2), Coverage()
    shares = [grows.follow(floor, PATH[:n]) for n in (1, 1, 7, 40, 199, 200)]
    assert shares == sorted(shares)
    assert shares[0] == shares[1] > 0
    assert shares[-1] == Coverage().follow(floor, PATH)
    assert shares[-1] < 1.0


def test_another_floor_or_a_new_path_begins_anew() -> None:
    floor, cover = FreeSpace(room(start=(1.0, 1.0, 0.0)), 0.2), Coverage()
    cover.follow(floor, PATH)
    assert cover.follow(floor, PATH[:10]) == Coverage().follow(floor, PATH[:10])
    divided = FreeSpace(room((2.0, 0.0, 2.0, 4.0), start=(1.0, 1.0, 0.0)), 0.2)
    assert cover.follow(divided, PATH) == Coverage().follow(divided, PATH)


def test_what_lies_behind_a_wall_is_not_covered() -> None:
    whole = FreeSpace(room(start=(1.0, 1.0, 0.0)), 0.2)
    divided = FreeSpace(room((2.0, 0.0, 2.0, 3.0), start=(1.0, 1.0, 0.0)), 0.2)
    beside = np.array([(1.7, 0.5)])
    assert (
        Coverage().follow(divided, beside) * divided.floor_cells
        < 0.7 * Coverage().follow(whole, beside) * whole.floor_cells
    )


def test_beside_the_floor_nothing_is_covered() -> None:
    floor = FreeSpace(load_world("office"), 0.22)
    assert Coverage().follow(floor, np.array([(-50.0, 3.0)])) == 0.0
    assert Coverage().follow(floor, np.zeros((0, 2))) == pytest.approx(0.0)
