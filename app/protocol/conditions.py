"""What is waited for: the first closed loop, the robot found again, so many packets ... For lessons and for `run_until`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import takewhile
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, ValidationError, model_validator

from app.protocol.measures import Packets
from app.protocol.steps import Metres, Part, Where, place_of

if TYPE_CHECKING:
    from app.session import Session
    from app.views.history import History
    from web.messages import Event

What = Literal["closure", "snap", "lost", "found again", "packets", "goal reached", "place", "explored"]


class Until(Part):
    """What is waited for. count: of packets; place: of the office, by name or (x, y); the robot comes within `within_m`."""

    what: What
    count: Annotated[int, Field(ge=2, le=9)] = 2
    place: Where | None = None
    within_m: Metres = 0.5

    @model_validator(mode="after")
    def _place_given(self) -> Until:
        if (self.what == "place") != (self.place is not None):
            raise ValueError('"place" goes with place = a name or [x, y] in metres, and nothing else does')
        return self

    @property
    def words(self) -> str:
        """As in "until ..."."""
        where = self.place if isinstance(self.place, str) else "the place"
        return {
            "closure": "a loop closes",
            "snap": "the winner snaps",
            "lost": "the robot is lost",
            "found again": "the robot has recovered",
            "packets": f"{self.count} packets compete",
            "goal reached": "the goal is reached",
            "place": f"the robot comes to {where}",
            "explored": "everything is explored",
        }[self.what]


def read_until(values: dict[str, object]) -> Until:
    """ValueError says in a sentence what is wrong."""
    try:
        return Until.model_validate(values)
    except ValidationError as error:
        raise ValueError(error.errors()[0]["msg"].removeprefix("Value error, ")) from None


class Waiting:
    """Whether what is waited for has happened since this was made. Call `met` after each tick."""

    def __init__(self, until: Until, session: Session, history: History) -> None:
        """ValueError: it cannot happen, as things are."""
        self.until, self._session, self._history = until, session, history
        self._events = history.log.events[-1].number if history.log.events else 0
        self._place = None if until.place is None else place_of(session.world, until.place)
        if until.what == "found again" and not self._unresolved:
            raise ValueError("nobody has carried the robot away, or it has found itself again already: kidnap it first")
        if until.what == "goal reached" and session.pilot.goal_state is None:
            raise ValueError("the robot has no goal: give it one first")
        if until.what == "explored" and not session.config.pilot.seek:
            raise ValueError("this robot explores by chance and cannot tell: switch pilot.seek on first")

    def met(self) -> bool:
        """[ours] test_run_until.py, test_lessons_in_engine.py."""
        session, what = self._session, self.until.what
        if what in ("closure", "snap"):
            return any(event.kind == what for event in self._new_events())
        if what == "lost":
            from app.session import is_lost

            return is_lost(session)
        if what == "found again":
            return not self._unresolved
        if what == "packets":
            return sum(packet.mass >= Packets.LEAST for packet in session.brain.pose_cells.packets) >= self.until.count
        if what == "goal reached":
            state = session.pilot.goal_state
            return state is not None and state[1] == "arrived"
        if what == "explored":
            return session.pilot.explored
        truth = session.simulator.truth
        assert self._place is not None
        return math.dist((truth.x, truth.y), self._place) <= self.until.within_m

    @property
    def _unresolved(self) -> bool:
        kidnaps = self._session.evaluation.kidnaps
        return bool(kidnaps) and kidnaps[-1].after_s is None

    def _new_events(self) -> Iterator[Event]:
        return takewhile(lambda event: event.number > self._events, reversed(self._history.log.events))
