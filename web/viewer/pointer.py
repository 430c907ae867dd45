"""What people do with the pointer on the plates: a click on the map sets a goal, a drag of the robot kidnaps it.

`Pointer` runs in the viewer's own thread; viser's callbacks only post to it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Literal

import numpy as np

from web.messages import (
    Accepted,
    Closure,
    Command,
    Inspect,
    Kidnap,
    KnownPlace,
    Refused,
    RunUntil,
    SetDoor,
    SetGoal,
    SetMode,
    Snapshot,
)
from web.viewer.marks.names import Z as NAMES_Z
from web.viewer.plates.map_plate import NODE_Z, MapPlate, on_sheet
from web.viewer.plates.office_plate import OfficePlate
from web.viewer.plates.plate import point_on_plane

Answer = Accepted | Refused
PATIENCE_S = 3.0  # how long a clicked marker waits for its goal
GRIP_Z = 0.15
DOOR_Z = 0.25  # half the height of a leaf


BESIDE_MAP = "No goal set: that is beside the map; click on the map itself"
NOT_THERE = "The click did not arrive: the stage is still waking; click again in a moment"
NOTHING_THERE = "No goal set: there is nothing to click; click on the map"
OTHER_BRAIN = "No goal set: this is the other brain's map; the robot goes by the first one's"


@dataclass(frozen=True)
class Click:
    """A ray; `on_answer` is called once with the outcome: None when it was carried out, else why not."""

    origin: tuple[float, float, float]
    direction: tuple[float, float, float]
    on_answer: Callable[[str | None], None]

    def answered(self, answer: Answer, title: str) -> None:
        self.on_answer(f"{title}: {answer.reason}" if isinstance(answer, Refused) else None)


@dataclass(frozen=True)
class Meaning:
    """What a click at a place would do. words: for who points there, empty where it does nothing."""

    words: str
    act: Callable[[], None]


@dataclass(frozen=True)
class Drag:
    client_id: int
    phase: Literal["start", "update", "end"]
    turning: bool  # shift is held: the robot turns instead of moving
    eye: tuple[float, float, float]
    pointer: tuple[float, float, float]  # any point on the ray through the pointer


class Pointer:
    def __init__(
        self, send: Callable[[Command, Callable[[Answer], None]], None], complain: Callable[[int, str, str], None]
    ) -> None:
        """send: submits a command and brings the answer back to this thread; complain(client, title, body): notifies."""
        self._send, self._complain = send, complain
        self._asked: tuple[tuple[float, float], float, int | None] | None = None  # place, time, tick of acceptance
        self.dragging = False

    def meant(
        self, click: Click, plate: MapPlate, now_s: float, office: OfficePlate, places: tuple[KnownPlace, ...] = ()
    ) -> Meaning:
        """A click on the map shows the marker at once and asks for the goal. A click on a door opens or shuts it, one on the
        name of a place asks for the way there."""
        name = self._name_at(click, office) or self._name_at(click, plate)
        if name is not None:
            return self._way_to(name, places, click, plate, now_s)
        door = self._door_at(click, office)
        if door is not None:
            words = f"Click: {'open' if door.open else 'shut'} the door"
            return Meaning(
                words, lambda: self._send(door, lambda said: click.answered(said, "The door stays as it is"))
            )
        on_plate = point_on_plane(np.array(click.origin), np.array(click.direction), plate.origin, NODE_Z)
        place = None if on_plate is None else plate.map_place(on_plate)
        if place is None:
            why = BESIDE_MAP if on_plate is not None and on_sheet(on_plate) else NOTHING_THERE
            return Meaning("", lambda: click.on_answer(why))
        return Meaning("Click: the robot goes there", lambda: self._ask(place, click, plate, now_s))

    def _name_at(self, click: Click, plate: MapPlate | OfficePlate) -> str | None:
        at = point_on_plane(np.array(click.origin), np.array(click.direction), plate.origin, NAMES_Z)
        return None if at is None or not plate.frame.visible else plate.names.at(at)

    def _way_to(
        self, name: str, places: tuple[KnownPlace, ...], click: Click, plate: MapPlate, now_s: float
    ) -> Meaning:
        """The place of the map that is known by this name becomes the goal."""
        known = next((place.map_xy for place in places if place.name == name), None)
        if known is None:
            words = f"The map does not know the {name} yet. Click: the robot explores until it comes there"
            return Meaning(words, lambda: self._explore_to(name, click))
        return Meaning(f"Click: the robot goes to the {name}", lambda: self._ask(known, click, plate, now_s))

    def _explore_to(self, name: str, click: Click) -> None:
        def answered(answer: Answer) -> None:
            click.answered(answer, f"It does not look for the {name}")

        def explores(answer: Answer) -> None:
            if isinstance(answer, Refused):
                answered(answer)
            else:
                self._send(RunUntil(type="run_until", what="place", place=name), answered)

        self._send(SetMode(type="set_mode", mode="explore"), explores)

    def _ask(self, place: tuple[float, float], click: Click, plate: MapPlate, now_s: float) -> None:
        self._asked = (place, now_s, None)
        plate.show_click(place)

        def answered(answer: Answer) -> None:
            if isinstance(answer, Refused):
                self._forget_click(plate)
            elif self._asked is not None and self._asked[0] == place:
                self._asked = (place, now_s, answer.tick)
            click.answered(answer, "No goal set")

        self._send(SetGoal(type="set_goal", x=place[0], y=place[1]), answered)

    def _door_at(self, click: Click, office: OfficePlate) -> SetDoor | None:
        origin, direction = np.array(click.origin), np.array(click.direction)
        at = point_on_plane(origin, direction, office.origin, DOOR_Z * office.fit.relief)
        door = None if at is None else office.things.door_at(at, office.fit)
        return None if door is None else SetDoor(type="set_door", name=door[0], open=door[1])

    def experience_at(self, click: Click, plate: MapPlate) -> int | None:
        """The experience that a click on the map means, None for none."""
        on_plate = point_on_plane(np.array(click.origin), np.array(click.direction), plate.origin, NODE_Z)
        place = None if on_plate is None else plate.map_place(on_plate)
        return None if place is None else plate.nearest(place)

    def closure_at(self, click: Click, plate: MapPlate) -> Closure | None:
        """The loop closure whose mark a click has hit."""
        on_plate = point_on_plane(np.array(click.origin), np.array(click.direction), plate.origin, NODE_Z)
        return None if on_plate is None else plate.closures.at(on_plate)

    def inspect(self, click: Click, **wish: int | None) -> None:
        """Chooses what is inspected, by the fields of `Inspect`; the panel then shows it."""
        order = Inspect(type="inspect", **wish)  # type: ignore[arg-type]
        self._send(order, lambda answer: click.answered(answer, "Nothing to inspect"))

    def settle(self, snapshot: Snapshot, plate: MapPlate, now_s: float) -> None:
        """Removes the clicked marker when its goal is set, or when it has not been set in time."""
        if self._asked is None:
            return
        _, asked_s, accepted = self._asked
        arrived = accepted is not None and snapshot.tick >= accepted and snapshot.goal is not None
        if arrived or now_s - asked_s > PATIENCE_S:
            self._forget_click(plate)

    def moved(self, plate: MapPlate) -> None:
        """The map has another fit, and the marker follows it."""
        if self._asked is not None:
            plate.show_click(self._asked[0])

    def _forget_click(self, plate: MapPlate) -> None:
        self._asked = None
        plate.show_click(None)

    def drag(self, drag: Drag, plate: OfficePlate, snapshot: Snapshot) -> None:
        """While the robot is dragged, a ring shows whether it fits. When it is dropped, it is kidnapped."""
        ray = np.array(drag.pointer) - np.array(drag.eye)
        on_plate = point_on_plane(np.array(drag.eye), ray, plate.origin, GRIP_Z)
        if on_plate is None:
            return self._drop_beside(drag, plate) if drag.phase == "end" else None
        x, y = (float(v) for v in plate.fit.to_office(np.array([on_plate]))[0])
        truth = snapshot.truth
        if truth is None:
            return None
        heading = truth.heading_rad
        if drag.turning:
            heading = math.atan2(y - truth.y, x - truth.x)
            x, y = truth.x, truth.y
        self.dragging = True
        plate.show_drop((x, y), snapshot.no_room(x, y) is None, heading)
        if drag.phase == "end":
            self._drop(drag, plate, (x, y, heading))
        return None

    def _drop(self, drag: Drag, plate: OfficePlate, pose: tuple[float, float, float]) -> None:
        def answered(answer: Answer) -> None:
            self._let_go(plate)
            if isinstance(answer, Refused):
                self._complain(drag.client_id, "The robot stays where it is", answer.reason)

        self._send(Kidnap(type="kidnap", x=pose[0], y=pose[1], heading_rad=pose[2]), answered)

    def _drop_beside(self, drag: Drag, plate: OfficePlate) -> None:
        self._let_go(plate)
        self._complain(
            drag.client_id, "The robot stays where it is", "that is beside the office; drop it on free floor"
        )

    def _let_go(self, plate: OfficePlate) -> None:
        self.dragging = False
        plate.show_drop(None, False, 0.0)


def ask(submit: Callable[[Command], Future[Answer]], command: Command, bring: Callable[[Answer], None]) -> None:
    """Submits a command. `bring` is called with the answer, in the thread in which it arrives; a failure is a refusal."""

    def done(future: Future[Answer]) -> None:
        error = None if future.cancelled() else future.exception()
        if future.cancelled() or error is not None:
            bring(Refused("command", command.type, str(error or "the session has ended")))
        else:
            bring(future.result())

    submit(command).add_done_callback(done)
