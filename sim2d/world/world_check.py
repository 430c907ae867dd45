"""The checks that a schema cannot make: the outline is closed, elements lie inside it, starts are free, names exist."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import chain, pairwise

import numpy as np

from sim2d.geometry.segments import inside_ring
from sim2d.world.free_space import FreeSpace, RobotFit, Standing
from sim2d.world.world import Event, Wall, World

ROBOT_HEIGHT_M = 0.6  # walls whose lower edge is at least this high do not touch the robot
MOST_M = 3000.0
MOST_WALL_M2 = 200_000.0
MOST_FLOOR_M2 = 2_000_000.0
_JOIN_M = 1e-6
_NEEDS = {"open_door": "doors", "close_door": "doors", "lamp_on": "lamps", "lamp_off": "lamps", "box_appear": "boxes",
          "box_vanish": "boxes"}  # fmt: skip

Where = tuple[str | int, ...]


class Fault(ValueError):  # noqa: N818
    """What is wrong with a world, and the path of the item that is at fault."""

    def __init__(self, where: Where, message: str) -> None:
        super().__init__(message)
        self.where, self.message = where, message


def check_world(
    world: World, radius: float, before: World | None = None, free_in: Callable[[World], FreeSpace] | None = None
) -> None:
    """Raises Fault for the first thing that is wrong. radius: of the robot (m).

    before: a valid world, whose walls are not checked again. free_in: gives the free space of a world for that radius.
    """
    for fault in world_faults(world, radius, before, free_in):
        raise fault


def world_faults(
    world: World, radius: float, before: World | None = None, free_in: Callable[[World], FreeSpace] | None = None,
    *, begins: bool = True,
) -> Iterator[Fault]:  # fmt: skip
    """Everything that is wrong. Checks that need a valid outline are made only if nothing else is wrong.

    begins: whether a robot is to begin in it; else something may have been put down where it once began.
    """
    sound = True
    known = set[int]() if before is None else set(map(id, before.walls))
    new = ((i, wall) for i, wall in enumerate(world.walls) if id(wall) not in known)
    walls = (_wall_faults(("walls", i), wall) for i, wall in new)
    for fault in chain(chain.from_iterable(walls), _outline_faults(world)):
        sound = False
        yield fault
    if not sound:
        return
    for fault in _thing_faults(world):
        sound = False
        yield fault
    if sound:
        yield from _place_faults(world, FreeSpace(world, radius) if free_in is None else free_in(world), begins)


def _place_faults(world: World, free: FreeSpace, begins: bool) -> Iterator[Fault]:
    """The robot must fit at every start as the world begins, and at every place between the walls."""
    for kind, points, fit in (
        ("starts", world.starts if begins else (), RobotFit(free, Standing.at_first(world))),
        ("places", world.places, RobotFit(free)),
    ):
        for i, point in enumerate(points):
            refusal = fit.refusal(point.x, point.y)
            if refusal is not None:
                yield Fault((kind, i), f"({point.name}): {refusal}")


def _wall_faults(where: Where, wall: Wall) -> Iterator[Fault]:
    if wall.length < 0.01:
        yield Fault(
            where,
            f"no length: runs from ({wall.x1:g}, {wall.y1:g}) to ({wall.x2:g}, {wall.y2:g}); "
            "its ends must be at least 0.01 m apart",
        )
    if wall.bottom >= wall.height:
        yield Fault(where, f"bottom {wall.bottom:g} must be below its height {wall.height:g}")
    if not wall.stands and wall.bottom < ROBOT_HEIGHT_M:
        yield Fault(where, f"bottom {wall.bottom:g} must be 0 or at least {ROBOT_HEIGHT_M} m, above the robot")
    for j, panel in enumerate(wall.panels):
        if panel.at + panel.width > wall.length + 1e-9:
            yield Fault(
                (*where, "panels", j),
                f"reaches to {panel.at + panel.width:g} m; the wall is {wall.length:g} m long",
            )
        if not wall.bottom <= panel.bottom < panel.top <= wall.height:
            yield Fault(
                (*where, "panels", j),
                f"from {panel.bottom:g} up to {panel.top:g} m; must be upright and "
                f"between the wall's {wall.bottom:g} and {wall.height:g} m",
            )


def _outline_faults(world: World) -> Iterator[Fault]:
    """Outer walls come first, each must begin where the one before ends, counter-clockwise."""
    outer = [i for i, wall in enumerate(world.walls) if wall.outer]
    if len(outer) < 3:
        yield Fault(("walls",), f"{len(outer)} are outer; at least 3 must close the outline")
        return
    if outer != list(range(len(outer))):
        yield Fault(("walls", outer[-1]), "is outer but comes after inner ones; the outer walls come first")
    for i, k in [*pairwise(outer), (outer[-1], outer[0])]:
        ends, begins = world.walls[i], world.walls[k]
        if math.hypot(begins.x1 - ends.x2, begins.y1 - ends.y2) > _JOIN_M:
            yield Fault(
                ("walls", i),
                f"the outline is open: it ends at ({ends.x2:g}, {ends.y2:g}) but walls[{k}] begins "
                f"at ({begins.x1:g}, {begins.y1:g}); each outer wall must begin where the one before ends",
            )
        if not ends.stands:
            yield Fault(("walls", i), f"bottom {ends.bottom:g} must be 0 in the outer wall")
    ring = world.outline
    after = np.roll(ring, -1, axis=0)
    area = 0.5 * float(np.sum(ring[:, 0] * after[:, 1] - ring[:, 1] * after[:, 0]))
    if area <= 0:
        yield Fault(("walls", 0), f"the outline encloses {area:g} m^2; it must run counter-clockwise")
    yield from _size_faults(world)


def _size_faults(world: World) -> Iterator[Fault]:
    x0, y0, x1, y1 = world.bounds
    if max(x1 - x0, y1 - y0) > MOST_M:
        yield Fault(("walls",), f"the outline spans {x1 - x0:g} by {y1 - y0:g} m; at most {MOST_M:g} m each way")
    if (x1 - x0) * (y1 - y0) > MOST_FLOOR_M2:
        yield Fault(("walls",), f"{(x1 - x0) * (y1 - y0):.0f} m^2 of floor in all; at most {MOST_FLOOR_M2:g}")
    ends, upright = world.segments(), np.array([wall.height - wall.bottom for wall in world.walls])
    area = float(np.hypot(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1]) @ upright)
    if area > MOST_WALL_M2:
        yield Fault(("walls",), f"{area:.0f} m^2 of wall in all; at most {MOST_WALL_M2:g}")


def _thing_faults(world: World) -> Iterator[Fault]:
    kinds = ("starts", "places", "doors", "lamps", "boxes", "people", "slow_zones")
    names = {kind: [item.name for item in getattr(world, kind)] for kind in kinds}
    for kind in kinds[2:]:
        for i, name in enumerate(names[kind]):
            if name in names[kind][:i]:
                yield Fault((kind, i, "name"), f"{name!r} is taken by {kind}[{names[kind].index(name)}]; use another")
    ring = world.outline
    for where, what, x, y in _points(world):
        if not inside_ring(ring, x, y):
            x0, y0, x1, y1 = world.bounds
            yield Fault(
                where,
                f"{what} ({x:g}, {y:g}) is outside of {world.name}, which spans {x0:g} to {x1:g} by {y0:g} to {y1:g} m",
            )
    for i, door in enumerate(world.doors):
        if door.open_s > door.period_s:
            yield Fault(("doors", i, "open_s"), f"{door.open_s:g} s must be at most its period_s, {door.period_s:g} s")
    for i, person in enumerate(world.people):
        if len(person.wait_s) != len(person.path):
            yield Fault(
                ("people", i, "wait_s"),
                f"has {len(person.wait_s)} times; must be one time, or one for each of the {len(person.path)} points",
            )
    yield from _daylight_faults(world)
    for i, event in enumerate(world.script):
        yield from _event_faults(("script", i), event, names)


def _points(world: World) -> Iterator[tuple[Where, str, float, float]]:
    """Every point that must lie inside the outline: path of the item, what it is, x, y."""
    for i, door in enumerate(world.doors):
        yield ("doors", i, "hinge"), "the hinge", door.x, door.y
    for kind, items in (("lamps", world.lamps), ("boxes", world.boxes)):
        for i, item in enumerate(items):
            yield (kind, i), f"{item.name!r}", item.x, item.y
    for i, person in enumerate(world.people):
        for j, (x, y) in enumerate(person.path):
            yield ("people", i, "path", j), f"a point of {person.name!r}", x, y


def _daylight_faults(world: World) -> Iterator[Fault]:
    day = world.daylight
    if day is None:
        return
    for j, (at, level) in enumerate(zip(day.at_s, day.level, strict=True)):
        where = ("daylight", "points", j)
        if at < 0 or (j > 0 and at <= day.at_s[j - 1]):
            yield Fault(where, f"is at {at:g} s; times must grow from point to point and begin at 0 or later")
        if not 0 <= level <= 3:
            yield Fault(where, f"has level {level:g}; must be from 0 to 3")
    if 0 < day.repeat_s < day.at_s[-1]:
        yield Fault(
            ("daylight", "repeat_s"), f"{day.repeat_s:g} s must be 0 or at least the last point's {day.at_s[-1]:g} s"
        )


def _event_faults(where: Where, event: Event, names: dict[str, list[str]]) -> Iterator[Fault]:
    kind = _NEEDS.get(event.do)
    if kind is not None and event.name not in names[kind]:
        known = ", ".join(names[kind]) or f"none, since the world has no {kind}"
        yield Fault((*where, "name"), f"no {kind} named {event.name!r}; expected one of: {known}")
