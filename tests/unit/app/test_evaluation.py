from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from evo.core import metrics
from evo.core.geometry import umeyama_alignment
from evo.core.trajectory import PoseTrajectory3D
from hypothesis import given, settings
from hypothesis import strategies as st

from app.evaluation import Coverage, Evaluation, align, alignment, rmse
from app.evaluation.agreement import steady_alignment
from app.evaluation.evaluation import CONSISTENT_WITHIN_S, EVERY, MOST_TICKS
from ratslam_core import Odometry, Pose2
from sim2d import FreeSpace, Truth, load_world

from .worlds import room

DT = 0.1


def walk(rng: np.random.Generator, n: int) -> np.ndarray:
    return np.cumsum(rng.uniform(-1, 1, (n, 2)), axis=0)


def moved(points: np.ndarray, frame: Pose2) -> np.ndarray:
    c, s = math.cos(frame.heading_rad), math.sin(frame.heading_rad)
    return points @ np.array([[c, s], [-s, c]]) + (frame.x, frame.y)


@settings(max_examples=80)
@given(st.integers(0, 2**32 - 1), st.integers(3, 60), st.floats(0.0, 2.0))
def test_evo_aligns_the_same_way(seed: int, n: int, noise: float) -> None:
    rng = np.random.default_rng(seed)
    truth = walk(rng, n)
    estimate = moved(truth, Pose2(3.0, -2.0, 2.1)) + rng.normal(0, noise, (n, 2))
    rotation, translation, _ = umeyama_alignment(estimate.T, truth.T)
    frame = alignment(estimate, truth)
    assert math.atan2(rotation[1, 0], rotation[0, 0]) == pytest.approx(frame.heading_rad, abs=1e-7)
    assert translation == pytest.approx([frame.x, frame.y], abs=1e-6)
    assert align(estimate, truth) == pytest.approx((rotation @ estimate.T).T + translation, abs=1e-6)


@given(st.integers(0, 2**32 - 1))
def test_some_seconds_at_a_false_place_do_not_turn_the_frame(seed: int) -> None:
    rng = np.random.default_rng(seed)
    truth, frame = walk(rng, 200), Pose2(1.0, 5.0, -0.7)
    estimate, begin = moved(truth, frame.inverse()), rng.integers(190)
    estimate[begin : begin + 10] += moved(np.array([10.0, 0.0]), Pose2(0.0, 0.0, rng.uniform(0, 6)))
    found = steady_alignment(estimate, truth)
    assert (found.x, found.y, found.heading_rad) == pytest.approx((frame.x, frame.y, frame.heading_rad), abs=1e-6)


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


def test_scale_is_an_error_and_fewer_than_two_points_have_none() -> None:
    truth = np.array([[0.0, 0.0], [2.0, 0.0]])
    assert rmse(2 * truth, truth) == pytest.approx(1.0)
    assert rmse(np.zeros((1, 2)), np.ones((1, 2))) == rmse(np.zeros((0, 2)), np.zeros((0, 2))) == 0.0


class Map:
    """The part of an experience map that the evaluation reads: one experience, with the robot beside it."""

    def __init__(self) -> None:
        self.poses = np.zeros((1, 3))
        self.active = 0
        self.carried = self.suspects_kidnap = self.lost = False
        self.local_pose = Pose2(0.0, 0.0, 0.0)

    @property
    def here(self) -> int:
        return self.active

    @property
    def robot(self) -> Pose2:
        return Pose2(*self.poses[self.active]).compose(self.local_pose)

    def pose(self, experience: int) -> Pose2:
        return Pose2(*self.poses[experience])


STILL = Odometry(0.0, 0.0, DT)


def driven(ticks: int = 0, *, known: int = 0, start: int = 0) -> tuple[Evaluation, Any]:
    evaluation, map_ = Evaluation(known), Map()
    drive(evaluation, map_, ticks, start=start)
    return evaluation, map_


