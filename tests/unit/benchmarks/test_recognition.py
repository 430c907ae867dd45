"""The table of recognition: what counts as a revisit, and how recall follows from precision."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.recognition import ROWS, Frames, Sights, recalls, revisits, sights
from tests.unit.ratslam_core.scenes import office

LAP = 60  # frames of 1 s


def two_laps(turned: int = 0) -> Frames:
    """A line of places half a metre apart, driven twice; in the second lap the robot looks `turned` pixels aside."""
    images = [office(k % LAP, turned=turned if k >= LAP else 0) for k in range(2 * LAP)]
    poses = [(0.5 * (k % LAP), 0.0, 0.0) for k in range(2 * LAP)]
    echoes = [np.full(8, 0.5 + 0.05 * (k % LAP)) for k in range(2 * LAP)]
    return Frames(np.array(images), np.array(echoes, np.float32), np.array(poses), 1.0)


def test_only_what_is_older_near_and_alike_in_heading_is_a_revisit() -> None:
    frames = two_laps()
    assert np.array_equal(revisits(frames), np.arange(2 * LAP) >= LAP)
    frames.poses[LAP:, 2] = math.radians(20)
    assert not revisits(frames).any()
    frames.poses[LAP:, 2] = 2 * math.pi - math.radians(10)
    assert revisits(frames)[LAP:].all()
    frames.poses[LAP:, 1] = 0.31
    assert not revisits(frames).any()


@pytest.mark.parametrize("row", ["template", "image and sonars", "image and sonars, sonars off"])
def test_two_laps_past_different_scenes_are_recalled_altogether(row: str) -> None:
    frames = two_laps(turned=5)
    seen = sights(frames, ROWS[row])
    assert np.array_equal(seen.best[LAP:], np.arange(LAP))
    assert [recall for recall, _ in recalls(frames, seen, revisits(frames))] == [1.0, 1.0, 1.0]


def test_recall_is_that_at_the_last_place_where_precision_holds() -> None:
    """50 sights that are right, then 2 that are wrong, then 8 that are right again. 50 of 51 are 98 %, 58 of 60 are 96.7 %."""
    frames = two_laps()
    best, levels = np.full(2 * LAP, -1), np.full(2 * LAP, np.inf)
    best[LAP:], levels[LAP:] = np.arange(LAP), np.arange(LAP)
    best[LAP + 50 : LAP + 52] = 0
    seen = Sights(best, levels)
    found = recalls(frames, seen, revisits(frames))
    assert found == [(50 / LAP, 49.0), (50 / LAP, 50.0), (58 / LAP, 59.0)]
    shown = Sights(np.where(levels < 50, best, -1), levels)
    assert [recall for recall, _ in recalls(frames, shown, revisits(frames))] == [50 / LAP] * 3
    few = Sights(np.where(levels < 19, best, -1), levels)
    assert recalls(frames, few, revisits(frames)) == [(0.0, 0.0)] * 3
