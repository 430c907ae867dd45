"""The actors of the office, as the viewer draws them. The layer is the same object as long as nothing has moved."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.views.arrays import frozen
from disk import encode
from sim2d import Simulator, World
from web.messages import LivingLayer


class ActorsView:
    """Looks at one simulator."""

    def __init__(self) -> None:
        self._seen: tuple[object, str] | None = None
        self._layer: LivingLayer | None = None
        self._world: World | None = None
        self._switches: tuple[str, ...] = ()

    def switches(self, world: World) -> tuple[str, ...]:
        """The parameters of the section `office` that have an effect in this world."""
        if self._world is not world:
            self._world, self._switches = world, _switches(world)
        return self._switches

    def look(self, simulator: Simulator) -> LivingLayer | None:
        """The layer as it is now; None if the world has no actors."""
        world, living = simulator.world, simulator.actors
        if not (world.doors or world.boxes or world.people or world.lamps or world.daylight or world.script):
            return None
        seen = (world, encode(living).digest())
        if self._seen is None or self._seen[0] is not world or self._seen[1] != seen[1]:
            self._seen, self._layer = seen, _layer(simulator)
        return self._layer


def _switches(world: World) -> tuple[str, ...]:
    there = {
        "people": bool(world.people),
        "doors": any(door.period_s > 0 for door in world.doors),
        "lamps": bool(world.lamps),
        "daylight": world.daylight is not None,
        "reflections": any(wall.kind == "glass" for wall in world.walls),
        "door_s": bool(world.doors),
        "door_tip_m": bool(world.doors),
        "patience_least_s": bool(world.people),
        "patience_most_s": bool(world.people),
        "slow_zones": bool(world.slow_zones),
        "boxes": bool(world.boxes),
        "script": bool(world.script),
        "seed": bool(world.people),
    }
    return tuple(name for name, is_there in there.items() if is_there)


def _layer(simulator: Simulator) -> LivingLayer:
    world, living = simulator.world, simulator.actors
    boxes = [box for box, is_there in zip(world.boxes, living.box_present, strict=True) if is_there]
    walkers = living.walkers
    there = np.flatnonzero(walkers.present)
    people = [world.people[i] for i in there]
    rows = [(*walkers.xy[i], walkers.heading[i], p.radius, p.height) for i, p in zip(there, people, strict=True)]
    return LivingLayer(
        door_names=tuple(door.name for door in world.doors),
        doors=_table(living.segments[: len(world.doors)], 4),
        door_wanted=frozen(living.door_wanted),
        door_opening=frozen(living.opening.astype(np.float32)),
        box_names=tuple(box.name for box in boxes),
        boxes=_table([(b.x, b.y, b.width, b.depth, b.height, b.angle_rad) for b in boxes], 6),
        box_rgb=frozen(np.array([b.colour for b in boxes], np.uint8).reshape(-1, 3)),
        person_names=tuple(person.name for person in people),
        people=_table(rows, 5),
        people_rgb=frozen(np.array([p.colour for p in people], np.uint8).reshape(-1, 3)),
        lamp_names=tuple(lamp.name for lamp in world.lamps),
        lamps=_table([(k.x, k.y, k.reach, float(on)) for k, on in zip(world.lamps, living.lit, strict=True)], 4),
        lamp_on=frozen(living.lamp_on.copy()),
        daylight=living.daylight,
    )


def _table(rows: object, width: int) -> NDArray[np.float32]:
    return frozen(np.array(rows, np.float32).reshape(-1, width))
