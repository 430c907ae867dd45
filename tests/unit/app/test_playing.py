"""A recording is played through the engine: the same brain as in the simulator, and rules where nobody set parameters."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.config import Config
from app.export.mcap_file import write_mcap
from app.recordings.opening import open_recording
from app.recordings.playing import WIDTH_ERROR, Player, columns_of, rules
from app.recordings.recording import About, Moment, Wanted, every
from app.session import Session
from sim2d import SONAR_ANGLES_RAD, load_world

from .made_scans import ANGLES, room

pytestmark = pytest.mark.slow


class Held:
    """A recording in memory."""

    def __init__(self, about: About, moments: list[Moment]) -> None:
        self.about, self._moments = about, moments

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:  # noqa: ARG002
        return iter(self._moments)

    def but(self, change: Callable[[Moment], Moment]) -> Held:
        return Held(self.about, [change(moment) for moment in self._moments])


def sensed(session: Session, frame: int) -> Moment:
    f, pose = session.frame, session.simulator.truth
    return Moment(
        frame, session.time_s, session.odometry.dt, f.image, session.odometry.speed, session.odometry.yaw_rate, None,
        np.asarray(f.ranges_m, np.float64), (pose.x, pose.y, pose.heading_rad), session.pilot.behaviour.number,
    )  # fmt: skip


@pytest.fixture(scope="module")
def run() -> tuple[Session, Held]:
    """Forty seconds of our own office, and what was sensed in it. On trips the pilot tells the map where a way failed, which
    no recording holds: so it wanders."""
    session = Session(load_world("office"), 3, Config().with_value("pilot.seek", False))
    moments = [sensed(session, 0)]
    for k in range(1, 400):
        session.tick()
        moments.append(sensed(session, k))
    has = frozenset({"camera", "speed", "yaw rate", "ranges", "truth"})
    about = About("office", "ours", len(moments), session.time_s, has, (48, 64), SONAR_ANGLES_RAD, 5.0)
    return session, Held(about, moments)


def test_a_run_of_ours_played_with_its_parameters_is_the_same_run(run: tuple[Session, Held]) -> None:
    session, recording = run
    *_, last = Player(recording, 3, Config()).steps()
    assert last.brain.digest() == session.brain.digest()


def test_a_run_of_ours_that_was_exported_comes_out_the_same(tmp_path: Path) -> None:
    config = Config().with_values({"local_view.match_threshold": 1.2, "robot.odometry_noise": 0.1})
    session = Session(load_world("living"), 11, config)

    def played() -> Iterator[Session]:
        yield session
        for k in range(300):
            session.tick()
            yield session
            if k == 150:
                session.kidnap()

    with (tmp_path / "run.mcap").open("wb") as file:
        write_mcap(played(), file)
    recording = open_recording(tmp_path / "run.mcap")
    assert (recording.about.config, recording.about.problems) == (config, ())
    *_, last = Player(recording, 99).steps()
    assert last.brain.digest() == session.brain.digest()


def test_rules_follow_what_was_recorded(run: tuple[Session, Held]) -> None:
    """The office's own camera as in the simulator; one under which half a turn takes as many columns, by half as many. Who
    drives ten times as fast sees things ten times as far away: in larger cells it is the same run."""
    usual, config = rules(run[1])[0], Config()
    assert usual.local_view.field_of_view == pytest.approx(config.robot.camera_fov_rad, rel=0.25)
    assert usual.local_view.shift == config.local_view.shift
    fast, _ = rules(run[1].but(lambda m: replace(m, speed=10 * (m.speed or 0.0))))
    assert fast.pose_cells.cell_m == pytest.approx(10 * usual.pose_cells.cell_m)
    assert fast.local_view.match_threshold == usual.local_view.match_threshold
    wide, _ = rules(run[1].but(lambda m: replace(m, yaw_rate=2 * (m.yaw_rate or 0.0))))
    assert wide.local_view.shift == config.local_view.shift // 2


@given(st.floats(math.radians(20), math.tau), st.floats(0.0, 0.5))
def test_views_are_shifted_by_the_same_angle_whatever_the_camera(field_of_view: float, turned_rad: float) -> None:
    column, shift = field_of_view / 12, columns_of(turned_rad, 12, field_of_view)
    assert shift * column <= WIDTH_ERROR * turned_rad * (1 + 1e-9)
    assert (shift + 1) * column > WIDTH_ERROR * turned_rad * (1 - 1e-9)


def test_a_recording_in_which_hardly_anything_moves_plays(run: tuple[Session, Held]) -> None:
    """Most views are the same, so only the same view counts as known."""
    about, moments = run[1].about, list(run[1].moments())
    still = Held(about, [replace(moment, image=moments[0].image) for moment in moments[:200]])
    assert rules(still)[0].local_view.match_threshold == 0.0
    assert sum(1 for _ in Player(still, 1).steps()) == 200


def test_after_a_gap_the_robot_knows_that_it_does_not_know(run: tuple[Session, Held]) -> None:
    """Without wheels: nobody knows how far it was carried while nothing was recorded."""
    blind = [replace(m, speed=None, throttle=0.2) for m in run[1].moments()]
    k = next(k for k in range(200, 400) if abs(blind[k].yaw_rate or 0.0) > 0.2)  # it does not stand
    late = [replace(m, time_s=m.time_s + 5, dt=m.dt + 5 * (i == 0)) for i, m in enumerate(blind[k + 20 : k + 60])]
    about = replace(run[1].about, has=frozenset({"camera", "yaw rate", "throttle", "ranges"}))
    lost = [s.brain.experience_map.submaps.begun for s in Player(Held(about, blind[:k] + late)).steps()]
    assert (lost[k - 1], lost[k]) == (0, 1)


def test_who_sees_nothing_is_told_so() -> None:
    moments = [Moment(k, k / 10, 0.1, speed=0.3, yaw_rate=0.0) for k in range(20)]
    with pytest.raises(ValueError, match="neither a camera nor a laser"):
        Player(Held(About("blind", "test", 20, 2.0, frozenset({"speed", "yaw rate"})), moments))


def test_beams_may_be_told_from_either_side() -> None:
    """The same scans, counted from the left: the same estimates. A robot turns left by 0.1 rad a second and drives 0.1 m."""
    moments = [
        Moment(
            k, float(k), 1.0, speed=0.05 * (k > 0), yaw_rate=0.1 * (k > 0),
            ranges_m=room(0.5 * math.sin(0.1 * k), 0.5 * (1 - math.cos(0.1 * k)), 0.1 * k),
        ) for k in range(20)
    ]  # fmt: skip
    about = About(
        "room", "test", 20, 20.0, frozenset({"speed", "yaw rate", "ranges"}), None, tuple(ANGLES.tolist()), 20.0
    )
    turned = replace(about, beam_angles_rad=about.beam_angles_rad[::-1])
    mirrored = Held(turned, moments).but(lambda m: replace(m, ranges_m=m.ranges_m[::-1]))  # type: ignore[index]
    for step, other in zip(Player(Held(about, moments)).steps(), Player(mirrored).steps(), strict=True):
        a, b = step.estimate.pose_map_robot, other.estimate.pose_map_robot
        assert (a.x, a.y, a.heading_rad) == pytest.approx((b.x, b.y, b.heading_rad), abs=1e-6)
