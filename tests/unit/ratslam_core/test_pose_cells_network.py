"""The network of pose cells: a torus of any size, its room, and parameters that change while it runs."""

from __future__ import annotations

import math
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import pytest

from ratslam_core import PoseCellParams, PoseCells
from ratslam_core.pose_cells import attractor_kernels, network
from ratslam_core.pose_cells.network import ROOM

from . import literal
from .packets import drive, rest, settled

SIZE = PoseCellParams(n_x=24, n_y=24, n_theta=36)
FACES = {"+x": (0, 0.8, 0.0), "-x": (18, 0.8, 0.0), "+y": (9, 0.8, 0.0), "-y": (27, 0.8, 0.0)}
FACES |= {"+theta": (0, 0.0, 0.7), "-theta": (0, 0.0, -0.7), "corner": (4, 0.9, 0.3)}


def test_a_packet_crosses_every_face_unchanged(subtests: pytest.Subtests) -> None:
    for face, (theta, forwards, turn) in FACES.items():
        with subtests.test(face):
            inside, across = settled(3, 4, theta, SIZE), settled(12, 12, theta, SIZE)
            for _ in range(60):  # 48 cells: twice around
                drive(inside, forwards, turn, 1)
                drive(across, forwards, turn, 1)
                shifted = np.roll(inside.activity, (8, 9), (1, 2))
                assert np.abs(across.activity - shifted).max() < 1e-5
                assert across.activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)
                assert across.winner.mass > 0.9
    inside, across = settled(12, 12, 14, SIZE), settled(12, 12, 32, SIZE)
    for _ in range(20):  # the last layer; layers are headings, so the plane turns with them
        drive(inside, 0.0, 0.7, 1)
        drive(across, 0.0, 0.7, 1)
        assert np.abs(across.activity - np.roll(inside.activity, 18, 0)).max() < 1e-5


def test_growing_room_changes_nothing() -> None:
    """More cells become active than there was room for at first."""
    params = PoseCellParams(inhibit=0.0, n_x=24, n_y=24, n_theta=24)
    pose_cells = PoseCells(params)
    dense = np.random.default_rng(3).random(pose_cells.shape)
    dense /= dense.sum()
    literal.fill(pose_cells, dense)
    assert np.abs(pose_cells.activity - dense).max() < 1e-9
    pose_cells.attract()
    assert pose_cells.active[0].shape == (24**3, 4)
    assert pose_cells.activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)
    for axis in range(3):
        dense = sum(w * np.roll(dense, k - 2, axis) for k, w in enumerate(literal.gaussian(0.5, 2)))
    assert np.abs(pose_cells.activity - dense).max() < 1e-9


def test_live_parameters_act_at_once_and_the_size_is_fixed() -> None:
    pose_cells = settled()
    sharp = len(pose_cells.active[0])
    pose_cells.set_params(PoseCellParams(excite_sigma=1.0))
    rest(pose_cells, 30)
    assert len(pose_cells.active[0]) > sharp
    for other in ({"n_x": 65}, {"n_y": 63}, {"n_theta": 72}, {"cell_m": 0.5}):
        with pytest.raises(ValueError, match="size of the pose cells is fixed at 64 x 64 x 36 until a reset"):
            pose_cells.set_params(PoseCellParams(**other))


