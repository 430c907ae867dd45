from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from ratslam_core import (
    ExperienceMapParams,
    LocalViewParams,
    Odometry,
    Pose2,
    PoseCellParams,
    PoseCells,
    RatSlam,
    RatSlamParams,
)
from tests.unit.ratslam_core.drives import LAP, RADIUS_M, STEP_RAD, Circle


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
    assert np.hypot(*(after - map_before)[:, :2].T).max() < 0.3  # the map is as before


def test_a_changed_place_does_not_keep_the_robot_lost() -> None:
    """Something was put up: every second view is new from now on, but the others are where they always were."""
    circle, brain = start()
    circle.advance(brain, 2 * LAP)
    brain.declare_kidnapped()
    rng = np.random.default_rng(1)
    row = 0
    for tick in range(LAP):
        circle.angle += STEP_RAD
        changed = tick % 8 >= 4
        image = rng.integers(0, 256, (8, 12), np.uint8) if changed else circle.image
        before = len(brain.experience_map)
        brain.local_view._last = None  # only the first change is a surprise
        estimate = brain.step(image, Odometry(RADIUS_M * STEP_RAD / 0.1, STEP_RAD / 0.1, 0.1))
        known = estimate.experience < before and not changed
        row = row + 1 if known else 0
        assert row < 8  # never so many in a row
        if not brain.lost:
            break
    assert not brain.lost
    assert circle.miss_m(estimate) < 0.3


def test_sights_that_contradict_each_other_find_nobody_again() -> None:
    circle, brain = start()
    circle.advance(brain, 2 * LAP)
    brain.declare_kidnapped()
    for agrees in [True] * 7 + ([False] + [True] * 6) * 3 + [False] + [True] * 7:
        assert brain.lost
        brain.kidnap_detector.settle(agrees, 0)
    assert not brain.lost


@pytest.mark.parametrize("most", [256, 2])
def test_nobody_is_lost_for_ever(most: int) -> None:
    """The robot stands before a new wall, perhaps a bland one, or was carried to where it has never been."""
    circle, brain = start()
    circle.advance(brain, 100)
    still, wall = Odometry(0.0, 0.0, 0.1), np.random.default_rng(1).integers(0, most, (8, 12), np.uint8)
    brain.step(wall, still)
    assert brain.lost
    steps = 0
    while brain.lost:
        brain.step(wall, still)
        steps += 1
        assert steps <= 2000
    assert steps > 600  # but it takes long


@pytest.mark.parametrize(
    ("alike", "others_m", "noticed"),
    [(0.7, 2.0, True), (0.7, 1.0, False), (1.2, 1.4, True), (1.2, 1.0, False), (0.4, 2.0, False)],
)
def test_sonars_help_to_notice_a_kidnap(alike: float, others_m: float, noticed: bool) -> None:
    """alike: the change of the image, as a share of what is needed without sonars. Sonars alone are not enough."""
    near = np.full(8, 1.0)
    circle, brain = Circle(0), RatSlam(sonar_angles_rad=np.linspace(-1.5, 1.5, 8).tolist())
    still = Odometry(0.0, 0.0, 0.1)
    brain.step(circle.image, still, ranges_m=near)
    circle.angle += 2.6
    params = brain.params.local_view
    changed = replace(params, surprise=params.surprise * _unlikeness(circle) / alike)
    brain.set_params(replace(brain.params, local_view=changed))
    brain.step(circle.image, still, ranges_m=np.array([1.0, 1.0, 1.0, *[others_m] * 5]))
    assert brain.local_view.image_change == pytest.approx(alike)
    assert brain.lost is noticed


def _unlikeness(circle: Circle) -> float:
    """The difference between the current image and that at the beginning of the circle."""
    fresh = RatSlam()
    fresh.local_view.observe(Circle(0).image)
    fresh.local_view.observe(circle.image)
    return fresh.local_view.image_change


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
    agreed = brain.kidnap_detector._agreed
    brain.step(np.full((8, 12), 100, np.uint8), Odometry(0.0, 0.0, 0.1))
    assert brain.lost
    assert brain.experience_map.cell_state(brain.experience_map.active)[3] == -1
    assert brain.kidnap_detector._agreed == 0 <= agreed


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
    """While a view is too young to inject, the pose cells move as if it were not there."""
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
    assert brain.experience_map.calibrated(Odometry(0.3, 0.2, 0.1)) == Odometry(0.3, 0.2 - 0.05, 0.1)
    assert brain.experience_map.calibrated(Odometry(0.0, 0.2, 0.1)).yaw_rate == pytest.approx(0.15)
    still = Odometry(0.0, 0.0, 0.1)
    assert brain.experience_map.calibrated(still) is still


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
    assert brain.params is new  # nothing was taken over from the refused ones
    circle.advance(brain, 5)


