from __future__ import annotations

import math
import re

import numpy as np
import pytest

from app.config import Config
from app.pilot.behaviours import Behaviour
from app.protocol.steps import spread_goals
from app.session import Session
from app.views.snapshots import senses_of

from .sessions import OFFICE, a_session

pytestmark = pytest.mark.slow

# ---------------------------------------------------------------- the loop


def test_a_tick_is_a_tenth_of_a_second() -> None:
    session = a_session()
    assert (session.tick_count, session.time_s) == (0, 0.0)
    assert session.estimate.created  # it has looked around already
    for tick in range(1, 31):
        session.tick()
        assert (session.tick_count, session.time_s) == (tick, pytest.approx(tick / 10))
    assert session.evaluation.path_m > 0.5


def test_links_remember_what_the_pilot_was_doing() -> None:
    session = a_session()
    learnt: dict[tuple[int, int], int] = {}
    for _ in range(400):
        before = session.brain.experience_map.link_count
        session.tick()
        if session.brain.experience_map.link_count > before:
            i, j = session.brain.experience_map.links[-1]
            learnt[int(i), int(j)] = session.pilot.behaviour.number
    map_ = session.brain.experience_map
    assert {(int(i), int(j)): int(b) for (i, j), b in zip(map_.links, map_.behaviours, strict=True)} == learnt
    assert set(learnt.values()) >= {Behaviour.FOLLOWING_THE_WALL.number, Behaviour.LOOKING_BACK.number}
    session.set_mode("manual")
    session.tick()
    assert session.pilot.behaviour is Behaviour.WAITING
    session.pilot.drive(0.1, 0.0)
    session.tick()
    assert session.pilot.behaviour is Behaviour.DRIVEN_BY_HAND


@pytest.mark.parametrize("front_end", ["complex cells", "hue and saturation", "scene numbers"])
def test_each_front_end_maps_the_office(front_end: str) -> None:
    """Known places are recognised and nothing is far off; the picture shows what the front end sees."""
    session = a_session(1200, config=Config().with_value("local_view.front_end", front_end))
    map_error, _ = session.evaluation.errors(session.brain.experience_map)
    assert map_error < 1.5
    assert len(session.brain.experience_map) > 100
    assert session.brain.experience_map.closures > 0
    senses = senses_of(session)
    assert senses.front_end == front_end
    assert senses.best is not None
    assert senses.seen.shape[2:] == senses.best.shape[2:] == ((3,) if front_end == "hue and saturation" else ())
    assert senses.threshold == session.brain.local_view.threshold
    if front_end == "scene numbers":
        assert senses.seen_words == f"scene {session.frame.scene}"


def test_the_true_pose_stays_out_of_a_brain_that_sees_images(monkeypatch: pytest.MonkeyPatch) -> None:
    for front_end in ("template", "scene numbers"):
        session, told = a_session(5, config=Config().with_value("local_view.front_end", front_end)), list[int | None]()

        def step(*args: object, plain=session.brain.step, told=told, **named: object) -> object:
            told.append(named["scene"])  # type: ignore[arg-type]
            return plain(*args, **named)

        monkeypatch.setattr(session.brain, "step", step)
        session.tick()
        assert told == [session.frame.scene if front_end == "scene numbers" else None]


# ---------------------------------------------------------------- orders


def test_a_goal_is_the_nearest_experience() -> None:
    session = a_session(100)
    poses = session.brain.experience_map.poses
    for x, y in ((0.0, 0.0), (1.0, 0.2), tuple(poses[-1, :2] + 0.3)):
        goal = session.set_goal(float(x), float(y))
        assert goal == np.argmin(np.hypot(poses[:, 0] - x, poses[:, 1] - y))
        assert session.pilot.goal == goal
        assert session.pilot.mode == "goal"


def test_a_goal_off_the_map_is_refused_and_how_far_off_it_may_be_can_be_set() -> None:
    session = a_session(50)
    for place in ((40.0, 0.0), (0.0, -30.0), (math.nan, 0.0), (0.0, math.inf)):
        with pytest.raises(
            ValueError, match=r"is off the map: the nearest experience is .* m away, at \(.*\); choose a place"
        ):
            session.set_goal(*place)
        assert (session.pilot.goal, session.pilot.mode) == (None, "explore")
    x, y = session.brain.experience_map.poses[:, :2].min(axis=0) - 2.0
    with pytest.raises(ValueError, match=r"choose a place within 1\.5 m of one"):
        session.set_goal(x, y)
    x, y = session.brain.experience_map.poses[0, :2]
    session.set_goal(x - 1.0, y - 1.0)
    assert session.pilot.mode == "goal"


