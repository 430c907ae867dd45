"""The replay of a situation that was opened: its orders are given at their ticks, and noted on the timeline, up to its moment;
there the hashes are compared."""

from __future__ import annotations

from functools import partial

from app.engine.supervisor import Supervisor
from app.orders import Order, carry_out
from app.run_record.record import replay
from app.run_record.situation import Situation
from app.session import Session
from app.views.events import EventLog
from app.views.office import goal_view
from web.messages import EventKind, SituationState, SituationView

_OFFICE = {
    "set_door": "door {name} told to move", "set_lamp": "lamp {name} switched", "put_box": "a box put down",
    "remove_box": "box {name} taken away", "edit_world": "edited",
}  # fmt: skip


def events_of(order: Order, session: Session) -> list[tuple[EventKind, str]]:
    """Kinds and words; none for an order that is seen anyway. The session has just carried it out."""
    name, values = order.name, order.values
    if name == "kidnap":
        return [("kidnap", "carried away without being told")]
    if name in ("set_goal", "go_to_place_of", "go_to", "go_to_tag"):
        goal = goal_view(session)
        return [] if goal is None else [("goal", f"to experience {goal.experience}")]
    if name == "tag":
        return [("place", f"{values['name']} is here")]
    if name == "set_parameters":
        return [("parameter", f"{parameter} = {value}") for parameter, value in values["values"].items()]
    if name == "put_packet":
        return [("packet", f"a packet put at cell ({values['x']}, {values['y']}) by hand")]
    return [("office", _OFFICE[name].format_map(values))] if name in _OFFICE else []


def _give(log: EventLog, session: Session, order: Order) -> None:
    carry_out(session, order)
    for kind, words in events_of(order, session):
        log.note(kind, words)


def _by_the_run(_session: Session, _watch: object) -> None:
    """The run that is open runs the ticks."""


class SituationReplay(Supervisor):
    """Call `after_tick` at the beginning and after each tick."""

    def __init__(self, situation: Situation, session: Session, log: EventLog) -> None:
        self.situation = situation
        self.state: SituationState = "playing"
        self._words = ""
        self._session, self._log = session, log
        give = partial(_give, log)
        self._replay = replay(session, situation.orders_after, situation.tick, give=give, tick=_by_the_run)
        next(self._replay)

    def after_tick(self) -> None:
        """Give the orders of the tick that has just been run; at the moment, see whether it is the same."""
        if self.state != "playing":
            return
        try:
            if next(self._replay, None) is not None:
                return
        except ValueError as error:
            self.stop(str(error))
            self._log.note("warning", self._words)
            return
        same, self._words = self.situation.verdict(self._session)
        self.state = "same" if same else "other"
        if not same:
            self._log.note("warning", self._words)

    @property
    def runs_ahead(self) -> bool:
        return self.state == "playing"

    def stop_running_ahead(self) -> None:
        self.stop("it was stopped")

    def stop(self, why: str) -> None:
        """It does not come to its moment."""
        if self.state == "playing":
            self.state = "stopped"
            self._words = f"Stopped at tick {self._session.tick_count} of {self.situation.tick}: {why}"

    def view(self) -> SituationView:
        situation, done = self.situation, self._session.tick_count
        return SituationView(
            self.state, min(done, situation.tick), situation.tick, self._words, situation.state_hash, situation.look
        )