def test_new_parameters_reach_the_grids_of_a_robot_with_sonars() -> None:
    brain = RatSlam(sonar_angles_rad=np.zeros(1))
    new = replace(brain.params, occupancy=replace(brain.params.occupancy))
    brain.set_params(new)
    assert brain.occupancy is not None
    assert brain.map_grid is not None
    assert brain.occupancy.params is brain.map_grid.params is new.occupancy


def test_without_robust_weights_every_link_is_believed_as_measured() -> None:
    circle, brain = start()
    for robust in (True, False):
        experience_map = replace(brain.params.experience_map, robust=robust, solve_every=5)
        brain.set_params(replace(brain.params, experience_map=experience_map))
        circle.advance(brain, 2 * LAP)
        t = brain.experience_map.transitions
        assert np.array_equal(t.believed[: t.count], t.weight[: t.count]) is not robust


def test_what_is_not_an_image_changes_nothing() -> None:
    circle, brain = start()
    before = brain.pose_cells.activity
    with pytest.raises(ValueError, match="image must be an array of uint8"):
        brain.step(circle.image.astype(np.float32), Odometry(1.0, 0.0, 0.1))
    assert np.array_equal(brain.pose_cells.activity, before)
    assert len(brain.experience_map) == 1


SONARS = (-0.5, 0.0, 0.5)
ECHOES = np.array([1.0, 2.0, 3.0], np.float32)


def test_sonars_draw_both_pictures() -> None:
    circle, brain = Circle(), RatSlam(sonar_angles_rad=SONARS)
    deaf = RatSlam()
    circle.advance(brain, 100, ranges_m=ECHOES)
    circle.angle = 0.0
    circle.advance(deaf, 100)
    assert brain.occupancy is not None
    assert brain.map_grid is not None
    assert brain.occupancy.probability.max() > 0.55
    assert brain.occupancy.probability.min() < 0.4
    assert len(brain.map_grid) >= len(brain.experience_map)
    assert brain.experience_map.poses.tobytes() == deaf.experience_map.poses.tobytes()  # SLAM does not read the sonars


@pytest.mark.parametrize(
    ("sonars", "ranges", "message"),
    [
        ((), ECHOES, "ranges_m needs a RatSlam that was made with sonar_angles_rad"),
        (SONARS, ECHOES[:2], r"ranges_m must have shape \(3,\), one for each sonar, got \(2,\)"),
        (SONARS, np.array([1, np.nan, 1], np.float32), "ranges_m must be 0 m or more"),
    ],
)
def test_a_scan_that_cannot_be_changes_nothing(sonars: tuple, ranges: np.ndarray, message: str) -> None:
    circle, brain = Circle(), RatSlam(sonar_angles_rad=sonars)
    before = brain.digest()
    with pytest.raises(ValueError, match=message):
        circle.advance(brain, 1, ranges_m=ranges)
    assert brain.digest() == before


def test_goal_memory_learns_the_way_round() -> None:
    circle, brain = start()
    circle.advance(brain, LAP)
    packet = brain.pose_cells.winner
    goal = round(packet.x) % 64, round(packet.y) % 64
    circle.advance(brain, LAP // 2)
    here = brain.pose_cells.winner
    times = brain.goal_memory.times_to(*goal)
    taken = times[round(here.y) % 64, round(here.x) % 64]
    assert 0.5 < taken / (LAP / 2 * 0.1) < 2.5  # each link adds its share of activity and distance
    assert brain.goal_memory.direction(times, here) is not None
    before = len(brain.goal_memory)
    for _ in range(50):
        brain.step(circle.image, Odometry(0.0, 0.0, 0.1))
    assert len(brain.goal_memory) == before  # waiting is no way


def test_a_leap_of_the_packet_is_no_way() -> None:
    circle, brain = start()
    circle.advance(brain, 2 * LAP)
    circle.angle += 2.6
    circle.advance(brain, LAP // 2)
    assert brain.relocalisations >= 1
    pairs, _ = brain.goal_memory.links
    y, x = np.divmod(pairs, 64)
    apart = np.hypot((x[:, 0] - x[:, 1] + 32) % 64 - 32, (y[:, 0] - y[:, 1] + 32) % 64 - 32)
    assert apart.max() < 7  # half a metre and the width of two packets; the leap was 10 cells


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


@pytest.mark.slow
def test_a_step_allocates_no_more_with_time() -> None:
    """Known ground, lap after lap: what steps allocate is freed again, and the tenth lap needs no more than the third."""
    circle, brain = start()
    circle.advance(brain, 3 * LAP)
    tracemalloc.start()
    try:
        held, needed = [], []
        for _ in range(8):
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            circle.advance(brain, LAP)
            now, peak = tracemalloc.get_traced_memory()
            held.append(now)
            needed.append(peak - before)
    finally:
        tracemalloc.stop()
    assert min(needed[4:]) < 1.2 * min(needed[:4])  # of laps in which no array grew
    assert held[-1] < 1_000_000 + 8 * brain.view_links.room  # it moved meanwhile, arrays that grew included