def drive(
    evaluation: Evaluation, map_: Any, ticks: int, *, wrong_m: float = 0.0, turned_rad: float = 0.0, start: int = 0
) -> None:
    """Drive along +y of the office at 0.3 m/s. The map, which lies elsewhere and is turned, is wrong by a given amount."""
    for tick in range(start, start + ticks):
        x = 0.03 * tick
        map_.local_pose = Pose2(x, wrong_m, turned_rad)
        truth = Truth(7.0, 1.0 + x, math.pi / 2, 0.3 if tick else 0.0, 0.0)
        odometry = Odometry(0.33 if tick else 0.0, 0.0, DT)
        evaluation.record(tick * DT, truth, map_, tick == 0, odometry)


def test_paths_and_errors() -> None:
    evaluation, map_ = driven(5001)
    truth, mapped, odometry = evaluation.trajectories(map_)
    assert len(truth) == len(mapped) == len(odometry) == 5001
    assert truth[-1] == pytest.approx([7.0, 151.0])
    assert mapped[-1] == pytest.approx([150.0, 0.0])
    assert odometry[-1] == pytest.approx([165.0, 0.0])
    assert evaluation.path_m == pytest.approx(150.0)
    map_error, odometry_error = evaluation.errors(map_)
    assert map_error == pytest.approx(0.0, abs=1e-6)
    assert odometry_error == pytest.approx(15 / math.sqrt(12), rel=1e-3)  # a tenth too long, evenly
    assert evaluation.errors(map_, 10)[1] == pytest.approx(odometry_error, rel=0.01)
    assert evaluation.made_at(0, map_) == (7.0, 1.0)
    for each in ((evaluation, map_), driven(2)):  # by its whole path or, while that is too short, by its end
        frame = each[0].map_in_office(each[1])
        assert (frame.x, frame.y, frame.heading_rad) == pytest.approx((7.0, 1.0, math.pi / 2))
    map_.poses[0, 2] = math.pi / 6  # the whole map is turned
    assert evaluation.trajectories(map_)[1][-1] == pytest.approx([150 * math.cos(math.pi / 6), 75.0])


def test_the_map_is_judged_as_it_is_now() -> None:
    evaluation, map_ = driven(100)
    map_.poses = np.zeros((2, 3))
    map_.active = 1
    drive(evaluation, map_, 100, start=100)
    assert evaluation.errors(map_)[0] == pytest.approx(0.0, abs=1e-6)
    map_.poses[1] = 0.0, 2.0, 0.0
    assert evaluation.errors(map_)[0] > 0.5


def test_consistency_counts_old_experiences_only() -> None:
    evaluation, map_ = driven()
    assert evaluation.revisit_consistency is None
    drive(evaluation, map_, 200)
    assert evaluation.revisit_consistency is None
    drive(evaluation, map_, 101, start=200)
    assert evaluation.revisit_consistency == 1.0
    drive(evaluation, map_, 100, start=301, wrong_m=0.6)
    assert evaluation.revisit_consistency == pytest.approx(0.5, abs=0.01)


def kidnapped(*, poses: list[tuple[float, float, float]] | None = None, **wrong: float) -> float | None:
    """After how many seconds a kidnap is over that the map does not follow, after ten seconds of driving.

    poses: those that the map has then; the last is the active one.
    """
    evaluation, map_ = driven(100)
    evaluation.kidnapped(9.9, map_)
    if poses:
        map_.poses, map_.active = np.array(poses), len(poses) - 1
    drive(evaluation, map_, 50, start=100, **wrong)
    return evaluation.kidnaps[0].after_s


def test_a_kidnap_is_over_when_the_robot_stays_right_for_half_a_second() -> None:
    evaluation, map_ = driven(100)
    evaluation.kidnapped(9.9, map_)
    kidnap = evaluation.kidnaps[0]
    drive(evaluation, map_, 50, start=100, wrong_m=3.0)
    drive(evaluation, map_, 4, start=150)  # right by chance, but not for long
    drive(evaluation, map_, 36, start=154, wrong_m=-2.0)
    assert kidnap.after_s is None
    drive(evaluation, map_, 40, start=190, wrong_m=0.5)
    assert kidnap.at_s == 9.9
    assert kidnap.after_s == pytest.approx(19.0 - 9.9)
    assert kidnap.after_m == pytest.approx(0.03 * 91)
    evaluation.kidnapped(22.9, map_)
    drive(evaluation, map_, 30, start=230, wrong_m=4.0)
    assert evaluation.kidnaps[1].after_s is None
    assert kidnap.after_s == pytest.approx(9.1)


