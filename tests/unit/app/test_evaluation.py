from __future__ import annotations

import math

import numpy as np
import pytest
from evo.core import metrics
from evo.core.geometry import umeyama_alignment
from evo.core.trajectory import PoseTrajectory3D
from hypothesis import given, settings
from hypothesis import strategies as st

from app.evaluation import Evaluation, align, alignment, rmse
from app.evaluation.earlier_passes import EVERY
from app.evaluation.evaluation import CONSISTENT_WITHIN_S, MOST_TICKS
from ratslam_core import Odometry, Pose2
from sim2d import Truth

DT = 0.1


def walk(rng: np.random.Generator, n: int) -> np.ndarray:
    return np.cumsum(rng.uniform(-1, 1, (n, 2)), axis=0)


def moved(points: np.ndarray, frame: Pose2) -> np.ndarray:
    c, s = math.cos(frame.heading_rad), math.sin(frame.heading_rad)
    return points @ np.array([[c, s], [-s, c]]) + (frame.x, frame.y)


seeds = st.integers(0, 2**32 - 1)
frames = st.builds(Pose2, st.floats(-20, 20), st.floats(-20, 20), st.floats(-3.1, 3.1))


@settings(max_examples=80)
@given(seeds, st.integers(3, 60), st.floats(0.0, 2.0))
def test_evo_aligns_the_same_way(seed: int, n: int, noise: float) -> None:
    rng = np.random.default_rng(seed)
    truth = walk(rng, n)
    estimate = moved(truth, Pose2(3.0, -2.0, 2.1)) + rng.normal(0, noise, (n, 2))
    rotation, translation, _ = umeyama_alignment(estimate.T, truth.T)
    frame = alignment(estimate, truth)
    assert math.atan2(rotation[1, 0], rotation[0, 0]) == pytest.approx(frame.heading_rad, abs=1e-7)
    assert translation == pytest.approx([frame.x, frame.y], abs=1e-6)
    assert align(estimate, truth) == pytest.approx((rotation @ estimate.T).T + translation, abs=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_evo_finds_the_same_error(seed: int) -> None:
    rng = np.random.default_rng(seed)
    truth = walk(rng, 200)
    estimate = moved(truth, Pose2(1.0, 5.0, -0.7)) + rng.normal(0, 0.3, truth.shape)

    def trajectory(points: np.ndarray) -> PoseTrajectory3D:
        xyz = np.column_stack([points, np.zeros(len(points))])
        quaternions = np.tile([1.0, 0.0, 0.0, 0.0], (len(points), 1))
        return PoseTrajectory3D(xyz, quaternions, np.arange(len(points)) * DT)

    reference, estimated = trajectory(truth), trajectory(estimate)
    estimated.align(reference)
    ape = metrics.APE(metrics.PoseRelation.translation_part)
    ape.process_data((reference, estimated))
    assert rmse(estimate, truth) == pytest.approx(ape.get_statistic(metrics.StatisticsType.rmse), rel=1e-6)


@settings(max_examples=60)
@given(seeds, frames)
def test_the_frame_of_the_estimate_is_no_error(seed: int, frame: Pose2) -> None:
    truth = walk(np.random.default_rng(seed), 30)
    assert rmse(moved(truth, frame), truth) < 1e-9
    back = alignment(moved(truth, frame), truth).compose(frame)
    assert math.hypot(back.x, back.y) < 1e-7
    assert abs(back.heading_rad) < 1e-7


@settings(max_examples=40)
@given(seeds, st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_no_other_frame_fits_better(seed: int, dx: float, dy: float, turn: float) -> None:
    rng = np.random.default_rng(seed)
    truth = walk(rng, 20)
    estimate = truth + rng.normal(0, 0.5, truth.shape)
    other = moved(align(estimate, truth), Pose2(dx, dy, turn))
    assert rmse(estimate, truth) <= math.sqrt(float(np.mean(np.sum((other - truth) ** 2, 1)))) + 1e-9


def test_scale_is_an_error() -> None:
    truth = np.array([[0.0, 0.0], [2.0, 0.0]])
    assert rmse(2 * truth, truth) == pytest.approx(1.0)


def test_fewer_than_two_points_have_no_error() -> None:
    assert rmse(np.zeros((1, 2)), np.ones((1, 2))) == 0.0
    assert rmse(np.zeros((0, 2)), np.zeros((0, 2))) == 0.0


class Map:
    """The part of an experience map that the evaluation reads: one experience, with the robot beside it."""

    def __init__(self) -> None:
        self.poses = np.zeros((1, 3))
        self.active = 0
        self.carried = self.lost = False
        self.local_pose = Pose2(0.0, 0.0, 0.0)

    @property
    def here(self) -> int:
        return self.active

    @property
    def robot(self) -> Pose2:
        return Pose2(*self.poses[self.active]).compose(self.local_pose)

    def pose(self, experience: int) -> Pose2:
        return Pose2(*self.poses[experience])


def drive(
    evaluation: Evaluation, map_: Map, ticks: int, *, wrong_m: float = 0.0, turned_rad: float = 0.0, start: int = 0
) -> None:
    """Drive along +y of the office at 0.3 m/s. The map, which lies elsewhere and is turned, is wrong by a given amount."""
    for tick in range(start, start + ticks):
        x = 0.03 * tick
        map_.local_pose = Pose2(x, wrong_m, turned_rad)
        truth = Truth(7.0, 1.0 + x, math.pi / 2, 0.3 if tick else 0.0, 0.0)
        odometry = Odometry(0.33 if tick else 0.0, 0.0, DT)
        evaluation.record(tick * DT, truth, map_, tick == 0, odometry)  # type: ignore[arg-type]


def test_paths_and_errors() -> None:
    evaluation, map_ = Evaluation(), Map()
    drive(evaluation, map_, 5001)
    truth, mapped, odometry = evaluation.trajectories(map_)  # type: ignore[arg-type]
    assert len(truth) == len(mapped) == len(odometry) == 5001
    assert truth[-1] == pytest.approx([7.0, 151.0])
    assert mapped[-1] == pytest.approx([150.0, 0.0])
    assert odometry[-1] == pytest.approx([165.0, 0.0])
    assert evaluation.path_m == pytest.approx(150.0)
    map_error, odometry_error = evaluation.errors(map_)  # type: ignore[arg-type]
    assert map_error == pytest.approx(0.0, abs=1e-9)
    assert odometry_error == pytest.approx(15 / math.sqrt(12), rel=1e-3)  # a tenth too long, evenly
    assert evaluation.errors(map_, 10)[1] == pytest.approx(odometry_error, rel=0.01)  # type: ignore[arg-type]
    assert evaluation.made_at(0, map_) == (7.0, 1.0)  # type: ignore[arg-type]


def test_the_map_is_judged_as_it_is_now() -> None:
    evaluation, map_ = Evaluation(), Map()
    map_.poses = np.zeros((2, 3))
    drive(evaluation, map_, 100)
    map_.active = 1
    drive(evaluation, map_, 100, start=100)
    assert evaluation.errors(map_)[0] == pytest.approx(0.0, abs=1e-9)  # type: ignore[arg-type]
    map_.poses[1] = 0.0, 2.0, 0.0
    assert evaluation.errors(map_)[0] > 0.5  # type: ignore[arg-type]


def test_consistency_counts_old_experiences_only() -> None:
    evaluation, map_ = Evaluation(), Map()
    assert evaluation.revisit_consistency is None
    drive(evaluation, map_, 200)
    assert evaluation.revisit_consistency is None
    drive(evaluation, map_, 101, start=200)
    assert evaluation.revisit_consistency == 1.0
    drive(evaluation, map_, 100, start=301, wrong_m=0.6)
    assert evaluation.revisit_consistency == pytest.approx(0.5, abs=0.01)


def kidnapped(*, turned_rad: float = 0.0, wrong_m: float = 0.0, known: bool = True) -> Evaluation:
    """Ten seconds of driving, a kidnap that the map does not follow, and five seconds after it."""
    evaluation, map_ = Evaluation(), Map()
    drive(evaluation, map_, 100)
    evaluation.kidnapped(9.9, map_)  # type: ignore[arg-type]
    if not known:
        map_.poses, map_.active = np.zeros((2, 3)), 1
    drive(evaluation, map_, 50, start=100, wrong_m=wrong_m, turned_rad=turned_rad)
    return evaluation


def test_a_kidnap_is_over_when_the_robot_stays_right_for_half_a_second() -> None:
    evaluation, map_ = Evaluation(), Map()
    drive(evaluation, map_, 100)
    evaluation.kidnapped(9.9, map_)  # type: ignore[arg-type]
    kidnap = evaluation.kidnaps[0]
    drive(evaluation, map_, 50, start=100, wrong_m=3.0)
    drive(evaluation, map_, 4, start=150)  # right by chance, but not for long
    drive(evaluation, map_, 36, start=154, wrong_m=-2.0)
    assert kidnap.after_s is None
    drive(evaluation, map_, 40, start=190, wrong_m=0.5)
    assert kidnap.at_s == 9.9
    assert kidnap.after_s == pytest.approx(19.0 - 9.9)
    assert kidnap.after_m == pytest.approx(0.03 * 91)
    evaluation.kidnapped(22.9, map_)  # type: ignore[arg-type]
    drive(evaluation, map_, 30, start=230, wrong_m=4.0)
    assert evaluation.kidnaps[1].after_s is None
    assert kidnap.after_s == pytest.approx(9.1)


def test_who_was_turned_on_the_spot_has_not_recovered_while_it_does_not_know_its_heading() -> None:
    assert kidnapped(turned_rad=0.5).kidnaps[0].after_s == pytest.approx(0.1)
    for turned_rad in (0.7, -0.7, math.pi):
        assert kidnapped(turned_rad=turned_rad).kidnaps[0].after_s is None
    assert kidnapped(wrong_m=1.1).kidnaps[0].after_s is None


def test_an_experience_made_after_the_kidnap_recovers_nothing() -> None:
    assert kidnapped().kidnaps[0].after_s == pytest.approx(0.1)
    assert kidnapped(known=False).kidnaps[0].after_s is None


def test_a_map_that_moves_after_the_kidnap_changes_no_verdict() -> None:
    """The active experience counts as being where it was truly made, wherever the map has it now."""
    evaluation, map_ = Evaluation(), Map()
    drive(evaluation, map_, 100)
    evaluation.kidnapped(9.9, map_)  # type: ignore[arg-type]
    map_.poses[0] = 5.0, -3.0, 1.0
    drive(evaluation, map_, 50, start=100)
    assert evaluation.kidnaps[0].after_s == pytest.approx(0.1)


@pytest.mark.parametrize(("wrong_m", "after_s"), [(0.5, 0.1), (1.5, None)])
def test_of_what_a_brain_brought_the_map_says_where_it_is(wrong_m: float, after_s: float | None) -> None:
    evaluation, map_ = Evaluation(known=1), Map()
    drive(evaluation, map_, 100, start=1)
    evaluation.kidnapped(10.0, map_)  # type: ignore[arg-type]
    drive(evaluation, map_, 50, start=101, wrong_m=wrong_m)
    assert evaluation.kidnaps[0].after_s == (None if after_s is None else pytest.approx(after_s))


def test_what_the_robot_believes_is_compared_with_where_it_is() -> None:
    evaluation, map_ = Evaluation(), Map()
    drive(evaluation, map_, 10)
    truth = Truth(7.0, 1.27, math.pi / 2, 0.3, 0.0)
    assert evaluation.belief_off(truth, map_) == pytest.approx((0.0, 0.0), abs=1e-9)  # type: ignore[arg-type]
    map_.local_pose = Pose2(0.27, 0.4, 0.3)
    assert evaluation.belief_off(truth, map_) == pytest.approx((0.4, 0.3))  # type: ignore[arg-type]
    map_.poses, map_.active = np.zeros((2, 3)), 1
    assert np.isnan(evaluation.belief_off(truth, map_)).all()  # type: ignore[arg-type]


def test_the_share_of_the_ticks_on_an_old_experience() -> None:
    evaluation, map_ = Evaluation(), Map()
    assert evaluation.revisit_share == 0.0
    drive(evaluation, map_, 400)  # the first 20 s do not count
    assert evaluation.revisit_share == pytest.approx(199 / 400)


def test_births_are_known_or_not_a_number() -> None:
    evaluation, map_ = Evaluation(), Map()
    drive(evaluation, map_, 10)
    births = evaluation.births(3000)
    assert births.shape == (3000, 4)
    assert births[0] == pytest.approx([7.0, 1.0, math.pi / 2, 0.0])
    assert np.isnan(births[1:]).all()
    assert evaluation.path == pytest.approx(evaluation.trajectories(map_)[0])  # type: ignore[arg-type]


def test_a_robot_that_has_never_driven_is_judged_by_how_it_stood() -> None:
    evaluation, map_ = Evaluation(), Map()
    stood, turned = Truth(7.0, 1.0, 2.0, 0.0, 0.0), Truth(7.0, 1.0, -1.0, 0.0, 0.0)
    for truth in (stood, turned):
        for tick in range(10):
            made = truth is stood and tick == 0
            evaluation.record(tick * DT, truth, map_, made, Odometry(0.0, 0.0, DT))  # type: ignore[arg-type]
        if truth is stood:
            evaluation.kidnapped(0.9, map_)  # type: ignore[arg-type]
    assert evaluation.kidnaps[0].after_s is None
    for tick in range(20, 30):
        evaluation.record(tick * DT, stood, map_, False, Odometry(0.0, 0.0, DT))  # type: ignore[arg-type]
    assert evaluation.kidnaps[0].after_s == pytest.approx(1.1)


def test_thousands_of_experiences_keep_where_they_were_made() -> None:
    evaluation, map_ = Evaluation(), Map()
    map_.poses = np.zeros((2500, 3))
    for i in range(2500):
        map_.active = i
        evaluation.record(i * DT, Truth(i, -i, 0.0, 0.0, 0.0), map_, True, Odometry(0.0, 0.0, DT))  # type: ignore[arg-type]
    assert evaluation.memory_bytes >= 2500 * 13 * 8
    for i in (0, 1023, 1024, 2499):
        assert evaluation.made_at(i, map_) == (i, -i)


def test_experiences_that_a_brain_brought_are_where_the_map_says() -> None:
    evaluation, map_ = Evaluation(known=2000), Map()
    map_.poses = np.zeros((2001, 3))
    map_.poses[:, 0] = np.arange(2001)
    map_.active = 1500  # not made in this run
    drive(evaluation, map_, 300, start=1)
    assert evaluation.revisit_consistency is None
    x, y = evaluation.made_at(1510, map_)  # type: ignore[arg-type]
    here = evaluation.trajectories(map_)  # type: ignore[arg-type]
    assert math.dist((x, y), here[0][0]) == pytest.approx(10.0 - 0.03, abs=1e-6)  # the first place is a tick on


def test_what_a_kidnap_asks_of_the_past_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """However long the robot drove before it, and however long it is never consistent."""
    evaluation, map_, asked = Evaluation(), Map(), list[int]()
    drive(evaluation, map_, MOST_TICKS + 5000)
    evaluation.kidnapped(evaluation._count * DT, map_)  # type: ignore[arg-type]

    def passes(true: np.ndarray, *_rest: object) -> tuple[float, float]:
        asked.append(len(true))
        return math.nan, math.nan

    monkeypatch.setattr("app.evaluation.evaluation.off_earlier_passes", passes)
    drive(evaluation, map_, 3200, start=MOST_TICKS + 5000, wrong_m=9.0)
    assert set(asked) == {MOST_TICKS // EVERY}
    assert len(asked) == pytest.approx(CONSISTENT_WITHIN_S / DT, abs=2)
