"""What vision does to the pose cells: nothing without it, nothing of views too young, and how fast it is learnt."""

from __future__ import annotations

from dataclasses import replace

import pytest

from ratslam_core import ExperienceMapParams, LocalViewParams, PoseCells, RatSlamParams
from tests.unit.ratslam_core.drives import LAP, RADIUS_M, STEP_RAD, start


def test_without_vision_there_is_path_integration_only() -> None:
    params = RatSlamParams(local_view=LocalViewParams(enabled=False))
    params = replace(params, experience_map=replace(params.experience_map, calibrate=False))
    circle, brain = start(params=params)
    alone = PoseCells()
    alone.step(speed=0.0, yaw_rate=0.0, dt=0.1)
    for estimate in circle.advance(brain, LAP + 50):
        packet = alone.step(speed=RADIUS_M * STEP_RAD / 0.1, yaw_rate=STEP_RAD / 0.1, dt=0.1)
        assert estimate.packet == packet
        assert not estimate.relocalised
    assert len(brain.local_view) == 0


def test_vision_may_be_switched_off_and_on() -> None:
    circle, brain = start()
    circle.advance(brain, 60)
    brain.set_params(replace(brain.params, local_view=replace(brain.params.local_view, enabled=False)))
    circle.advance(brain, 60)
    brain.set_params(replace(brain.params, local_view=replace(brain.params.local_view, enabled=True)))
    circle.advance(brain, 2 * LAP)
    assert circle.miss_m(circle.advance(brain, 1)[0]) < 0.6


def test_a_young_view_does_not_hold_the_packet_back() -> None:
    """While a view is too young to inject, the pose cells move as if it were not there."""
    plain = ExperienceMapParams(calibrate=False)
    seeing, blind = (
        start(params=RatSlamParams(local_view=LocalViewParams(rest=r, enabled=e), experience_map=plain))
        for r, e in [(1e6, True), (0, False)]
    )
    for _ in range(80):
        a, b = seeing[0].advance(seeing[1], 1)[0], blind[0].advance(blind[1], 1)[0]
        assert a.packet == b.packet


def test_the_adaptive_rate_follows_vision_and_confidence() -> None:
    params = RatSlamParams(local_view=LocalViewParams(adaptive=True))
    circle, brain = start(params=params)
    eta = params.local_view.learning_rate
    rates = []
    for _ in range(LAP + 60):
        circle.advance(brain, 1)
        rates.append(brain.association.learning_rate)
    assert 0 <= min(rates) < max(rates) <= 2 * eta
    one = circle.advance(brain, 1)[0]
    strength = 1 - one.recognition.difference / params.local_view.match_threshold
    assert brain.association.learning_rate == pytest.approx(2 * eta * strength * brain.pose_cells.winner.mass, rel=0.05)
    circle.angle += 2.6
    circle.advance(brain, 1)
    assert brain.lost
    assert brain.association.learning_rate == 0.0


def test_the_fixed_rate_is_fixed() -> None:
    circle, brain = start()
    circle.advance(brain, LAP)
    assert brain.association.learning_rate == brain.params.local_view.learning_rate