def test_a_kidnap_moves_the_robot_and_tells_nobody() -> None:
    session, places = a_session(50), set[tuple[float, float]]()
    believed = session.brain.experience_map.robot
    session.kidnap(7.0, 7.4, 1.0)
    truth = session.simulator.truth
    assert (truth.x, truth.y, truth.heading_rad) == pytest.approx((7.0, 7.4, 1.0))
    assert session.brain.experience_map.robot == believed
    assert session.frame.odometry_speed == 0.0
    assert [k.at_s for k in session.evaluation.kidnaps] == [5.0]
    session.kidnap(9.0, 1.0)
    assert session.simulator.truth.heading_rad == pytest.approx(1.0)  # kept
    for _ in range(5):
        session.kidnap()
        truth = session.simulator.truth
        assert session.simulator.free_space.is_free(truth.x, truth.y)
        places.add((truth.x, truth.y))
    assert len(places) == 5
    session.kidnap(heading_rad=0.5)
    assert session.simulator.truth.heading_rad == pytest.approx(0.5)
    session.tick()


def test_a_kidnap_or_parameter_that_cannot_be_changes_nothing(subtests: pytest.Subtests) -> None:
    session = a_session(20)
    config, before = session.config, session.state_hash()
    kidnaps = [
        ((5.0, 0.1, 0.0), "from walls[0] (wall); the robot needs 0.22 m"),
        ((11.0, 4.0, 0.0), "is outside of office"),
        ((math.nan, 4.0, 0.0), "is not a place"),
        ((5.0, 4.0, math.inf), "heading must be finite"),
        ((5.0, None, 0.0), "a kidnap needs both x and y, or neither"),
        ((None, 5.0, None), "a kidnap needs both x and y, or neither"),
    ]
    parameters = [
        (("pilot.cruise", 0.2), "unknown parameter 'pilot.cruise'; expected one of: pilot.cruise_speed"),
        (("nothing", 1), "unknown parameter 'nothing'"),
        (("pilot.cruise_speed", 3.0), "pilot.cruise_speed must be between 0.05 and 0.5 m/s, got 3.0"),
        (("pilot.cruise_speed", "fast"), "pilot.cruise_speed must be a number, got 'fast'"),
        (("local_view.facing", 1), "local_view.facing must be true or false, got 1"),
        (("robot.light", math.nan), "robot.light must be between 0.1 and 2, got nan"),
    ]
    for give, rows in ((session.kidnap, kidnaps), (session.set_parameter, parameters)):
        for values, reason in rows:
            with subtests.test(str(values)):
                with pytest.raises(ValueError, match=re.escape(reason)):
                    give(*values)
                assert session.state_hash() == before
                assert session.config is config
                assert session.evaluation.kidnaps == []


def test_live_parameters_act_at_once_others_wait() -> None:
    session = a_session(10)
    brain = session.brain

    def act() -> list[float]:
        return [
            brain.local_view.params.match_threshold, brain.experience_map.params.sweeps, brain.pose_cells.params.inhibit,
            session.simulator.params.light, session.pilot.params.cruise_speed,
        ]  # fmt: skip

    names = (
        "local_view.match_threshold",
        "experience_map.sweeps",
        "pose_cells.inhibit",
        "robot.light",
        "pilot.cruise_speed",
    )
    assert all(session.set_parameter(name, value) for name, value in zip(names, (9, 3, 5e-4, 0.7, 0.2), strict=True))
    assert act() == [9.0, 3, 5e-4, 0.7, 0.2]
    assert not session.set_parameter("pose_cells.n_x", 32)
    assert brain.pose_cells.shape == (36, 64, 64)
    assert session.config.pose_cells.n_x == 32
    assert session.set_parameter("pose_cells.inhibit", 4e-4)  # though another waits
    assert session.set_parameter("robot.light", 0.8)
    assert act() == [9.0, 3, 4e-4, 0.8, 0.2]
    session.tick()
    anew = Session(OFFICE, 3, session.config)
    assert anew.brain.pose_cells.shape == (36, 64, 32)
    assert anew.brain.local_view.params.match_threshold == 9.0


def test_goals_are_spread_over_the_map() -> None:
    session = a_session(600)
    poses = session.brain.experience_map.poses[:, :2]
    goals, robot = spread_goals(session, 4), session.brain.experience_map.robot
    assert len(set(goals)) == 4
    known = [np.array([robot.x, robot.y])]
    for goal in goals:
        away = np.min([np.hypot(*(poses - place).T) for place in known], axis=0)
        assert away[goal] == away.max()
        known.append(poses[goal])
    assert (spread_goals(session, 0), spread_goals(a_session(), 5)) == ([], [0])
