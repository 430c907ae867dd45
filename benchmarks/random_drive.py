"""Does the robot ever get into a wall? It drives wildly among people and moving doors; the deepest overlap is reported.

    python -m benchmarks.random_drive [--hours 10] [--seed 1] [WORLD ...]

A world is a name or a file, as for `ratslam run --world`; the default is all worlds that come with the program. Physics
only: no camera, no brain. Every ten minutes the robot is put at a random place, so that it comes to all parts of a
large world.
"""

# The driver puts itself in the place of the sensors.
# pyright: reportPrivateUsage=false

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass, replace

import numpy as np

from sim2d import Drive, FreeSpace, Person, SimParams, Simulator, World, world_names
from sim2d.geometry.segments import nearest_segment
from sim2d.geometry.wall_index import build_index, nearest_within
from sim2d.importers import open_world

BAR_M = 0.01
PEOPLE = 12
ELSEWHERE_S = 600.0
SIGHT_M = 0.4  # nothing farther away is measured


@dataclass(frozen=True, slots=True)
class Deepest:
    """The deepest overlap (m) with a wall, and with a leaf, box or person, and where. Negative: never touched."""

    wall_m: float
    thing_m: float
    at: tuple[float, float, float]  # seconds, x, y


def with_people(world: World, seed: int, count: int = PEOPLE) -> World:
    """The world; if nobody walks in it, with people who walk between random free places."""
    if world.people:
        return world
    free, rng = FreeSpace(world, SimParams().robot_radius_m), np.random.default_rng(seed)
    home = world.starts[0]
    places: list[tuple[float, float]] = []
    while len(places) < 3 * count:
        x, y = free.random_point(rng)
        if math.hypot(x - home.x, y - home.y) > 1.0:
            places.append((x, y))
    people = (
        Person(f"person {i}", tuple(places[3 * i : 3 * i + 3]), (1.0,) * 3, float(rng.uniform(0.4, 1.4)))
        for i in range(count)
    )
    return replace(world, people=tuple(people))


def drive(world: World, hours: float, seed: int) -> Deepest:
    """Hold random drives for up to 3 s each, mostly at full speed, and open and shut doors at random."""
    simulator = Simulator(world, seed=seed)
    frame, params = simulator.observe(), simulator.params
    simulator._sense = lambda _speed, _yaw_rate: frame  # type: ignore[method-assign]
    walls = build_index(world.segments()[list(world.obstacles)])
    rng, radius = np.random.default_rng(seed), params.robot_radius_m
    deepest = Deepest(-math.inf, -math.inf, (0.0, 0.0, 0.0))
    elsewhere, hold, now = round(ELSEWHERE_S / params.tick_s), 0, Drive(0.0, 0.0)
    for tick in range(round(hours * 3600 / params.tick_s)):
        if tick % elsewhere == elsewhere - 1:
            _go_elsewhere(simulator)
        if hold == 0:
            hold = int(rng.integers(1, 30))
            speed = float(rng.choice([-1.0, 1.0, 1.0]) if rng.random() < 0.7 else rng.uniform(-1, 1))
            now = Drive(speed * params.max_speed, float(rng.normal(0.0, 0.6)))
            if world.doors and rng.random() < 0.3:
                simulator.set_door(world.doors[int(rng.integers(len(world.doors)))].name, bool(rng.random() < 0.5))
        hold -= 1
        simulator.step(now)
        x, y, _ = simulator._robot.pose
        wall = radius - nearest_within(walls, x, y, SIGHT_M)
        thing = _into_things(simulator, x, y, radius)
        if wall > deepest.wall_m or thing > deepest.thing_m:
            deepest = Deepest(max(wall, deepest.wall_m), max(thing, deepest.thing_m), (tick * params.tick_s, x, y))
    return deepest


def _go_elsewhere(simulator: Simulator) -> None:
    while True:
        try:
            simulator.teleport(*simulator.random_free_pose())
            return
        except ValueError:
            continue  # a person or a box stands there


def _into_things(simulator: Simulator, x: float, y: float, radius: float) -> float:
    living = simulator.actors
    deepest = radius - SIGHT_M
    walkers = living.walkers
    if len(walkers.xy):
        away = np.hypot(walkers.xy[:, 0] - x, walkers.xy[:, 1] - y) - walkers.radius
        deepest = max(deepest, radius - float(np.where(walkers.present, away, math.inf).min()))
    solid = living.segments[: living.first_person][living.present[: living.first_person]]
    if len(solid):
        deepest = max(deepest, radius - nearest_segment(solid, x, y)[1])
    return deepest


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("worlds", nargs="*", metavar="WORLD")
    parser.add_argument("--hours", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scale", type=float, help="metres a pixel, for a plain picture")
    args = parser.parse_args()
    worst = 0.0
    for name in args.worlds or [name for name, _ in world_names()]:
        world = with_people(open_world(name, args.scale), args.seed)
        deepest = drive(world, args.hours, args.seed)
        worst = max(worst, deepest.wall_m)
        seconds, x, y = deepest.at
        print(
            f"{world.name:20} {args.hours:g} h, seed {args.seed}: {1e3 * deepest.wall_m:6.2f} mm into a wall, "
            f"{1e3 * deepest.thing_m:6.2f} mm into anything else; last deeper at {seconds:.1f} s, ({x:.2f}, {y:.2f})",
            flush=True,
        )
    print(f"deepest {1e3 * worst:.2f} mm; bar {1e3 * BAR_M:g} mm: {'holds' if worst <= BAR_M else 'MISSED'}")
    return 0 if worst <= BAR_M else 1


if __name__ == "__main__":
    raise SystemExit(main())
