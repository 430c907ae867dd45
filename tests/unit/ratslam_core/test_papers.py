"""With all our additions off, whole runs equal those of the papers' equations, tick by tick."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ratslam_core import Odometry, RatSlam, RatSlamParams
from ratslam_core.params.additions import ADDITIONS, Value
from ratslam_core.params.presets import PRESETS, preset, with_values

from .drives import RADIUS_M, STEP_RAD, Circle
from .paper_twin import PaperTwin

# With the equations as they are printed, which the twin follows; `presets._READ` reads some otherwise.
SMALL: dict[str, Value] = {
    "local_view.learning_rate": 0.15,
    "local_view.saturation": 0.02,
    "experience_map.sweep": "by link",
    "experience_map.zone_offset": False,
    "pose_cells.n_x": 21,
    "pose_cells.n_y": 17,
    "pose_cells.n_theta": 13,
}  # odd, so that nothing is equally far both ways round


def in_step(params: RatSlamParams, ticks: int, seed: int) -> tuple[RatSlam, PaperTwin]:
    """Drive both round a circle and over it again, faster and faster, and compare them after every tick."""
    circle, brain, twin = Circle(seed), RatSlam(params, np.random.default_rng(seed)), PaperTwin(params)
    for tick in range(ticks):
        faster = 2 + tick % 3
        circle.angle += faster * STEP_RAD
        odometry = Odometry(
            faster * RADIUS_M * STEP_RAD / 0.1, faster * STEP_RAD / 0.1 * (1 + 0.05 * math.sin(tick)), 0.1
        )
        estimate = brain.step(circle.image, odometry, behaviour=tick // 7 % 3)
        view = twin.step(circle.image, odometry.speed, odometry.yaw_rate, 0.1, tick // 7 % 3)
        assert estimate.recognition.view == view, tick
        np.testing.assert_allclose(brain.pose_cells.activity, twin.P, atol=3e-6)
        x, y, theta, mass = twin.winner()
        winner = estimate.packet
        there = winner.x, winner.y, winner.heading_rad % (2 * math.pi) * 13 / (2 * math.pi), winner.mass
        assert np.allclose(np.array(there), (x, y, theta, mass), atol=1e-4), tick
        assert estimate.experience == twin.active, tick
        np.testing.assert_allclose(brain.experience_map.poses, twin.poses, atol=1e-6)
        robot = estimate.pose_map_robot
        assert (robot.x, robot.y) == pytest.approx(twin.robot[:2], abs=1e-6)
        ways = [t for t in twin.transitions if not t.deleted]
        assert brain.experience_map.links.tolist() == [[t.start, t.end] for t in ways], tick
        np.testing.assert_allclose(brain.experience_map.moves, [t.move for t in ways] or np.zeros((0, 3)), atol=1e-9)
        np.testing.assert_allclose(brain.experience_map.link_times, [t.time_s for t in ways], atol=1e-9)
    return brain, twin


@pytest.mark.slow
def test_a_run_is_that_of_the_literal_twin() -> None:
    brain, twin = in_step(with_values(preset("paper-2006"), SMALL), 260, 0)
    assert len(twin.views) > 20
    assert brain.experience_map.closures > 10
    assert any(t.passages > 1 for t in twin.transitions)


@pytest.mark.slow
def test_links_are_deleted_as_in_the_twin() -> None:
    params = with_values(
        preset("paper-2006"), {**SMALL, "experience_map.link_confidence": 0.6, "experience_map.link_trials": 2}
    )
    _, twin = in_step(params, 200, 3)
    assert any(t.deleted for t in twin.transitions)


@pytest.mark.slow
def test_a_biased_loop_is_corrected_as_in_the_twin() -> None:
    """With more sweeps and another rate, too, the map bends as the equations say."""
    in_step(
        with_values(preset("paper-2006"), {**SMALL, "experience_map.sweeps": 3, "experience_map.correction": 0.3}),
        150,
        4,
    )


def test_ours_is_what_runs_by_default_and_every_preset_sets_the_same_names() -> None:
    assert preset("ours") == RatSlamParams()
    assert len({frozenset(values) for values in PRESETS.values()}) == 1
    for name in PRESETS:
        assert preset("ours", preset(name)) == RatSlamParams()
        assert (preset(name) == RatSlamParams()) is (name == "ours")
    with pytest.raises(ValueError, match="unknown preset 'paper-2010'; expected one of: ours, paper-2004"):
        preset("paper-2010")


def test_in_2004_the_packet_is_where_the_robot_is() -> None:
    params = with_values(preset("paper-2004"), {"local_view.front_end": "template", "local_view.enabled": False})
    circle, brain = Circle(0), RatSlam(params)
    off = [circle.miss_m(circle.advance(brain, 1)[0]) for _ in range(100)]
    assert len(brain.experience_map) == 1
    assert 0.001 < max(off) < 0.6  # the lattice holds a slow packet back, and no addition gives the lost motion back
    brain.declare_kidnapped()
    assert not brain.lost


OFF = {name: value for addition in ADDITIONS for name, value in addition.off.items()}
FITS = {"local_view.front_end": "image and sonars"}  # the front end that a switch is of, if not of every one


@pytest.mark.slow
def test_each_addition_alone_changes_the_run(subtests: pytest.Subtests) -> None:
    """Each switch must have an effect."""
    switches = [name for name, value in OFF.items() if value != PRESETS["ours"][name]]
    for front_end in ("template", *FITS.values()):
        base = with_values(RatSlamParams(), {"local_view.front_end": front_end})
        told = _told(base)
        for name in (name for name in switches if FITS.get(name, "template") == front_end):
            with subtests.test(name):
                assert told != _told(with_values(base, {name: OFF[name]}))


def _told(params: RatSlamParams) -> list[object]:
    """A run in which everything happens: laps slightly beside each other, a bare wall, another light, a kidnap, a dash,
    and a way that is barred and later free again."""
    circle, brain = Circle(2), RatSlam(params, np.random.default_rng(0), sonar_angles_rad=(0.0,))
    told: list[object] = []
    for tick in range(520):
        faster = 12 if tick > 500 else 2.07
        circle.angle += faster * STEP_RAD + 0.4 * (tick == 440)
        image = circle.image + np.uint8(14 * (230 < tick < 250))
        image = np.dstack([image] * 3)
        image[..., 1] //= 2 if tick % 97 != 50 else 1
        image = np.full_like(image, 90) if tick % 97 == 50 else image
        odometry = Odometry(faster * RADIUS_M * STEP_RAD / 0.1, faster * STEP_RAD / 0.1 + 0.02, 0.1)
        estimate = brain.step(image, odometry, ranges_m=np.array([1.0 if tick < 440 else 3.0]), behaviour=tick // 9 % 2)
        told.append((estimate.packet, estimate.experience, estimate.pose_map_robot, brain.lost))
    map_, packet = brain.experience_map, estimate.packet
    for reached in (False, True) * 3:
        map_.tried(*map_.links[-1].tolist(), reached)
    times = brain.goal_memory.times_to(round(packet.x) % 64, round(packet.y) % 64)
    return [*told, times.tobytes(), map_.link_times.tobytes(), map_.confidences.tobytes()]
