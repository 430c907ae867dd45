"""One goal: sending the robot there, and judging by truth whether it came there."""

from __future__ import annotations

import math
from dataclasses import dataclass

from app.headless.loop import Loop
from app.session import Session

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
