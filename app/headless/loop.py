"""The ticks of a run without a server, and what is kept of them for its report: how it grows, how sure the robot is of its
place and whether it is right to be; and sending it to a goal, judged by the truth."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.headless.report import BrainFile, Growth
from app.session import Session

EVERY = 10  # ticks


class Uncertainty:
    """Call `note` after each tick."""

    def __init__(self) -> None:
        self._sigma_m, self._off_m = array("d"), array("d")
        self._ticks = self._lost = 0

    def note(self, session: Session) -> None:
        self._ticks += 1
        self._lost += session.brain.lost
        sigma_m = session.brain.experience_map.off_m
        if not math.isfinite(sigma_m) or session.brain.carried or session.tick_count % EVERY:
            return
        self._sigma_m.append(sigma_m)
        self._off_m.append(session.evaluation.belief_off(session.simulator.truth, session.brain.experience_map)[0])

    def report(self) -> dict[str, Any]:
        """The robot's own sigma (m) while it was not lost, and the share of the time in which it was right to two
        sigma; None without a belief that has one. And the share of the ticks in which it held itself to be lost."""
        sigma, off = np.array(self._sigma_m), np.array(self._off_m)
        judged = np.isfinite(off)
        right = float(np.mean(off[judged] <= 2 * sigma[judged])) if judged.any() else math.nan
        return {
            "median_m": _rounded(float(np.median(sigma))) if sigma.size else None,
            "most_m": _rounded(float(sigma.max())) if sigma.size else None,
            "within_two_sigma": _rounded(right),
            "lost_share": _rounded(self._lost / max(self._ticks, 1)),
        }


def _rounded(value: float) -> float | None:
    return round(value, 4) if math.isfinite(value) else None


LOOK_AFTER = 600  # ticks between two checks of the brain's size
TELL_AFTER = 10  # ticks between two calls of `progress`

Progress = Callable[[float, str], None]  # simulated seconds since the last call, what is being done


def silent(_simulated_s: float, _what: str) -> None:
    """Progress that nobody follows."""


class Loop:
    """Ticks a session."""

    def __init__(self, session: Session, progress: Progress = silent, brain_file: BrainFile | None = None) -> None:
        """brain_file: is shown the brain now and then."""
        self.session, self._progress, self._brain_file = session, progress, brain_file
        self.growth, self.uncertainty = Growth(session), Uncertainty()

    def tick(self, what: str) -> None:
        """One tick. what: is being done, in words."""
        session = self.session
        session.tick()
        self.growth.note(session)
        self.uncertainty.note(session)
        if session.tick_count % TELL_AFTER == 0:
            self._progress(TELL_AFTER * session.frame.dt, what)
        if self._brain_file is not None and session.tick_count % LOOK_AFTER == 0:
            self._brain_file.look(session.brain)

    def explore(self, minutes: float, kidnap_at_s: Sequence[float] = ()) -> None:
        """Explore for so many simulated minutes. kidnap_at_s: simulated times (s) at which the robot is kidnapped."""
        session, kidnaps = self.session, sorted(kidnap_at_s)
        for _ in range(round(minutes * 60 / session.frame.dt)):
            while kidnaps and session.time_s >= kidnaps[0] - 1e-9:
                session.kidnap()
                kidnaps.pop(0)
            self.tick("exploring")


NEAR_ENOUGH_M = 1.0


@dataclass(frozen=True, slots=True)
class Visit:
    """How a visit ended."""

    goal: int  # experience
    began_s: float
    time_s: float
    path_m: float
    shortest_m: float  # from where it began; inf if there is no way
    miss_m: float  # between the robot and where the goal was made
    state: str  # of the goal, as the robot says it
    timeout_s: float

    @property
    def reached(self) -> bool:
        """The robot says that it has arrived, and truly is near."""
        return self.state == "arrived" and self.miss_m <= NEAR_ENOUGH_M

    @property
    def reason(self) -> str:
        """Why it is a failure, in words; empty if it is none."""
        if self.reached:
            return ""
        if self.state == "arrived":
            return f"arrived {self.miss_m:.2f} m away"
        unknown = " and says that it knows no way" if self.state == "unreachable" else ""
        return f"not reached in {self.timeout_s:g} s: it is {self.miss_m:.2f} m away{unknown}"


def visit(loop: Loop, goal: int, place: tuple[float, float], timeout_s: float, what: str) -> Visit:
    """Send the robot to an experience that was made at `place` (m, office frame). what: is being done, in words."""
    session = loop.session
    shortest_m = session.simulator.free_space.shortest_m(_here(session), place)
    began_s, began_m = session.time_s, session.evaluation.path_m
    session.go_to(goal)
    while session.pilot.goal_state != (goal, "arrived") and session.time_s - began_s < timeout_s - 1e-9:
        loop.tick(what)
    _, state = session.pilot.goal_state or (goal, "given up")
    return Visit(
        goal, began_s, session.time_s - began_s, session.evaluation.path_m - began_m, shortest_m,
        math.dist(_here(session), place), state, timeout_s,
    )  # fmt: skip


def _here(session: Session) -> tuple[float, float]:
    truth = session.simulator.truth
    return truth.x, truth.y
