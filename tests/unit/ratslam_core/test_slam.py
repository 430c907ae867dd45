"""A whole brain on laps of a circle: it knows places again, is the same each time, and takes parameters and sonars."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from ratslam_core import ExperienceMapParams, LocalViewParams, Odometry, PoseCellParams, RatSlam, RatSlamParams, laws
from ratslam_core.localisation import SNAP_CELLS
from tests.unit.ratslam_core.drives import LAP, SONARS, Circle, start


@pytest.mark.parametrize("seed", [0, 2])
def test_a_second_lap_finds_the_places_of_the_first(seed: int) -> None:
    circle, brain = start(seed)
    circle.advance(brain, LAP + 30)
    known = len(brain.experience_map)
    missed = []
    for _ in range(LAP):
        missed.append(circle.miss_m(circle.advance(brain, 1)[0]))
    assert len(brain.experience_map) < 1.4 * known
    assert brain.experience_map.closures > 10
    assert float(np.median(missed)) < 0.2
    assert max(missed) < 0.6
    assert brain.experience_map.robot.heading_rad == pytest.approx(circle.truth.heading_rad, abs=0.3)


def test_a_forgotten_view_leads_nowhere() -> None:
    """After half a lap every view is forgotten: the second lap knows no place of the first half again."""
    circle, brain = start()
    circle.advance(brain, LAP // 2)
    known = len(brain.experience_map)
    for view in range(len(brain.local_view)):
        brain.forget_view(view)
        assert len(brain.view_links.of(view)[0]) == 0
    assert (brain.experience_map.views == -1).all()
    with pytest.raises(ValueError, match=f"view must be from 0 to {len(brain.local_view) - 1}, got -1"):
        brain.forget_view(-1)
    circle.advance(brain, LAP // 2)
    there = [estimate.experience for estimate in circle.advance(brain, LAP // 2)]
    assert min(there) >= known - 1
    laws.check(brain)


def test_new_parameters_reach_every_part_and_the_size_is_refused() -> None:
    circle, brain = start()
    new = RatSlamParams(
        PoseCellParams(inhibit=5e-4),
        LocalViewParams(match_threshold=3.0),
        replace(brain.params.experience_map, sweeps=2),
        occupancy=replace(brain.params.occupancy),
        goal_memory=replace(brain.params.goal_memory),
    )
    brain.set_params(new)
    assert brain.pose_cells.params is new.pose_cells
    assert brain.local_view.params is brain.view_links.params is new.local_view
    assert brain.experience_map.params is new.experience_map
    assert brain.memories.params is new.occupancy
    assert brain.goal_memory.params is new.goal_memory
    with pytest.raises(ValueError, match="size of the pose cells is fixed at 64 x 64 x 36 until a reset"):
        brain.set_params(RatSlamParams(pose_cells=PoseCellParams(n_x=32)))
    assert brain.params is new  # nothing was taken over from the refused ones
    circle.advance(brain, 5)


def test_without_robust_weights_every_link_is_believed_as_measured() -> None:
    closing = ExperienceMapParams(familiar_ground=False)  # loops go on closing
    circle, brain = start(params=RatSlamParams(experience_map=closing))
    for robust in (True, False):
        experience_map = replace(brain.params.experience_map, robust=robust, solve_every=5)
        brain.set_params(replace(brain.params, experience_map=experience_map))
        circle.advance(brain, 2 * LAP)
        t = brain.experience_map.transitions
        assert np.array_equal(t.believed[: t.count], t.weight[: t.count]) is not robust


ECHOES = np.array([1.0, 2.0, 3.0], np.float32)


def test_sonars_draw_both_pictures() -> None:
    deafly = ExperienceMapParams(scan_matching=False)
    grey = RatSlamParams(local_view=LocalViewParams(front_end="template"), experience_map=deafly)
    circle, brain = Circle(), RatSlam(grey, sonar_angles_rad=SONARS)
    deaf = RatSlam(grey)
    circle.advance(brain, 100, ranges_m=ECHOES)
    circle.angle = 0.0
    circle.advance(deaf, 100)
    assert brain.occupancy is not None
    assert brain.map_grid is not None
    assert brain.occupancy.probability.max() > 0.55
    assert brain.occupancy.probability.min() < 0.4
    assert len(brain.map_grid) >= len(brain.experience_map)
    assert brain.experience_map.poses.tobytes() == deaf.experience_map.poses.tobytes()  # templates are deaf


def test_an_image_or_a_scan_that_cannot_be_changes_nothing(subtests: pytest.Subtests) -> None:
    for sonars, ranges, message in (
        ((), ECHOES, "ranges_m needs a RatSlam that was made with sonar_angles_rad"),
        (SONARS, ECHOES[:2], r"ranges_m must have shape \(3,\), one for each sonar, got \(2,\)"),
        (SONARS, np.array([1, np.nan, 1], np.float32), "ranges_m must be 0 m or more"),
        ((), None, "image must be an array of uint8"),
    ):
        with subtests.test(message):
            brain = RatSlam(sonar_angles_rad=sonars)
            before, image = brain.digest(), Circle().image
            with pytest.raises(ValueError, match=message):
                brain.step(image if ranges is not None else image * 1.0, Odometry(1.0, 0.0, 0.1), ranges_m=ranges)  # type: ignore[arg-type]
            assert brain.digest() == before


def test_the_goal_memory_learns_whenever_the_wheels_turn() -> None:
    """Straight ahead, too; and the time in which the robot turns on the spot is part of the way."""
    still, ahead, left, right = (Odometry(*way, 0.1) for way in ((0.0, 0.0), (0.5, 0.0), (0.0, 1.0), (0.0, -1.0)))
    image = np.random.default_rng(0).integers(0, 256, (8, 12), np.uint8)
    longest = []
    for pause in ([still] * 20, [left] * 10 + [right] * 10):
        brain = RatSlam(
            RatSlamParams(local_view=LocalViewParams(enabled=False))
        )  # or the view that it sees holds it back
        for odometry in [ahead] * 12 + pause + [ahead] * 12:
            brain.step(image, odometry)
        assert len(brain.goal_memory) > 0
        longest.append(float(brain.goal_memory.links[1].max()))
    assert longest[1] - longest[0] == pytest.approx(2.0, abs=0.3)


def test_a_packet_relocalises_when_it_jumps_farther_than_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    for beyond, relocalised in ((0.0, False), (1e-6, True)):
        circle, brain = start()
        monkeypatch.setattr(brain.pose_cells, "cells_apart", lambda *_, jump=SNAP_CELLS + beyond: jump)
        assert circle.advance(brain, 1)[0].relocalised is relocalised
        assert brain.relocalisations == relocalised


def test_a_leap_of_the_packet_is_no_way() -> None:
    circle, brain = start()
    circle.advance(brain, 2 * LAP)
    circle.angle += 2.6
    circle.advance(brain, LAP // 2)
    assert brain.relocalisations >= 1
    pairs, _ = brain.goal_memory.links
    y, x = np.divmod(pairs, 64)
    apart = np.hypot((x[:, 0] - x[:, 1] + 32) % 64 - 32, (y[:, 0] - y[:, 1] + 32) % 64 - 32)
    assert apart.max() < 10  # half a metre and the width of two packets; the leap was 10 cells and that width


@pytest.mark.slow
def test_a_step_allocates_no_more_with_time() -> None:
    """Known ground, lap after lap: what steps allocate is freed again, and the last laps need no more than those before."""
    circle, brain = start()
    circle.advance(brain, 10 * LAP)
    tracemalloc.start()
    try:
        held, needed = [], []
        for _ in range(6):
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            circle.advance(brain, LAP)
            now, peak = tracemalloc.get_traced_memory()
            held.append(now)
            needed.append(peak - before)
    finally:
        tracemalloc.stop()
    assert min(needed[3:]) < 1.2 * min(needed[:3])  # of laps in which no array grew
    assert held[-1] < 1_000_000 + 8 * brain.view_links.room  # it moved meanwhile, arrays that grew included