def test_who_has_recovered() -> None:
    well: list[dict[str, Any]] = [
        {},
        {"turned_rad": 0.5},
        {"poses": [(5.0, -3.0, 1.0)]},  # the active experience is where it was truly made, wherever the map has it now
    ]
    badly: list[dict[str, Any]] = [
        *({"turned_rad": turned} for turned in (0.7, -0.7, math.pi)),  # on the spot: it does not know its heading
        {"wrong_m": 1.1},
        {"poses": [(0.0, 0.0, 0.0)] * 2},  # an experience made after the kidnap recovers nothing
    ]
    assert [kidnapped(**how) for how in well] == pytest.approx([0.1] * 3)
    assert [kidnapped(**how) for how in badly] == [None] * 5


def test_known_ground_is_met_within_a_metre_of_an_old_pose_and_half_a_radian() -> None:
    evaluation, map_ = driven(100)  # from (7, 1) to (7, 4), north
    evaluation.kidnapped(9.9, map_)
    north = math.pi / 2
    elsewhere = (8.2, 2.0, north), (7.0, 5.2, north), (7.0, 2.0, north + 0.6), (7.0, 2.0, -north)
    for tick, pose in enumerate((*elsewhere, elsewhere[0], (7.9, 2.0, north - 0.4), elsewhere[0]), start=100):
        evaluation.record(tick * DT, Truth(*pose, 0.0, 0.0), map_, False, STILL)
        assert evaluation.kidnaps[0].met_s == (None if tick < 105 else pytest.approx(0.6))


def test_of_what_a_brain_brought_the_map_says_where_it_is() -> None:
    for wrong_m, after_s in ((0.5, pytest.approx(0.1)), (1.5, None)):
        evaluation, map_ = driven(100, known=1, start=1)
        evaluation.kidnapped(10.0, map_)
        drive(evaluation, map_, 50, start=101, wrong_m=wrong_m)
        assert evaluation.kidnaps[0].after_s == after_s


def test_what_the_robot_believes_is_compared_with_where_it_is() -> None:
    evaluation, map_ = driven(10)
    truth = Truth(7.0, 1.27, math.pi / 2, 0.3, 0.0)
    assert evaluation.belief_off(truth, map_) == pytest.approx((0.0, 0.0), abs=1e-9)
    map_.local_pose = Pose2(0.27, 0.4, 0.3)
    assert evaluation.belief_off(truth, map_) == pytest.approx((0.4, 0.3))
    map_.poses, map_.active = np.zeros((2, 3)), 1
    assert np.isnan(evaluation.belief_off(truth, map_)).all()


def test_the_share_of_the_ticks_on_an_old_experience() -> None:
    evaluation, map_ = driven()
    assert evaluation.revisit_share == 0.0
    drive(evaluation, map_, 400)  # the first 20 s do not count
    assert evaluation.revisit_share == pytest.approx(199 / 400)


def test_births_are_known_or_not_a_number() -> None:
    evaluation, map_ = driven(10)
    births = evaluation.births(3000)
    assert births.shape == (3000, 4)
    assert births[0] == pytest.approx([7.0, 1.0, math.pi / 2, 0.0])
    assert np.isnan(births[1:]).all()
    assert evaluation.path == pytest.approx(evaluation.trajectories(map_)[0])


def test_a_robot_that_has_never_driven_is_judged_by_how_it_stood() -> None:
    evaluation, map_ = driven()
    stood, turned = Truth(7.0, 1.0, 2.0, 0.0, 0.0), Truth(7.0, 1.0, -1.0, 0.0, 0.0)
    for truth in (stood, turned):
        for tick in range(10):
            made = truth is stood and tick == 0
            evaluation.record(tick * DT, truth, map_, made, STILL)
        if truth is stood:
            evaluation.kidnapped(0.9, map_)
    assert evaluation.kidnaps[0].after_s is None
    for tick in range(20, 30):
        evaluation.record(tick * DT, stood, map_, False, STILL)
    assert evaluation.kidnaps[0].after_s == pytest.approx(1.1)


