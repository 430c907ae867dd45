"""Packets: which are reported, which wins, and that each keeps its id."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ratslam_core import PoseCellParams, PoseCells

from . import literal
from .packets import drive, two_packets


def test_more_packets_than_can_be_reported() -> None:
    params = PoseCellParams(inhibit=0.0)
    pose_cells = PoseCells(params)
    dense = np.zeros(pose_cells.shape)
    dense[5, 10, 4::14] = 1.0
    dense[20, 40, 4::14] = np.arange(2, 7)
    literal.fill(pose_cells, dense / dense.sum())
    pose_cells.attract()
    masses = [p.mass for p in pose_cells.packets]
    assert len(masses) == 8
    assert masses == sorted(masses, reverse=True)
    assert masses[:5] == pytest.approx([0.24, 0.20, 0.16, 0.12, 0.08], abs=1e-3)


def ids(pose_cells: PoseCells) -> list[int]:
    return [p.id for p in pose_cells.packets]


def test_a_packet_keeps_its_id_while_it_moves_wraps_and_turns() -> None:
    """Also where it is so fast that its layers drift apart: those that lag behind are no packet of their own."""
    pose_cells = PoseCells()
    for cells, layers, steps in ((0.9, 0.6, 80), (1.0, 0.0, 40)):  # around the torus in every direction
        for _ in range(steps):
            drive(pose_cells, cells, layers, 1)
            assert ids(pose_cells) == [1]
    pose_cells.place(3, 4, 5)
    assert ids(pose_cells) == [1]


def test_ids_stay_when_packets_swap_rank() -> None:
    """The lighter of two packets gets activity while both drive on, so that they take turns in leading."""
    pose_cells = two_packets(20, 0.55, turned=18)
    pose_cells.attract()
    both = set(ids(pose_cells))
    led = []
    for _ in range(60):
        lighter = pose_cells.packets[1]
        flat = (round(lighter.heading_rad * 18 / math.pi) % 36 * 64 + round(lighter.y) % 64) * 64 + round(
            lighter.x
        ) % 64
        pose_cells.inject(np.array([flat], np.int32), np.array([0.05], np.float32))
        drive(pose_cells, 0.3, 0.4, 1)
        near = min(pose_cells.packets, key=lambda p: pose_cells.cells_apart(p.x, p.y, lighter.x, lighter.y))
        assert near.id == lighter.id
        assert set(ids(pose_cells)) == both
        led.append(pose_cells.winner.id)
    assert set(led) == both


def test_what_was_injected_is_a_packet_at_once() -> None:
    pose_cells = two_packets(20, 0.6)
    pose_cells.attract()
    known = pose_cells.packets
    pose_cells.inject(np.array([7], np.int32), np.array([0.5], np.float32))
    pose_cells.settle()
    assert pose_cells.active[1].sum() == pytest.approx(1.0)
    assert [p.id for p in pose_cells.packets] == [known[0].id, 3, known[1].id]
    assert [p.mass for p in pose_cells.packets] == pytest.approx([0.4, 1 / 3, 0.8 / 3], abs=0.02)
    new = pose_cells.packets[1]
    assert (new.x, new.y, new.heading_rad) == (7.0, 0.0, 0.0)


def test_ids_beyond_those_reported() -> None:
    """All packets are tracked: one that was too light to be reported appears with the id that it has always had."""
    pose_cells = PoseCells(PoseCellParams(inhibit=0.0))
    dense = np.zeros(pose_cells.shape)
    dense[5, 10, 4::14] = [8, 7, 6, 5, 4]
    dense[20, 40, 4::14] = [3.9, 3.8, 3.7, 3.6, 3.5]
    literal.fill(pose_cells, dense / dense.sum())
    pose_cells.attract()
    known = ids(pose_cells)
    assert len(known) == 8
    pose_cells.inject(np.array([(20 * 64 + 40) * 64 + 60], np.int32), np.array([0.5], np.float32))
    pose_cells.attract()
    newest = pose_cells.winner
    assert newest.id not in known
    assert newest.id == max(known) + 2  # as many were tracked
