"""Packets move as far as the robot does, at any rate, and stand still when it does."""

from __future__ import annotations

import cmath
import math
from itertools import product

import numpy as np
import pytest

from ratslam_core import PoseCellParams, PoseCells

from . import literal
from .packets import drive, rest, settled, two_packets, where


def test_gain_is_one_up_to_a_cell_and_a_half_a_step(subtests: pytest.Subtests) -> None:
    """That is 3.75 m/s. With two cells, the layers of a packet drift apart by a few per cent of the way."""
    for heading, cells_a_step in product([0.0, 1.7, 9.5, 23.2], [*np.geomspace(0.01, 1.5, 9).tolist(), 1.0]):
        with subtests.test(heading=heading, cells_a_step=cells_a_step):
            pose_cells = turned_to(heading)
            steps = max(40, round(4 / cells_a_step))
            angle = pose_cells.winner.heading_rad
            way = drive(pose_cells, cells_a_step, 0.0, steps) / (steps * cells_a_step)
            assert way[:2] == pytest.approx([math.cos(angle), math.sin(angle)], abs=0.01)
            assert pose_cells.winner.heading_rad == pytest.approx(angle, abs=math.radians(0.5))


@pytest.mark.parametrize("layers_a_step", [-2.3, -1.0, -0.1, 0.01, 0.02, 0.4, 1.0, 3.0])
def test_gain_of_turning_is_one(layers_a_step: float) -> None:
    pose_cells = turned_to(0.6)
    steps = max(40, round(4 / abs(layers_a_step)))
    way = drive(pose_cells, 0.0, layers_a_step, steps)
    assert way[2] / (steps * layers_a_step) == pytest.approx(1.0, abs=0.01)
    assert np.abs(way[:2]).max() < 0.01


@pytest.mark.parametrize("layers_a_step", [-0.7, 0.05, 0.3, 1.4])
@pytest.mark.parametrize("cells_a_step", [0.02, 0.15, 1.0, 1.5])
def test_an_arc_ends_where_it_should(cells_a_step: float, layers_a_step: float) -> None:
    """Driving and turning at once gives a circle. Euler steps would end up to a cell beside it."""
    pose_cells = turned_to(2.7)
    heading, turn = pose_cells.winner.heading_rad, layers_a_step * 2 * math.pi / 36
    steps = max(40, round(8 / cells_a_step))
    way = drive(pose_cells, cells_a_step, layers_a_step, steps)
    end = cmath.exp(1j * heading) * cells_a_step * (cmath.exp(1j * turn * steps) - 1) / (1j * turn)
    assert abs(complex(way[0], way[1]) - end) < 0.01 * steps * cells_a_step
    assert way[2] == pytest.approx(steps * layers_a_step, rel=0.01)


def turned_to(layers: float) -> PoseCells:
    """A settled packet that heads between two layers."""
    pose_cells = settled(theta=int(layers))
    drive(pose_cells, 0.0, (layers - int(layers)) / 20, 20)
    rest(pose_cells, 60)
    return pose_cells


def test_every_packet_is_moved_not_only_the_winner() -> None:
    """Two hypotheses with different headings, both slow: each goes its own way with its own carry."""
    pose_cells = two_packets(20, 0.5, turned=9)
    rest(pose_cells, 5)
    starts = {p.id: p for p in pose_cells.packets}
    drive(pose_cells, 0.04, 0.0, 50)
    assert len(starts) == len(pose_cells.packets) == 2
    for packet in pose_cells.packets:
        start = starts[packet.id]
        way = packet.x - start.x, packet.y - start.y
        assert way == pytest.approx((2 * math.cos(start.heading_rad), 2 * math.sin(start.heading_rad)), abs=0.02)


def test_much_activity_is_moved_whole_however_much_room_it_takes() -> None:
    """Between two cells each active cell becomes eight, more than there is room for at first."""
    pose_cells = PoseCells(PoseCellParams(n_x=60, n_y=60))
    field = np.zeros(pose_cells.shape, np.float32)
    field[::2, ::3, ::3] = np.random.default_rng(3).uniform(0.5, 1.0, field[::2, ::3, ::3].shape)
    literal.fill(pose_cells, field)
    pose_cells.settle()
    before = pose_cells.activity.astype(np.float64)
    assert np.count_nonzero(before) > 5_000
    pose_cells.integrate(0.0, math.radians(5.0))  # half a layer
    after = pose_cells.activity
    assert np.count_nonzero(after) == 2 * np.count_nonzero(before)
    np.testing.assert_allclose(after, 0.5 * (before + np.roll(before, 1, 0)), atol=1e-9)


def test_a_fast_packet_stays_one() -> None:
    """Its layers drift apart, but those that lag behind must not become a packet of their own."""
    pose_cells = turned_to(0.5)
    for _ in range(40):
        drive(pose_cells, 1.0, 0.0, 1)
        assert [p.id for p in pose_cells.packets] == [pose_cells.winner.id]


def test_without_carry_a_slow_packet_is_pinned() -> None:
    """The reason for `carry`: the attractor swallows part of a small shift."""
    with_carry, without = (
        drive(settled(params=PoseCellParams(carry=carry)), 0.03, 0.0, 200)[0] for carry in (True, False)
    )
    assert without < 0.97 * 200 * 0.03
    assert with_carry == pytest.approx(200 * 0.03, rel=0.01)


def test_standing_still_does_not_drift() -> None:
    pose_cells = settled(5, 60, 30)
    drive(pose_cells, 0.37, 0.21, 25)  # to somewhere between the cells
    rest(pose_cells, 40)  # settle there
    before, shape = where(pose_cells), pose_cells.activity
    rest(pose_cells, 1000)
    assert np.abs(where(pose_cells) - before).max() < 0.01
    assert np.abs(pose_cells.activity - shape).max() < 1e-3


@pytest.mark.parametrize(("speed", "yaw_rate"), [(0.5, 0.0), (0.3, 0.4), (-0.4, -0.7), (0.5, 1.3)])
def test_the_end_point_does_not_depend_on_the_rate(speed: float, yaw_rate: float) -> None:
    ends = []
    for rate in (5, 10, 50):
        pose_cells = settled()
        for _ in range(8 * rate):
            pose_cells.step(speed=speed, yaw_rate=yaw_rate, dt=1 / rate)
        ends.append(pose_cells.winner)
    for end in ends[:2]:
        assert pose_cells.cells_apart(end.x, end.y, ends[2].x, ends[2].y) < 1.0
        assert abs(math.remainder(end.heading_rad - ends[2].heading_rad, 2 * math.pi)) < math.radians(10)


@pytest.mark.slow
def test_standing_still_for_ever_does_not_drift() -> None:
    """100,000 steps, or fewer once the whole state recurs bit for bit, since nothing new can happen from then on."""
    pose_cells = settled(5, 60, 30)
    drive(pose_cells, 0.37, 0.21, 25)
    rest(pose_cells, 40)
    before, seen = where(pose_cells), set()
    for _ in range(100_000):
        rest(pose_cells, 1)
        cells, values = pose_cells.active
        rows = pose_cells._rows[: pose_cells._found]
        state = cells.tobytes() + values.tobytes() + rows.tobytes()
        if state in seen:
            break
        seen.add(state)
        assert np.abs(where(pose_cells) - before).max() < 0.01
