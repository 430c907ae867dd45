"""Packets move as far as the robot does, at any rate, and stand still when it does."""

from __future__ import annotations

import cmath
import math
from itertools import product

import numpy as np
import pytest

from ratslam_core import PoseCellParams, PoseCells

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


def test_gain_of_turning_is_one() -> None:
    for layers_a_step in (-2.3, -1.0, -0.1, 0.01, 0.02, 0.4, 1.0, 3.0):
        pose_cells = turned_to(0.6)
        steps = max(40, round(4 / abs(layers_a_step)))
        way = drive(pose_cells, 0.0, layers_a_step, steps)
        assert way[2] / (steps * layers_a_step) == pytest.approx(1.0, abs=0.01)
        assert np.abs(way[:2]).max() < 0.01


def test_an_arc_ends_where_it_should(subtests: pytest.Subtests) -> None:
    """Driving and turning at once gives a circle. Euler steps would end up to a cell beside it."""
    for cells_a_step, layers_a_step in product([0.02, 0.15, 1.0, 1.5], [-0.7, 0.05, 0.3, 1.4]):
        with subtests.test(cells_a_step=cells_a_step, layers_a_step=layers_a_step):
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


def test_without_carry_a_slow_packet_is_pinned() -> None:
    """The reason for `carry`: the attractor swallows part of a small shift."""
    with_carry, without = (
        drive(settled(params=PoseCellParams(carry=carry)), 0.03, 0.0, 200)[0] for carry in (True, False)
    )
    assert without < 0.97 * 200 * 0.03
    assert with_carry == pytest.approx(200 * 0.03, rel=0.01)


def test_the_end_point_does_not_depend_on_the_rate() -> None:
    for speed, yaw_rate in ((0.5, 0.0), (0.3, 0.4), (-0.4, -0.7), (0.5, 1.3)):
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
    drive(pose_cells, 0.37, 0.21, 25)  # to somewhere between the cells
    rest(pose_cells, 40)  # settle there
    before, shape, seen = where(pose_cells), pose_cells.activity, set()
    for _ in range(100_000):
        rest(pose_cells, 1)
        cells, values = pose_cells.active
        state = cells.tobytes(), values.tobytes(), pose_cells.packets, pose_cells.carry
        if state in seen:
            break
        seen.add(state)
        assert np.abs(where(pose_cells) - before).max() < 0.01
    assert np.abs(pose_cells.activity - shape).max() < 1e-3