def test_thousands_of_experiences_keep_where_they_were_made() -> None:
    evaluation, map_ = driven()
    map_.poses = np.zeros((2500, 3))
    for i in range(2500):
        map_.active = i
        evaluation.record(i * DT, Truth(i, -i, 0.0, 0.0, 0.0), map_, True, STILL)
    assert evaluation.memory_bytes >= 2500 * (9 * 4 + 4 * 8)
    for i in (0, 1023, 1024, 2499):
        assert evaluation.made_at(i, map_) == (i, -i)


def test_experiences_that_a_brain_brought_are_where_the_map_says() -> None:
    evaluation, map_ = driven(known=2000)
    map_.poses = np.zeros((2001, 3))
    map_.poses[:, 0] = np.arange(2001)
    map_.active = 1500  # not made in this run
    drive(evaluation, map_, 300, start=1)
    assert evaluation.revisit_consistency is None
    x, y = evaluation.made_at(1510, map_)
    here = evaluation.trajectories(map_)
    assert math.dist((x, y), here[0][0]) == pytest.approx(10.0 - 0.03, abs=1e-6)  # the first place is a tick on


def test_what_a_kidnap_asks_of_the_past_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """However long the robot drove before it, and however long it is never consistent."""
    (evaluation, map_), asked = driven(MOST_TICKS + 5000), list[int]()
    evaluation.kidnapped((MOST_TICKS + 5000) * DT, map_)

    def passes(true: np.ndarray, *_rest: object) -> tuple[float, float]:
        asked.append(len(true))
        return math.nan, math.nan

    monkeypatch.setattr("app.evaluation.evaluation.off_earlier_passes", passes)
    drive(evaluation, map_, 3200, start=MOST_TICKS + 5000, wrong_m=9.0)
    assert set(asked) == {MOST_TICKS // EVERY}
    assert len(asked) == pytest.approx(CONSISTENT_WITHIN_S / DT, abs=2)


# ------------------------------------------------------------ the share of the floor that a path has covered

PATH = np.stack([np.linspace(0.5, 3.5, 200), np.linspace(0.5, 1.5, 200)], axis=1)


HALL = room(start=(1.0, 1.0, 0.0))


def test_a_growing_path_covers_what_the_whole_of_it_covers_and_another_begins_anew() -> None:
    floor, grows = FreeSpace(HALL, 0.2), Coverage()
    shares = [grows.follow(floor, PATH[:n]) for n in (1, 1, 7, 40, 199, 200)]
    assert shares == sorted(shares)
    assert shares[0] == shares[1] > 0
    assert shares[-1] == Coverage().follow(floor, PATH)
    assert shares[-1] < 1.0
    assert grows.follow(floor, PATH[:10]) == Coverage().follow(floor, PATH[:10])
    divided = FreeSpace(room((2.0, 0.0, 2.0, 4.0), start=(1.0, 1.0, 0.0)), 0.2)
    assert grows.follow(divided, PATH) == Coverage().follow(divided, PATH)


def test_what_lies_behind_a_wall_or_beside_the_floor_is_not_covered() -> None:
    whole, divided = (FreeSpace(world, 0.2) for world in (HALL, room((2.0, 0.0, 2.0, 3.0), start=(1.0, 1.0, 0.0))))
    in_sight, behind = (Coverage().follow(floor, np.array([(1.7, 0.5)])) for floor in (whole, divided))
    assert behind * divided.floor_cells < 0.7 * in_sight * whole.floor_cells
    office = FreeSpace(load_world("office"), 0.22)
    assert Coverage().follow(office, np.array([(-50.0, 3.0)])) == 0.0
    assert Coverage().follow(office, np.zeros((0, 2))) == pytest.approx(0.0)
