"""The two sentences, of the robot and of its goal, over all that can be: they never contradict each other."""

from __future__ import annotations

from itertools import product
from typing import Any, Literal, get_args

import numpy as np
import pytest

from web.messages import Goal, GoalState
from web.messages.robot_status import Facts, goal_meaning, goal_status, robot_status

STATES: tuple[GoalState, ...] = get_args(GoalState)
MODES: tuple[Literal["explore", "manual", "goal", "recorded"], ...] = ("explore", "manual", "goal", "recorded")
FLAGS = ("lost", "running", "past", "faulty", "over", "played_ahead")


def a_goal(
    state: GoalState, eta_s: float | None = 61.4, remaining_m: float | None = 12.34, *, lost: bool = False,
    followed: bool = True,
) -> Goal:  # fmt: skip
    nothing: Any = np.zeros((0, 2), np.float32)
    return Goal(7, 1.0, 2.0, state, eta_s, remaining_m, nothing, nothing[:, 0], lost=lost, followed=followed)


def test_the_robot_and_its_goal_never_contradict_each_other() -> None:
    """One walk over the product of the facts."""
    flags = [dict(zip(FLAGS, on, strict=True)) for on in product((False, True), repeat=len(FLAGS))]
    for packets, mode, state, on in product((1, 2), MODES, (None, *STATES), flags):
        facts = Facts(packets=packets, mode=mode, goal=state, **on)
        robot = robot_status(facts)
        stands_still = facts.past or facts.faulty or facts.over or not facts.running
        tells_of_something_else = facts.past or facts.faulty or facts.over or (facts.played_ahead and not facts.running)
        assert ("lost" in robot.words) is (facts.lost and not tells_of_something_else)
        if state is None:
            assert "goal" not in robot.words
            continue
        goal = goal_status(a_goal(state, lost=facts.lost, followed=mode == "goal"))
        if facts.lost:  # it knows neither that it is there nor that no way leads there
            assert goal.short not in ("arrived", "no route", "no route yet")
            assert goal.words not in ("at the goal", "no route to the goal", "looking for a route", "going to the goal")
        if mode != "goal" and state != "arrived":  # nobody goes there
            assert goal.words == "the goal waits"
        if mode == "goal" and not facts.lost and not stands_still:  # one state, worded once
            assert robot.words == goal.words
        assert bool(goal.metres) is bool(goal.seconds)
        assert not goal.metres or "arrived" not in goal.short


def test_each_meaning_has_words_of_its_own() -> None:
    cases = list(product(STATES, (False, True), (False, True)))
    meanings = {goal_meaning(state, lost=lost, followed=followed) for state, lost, followed in cases}
    words = {goal_status(a_goal(state, lost=lost, followed=followed)).words for state, lost, followed in cases}
    assert len(words) == len(meanings) == len(STATES) + 4


LOST: dict[str, Any] = {"lost": True, "goal": "tracking", "mode": "goal"}


@pytest.mark.parametrize(
    ("facts", "words"),
    [
        (Facts(**LOST, past=True, faulty=True), "the past, played"),
        (Facts(**LOST, faulty=True), "in a long tick"),
        (Facts(**LOST, faulty=True, running=False), "stopped by a fault"),
        (Facts(**LOST, running=False), "paused; lost"),
        (Facts(odds=40.4, running=False), "paused; believes it is here, 40:1"),
        (Facts(running=False), "paused"),
        (Facts(**LOST, running=False, played_ahead=True), "playing up to a moment"),
        (Facts(**LOST, packets=2), "lost: 2 packets"),
        (Facts(mode="manual", goal="tracking"), "driving by hand"),
        (Facts(mode="recorded"), "playing a recording"),
        (Facts(mode="recorded", running=False, over=True), "the recording has ended"),
        (Facts(goal="tracking"), "exploring"),
        (Facts(odds=40.4), "believes it is here, 40:1"),
        (Facts(odds=1e6), "believes it is here, over 1000:1"),
    ],
)
def test_what_counts_most_is_said(facts: Facts, words: str) -> None:
    assert robot_status(facts).words == words


@pytest.mark.parametrize(
    ("goal", "metres", "seconds"),
    [
        (a_goal("tracking"), "12.3 m", "61 s"),
        (a_goal("tracking", 3600.0, 100.0), "100 m", "60 min"),
        (a_goal("coasting", None, None), "", ""),
        (a_goal("tracking", 119.4, 99.96), "100.0 m", "119 s"),
        (a_goal("arrived", 0.0, 0.0), "", ""),
        (a_goal("arrived", 0.0, 0.0, lost=True), "", ""),
        (a_goal("unreachable"), "", ""),
    ],
)
def test_how_far_and_how_long_is_told_while_there_is_a_way_to_go(goal: Goal, metres: str, seconds: str) -> None:
    status = goal_status(goal)
    assert (status.metres, status.seconds) == (metres, seconds)