@pytest.mark.parametrize("n", [8, 13, 256, 1000])
def test_any_size_holds_its_mass_across_every_face(n: int) -> None:
    """And large ones take less than six bytes a cell."""
    for n_theta in (8, 36, 360) if n < 256 else (37,):
        pose_cells = PoseCells(PoseCellParams(n_x=n, n_y=n, n_theta=n_theta))
        for forwards, heading in product((0.9, -1.7), range(0, n_theta, max(1, n_theta // 4))):
            pose_cells.place(n - 1, 0, heading)
            for _ in range(3):
                drive(pose_cells, forwards, 0.8, 1)
                _, values = pose_cells.active
                assert values.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)
            assert n == 1000 or np.count_nonzero(pose_cells.slot) == len(values)
        size = n * n * n_theta
        assert n < 256 or 4 * size <= pose_cells.memory_bytes <= 6 * size


def test_room_for_active_cells_doubles_when_it_is_full_and_not_before() -> None:
    pose_cells = PoseCells()

    def fill_up_to(cells: int) -> int:
        """By how many bytes the memory grows."""
        before, n = pose_cells.memory_bytes, len(pose_cells.active[1])
        free = np.flatnonzero(pose_cells.slot == 0)[: cells - n].astype(np.int32)
        pose_cells.inject(free, np.full(len(free), 1e-5, np.float32))
        assert len(pose_cells.active[1]) == cells
        return pose_cells.memory_bytes - before

    assert fill_up_to(ROOM) == 0
    first = fill_up_to(ROOM + 1)
    assert fill_up_to(2 * ROOM) == 0
    assert fill_up_to(2 * ROOM + 1) == 2 * first > 0
    assert fill_up_to(9 * ROOM) > 4 * first


def test_a_shift_has_room_for_eight_times_as_many_cells() -> None:
    """Single cells far from each other, each of which becomes a cube of 2 x 2 x 2."""
    pose_cells = PoseCells(PoseCellParams(n_x=64, n_y=64, n_theta=36))
    dense = np.zeros(pose_cells.shape)
    dense[4::4, ::4, ::4] = 1 / (8 * 16 * 16)  # but in the layer that moves along x'
    literal.fill(pose_cells, dense)
    pose_cells.integrate(0.1, 0.02)
    assert len(pose_cells.active[1]) == 8 * np.count_nonzero(dense) == len(pose_cells.active[0])
    assert pose_cells.activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)


def test_a_cluster_as_large_as_the_window_has_room(monkeypatch: pytest.MonkeyPatch) -> None:
    """Interpreted, since compiled code would write beyond the end."""
    literal.interpret(attractor_kernels, monkeypatch)
    monkeypatch.setattr(network, "WINDOW", 2)
    dense = np.zeros((12, 12, 12))
    dense[4:9, 4:9, 4:9] = 1.0
    dense[6, 6, 6] = 2.0
    dense /= dense.sum()
    for sigma, radius in ((0.5, 2), (0.8, 3), (1.2, 4)):
        pose_cells = PoseCells(PoseCellParams(n_x=12, n_y=12, n_theta=12, inhibit=0.0, excite_sigma=sigma))
        literal.fill(pose_cells, dense)
        pose_cells.attract()
        excited = literal.convolve(dense, literal.gaussian(sigma, radius))
        assert np.abs(pose_cells.activity - literal.inhibit(excited, 0.0)).max() < 2e-6


def test_distances_are_around_the_torus() -> None:
    pose_cells = PoseCells(PoseCellParams(n_x=30, n_y=20))
    assert pose_cells.cells_apart(29, 1, 2, 17) == 5.0
    assert pose_cells.cells_apart(5, 3, 5, 13) == 10.0
    assert pose_cells.cells_apart(5, 3, 20, 3) == 15.0


# ---------------------------------------------------------------- refusals, which change nothing


CELLS, VALUES = np.array([5, 9], np.int32), np.array([0.1, 0.2], np.float32)
FINITE, TIME = "must be a finite number, got", "dt must be a positive number of seconds, got "
INT32, FLOAT32 = (
    r"cells must be an int32 array of shape \(k,\), got ",
    r"values must be a float32 array of shape \(2,\), got ",
)
INJECTIONS: list[tuple[str, Any, Any]] = [
    (INT32 + r"\[5, 9\]", [5, 9], VALUES),
    (INT32 + r"int64 \(2,\)", CELLS.astype(np.int64), VALUES),
    (INT32 + r"int32 \(1, 2\)", CELLS.reshape(1, 2), VALUES),
    (FLOAT32 + r"float64 \(2,\)", CELLS, VALUES.astype(np.float64)),
    (FLOAT32 + r"float32 \(1,\)", CELLS, VALUES[:1]),
    (FLOAT32 + "0.1", CELLS, 0.1),
    ("from 0 to 147455 and values finite and >= 0, got cell -1 with 0.2 in row 1", np.array([5, -1], np.int32), VALUES),
    ("got cell 147456 with 0.1 in row 0", np.array([147456, 9], np.int32), VALUES),
    ("got cell 9 with -0.5 in row 1", CELLS, np.array([0.1, -0.5], np.float32)),
    ("got cell 9 with nan in row 1", CELLS, np.array([0.1, math.nan], np.float32)),
    ("got cell 5 with inf in row 0", CELLS, np.array([math.inf, 0.1], np.float32)),
]
PLACES: list[tuple[str, Any]] = [
    ("x must be a cell from 0 to 63, got 64", (64, 0, 0)),
    ("y must be a cell from 0 to 63, got -1", (0, -1, 0)),
    ("theta must be a cell from 0 to 35, got 36", (0, 0, 36)),
    ("x must be a cell from 0 to 63, got 0.5", (0.5, 0, 0)),
    ("y must be a cell from 0 to 63, got True", (0, True, 0)),
    ("theta must be a cell from 0 to 35, got nan", (0, 0, math.nan)),
    ("x must be a cell from 0 to 63, got '3'", ("3", 0, 0)),
]


def test_what_is_refused_changes_nothing(subtests: pytest.Subtests) -> None:
    pose_cells = settled()
    before, packet = pose_cells.activity, pose_cells.winner
    refused: list[tuple[str, Any]] = [
        *((message, partial(pose_cells.inject, *given)) for message, *given in INJECTIONS),
        *((message, partial(pose_cells.place, *place)) for message, place in PLACES),
        *((TIME, partial(pose_cells.step, speed=0.0, yaw_rate=0.0, dt=dt)) for dt in (0.0, -0.1)),
    ]
    for bad in (math.nan, math.inf, -math.inf):
        refused += [
            (f"speed {FINITE}", partial(pose_cells.step, speed=bad, yaw_rate=0.0, dt=0.1)),
            (f"yaw_rate {FINITE}", partial(pose_cells.step, speed=0.0, yaw_rate=bad, dt=0.1)),
            (TIME, partial(pose_cells.step, speed=0.0, yaw_rate=0.0, dt=bad)),
            (f"distance_m {FINITE}", partial(pose_cells.integrate, bad, 0.0)),
            (f"turn_rad {FINITE}", partial(pose_cells.integrate, 0.0, bad)),
        ]
    for message, call in refused:
        with subtests.test(message):
            with pytest.raises(ValueError, match=message):
                call()
            assert np.array_equal(pose_cells.activity, before)
            assert pose_cells.winner == packet


def test_a_cell_injected_twice_gets_both_and_nothing_is_no_fault() -> None:
    pose_cells = PoseCells()
    pose_cells.inject(np.array([7, 7], np.int32), np.array([0.25, 0.5], np.float32))
    pose_cells.inject(np.zeros(0, np.int32), np.zeros(0, np.float32))
    assert pose_cells.activity[0, 0, 7] == 0.75
    pose_cells.inject(np.arange(90_000, 90_100, dtype=np.int32), np.zeros(100, np.float32))
    assert pose_cells.attract() == pose_cells.winner
    assert pose_cells.activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)


def test_inhibition_that_takes_all_activity_is_refused_and_changes_nothing() -> None:
    pose_cells = settled()
    before, packet = pose_cells.activity, pose_cells.winner
    pose_cells.set_params(PoseCellParams(excite_sigma=3.0, inhibit=0.02))
    with pytest.raises(ValueError, match=r"inhibit = 0\.02 is above the activity of every cell"):
        pose_cells.attract()
    assert np.array_equal(pose_cells.activity, before)
    assert pose_cells.winner == packet
    pose_cells.set_params(PoseCellParams())
    rest(pose_cells, 1)
    assert pose_cells.winner.id == packet.id
