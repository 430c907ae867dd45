"""The network of pose cells: a torus of any size, its room, and parameters that change while it runs."""

from __future__ import annotations

import numpy as np
import pytest

from ratslam_core import PoseCellParams, PoseCells
from ratslam_core.pose_cells import activity_kernels as kernels
from ratslam_core.pose_cells import attractor_kernels, network
from ratslam_core.pose_cells.network import ROOM

from . import literal
from .packets import drive, rest, settled

FACES = {"+x": (0, 0.8, 0.0), "-x": (18, 0.8, 0.0), "+y": (9, 0.8, 0.0), "-y": (27, 0.8, 0.0)}
FACES |= {"+theta": (0, 0.0, 0.7), "-theta": (0, 0.0, -0.7), "corner": (4, 0.9, 0.3)}


@pytest.mark.parametrize("face", FACES)
def test_a_packet_crosses_every_face_unchanged(face: str) -> None:
    theta, forwards, turn = FACES[face]
    size = PoseCellParams(n_x=24, n_y=24, n_theta=36)
    inside, across = settled(3, 4, theta, size), settled(12, 12, theta, size)
    for step in range(60):  # 48 cells: twice around
        drive(inside, forwards, turn, 1)
        drive(across, forwards, turn, 1)
        shifted = np.roll(inside.activity, (8, 9), (1, 2))
        assert np.abs(across.activity - shifted).max() < 1e-5, f"step {step}"
        assert across.activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)
        assert across.winner.mass > 0.9


def test_a_packet_turns_through_the_last_layer_unchanged() -> None:
    """Layers are headings, so the plane turns with them: 9 layers make a quarter turn."""
    size = PoseCellParams(n_x=24, n_y=24, n_theta=36)
    inside, across = settled(12, 12, 14, size), settled(12, 12, 32, size)
    for _ in range(20):
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


def test_active_slot_and_activity_say_the_same() -> None:
    pose_cells = settled(63, 0, 35)
    cells, values = pose_cells.active
    dense = np.zeros(pose_cells.shape, np.float32)
    dense[cells[:, kernels.THETA], cells[:, kernels.Y], cells[:, kernels.X]] = values
    assert np.array_equal(dense, pose_cells.activity)
    assert np.array_equal(np.flatnonzero(pose_cells.slot), np.sort(cells[:, kernels.FLAT]))
    assert np.array_equal(pose_cells.slot[cells[:, kernels.FLAT]], np.arange(len(cells)) + 1)


def test_live_parameters_act_at_once_and_the_size_is_fixed() -> None:
    pose_cells = settled()
    sharp = len(pose_cells.active[0])
    pose_cells.set_params(PoseCellParams(excite_sigma=1.0))
    rest(pose_cells, 30)
    assert len(pose_cells.active[0]) > sharp
    for other in ({"n_x": 65}, {"n_y": 63}, {"n_theta": 72}, {"cell_m": 0.5}):
        with pytest.raises(ValueError, match="size of the pose cells is fixed at 64 x 64 x 36 until a reset"):
            pose_cells.set_params(PoseCellParams(**other))


@pytest.mark.parametrize("n_theta", [8, 36, 360])
@pytest.mark.parametrize("n", [8, 13, 1000])
def test_any_size_holds_its_mass_across_every_face(n: int, n_theta: int) -> None:
    if n == 1000 and n_theta == 360:
        n_theta = 37  # 1.4 GB of address space otherwise
    pose_cells = PoseCells(PoseCellParams(n_x=n, n_y=n, n_theta=n_theta))
    for forwards in (0.9, -1.7):
        for heading in range(0, n_theta, max(1, n_theta // 4)):
            pose_cells.place(n - 1, 0, heading)
            for _ in range(3):
                drive(pose_cells, forwards, 0.8, 1)
                _, values = pose_cells.active
                assert values.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)
            assert np.count_nonzero(pose_cells.slot) == len(values) if n < 1000 else True


@pytest.mark.parametrize("n", [256, 540, 1000])
def test_large_networks_take_less_than_six_bytes_a_cell(n: int) -> None:
    pose_cells = PoseCells(PoseCellParams(n_x=n, n_y=n))
    drive(pose_cells, 0.7, 0.3, 30)
    assert 4 * n * n * 36 <= pose_cells.memory_bytes <= 6 * n * n * 36


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


def test_one_packet_needs_hardly_more_room_than_there_is_at_first() -> None:
    pose_cells = PoseCells()
    before = pose_cells.memory_bytes
    drive(pose_cells, 0.7, 0.3, 30)
    assert pose_cells.memory_bytes < 1.5 * before


def test_a_shift_has_room_for_eight_times_as_many_cells() -> None:
    """Single cells far from each other, each of which becomes a cube of 2 x 2 x 2."""
    pose_cells = PoseCells(PoseCellParams(n_x=64, n_y=64, n_theta=36))
    dense = np.zeros(pose_cells.shape)
    dense[::4, ::4, ::4] = 1 / (9 * 16 * 16)
    literal.fill(pose_cells, dense)
    pose_cells.integrate(0.1, 0.02)
    assert len(pose_cells.active[1]) == 8 * np.count_nonzero(dense) == len(pose_cells.active[0])
    assert pose_cells.activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(("sigma", "radius"), [(0.5, 2), (0.8, 3), (1.2, 4)])
def test_a_cluster_as_large_as_the_window_has_room(sigma: float, radius: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Interpreted, since compiled code would write beyond the end."""
    literal.interpret(attractor_kernels, monkeypatch)
    monkeypatch.setattr(network, "WINDOW", 2)
    pose_cells = PoseCells(PoseCellParams(n_x=12, n_y=12, n_theta=12, inhibit=0.0, excite_sigma=sigma))
    dense = np.zeros(pose_cells.shape)
    dense[4:9, 4:9, 4:9] = 1.0
    dense[6, 6, 6] = 2.0
    dense /= dense.sum()
    literal.fill(pose_cells, dense)
    pose_cells.attract()
    excited = literal.convolve(dense, literal.gaussian(sigma, radius))
    assert np.abs(pose_cells.activity - literal.inhibit(excited, 0.0)).max() < 2e-6


def test_distances_are_around_the_torus() -> None:
    pose_cells = PoseCells(PoseCellParams(n_x=30, n_y=20))
    assert pose_cells.cells_apart(29, 1, 2, 17) == 5.0
    assert pose_cells.cells_apart(5, 3, 5, 13) == 10.0
    assert pose_cells.cells_apart(5, 3, 20, 3) == 15.0
