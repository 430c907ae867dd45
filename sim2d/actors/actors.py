"""What moves or changes in an office: doors, boxes, people, lamps, daylight, script.

Actors step tick by tick, draw random numbers only from their own generator, and never move anything onto the robot.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from disk import kind
from sim2d.actors.walkers import PERSON_SIDES, Walkers
from sim2d.geometry.segments import nearest_segment
from sim2d.params import OfficeParams
from sim2d.world.free_space import Standing
from sim2d.world.world import Box, Door, Event, Lamp, World

CLEARANCE_M = 0.01  # least distance from the robot of a moving leaf and of a box that appears
DOOR_TIP_M = 0.1  # the tip of a leaf moves no farther in a tick: not over a robot, and the smallest is as wide

_Named = Door | Box | Lamp


@kind("actors/1")
class Actors:
    """The state of everything that moves in one world.

    segments: (n, 4) the sides of doors, boxes and people, in this order, as rays and camera meet them. there: (m, 4)
    those of them that are present.
    """

    CACHES = ("world", "_script", "_anything", "first_box", "first_person", "segments", "present", "there")

    def __init__(
        self, world: World, rng: np.random.Generator, tick_s: float, params: OfficeParams | None = None
    ) -> None:
        """params: what people are like at first; None: as they are by default."""
        self._tick_s = tick_s
        self.opening = np.array([float(door.open) for door in world.doors])  # 0 = shut, 1 = open
        self._wanted = self.opening.copy()
        self._automatic: list[bool | None] = [None] * len(world.doors)
        self.box_present = np.array([box.present for box in world.boxes], bool)
        self._box_wanted = self.box_present.copy()
        self.lamp_on = np.array([lamp.on for lamp in world.lamps], bool)
        self._level: float | None = None
        self.daylight = 1.0 if world.daylight is None else world.daylight.at(0.0)
        self._people_on = self._lamps_on = True
        self.walkers = Walkers(world.people, rng, tick_s, (params or OfficeParams()).patience_least_s)
        self._next = 0  # line of the script
        self._time_s = -1.0  # of the last step
        self.settle(world)

    def settle(self, world: World) -> None:
        """Compute the caches from the world and the state of doors, boxes and people."""
        self.world = world
        self.walkers.settle(world.people)
        self._script = sorted(world.script, key=lambda event: event.at_s)
        self._anything = bool(world.doors or world.boxes or world.people or world.script or world.daylight)
        self.first_box = len(world.doors)
        self.first_person = self.first_box + 4 * len(world.boxes)
        self.segments = np.zeros((self.first_person + PERSON_SIDES * len(world.people), 4))
        self.present = np.zeros(len(self.segments), bool)
        for i, door in enumerate(world.doors):
            self.segments[i] = door.leaf(self.opening[i])
        for i, box in enumerate(world.boxes):
            self.segments[self._rows(i)] = _sides(box)
        self._show()

    def begin(self, params: OfficeParams) -> None:
        """Remove what is switched off at once, not only at the first step."""
        self._lamps_on = params.lamps
        self.box_present &= params.boxes
        self.walkers.present &= params.people
        self._show()

    def set_tick(self, tick_s: float) -> None:
        """Set the duration of a tick (s) from now on."""
        self._tick_s = self.walkers.tick_s = tick_s

    def step(
        self, time_s: float, robot: tuple[float, float], radius: float, comes: float, params: OfficeParams
    ) -> None:
        """Advance to `time_s`, the end of this tick. robot: its place; radius: of the robot; comes: how far it may
        drive in a tick (all m)."""
        self._lamps_on, self._time_s = params.lamps, time_s
        if not self._anything:
            return
        while self._next < len(self._script) and self._script[self._next].at_s <= time_s + 1e-9:
            if params.script:
                self._do(self._script[self._next])
            self._next += 1
        day = self.world.daylight
        if self._level is not None:
            self.daylight = self._level
        elif day is not None:
            self.daylight = day.at(time_s if params.daylight else 0.0)
        self._step_boxes(robot, radius, params.boxes)
        self._step_doors(time_s, robot, radius, params)
        walking = params.people and self._people_on
        solid, present = self.segments[: self.first_person], self.present[: self.first_person]
        patience_s = params.patience_least_s, params.patience_most_s
        self.walkers.step(robot, radius + comes, walking, solid, present, patience_s)
        self._show()

    def make_way(self, robot: tuple[float, float], radius: float) -> None:
        """People who stand where the robot has just been put disappear until it leaves."""
        self.walkers.make_way(robot, radius)
        self._show()

    # ------------------------------------------------------------ orders; ValueError says why one cannot be carried out

    def set_door(self, name: str, is_open: bool) -> None:
        """Open or shut a door. It moves over several ticks and waits for anybody in its way."""
        self._wanted[_find(self.world.doors, name, "door")] = float(is_open)

    def set_lamp(self, name: str, on: bool) -> None:
        self.lamp_on[_find(self.world.lamps, name, "lamp")] = on

    def set_box(self, name: str, present: bool) -> None:
        """Make one of the world's boxes disappear, or appear as soon as the robot is not in its place."""
        self._box_wanted[_find(self.world.boxes, name, "box")] = present

    def standing(self) -> Standing:
        """Everything that is in the robot's way now, apart from walls."""
        boxes = (box for box, is_there in zip(self.world.boxes, self.box_present, strict=True) if is_there)
        return Standing(
            tuple(zip(self.world.doors, self.opening.tolist(), strict=True)), tuple(boxes), self.walkers.standing()
        )

    def adopt(self, old: Actors) -> None:
        """After an edit: everything that has kept its name and kind goes on as it was.

        [ours] Script lines whose time has passed are not carried out afterwards, and what earlier lines have done
        stays. The daylight, however, follows its curve again if no line that has set it is left
        (test_actors.py::test_an_edited_script_goes_on_from_now).
        """
        doors, boxes = _by_name(old.world.doors), _by_name(old.world.boxes)
        for i, door in enumerate(self.world.doors):
            k = doors.get(door.name)
            if k is not None:
                self.opening[i], self._wanted[i] = old.opening[k], old._wanted[k]
                self._automatic[i] = old._automatic[k]
                self.segments[i] = door.leaf(self.opening[i])
        for i, box in enumerate(self.world.boxes):
            k = boxes.get(box.name)
            if k is not None:
                self.box_present[i], self._box_wanted[i] = old.box_present[k], old._box_wanted[k]
        lamps = _by_name(old.world.lamps)
        for i, lamp in enumerate(self.world.lamps):
            if lamp.name in lamps:
                self.lamp_on[i] = old.lamp_on[lamps[lamp.name]]
        self._people_on, self._time_s = old._people_on, old._time_s
        self._next = sum(event.at_s <= old._time_s + 1e-9 for event in self._script)
        if any(event.do == "daylight" for event in self._script[: self._next]):
            self._level = old._level
        if self._level is not None or self.world.daylight is not None:
            self.daylight = old.daylight
        self.walkers.adopt(old.walkers)
        self._show()

    @property
    def lit(self) -> NDArray[np.bool_]:
        """Which lamps shine."""
        return self.lamp_on & self._lamps_on

    @property
    def door_wanted(self) -> NDArray[np.bool_]:
        """Which doors are open or opening."""
        return self._wanted > 0.5

    # ------------------------------------------------------------ inside

    def _do(self, event: Event) -> None:
        match event.do:
            case "open_door" | "close_door":
                self.set_door(event.name, event.do == "open_door")
            case "lamp_on" | "lamp_off":
                self.set_lamp(event.name, event.do == "lamp_on")
            case "box_appear" | "box_vanish":
                self.set_box(event.name, event.do == "box_appear")
            case "people_on" | "people_off":
                self._people_on = event.do == "people_on"
            case "daylight":
                self._level = event.level

    def _step_boxes(self, robot: tuple[float, float], radius: float, switched_on: bool) -> None:
        wanted = self._box_wanted & switched_on
        for i in np.flatnonzero(self.box_present != wanted):
            box = self.world.boxes[i]
            if not wanted[i] or box.distance(*robot) > radius + CLEARANCE_M:
                self.box_present[i] = wanted[i]

    def _step_doors(self, time_s: float, robot: tuple[float, float], radius: float, params: OfficeParams) -> None:
        for i, door in enumerate(self.world.doors):
            if door.period_s > 0 and params.doors:
                automatic = math.fmod(time_s + door.phase_s, door.period_s) < door.open_s
                if automatic != self._automatic[i]:
                    self._automatic[i], self._wanted[i] = automatic, float(automatic)
            gap = self._wanted[i] - self.opening[i]
            if gap == 0.0:
                continue
            travel = door.width * (1.0 if door.slides else abs(door.swing_rad))
            step = min(self._tick_s / params.door_s, DOOR_TIP_M / max(travel, 1e-9))
            opening = self.opening[i] + min(max(gap, -step), step)
            after = door.leaf(opening)
            if not self._in_the_way(self.segments[i], after, robot, radius):
                self.opening[i], self.segments[i] = opening, after

    def _in_the_way(
        self, before: NDArray[np.float64], after: NDArray[np.float64], robot: tuple[float, float], radius: float
    ) -> bool:
        """Whether a leaf would come too near to the robot or a person, nearer than it is."""
        discs = [(*robot, radius + CLEARANCE_M), *self.walkers.discs()]
        for x, y, r in discs:
            distance = nearest_segment(after[None], x, y)[1]
            if distance < r and distance < nearest_segment(before[None], x, y)[1]:
                return True
        return False

    def _rows(self, box: int) -> slice:
        return slice(self.first_box + 4 * box, self.first_box + 4 * box + 4)

    def _show(self) -> None:
        self.present[: self.first_box] = True
        self.present[self.first_box : self.first_person] = np.repeat(self.box_present, 4)
        self.segments[self.first_person :] = self.walkers.sides()
        self.present[self.first_person :] = np.repeat(self.walkers.present, PERSON_SIDES)
        self.there = self.segments[self.present]


def _sides(box: Box) -> NDArray[np.float64]:
    corners = box.corners
    return np.hstack([corners, np.roll(corners, -1, axis=0)])


def _by_name(items: Sequence[_Named]) -> dict[str, int]:
    return {item.name: i for i, item in enumerate(items)}


def _find(items: Sequence[_Named], name: str, what: str) -> int:
    names = _by_name(items)
    if name not in names:
        known = ", ".join(names) or f"none, since this world has no {what}"
        raise ValueError(f"no {what} named {name!r}; expected one of: {known}")
    return names[name]
