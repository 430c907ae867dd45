"""A recording is played through the engine: the same brain as in the simulator, and rules where nobody set parameters."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.config import Config
from app.recordings.brain_rules import WIDTH_ERROR, columns_of, rules
from app.recordings.playing import Player
from app.recordings.recording import About, Moment, Wanted, every
from app.session import Session
from sim2d import SONAR_ANGLES_RAD, load_world

pytestmark = pytest.mark.slow


class Held:
    """A recording in memory."""

    def __init__(self, about: About, moments: list[Moment]) -> None:
        self.about, self._moments = about, moments

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:  # noqa: ARG002
        return iter(self._moments)


def _sensed(session: Session, frame: int) -> Moment:
    f, pose = session.frame, session.simulator.truth
    return Moment(
        frame, session.time_s, session.odometry.dt, f.image, session.odometry.speed, session.odometry.yaw_rate, None,
        np.asarray(f.ranges_m, np.float64), (pose.x, pose.y, pose.heading_rad), session.pilot.behaviour.number,
    )  # fmt: skip


@pytest.fixture(scope="module")
def run() -> tuple[Session, Held]:
    """Forty seconds of our own office, and what was sensed in it."""
    session = Session(load_world("office"), seed=3)
    moments = [_sensed(session, 0)]
    for k in range(1, 400):
        session.tick()
        moments.append(_sensed(session, k))
    has = frozenset({"camera", "speed", "yaw rate", "ranges", "truth"})
    about = About("office", "ours", len(moments), session.time_s, has, (48, 64), SONAR_ANGLES_RAD, 5.0)
    return session, Held(about, moments)


def test_a_run_of_ours_played_with_its_parameters_is_the_same_run(run: tuple[Session, Held]) -> None:
    session, recording = run
    *_, last = Player(recording, 3, Config()).steps()
    assert last.brain.digest() == session.brain.digest()


def test_it_plays_twice_alike(run: tuple[Session, Held]) -> None:
    player = Player(run[1])
    first, second = ([s.estimate for s in player.steps()] for _ in range(2))
    assert first == second


def test_lengths_grow_with_the_typical_speed(run: tuple[Session, Held]) -> None:
    """Who drives ten times as fast sees things ten times as far away: in larger cells it is the same run."""
    recording = run[1]
    fast = Held(recording.about, [dataclasses.replace(m, speed=10 * (m.speed or 0.0)) for m in recording.moments()])
    slow, quick = rules(recording)[0], rules(fast)[0]
    assert quick.pose_cells.cell_m == pytest.approx(10 * slow.pose_cells.cell_m)
    assert quick.local_view.match_threshold == slow.local_view.match_threshold


def test_the_field_of_view_is_measured(run: tuple[Session, Held]) -> None:
    told = rules(run[1])[0].local_view.field_of_view
    assert told == pytest.approx(Config().robot.camera_fov_rad, rel=0.25)


@given(st.floats(math.radians(20), math.tau), st.floats(0.0, 0.5))
def test_views_are_shifted_by_the_same_angle_whatever_the_camera(field_of_view: float, turned_rad: float) -> None:
    column, shift = field_of_view / 12, columns_of(turned_rad, 12, field_of_view)
    assert shift * column <= WIDTH_ERROR * turned_rad * (1 + 1e-9)
    assert (shift + 1) * column > WIDTH_ERROR * turned_rad * (1 - 1e-9)


def test_a_recording_in_which_hardly_anything_moves_plays(run: tuple[Session, Held]) -> None:
    """Most views are the same, so only the same view counts as known."""
    about, moments = run[1].about, list(run[1].moments())
    still = Held(about, [dataclasses.replace(m, image=moments[0].image) for m in moments[:200]])
    config, _ = rules(still)
    assert config.local_view.match_threshold == 0.0
    assert sum(1 for _ in Player(still, 1, config).steps()) == 200


def test_a_wide_camera_shifts_by_fewer_columns(run: tuple[Session, Held]) -> None:
    """The office's own camera as in the simulator; one under which half a turn takes as many columns, by half as many."""
    _, recording = run
    turned = [dataclasses.replace(m, yaw_rate=2 * (m.yaw_rate or 0.0)) for m in recording.moments()]
    usual = Config().local_view.shift
    assert rules(recording)[0].local_view.shift == usual
    assert rules(Held(recording.about, turned))[0].local_view.shift == usual // 2


def test_after_a_gap_the_robot_knows_that_it_does_not_know(run: tuple[Session, Held]) -> None:
    """Without wheels: nobody knows how far it was carried while nothing was recorded."""
    blind = [dataclasses.replace(m, speed=None, throttle=0.2) for m in run[1].moments()]
    k = next(k for k in range(200, 400) if abs(blind[k].yaw_rate or 0.0) > 0.2)  # it does not stand
    late = [dataclasses.replace(m, time_s=m.time_s + 5, dt=m.dt + 5 * (i == 0)) for i, m in enumerate(blind[k + 20 :])]
    about = dataclasses.replace(run[1].about, has=frozenset({"camera", "yaw rate", "throttle", "ranges"}))
    lost = [s.brain.experience_map.islands.begun for s in Player(Held(about, blind[:k] + late)).steps()]
    assert lost[k - 1] == 0
    assert lost[k] == 1


def test_who_sees_nothing_is_told_so() -> None:
    moments = [Moment(k, k / 10, 0.1, speed=0.3, yaw_rate=0.0) for k in range(20)]
    with pytest.raises(ValueError, match="neither a camera nor a laser"):
        Player(Held(About("blind", "test", 20, 2.0, frozenset({"speed", "yaw rate"})), moments))


def test_beams_may_be_told_from_either_side() -> None:
    """The same scans, counted from the left: the same estimates."""
    angles = np.radians(np.arange(-90.0, 90.0, 2.0))
    moments = [_scan(k, angles) for k in range(40)]
    has = frozenset({"speed", "yaw rate", "ranges"})
    about = About("room", "test", 40, 40.0, has, beam_angles_rad=tuple(angles.tolist()), range_limit_m=20.0)
    turned = dataclasses.replace(about, beam_angles_rad=about.beam_angles_rad[::-1])
    mirrored = [dataclasses.replace(m, ranges_m=None if m.ranges_m is None else m.ranges_m[::-1]) for m in moments]
    ways = [
        [s.estimate.pose_map_robot for s in Player(Held(*one)).steps()]
        for one in ((about, moments), (turned, mirrored))
    ]
    for a, b in zip(*ways, strict=True):
        assert (a.x, a.y, a.heading_rad) == pytest.approx((b.x, b.y, b.heading_rad), abs=1e-6)


def _scan(k: int, angles: np.ndarray) -> Moment:
    """A room of 8 m x 5 m, in which a robot turns left by 0.1 rad a second and drives 0.1 m."""
    heading, x, y = 0.1 * k, 0.5 * math.sin(0.1 * k), 0.5 * (1 - math.cos(0.1 * k))
    c, s = np.cos(angles + heading), np.sin(angles + heading)
    with np.errstate(divide="ignore"):
        ahead = np.where(c > 0, (4.5 - x) / c, (-3.5 - x) / c)
        aside = np.where(s > 0, (3.0 - y) / s, (-2.0 - y) / s)
    return Moment(
        k,
        float(k),
        1.0,
        speed=0.05 * (k > 0),
        yaw_rate=0.1 * (k > 0),
        ranges_m=np.minimum(np.abs(ahead), np.abs(aside)),
    )
