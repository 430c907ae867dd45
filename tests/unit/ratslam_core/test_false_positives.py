"""Views taken for another on purpose, as often as asked for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ratslam_core import LocalView, LocalViewParams, Odometry, RatSlam, RatSlamParams


def numbers_seen(share: float, ticks: int, known: int = 20) -> tuple[LocalView, list[tuple[int, int, bool]]]:
    local_view = LocalView(LocalViewParams(front_end="scene numbers", false_positives=share), np.random.default_rng(3))
    seen = []
    for tick in range(ticks):
        one = local_view.observe(None, tick % known)
        seen.append((tick % known, one.view, one.false_positive))
        assert not (one.false_positive and (one.view == one.best_view or one.recruited or one.facing_rad is not None))
        assert one.recruited or one.best_view == tick % known
    return local_view, seen


@pytest.mark.parametrize("share", [0.0, 0.02, 0.1, 1.0])
def test_so_many_recognised_views_are_taken_for_another(share: float) -> None:
    local_view, seen = numbers_seen(share, 8020)
    wrong = [(right, view) for right, view, false in seen if false]
    assert all(false == (right != view) for right, view, false in seen)
    assert local_view.false_positives == len(wrong)
    expected = share * 8000
    assert abs(len(wrong) - expected) <= 4 * math.sqrt(expected * (1 - share))
    if share == 1.0:
        others = np.bincount([view for right, view in wrong if right == 4], minlength=20)
        assert others[4] == 0
        assert others[[k for k in range(20) if k != 4]].min() > 5  # any other one


def test_a_single_known_view_cannot_be_taken_for_another() -> None:
    local_view, seen = numbers_seen(1.0, 5, known=1)
    assert local_view.false_positives == 0
    assert {view for _, view, _ in seen} == {0}


def test_false_positives_draw_from_a_generator_of_their_own() -> None:
    """Another share does not change the run's own generator; the digest covers the draws."""
    brains = []
    for share in (0.0, 0.5):
        params = RatSlamParams(local_view=LocalViewParams(front_end="scene numbers", false_positives=share))
        brain = RatSlam(params, np.random.default_rng(9))
        for tick in range(50):
            brain.step(None, Odometry(0.1, 0.0, 0.1), scene=tick % 5)
        brains.append(brain)
    assert brains[0].rng.bit_generator.state == brains[1].rng.bit_generator.state
    assert brains[1].local_view.false_positives > 5
    before = brains[1].digest()
    brains[1].local_view.rng.random()
    assert brains[1].digest() != before
    assert replace(brains[1].params, local_view=brains[0].params.local_view) == brains[0].params
