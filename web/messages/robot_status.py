"""What the robot does and how it stands with its goal, in words: the one place where both are worded.

Header, flag, panel, events and what is read aloud take their words from here, so that none can contradict another. A robot
that is lost does not know where it is: it has not arrived, it believes to have; and no way is missing before it knows from
where. A goal to which nobody drives waits. tests/unit/web/test_robot_status.py goes through all facts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from web.messages.brain import Goal, GoalState

GoalMeaning = Literal[
    "tracking", "coasting", "exploring", "arrived", "unreachable",  # what the pilot says, where it can be believed
    "trusting", "believed", "finding itself",  # the same said by a robot that is lost
    "waiting",
]  # fmt: skip
Tone = Literal["", "good", "bad", "past", "lost", "hand", "goal"]


@dataclass(frozen=True, slots=True)
class Chip:
    icon: str
    tone: Tone
    words: str


@dataclass(frozen=True, slots=True)
class GoalChip:
    icon: str
    words: str
    short: str  # for a chip and a flag
    metres: str  # to go; "" where nothing is known of it, as of `seconds`
    seconds: str


@dataclass(frozen=True, slots=True)
class Facts:
    """What the robot's sentence is made of, and the goal's."""

    lost: bool = False  # the robot was carried and believes no place, or packets compete
    packets: int = 1
    places: int = 0  # where a robot that was carried may be
    odds: float | None = None  # of where it believes itself to be, as long as the maps are not merged
    mode: Literal["explore", "manual", "goal", "recorded"] = "explore"
    goal: GoalState | None = None
    running: bool = True
    past: bool = False  # a moment of the past is shown
    faulty: bool = False
    over: bool = False  # the recording has ended
    played_ahead: bool = False  # it plays up to a moment that somebody shared


# meaning: icon, sentence, short
_GOALS: dict[GoalMeaning, tuple[str, str, str]] = {
    "tracking": ("flag", "going to the goal", "goal"),
    "coasting": ("flag", "by dead reckoning", "goal"),
    "exploring": ("compass", "looking for a route", "no route yet"),
    "arrived": ("check", "at the goal", "arrived"),
    "unreachable": ("warn", "no route to the goal", "no route"),
    "trusting": ("flag", "going where it believes the goal to be", "goal?"),
    "believed": ("lost", "believes to be at the goal", "arrived?"),
    "finding itself": ("lost", "relocalises before it goes on to the goal", "waits"),
    "waiting": ("flag", "the goal waits", "waits"),
}
_LOST: dict[GoalState, GoalMeaning] = {
    "tracking": "trusting", "coasting": "trusting", "arrived": "believed",
    "exploring": "finding itself", "unreachable": "finding itself",
}  # fmt: skip


def goal_meaning(state: GoalState, *, lost: bool, followed: bool) -> GoalMeaning:
    """followed: whether the robot is on its way to the goal now, not driven by hand or exploring."""
    if not followed and state != "arrived":
        return "waiting"
    return _LOST[state] if lost else state


def robot_status(facts: Facts) -> Chip:
    """What the robot does, or why it does not: what counts most."""
    if facts.past:
        return Chip("clock", "past", "the past, played" if facts.running else "the past")
    if facts.faulty:
        return Chip("warn", "bad", "in a long tick" if facts.running else "stopped by a fault")
    if facts.over:
        return Chip("check", "", "the recording has ended")
    if not facts.running:
        if facts.played_ahead:
            return Chip("play", "good", "playing up to a moment")
        return Chip("pause", "", "; ".join(filter(None, ("paused", _lost(facts) or _believes(facts)))))
    if lost := _lost(facts):
        return Chip("lost", "lost", lost)
    if facts.mode in ("explore", "recorded") and (believes := _believes(facts)):
        return Chip("compass", "good", believes)
    if facts.mode == "recorded":
        return Chip("play", "good", "playing a recording")
    if facts.mode == "manual":
        return Chip("hand", "hand", "driving by hand")
    if facts.mode == "goal" and facts.goal is not None:
        icon, words, _ = _GOALS[facts.goal]
        return Chip(icon, "bad" if facts.goal == "unreachable" else "goal", words)
    return Chip("compass", "good", "exploring")


def goal_status(goal: Goal) -> GoalChip:
    """How it stands with the goal."""
    meaning = goal_meaning(goal.state, lost=goal.lost, followed=goal.followed)
    icon, words, short = _GOALS[meaning]
    ahead = meaning in ("tracking", "coasting", "trusting", "waiting")
    metres = "" if not ahead or goal.remaining_m is None else f"{goal.remaining_m:.{int(goal.remaining_m < 100)}f} m"
    known = ahead and goal.eta_s is not None and math.isfinite(goal.eta_s)
    return GoalChip(icon, words, short, metres, seconds_words(goal.eta_s) if known and goal.eta_s is not None else "")


def _believes(facts: Facts) -> str:
    return "" if facts.odds is None else f"believes it is here, {odds_words(facts.odds)}"


def _lost(facts: Facts) -> str:
    if not facts.lost:
        return ""
    if facts.places:
        return "lost: one place is possible" if facts.places == 1 else f"lost: {facts.places} places possible"
    return f"lost: {facts.packets} packets" if facts.packets > 1 else "lost"


def odds_words(odds: float) -> str:
    """40:1, or more than a thousand to one."""
    return f"{odds:.0f}:1" if odds < 1000 else "over 1000:1"


def packet_words(number: int, mass: float, alone: bool) -> str:
    """Its number, and its part of the activity where it has rivals. A packet alone has all of it, and may be wrong."""
    return f"packet {number}" if alone else f"{number}: {share_words(mass)}"


def share_words(share: float) -> str:
    """12 %, or less than one."""
    return f"{100 * share:.0f} %" if share >= 0.01 else "< 1 %"


def seconds_words(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"
