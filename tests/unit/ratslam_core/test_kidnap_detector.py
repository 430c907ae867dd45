"""A kidnap is noticed and survived, and what is none is not taken for one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ratslam_core import KidnapParams, Odometry, RatSlam
from ratslam_core.extensions import kidnap_detector
from ratslam_core.extensions.kidnap_detector import FOUND_AGAIN, MOST, TIME_POWER, KidnapDetector
from tests.unit.ratslam_core.drives import LAP, RADIUS_M, STEP_RAD, Circle, start

STILL = Odometry(0.0, 0.0, 0.1)
AHEAD = Odometry(0.2, 0.0, 0.1)


@pytest.mark.parametrize("seed", [0, 3])
def test_a_kidnap_is_noticed_and_survived(seed: int) -> None:
    circle, brain = start(seed)
    circle.advance(brain, 2 * LAP)
    assert not brain.lost
    map_before = brain.experience_map.poses.copy()
    circle.angle += 2.6  # carried along a third of the circle and more; the wheels do not notice
    first = circle.advance(brain, 1)[0]
    assert brain.lost
    assert circle.miss_m(first) > 1.0
    brain.step(np.full((8, 12), 100, np.uint8), STILL)  # a view that shows nothing neither finds nor loses
    assert brain.lost
    assert brain.experience_map.cell_state(brain.experience_map.active)[3] == -1
    lost_for = 0
    while brain.lost and lost_for < LAP:
        circle.advance(brain, 1)
        lost_for += 1
    assert not brain.lost
    assert brain.relocalisations >= 1
    assert circle.miss_m(circle.advance(brain, 20)[-1]) < 0.3
    after = brain.experience_map.poses[: len(map_before)]
    assert np.hypot(*(after - map_before)[:, :2].T).max() < 0.3  # the map is as before


def test_a_changed_place_does_not_keep_the_robot_lost() -> None:
    """Something was put up: every second view is new from now on, but the others are where they always were."""
    circle, brain = start()
    circle.advance(brain, 2 * LAP)
    brain.declare_kidnapped()
    calm = replace(brain.params.local_view, surprise=100.0)  # only the first change is a surprise
    brain.set_params(replace(brain.params, local_view=calm))
    rng = np.random.default_rng(1)
    row = 0
    for tick in range(LAP):
        circle.angle += STEP_RAD
        changed = tick % 8 >= 4
        image = rng.integers(0, 256, (8, 12), np.uint8) if changed else circle.image
        before = len(brain.experience_map)
        estimate = brain.step(image, Odometry(RADIUS_M * STEP_RAD / 0.1, STEP_RAD / 0.1, 0.1))
        known = estimate.experience < before and not changed
        row = row + 1 if known else 0
        assert row < 8  # never so many in a row
        if not brain.lost:
            break
    assert not brain.lost
    assert circle.miss_m(estimate) < 0.3


def test_observations_that_contradict_each_other_find_nobody_again() -> None:
    circle, brain = start()
    circle.advance(brain, 2 * LAP)
    brain.declare_kidnapped()
    for agrees in [True] * 7 + ([False] + [True] * 6) * 3 + [False] + [True] * 7:
        assert brain.lost
        brain.kidnap_detector.settle(agrees, 0)
    assert not brain.lost


def test_nobody_is_lost_for_ever() -> None:
    """The robot stands before a new wall, perhaps a bland one, or was carried to where it has never been."""
    for most in (256, 2):
        circle, brain = start()
        circle.advance(brain, 100)
        wall = np.random.default_rng(1).integers(0, most, (8, 12), np.uint8)
        brain.step(wall, STILL)
        assert brain.lost
        steps = 0
        while brain.lost:
            brain.step(wall, STILL)
            steps += 1
            assert steps <= 2000
        assert steps > 600  # but it takes long


def test_sonars_help_to_notice_a_kidnap(subtests: pytest.Subtests) -> None:
    """alike: the change of the image, as a share of what is needed without sonars. Sonars alone are not enough. Only who drives
    may have come to such a change by driving."""
    before, after, fresh = Circle(0), Circle(0), RatSlam()
    after.angle += 2.6
    for circle in (before, after):
        fresh.local_view.observe(circle.image)
    for alike, others_m, moved, noticed in (
        (0.75, 2.0, STILL, True), (0.75, 2.0, AHEAD, True), (0.75, 1.0, AHEAD, False), (1.2, 1.1, AHEAD, True),
        (1.2, 1.0, STILL, True), (0.4, 2.0, STILL, False),
    ):  # fmt: skip
        with subtests.test(alike=alike, others_m=others_m, moved=moved):
            brain = RatSlam(sonar_angles_rad=np.linspace(-1.5, 1.5, 8).tolist())
            assert isinstance(brain.kidnap_detector, KidnapDetector)
            used_to_little(brain.kidnap_detector)
            params = brain.params.local_view
            changed = replace(params, surprise=params.surprise * fresh.local_view.image_change / alike)
            brain.set_params(replace(brain.params, local_view=changed))
            brain.step(before.image, STILL, ranges_m=np.full(8, 1.0))
            brain.step(after.image, moved, ranges_m=np.array([1.0, 1.0, 1.0, *[others_m] * 5]))
            assert brain.local_view.image_change == pytest.approx(alike)
            perhaps = noticed and alike < 1 and not moved.still
            assert brain.lost is (noticed and not perhaps)
            assert brain.experience_map.evidence.in_doubt is perhaps


def used_to_little(detector: KidnapDetector) -> KidnapDetector:
    """It has seen images change by nothing for a while."""
    for _ in range(300):
        assert not detector.observe(0.0, None)
    return detector


def test_where_images_always_jump_a_jump_tells_nothing() -> None:
    """All change must be twice as much as is usual of the image. What is usual is learnt, and forgotten."""
    detector = KidnapDetector(KidnapParams())
    for _ in range(300):
        assert not detector.observe(1.2, None)
    assert not detector.observe(1.9, None)
    assert detector.observe(3.0, None)
    for _ in range(200):
        detector.observe(0.2, None)
    assert detector.observe(1.2, None)


def test_driving_on_is_no_kidnap() -> None:
    circle, brain = start()
    for _ in range(LAP):
        circle.advance(brain, 1)
        assert not brain.lost


# ---------------------------------------------------------------- limits


def test_a_change_is_a_jump_only_above_its_limits() -> None:
    """Image and sonars together change by more than 1; all that sonars can add is MOST."""
    params = KidnapParams(range_surprise=1.0)
    for image, change, noticed in (
        (1.0, None, False), (1.001, None, True), (0.749, 0.25, False), (0.751, 0.25, True),
        (0.999 - MOST, 2.0, False), (1.001 - MOST, 2.0, True),
    ):  # fmt: skip
        detector = used_to_little(KidnapDetector(params))
        if change is None:
            assert detector.observe(image, None) is noticed
        else:
            detector.observe(0.0, np.full(4, 0.5))
            assert detector.observe(image, np.full(4, 0.5 * math.exp(change))) is noticed


def test_it_is_found_again_just_when_it_was_seen_often_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """After enough observations of experiences from before the kidnap, of which there were seven, or twelve steps."""
    monkeypatch.setattr(kidnap_detector, "SETTLED", 12)
    for known, steps in ((-1, 12), (0, FOUND_AGAIN), (6, FOUND_AGAIN), (7, 12)):
        detector = KidnapDetector(KidnapParams())
        detector.declare(7)
        for _ in range(steps):
            assert detector.kidnapped
            detector.settle(True, known)
        assert not detector.kidnapped


def test_in_more_time_driving_explains_more() -> None:
    """A change that tells of a kidnap within a tenth of a second is nothing unusual after a second."""
    for beats, limit in ((1, 1.0), (2, 2**TIME_POWER), (10, 10**TIME_POWER)):
        for change, noticed in ((0.999 * limit, False), (1.001 * limit, True)):
            detector = used_to_little(KidnapDetector(KidnapParams()))
            assert detector.observe(change, None, beats) is noticed
