"""The attractor: near packets merge and far ones compete, and its kernels interpreted."""

from __future__ import annotations

import numpy as np
import pytest

from ratslam_core import PoseCellParams, PoseCells
from ratslam_core.pose_cells import activity_kernels, attractor_kernels, packet_kernels

from . import literal
from .packets import drive, rest, two_packets


def test_two_packets_close_together_merge() -> None:
    pose_cells = two_packets(3, 0.5)
    rest(pose_cells, 100)
    assert len(pose_cells.packets) == 1
    assert pose_cells.winner.x == pytest.approx(33.5, abs=0.1)
    along_x = pose_cells.activity.sum((0, 1))
    assert np.argmax(along_x) in (33, 34)
    assert np.all(np.diff(along_x[30:34]) >= 0)
    assert np.all(np.diff(along_x[34:38]) <= 0)


def test_two_packets_far_apart_compete_and_the_heavier_wins() -> None:
    for apart, share in ((20, 0.45), (32, 0.6)):
        pose_cells = two_packets(apart, share)
        pose_cells.attract()
        assert len(pose_cells.packets) == 2
        assert sum(p.mass for p in pose_cells.packets) == pytest.approx(1.0, abs=1e-5)
        assert pose_cells.packets[0].mass > pose_cells.packets[1].mass
        rest(pose_cells, 400)
        assert len(pose_cells.packets) == 1
        assert pose_cells.winner.x == pytest.approx(32 if share > 0.5 else (32 + apart) % 64, abs=0.01)


def test_interpreted_kernels_do_what_the_compiled_ones_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also with cells of one layer too far apart to be shifted together, a packet with nothing left near it, and no cell."""
    runs = []
    for interpreted in (False, True):
        for module in (activity_kernels, attractor_kernels, packet_kernels) * interpreted:
            literal.interpret(module, monkeypatch)
        activity, pose_cells = [], PoseCells(PoseCellParams(n_x=9, n_y=8, n_theta=10, inhibit=1e-4))
        pose_cells.place(7, 7, 9)
        for forwards, turn in [(0.0, 0.0), (0.3, 0.2), (-1.7, 0.0), (0.0, -2.5), (1.0, 1.0)]:
            drive(pose_cells, forwards, turn, 1)
            pose_cells.inject(np.array([5, 300], np.int32), np.array([0.05, 0.02], np.float32))
            activity.append(pose_cells.activity.ravel())
        pose_cells = PoseCells()
        for forwards, row, value in ((0.4, 0, 0.1), (0.0, 60, 0.1), (1.3, 20, 1e5)):
            pose_cells.inject(
                np.array([0, 1, 20, 40, 41], np.int32) + np.int32(row * 64), np.full(5, value, np.float32)
            )
            pose_cells.integrate(0.25 * forwards, 0.1)
            pose_cells.attract()
        with pytest.raises(ValueError, match="got cell 5 with -1 in row 1"):
            pose_cells.inject(np.array([4, 5], np.int32), np.array([0, -1], np.float32))
        runs.append(np.concatenate([*activity, pose_cells.activity.ravel()]))
    assert np.abs(runs[0] - runs[1]).max() < 1e-6
