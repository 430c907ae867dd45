"""Packets move as the robot does, less what the attractor takes back, and stand still when it does."""

from __future__ import annotations

import cmath
import math
from itertools import product

import numpy as np
import pytest

from ratslam_core import PoseCells

from .packets import drive, rest, settled, two_packets, where


def test_a_packet_goes_the_way_of_the_robot_and_the_attractor_holds_a_slow_one_back(subtests: pytest.Subtests) -> None:
    """To where its strongest cell is: an eighth of the way at a hundredth of a cell a step, a hundredth from one cell on."""
    for heading, cells_a_step in product([0.0, 1.7, 9.5, 23.2], [0.01, 0.1, 0.5, 1.0, 1.5]):
        with subtests.test(heading=heading, cells_a_step=cells_a_step):
            pose_cells = turned_to(heading)
            steps = max(40, round(4 / cells_a_step))
            along = cmath.exp(-1j * pose_cells.winner.heading_rad)
            way = drive(pose_cells, cells_a_step, 0.0, steps) / (steps * cells_a_step)
            forwards = (complex(way[0], way[1]) * along).real
            assert (0.98 if cells_a_step >= 1 else 0.86) < forwards < 1.0
            assert abs((complex(way[0], way[1]) * along).imag) < 0.1


def test_a_packet_turns_with_the_robot_and_the_attractor_holds_a_slow_turn_back() -> None:
    for layers_a_step in (-2.3, -1.0, -0.1, 0.01, 0.02, 0.4, 1.0, 3.0):
        pose_cells = turned_to(0.6)
        steps = max(40, round(4 / abs(layers_a_step)))
        way = drive(pose_cells, 0.0, layers_a_step, steps)
        assert (0.99 if abs(layers_a_step) >= 0.4 else 0.89) < way[2] / (steps * layers_a_step) < 1.001
        assert np.abs(way[:2]).max() < 0.01


def turned_to(layers: float) -> PoseCells:
    """A settled packet that heads between two layers."""
    pose_cells = settled(theta=int(layers))
    drive(pose_cells, 0.0, (layers - int(layers)) / 20, 20)
    rest(pose_cells, 60)
    return pose_cells


def test_every_packet_is_moved_not_only_the_winner() -> None:
    """Two hypotheses with different headings: each goes its own way."""
    pose_cells = two_packets(20, 0.5, turned=9)
    rest(pose_cells, 5)
    starts = {p.id: p for p in pose_cells.packets}
    drive(pose_cells, 1.0, 0.0, 2)
    assert len(starts) == len(pose_cells.packets) == 2
    for packet in pose_cells.packets:
        start = starts[packet.id]
        way = packet.x - start.x, packet.y - start.y
        assert way == pytest.approx((2 * math.cos(start.heading_rad), 2 * math.sin(start.heading_rad)), abs=0.05)


@pytest.mark.slow
def test_standing_still_for_ever_does_not_drift() -> None:
    """100,000 steps, or fewer once the whole state recurs bit for bit, since nothing new can happen from then on."""
    pose_cells = settled(5, 60, 30)
    drive(pose_cells, 0.37, 0.21, 25)  # to somewhere between the cells
    rest(pose_cells, 2000)  # onto the lattice of the cells
    before, shape, seen = where(pose_cells), pose_cells.activity, set()
    for _ in range(100_000):
        rest(pose_cells, 1)
        cells, values = pose_cells.active
        state = cells.tobytes(), values.tobytes(), pose_cells.packets
        if state in seen:
            break
        seen.add(state)
        assert np.abs(where(pose_cells) - before).max() < 0.01
    assert np.abs(pose_cells.activity - shape).max() < 1e-3
