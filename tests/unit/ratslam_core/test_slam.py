from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ratslam_core import (
    Estimate,
    ExperienceMapParams,
    LocalViewParams,
    Odometry,
    Pose2,
    PoseCellParams,
    PoseCells,
    RatSlam,
    RatSlamParams,
)

RADIUS_M = 1.5
STEP_RAD = 0.02  # along the circle in a tick: 0.03 m
LAP = round(2 * math.pi / STEP_RAD)
COLUMN_RAD = math.radians(50) / 12


class Circle:
    """A robot that drives a circle of 1.5 m and sees the part of a panorama that lies ahead."""

    def __init__(self, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        columns = round(2 * math.pi / COLUMN_RAD / 3)
        self._coarse = rng.uniform(20, 235, (8, columns))
        self.angle = 0.0

    @property
    def image(self) -> np.ndarray:
        """Columns count to the right, headings to the left."""
        heading = self.angle - np.arange(-5.5, 6.0) * COLUMN_RAD
        at = (heading / (2 * math.pi) % 1.0) * self._coarse.shape[1]
        left = np.floor(at).astype(int)
        right = (left + 1) % self._coarse.shape[1]
        seen = self._coarse[:, left % self._coarse.shape[1]] * (1 - at + left) + self._coarse[:, right] * (at - left)
        return np.round(seen).astype(np.uint8)

    @property
    def truth(self) -> Pose2:
        """In the frame of the start."""
        a = self.angle
        return Pose2(RADIUS_M * math.sin(a), RADIUS_M * (1 - math.cos(a)), math.remainder(a, 2 * math.pi))

    def advance(self, brain: RatSlam, ticks: int) -> list[Estimate]:
        estimates = []
        for _ in range(ticks):
            self.angle += STEP_RAD
            estimates.append(brain.step(self.image, Odometry(RADIUS_M * STEP_RAD / 0.1, STEP_RAD / 0.1, 0.1)))
        return estimates

    def miss_m(self, estimate: Estimate) -> float:
        return math.hypot(estimate.pose_map_robot.x - self.truth.x, estimate.pose_map_robot.y - self.truth.y)


def start(seed: int = 0, params: RatSlamParams | None = None) -> tuple[Circle, RatSlam]:
    circle, brain = Circle(seed), RatSlam(params)
    first = brain.step(circle.image, Odometry(0.0, 0.0, 0.1))
    seen = 0 if brain.params.local_view.enabled else -1
    assert (first.experience, first.created, first.recognition.view) == (0, True, seen)
    assert first.pose_map_robot == Pose2(0.0, 0.0, 0.0)
    return circle, brain


@pytest.mark.parametrize("seed", range(4))
def test_a_second_lap_finds_the_places_of_the_first(seed: int) -> None:
    circle, brain = start(seed)
    circle.advance(brain, LAP + 30)
    known = len(brain.experience_map)
    missed = []
    for _ in range(LAP):
        missed.append(circle.miss_m(circle.advance(brain, 1)[0]))
    assert len(brain.experience_map) < 1.4 * known
    assert brain.experience_map.closures > 10
    assert float(np.median(missed)) < 0.15
    assert max(missed) < 0.6
    assert brain.experience_map.robot.heading_rad == pytest.approx(circle.truth.heading_rad, abs=0.3)


@pytest.mark.parametrize("seed", range(4))
def test_a_kidnap_is_noticed_and_survived(seed: int) -> None:
    circle, brain = start(seed)
    circle.advance(brain, 2 * LAP)
    assert not brain.lost
    map_before = brain.experience_map.poses.copy()
    circle.angle += 2.6  # carried along a third of the circle and more; the wheels do not notice
    first = circle.advance(brain, 1)[0]
    assert brain.lost
    assert circle.miss_m(first) > 1.0
    lost_for = 0
    while brain.lost and lost_for < LAP:
        circle.advance(brain, 1)
        lost_for += 1
    assert not brain.lost
    assert brain.relocalisations >= 1
    assert circle.miss_m(circle.advance(brain, 20)[-1]) < 0.3
    after = brain.experience_map.poses[: len(map_before)]
    assert np.hypot(*(after - map_before)[:, :2].T).max() < 0.3  # the map is what it was


def test_driving_on_is_no_kidnap() -> None:
    circle, brain = start()
    for _ in range(LAP):
        circle.advance(brain, 1)
        assert not brain.lost


def test_views_that_show_nothing_neither_find_nor_lose() -> None:
    circle, brain = start()
    circle.advance(brain, LAP)
    circle.angle += 2.6
    circle.advance(brain, 1)
    assert brain.lost
    agreed = brain._agreed
    brain.step(np.full((8, 12), 100, np.uint8), Odometry(0.0, 0.0, 0.1))
    assert brain.lost
    assert brain.experience_map.cell_state(brain.experience_map.active)[3] == -1
    assert brain._agreed == 0 <= agreed


def test_equal_inputs_give_equal_runs() -> None:
    runs = []
    for _ in range(2):
        circle, brain = start()
        estimates = circle.advance(brain, LAP + 60)
        runs.append((estimates, brain.pose_cells.activity, brain.experience_map.poses.copy()))
    assert runs[0][0] == runs[1][0]
    assert np.array_equal(runs[0][1], runs[1][1])
    assert np.array_equal(runs[0][2], runs[1][2])


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
    """While a view rests, the pose cells move as if it were not there."""
    plain = ExperienceMapParams(calibrate=False)
    seeing, blind = (
        start(params=RatSlamParams(local_view=LocalViewParams(rest=r, enabled=e), experience_map=plain))
        for r, e in [(1e6, True), (0, False)]
    )
    for _ in range(80):
        a, b = seeing[0].advance(seeing[1], 1)[0], blind[0].advance(blind[1], 1)[0]
        assert a.packet == b.packet


def test_the_learnt_bias_is_taken_off_while_the_wheels_turn() -> None:
    _, brain = start()
    brain.experience_map.yaw_bias = 0.05
    assert brain._calibrated(Odometry(0.3, 0.2, 0.1)) == Odometry(0.3, 0.2 - 0.05, 0.1)
    assert brain._calibrated(Odometry(0.0, 0.2, 0.1)).yaw_rate == pytest.approx(0.15)
    still = Odometry(0.0, 0.0, 0.1)
    assert brain._calibrated(still) is still


def test_new_parameters_reach_every_part_and_the_size_is_refused() -> None:
    circle, brain = start()
    new = RatSlamParams(
        PoseCellParams(inhibit=5e-4),
        LocalViewParams(match_threshold=3.0),
        replace(brain.params.experience_map, sweeps=2),
    )
    brain.set_params(new)
    assert brain.pose_cells.params is new.pose_cells
    assert brain.local_view.params is brain.view_links.params is new.local_view
    assert brain.experience_map.params is new.experience_map
    with pytest.raises(ValueError, match="size of the pose cells is fixed at 64 x 64 x 36 until a reset"):
        brain.set_params(RatSlamParams(pose_cells=PoseCellParams(n_x=32)))
    assert brain.params is new  # nothing of what was refused was taken
    circle.advance(brain, 5)


def test_what_is_not_an_image_changes_nothing() -> None:
    circle, brain = start()
    before = brain.pose_cells.activity
    with pytest.raises(ValueError, match="image must be an array of uint8"):
        brain.step(circle.image.astype(np.float32), Odometry(1.0, 0.0, 0.1))
    assert np.array_equal(brain.pose_cells.activity, before)
    assert len(brain.experience_map) == 1
