"""What experiments measure: each from a run in which the right answer is known."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from app.config import Config, Value
from app.protocol.course import Course, run_ticks
from app.protocol.measures import MEASURES, Measuring, Packets, measures_for
from app.protocol.steps import Drive, Explore, Kidnap, Move, Step, Tag, Visit, Wait, Where
from app.session import Session
from sim2d import load_world

pytestmark = pytest.mark.slow

IDEAL: dict[str, Value] = {"robot.odometry_noise": 0.0, "robot.gyro_bias": 0.0, "robot.odometry_scale_error": 0.0}
EVERYTHING = [name for kind in MEASURES for name in kind.readings if "_N_" not in name]
LAPS: list[Where] = ["south-east corner", "north-east corner", "north-west corner", "south-west corner"]


def measured(
    names: list[str], *steps: Step, world: str = "loop", seed: int = 5, **values: Value
) -> tuple[dict[str, float], Course]:
    config = Config().with_values({**IDEAL, **{name.replace("__", "."): value for name, value in values.items()}})
    course = Course(Session(load_world(world), seed, config), steps)
    measuring = Measuring(course, [kind for kind in MEASURES if kind.always or kind in measures_for(names)])
    run_ticks(course, course.ticks(), [measuring.note])
    return measuring.values(), course


def test_measuring_changes_nothing_and_scores_are_those_of_the_judges() -> None:
    steps = Explore(do="explore", minutes=0.5), Kidnap(do="kidnap"), Explore(do="explore", minutes=0.5)
    (scores, alone), (_, with_all) = measured([], *steps), measured(EVERYTHING, *steps)
    assert alone.session.state_hash() == with_all.session.state_hash()
    evaluation = alone.session.evaluation
    assert scores["kidnaps"] == 1.0
    assert scores["recovered"] == float(evaluation.kidnaps[0].after_s is not None)
    assert scores["error_m"] == evaluation.errors(alone.session.brain.experience_map)[0]
    assert (scores["goals"], scores["goal_s"]) == (0.0, math.inf)


def test_without_errors_the_packet_ends_where_the_moves_lead() -> None:
    square = Move(do="move", moves=[(0.2, 0, 5), (0, 45, 2), (0.2, 0, 5), (0, -45, 2)])
    scores, _ = measured(["end_off_m"], square, local_view__enabled=False)
    assert scores["end_off_m"] < 0.1
    off, _ = measured(["end_off_m"], square, local_view__enabled=False, robot__odometry_scale_error=0.5)
    assert off["end_off_m"] == pytest.approx(0.5 * math.hypot(1.0, 1.0), abs=0.3)  # less what the attractor takes back


def test_the_turn_of_the_cells_is_that_of_the_robot_less_the_bias() -> None:
    turn = Move(do="move", moves=[(0, 30, 10)])
    right, _ = measured(["turn_kept"], turn, local_view__enabled=False)
    assert right["turned_deg"] == pytest.approx(300, abs=5)
    assert right["turn_kept"] == pytest.approx(1.0, abs=0.03)
    biased, _ = measured(["turn_kept"], turn, local_view__enabled=False, pose_cells__yaw_bias=-math.radians(6))
    assert biased["turn_kept"] == pytest.approx(0.8, abs=0.03)


def test_a_robot_that_drove_everywhere_has_covered_the_floor() -> None:
    ways = [Drive(do="drive", path=path) for path in (LAPS[:2], [*LAPS, "home"])]
    standing = Move(do="move", moves=[(0, 10, 1)])
    none, half, full = (measured(["covered"], way)[0]["covered"] for way in (standing, *ways))
    assert none < half < full
    assert full > 0.95


def test_ways_out_and_back_lie_together_where_the_map_is_right() -> None:
    there_and_back = Drive(do="drive", path=["south-east corner", "north-east corner", "south-east corner", "home"])
    scores, course = measured(["ways_apart_m"], there_and_back)
    assert 0.0 < scores["ways_apart_m"] < 0.6
    map_ = course.session.brain.experience_map
    made = course.session.evaluation.births(len(map_))
    pairs = [
        math.dist(map_.poses[i, :2], map_.poses[j, :2])
        for i in range(len(map_))
        for j in range(i)
        if math.dist(made[i, :2], made[j, :2]) < 0.5
        and abs(math.remainder(made[i, 2] - made[j, 2], math.tau)) > 2.5
    ]  # fmt: skip
    assert scores["ways_apart_m"] == pytest.approx(float(np.mean(pairs)))
    assert scores["ways_apart_at_most_m"] == pytest.approx(max(pairs))


def test_of_a_visit_the_way_taken_the_arbitration_and_the_routes_of_the_goal_memory_are_measured() -> None:
    """The way is that of the last visit; the chosen movement ends nearer to the route than the others; and the routes stay when
    a weight changes by a fifth."""
    scores, course = measured(
        ["chosen_off_m", "route_off_m"],
        Tag(do="tag", places=["north-east corner", "south-west corner"]),
        Drive(do="drive", path=[*LAPS, *LAPS, *LAPS[:2]]),
        Visit(do="visit", places=["north-east corner", "south-west corner"], timeout_s=120),
        seed=1,
    )
    path = course.session.evaluation.path[round(course.visits[-1].began_s * 10) :, 1]
    middle = sum(course.session.world.bounds[1::2]) / 2
    assert scores["lower_way"] == pytest.approx(np.mean(path < middle))
    assert 0 < scores["lower_way"] < 1
    assert scores["chosen_off_m"] < scores["others_off_m"]
    assert scores["route_cells"] > 3
    assert scores["route_off_m"] < 0.5


def test_consistency_is_the_longest_time_off() -> None:
    drive = Drive(do="drive", path=LAPS)
    right, _ = measured(["longest_off_s"], drive)
    assert (right["longest_off_s"], right["farthest_off_m"]) == (0.0, 0.0)
    carried = Kidnap(do="kidnap", place="north-west corner", heading_deg=-90)
    wrong, _ = measured(["longest_off_s"], drive, carried, Move(do="move", moves=[(0, 0, 3)]), kidnap__enabled=False,
                        local_view__enabled=False)  # fmt: skip
    assert wrong["longest_off_s"] == pytest.approx(3.0, abs=0.15)
    assert wrong["farthest_off_m"] == pytest.approx(4.5, abs=0.4)


def test_false_and_true_snaps_are_all_snaps() -> None:
    """Where a single look moves the packet, and it was carried unseen, it jumps often."""
    eager: dict[str, Any] = {"local_view__learning_rate": 0.15, "local_view__saturation": 0.02, "local_view__rest": 0.0}
    explore, carried = Explore(do="explore", minutes=6), Kidnap(do="kidnap", least_m=3)
    scores, course = measured(
        ["false_snaps"], explore, carried, explore, world="office", seed=2, kidnap__enabled=False, **eager
    )
    assert 1 <= scores["false_snaps"] + scores["true_snaps"] <= course.session.brain.relocalisations


def told(packets: Measuring) -> tuple[float, float, float]:
    values = packets.values()
    return values["packets_at_most"], values["packets_most"], values["rival_s"]


def test_packets_are_counted_while_they_compete() -> None:
    """A second packet of a third of the activity is put far away, and taken away after a second."""
    course = Course(Session(load_world("loop"), 3, Config()), [Wait(do="wait", seconds=3.0)])
    session, packets = course.session, Measuring(course, [Packets])
    cells = session.brain.pose_cells
    for _ in range(10):
        session.tick()
        packets.note()
    assert told(packets) == (1.0, 1.0, 0.0)
    _, n_y, n_x = cells.shape
    here = cells.winner
    far = np.array([(round(here.y) + n_y // 2) % n_y * n_x + (round(here.x) + n_x // 2) % n_x], np.int32)
    cells.inject(far, np.array([0.5], np.float32))
    cells.settle()
    for _ in range(2):
        packets.note()
        assert told(packets) == (2.0, 2.0, pytest.approx(session.frame.dt))
        cells.place(round(here.x) % n_x, round(here.y) % n_y, 0)
