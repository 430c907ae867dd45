"""Makes the worlds that come with the program, except office, floor and loop, whose JSON files are the source.

    python -m sim2d.worlds.make

The sizes are from the papers. What these leave open (widths, furniture, looks) is ours. Lengths in metres.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from sim2d.importers.plan import Dresser, Point
from sim2d.world.world import Box, Daylight, Door, Event, Lamp, Panel, Person, Place, SlowZone, Start, Wall, World
from sim2d.world.world_schema import world_to_json

DOOR_M = 1.2


class Sketch:
    """A floor plan under construction."""

    def __init__(self, outline: Sequence[Point], seed: int) -> None:
        self.dresser = Dresser(seed)
        self.walls: list[Wall] = self.dresser.line([*outline, outline[0]], "left", outer=True)

    def block(self, points: Sequence[Point], kind: str = "wall", height: float = 2.6) -> None:
        """A solid block; corners clockwise."""
        self.walls += self.dresser.line([*points, points[0]], "left", kind, height)

    def box(self, x: float, y: float, width: float, depth: float, kind: str = "wall", height: float = 2.6) -> None:
        """A solid rectangle with its lower left corner at (x, y)."""
        self.block([(x, y), (x, y + depth), (x + width, y + depth), (x + width, y)], kind, height)

    def wall(self, a: Point, b: Point, *doors: float, kind: str = "wall", height: float = 2.6) -> None:
        """A wall from a to b with gaps of DOOR_M around these distances from a. Its two sides look different."""
        length = math.dist(a, b)
        ends = [0.0, *(end for door in doors for end in (door - DOOR_M / 2, door + DOOR_M / 2)), length]
        points = [(a[0] + (b[0] - a[0]) * end / length, a[1] + (b[1] - a[1]) * end / length) for end in ends]
        for begin, end in zip(points[::2], points[1::2], strict=True):
            self.walls += self.dresser.line([begin, end], "each", kind, height)

    def desk(self, x: float, y: float, width: float, depth: float) -> None:
        """A desk with a screen on it; lower left corner at (x, y)."""
        self.box(x, y, width, depth, "desk", 0.75)
        half, seed = 0.27, self.dresser.next_seed()
        dx, dy = (half, 0.0) if width > depth else (0.0, half)
        cx, cy = x + width / 2, y + depth / 2
        shine = 40 + seed * 37 % 180, 90, 40 + seed * 53 % 180
        panel = Panel(0.0, 2 * half, 0.82, 1.2, "screen", shine, seed, "both")
        x1, y1, x2, y2 = (round(v, 3) for v in (cx - dx, cy - dy, cx + dx, cy + dy))
        self.walls.append(Wall(x1, y1, x2, y2, "screen", 1.2, (24, 24, 28), False, 0.82, (panel,)))

    def partition(self, a: Point, b: Point) -> None:
        self.wall(a, b, kind="partition", height=1.4)

    def world(self, name: str, title: str, paper: str, about: str, source: str, start: Start, *places: Place) -> World:
        return World(
            name, title, source, tuple(self.walls), (start,), places, (110, 106, 102), (222, 222, 216),
            paper=paper, about=about,
        )  # fmt: skip


def corridors() -> World:
    """Environment A: the middle line of the corridor is 70 m long."""
    sketch = Sketch([(0, 0), (25.8, 0), (25.8, 12.8), (0, 12.8)], seed=2004)
    sketch.box(1.8, 1.8, 22.2, 9.2)
    return sketch.world(
        "corridors", "Corridor loop, 70 m round", "ACRA 2004",
        "Environment A: three autonomous laps of a corridor loop in ten minutes, closed on the second lap.",
        "Milford, Wyeth: ACRA 2004, environment A; shape, width and pictures are ours",
        Start("home", 4.0, 0.9, 0.0),
        Place("south-east corner", 24.9, 0.9), Place("north-east corner", 24.9, 11.9),
        Place("north-west corner", 0.9, 11.9), Place("south-west corner", 0.9, 0.9),
    )  # fmt: skip


def campus() -> World:
    """Environment B: a complete floor of 45 x 13 m."""
    sketch = Sketch([(0, 0), (45, 0), (45, 13), (0, 13)], seed=2005)
    sketch.box(3.0, 4.8, 8.0, 2.0)  # lifts and stores between two corridors, with a passage
    sketch.box(13.0, 4.8, 9.0, 2.0)
    sketch.wall((0, 8.7), (29, 8.7), 2.5, 8.0, 13.5, 20.5, 27.5)
    for x in (5.0, 11.0, 17.0, 24.0):
        sketch.wall((x, 8.7), (x, 13))
    sketch.wall((0, 3.0), (25, 3.0), 2.5, 8.5, 15.0, 22.5)
    for x in (5.0, 12.0, 18.0):
        sketch.wall((x, 0), (x, 3.0))
    sketch.wall((25, 0), (25, 6.0), 4.2)  # the laboratory
    sketch.wall((25, 6.0), (31, 6.0), 3.0)
    sketch.wall((31, 0), (31, 6.0))
    sketch.wall((29, 8.7), (29, 13))
    for x, y, w, d in ((1.0, 11.6, 1.6, 0.8), (7.0, 11.4, 1.6, 0.8), (13.2, 11.2, 2.0, 1.0), (19.6, 10.6, 2.0, 1.0),
                       (26.0, 11.8, 1.6, 0.8), (0.4, 0.4, 1.6, 0.8), (9.6, 0.4, 1.6, 0.8), (14.6, 0.4, 1.6, 0.8),
                       (19.4, 0.4, 1.6, 0.8), (27.0, 1.8, 2.2, 1.0)):  # fmt: skip
        sketch.desk(x, y, w, d)
    for x, y in ((34.0, 2.2), (39.5, 2.2), (34.0, 9.0), (39.5, 9.0)):  # cloisters of the open plan
        sketch.partition((x, y + 0.8), (x + 3.2, y + 0.8))
        sketch.partition((x + 1.6, y - 0.3), (x + 1.6, y + 1.9))
        sketch.desk(x + 0.1, y + 0.85, 1.4, 0.7)
        sketch.desk(x + 1.7, y + 0.05, 1.4, 0.7)
    sketch.box(37.6, 5.9, 0.9, 0.9)  # a pillar
    return sketch.world(
        "campus", "Campus floor, 45 x 13 m", "ACRA 2004",
        "Environment B: a whole floor, driven both ways and into rooms, with several ways between most points.",
        "Milford, Wyeth: ACRA 2004, environment B; rooms, furniture and pictures are ours",
        Start("home", 1.5, 7.7, 0.0),
        Place("laboratory", 29.5, 4.4), Place("open plan", 43.0, 6.5), Place("meeting room", 20.5, 12.2),
        Place("north-east desks", 42.5, 12.2), Place("office", 8.5, 2.0), Place("west end", 1.5, 3.9),
    )  # fmt: skip


def open_plan() -> World:
    """The open-plan office of 80 m² in which experience mapping was tested on a real robot."""
    sketch = Sketch([(0, 0), (10, 0), (10, 8), (0, 8)], seed=80)
    for x, y in ((2.0, 1.9), (6.2, 1.9), (2.0, 5.2), (6.2, 5.2)):
        sketch.partition((x, y), (x + 1.8, y))
        sketch.partition((x + 0.9, y - 0.8), (x + 0.9, y + 0.8))
        sketch.desk(x + 0.1, y + 0.05, 0.75, 0.65)
        sketch.desk(x + 0.95, y - 0.7, 0.75, 0.65)
    sketch.box(9.2, 3.4, 0.7, 0.7, "wall", 1.8)  # fridges
    sketch.box(9.2, 4.2, 0.7, 0.7, "wall", 1.8)
    sketch.box(4.8, 3.6, 0.5, 0.5, "desk", 0.9)  # a chair
    sketch.box(0.1, 3.6, 0.5, 0.8, "wall", 2.0)  # a cupboard
    return sketch.world(
        "open-plan", "Open-plan office, 80 m²", "ACRA 2005",
        "Desk cloisters, chairs and fridges: the robot explores for 15 minutes and no jumps are left in its map.",
        "Milford, Prasser, Wyeth: ACRA 2005, the open-plan experiment; furniture and pictures are ours",
        Start("home", 1.0, 1.0, 0.0),
        Place("fridges", 8.6, 4.1), Place("far corner", 9.2, 7.2), Place("window", 5.1, 7.2),
    )  # fmt: skip


def two_goals() -> World:
    """Two goals with two equally long ways between them. On the lower one wheels slip: the upper one is quicker."""
    outline = [(0, 0), (24, 0), (24, 12), (0, 12)]
    sketch = Sketch(outline, seed=1274)
    sketch.box(7.0, 4.2, 10.0, 3.6)
    sketch.box(7.0, 9.8, 10.0, 2.1)
    sketch.box(7.0, 0.1, 10.0, 2.1)
    sketch.wall((4.0, 8.5), (4.0, 12.0))
    sketch.wall((20.0, 0.0), (20.0, 3.5))
    for x, y in ((1.6, 2.0), (21.0, 9.6), (1.2, 10.2), (21.6, 1.2)):
        sketch.desk(x, y, 1.4, 0.8)
    sketch.partition((18.6, 6.0), (20.0, 6.0))
    world = sketch.world(
        "two-goals", "Two goals, two ways round", "IROS 2005",
        "Two ways of one length lead from goal to goal; on the lower one the wheels slip, so the upper one is quicker.",
        "Milford, Wyeth: IROS 2005, the goal-memory experiment; plan and pictures are ours",
        Start("home", 17.5, 8.8, math.pi), Place("goal 1", 2.2, 6.0), Place("goal 2", 21.8, 6.0),
    )  # fmt: skip
    lower = ((7.0, 2.2), (17.0, 2.2), (17.0, 4.2), (7.0, 4.2))
    return replace(world, slow_zones=(SlowZone("slippery floor", lower, 0.4),))


def twins() -> World:
    """Two corridors that look exactly alike; only their surroundings differ."""
    sketch = Sketch([(0, 0), (22, 0), (22, 8.6), (0, 8.6)], seed=17)
    below = Dresser(18)
    pair = [
        *below.line([(4.0, 1.0), (18.0, 1.0)], "left"),
        *below.line([(18.0, 2.8), (4.0, 2.8)], "left"),
        *below.line([(4.0, 2.8), (4.0, 3.4)], "left"),
        *below.line([(18.0, 3.4), (18.0, 2.8)], "left"),
    ]
    for wall in pair:
        sketch.walls += [wall, replace(wall, y1=round(wall.y1 + 4.8, 3), y2=round(wall.y2 + 4.8, 3))]
    sketch.walls += sketch.dresser.line([(18.0, 1.0), (18.0, 0.0)], "left")
    sketch.walls += sketch.dresser.line([(4.0, 0.0), (4.0, 1.0)], "left")
    sketch.walls += sketch.dresser.line([(4.0, 3.4), (4.0, 5.8)], "left")
    sketch.walls += sketch.dresser.line([(18.0, 5.8), (18.0, 3.4)], "left")
    sketch.walls += sketch.dresser.line([(4.0, 8.2), (4.0, 8.6)], "left")
    sketch.walls += sketch.dresser.line([(18.0, 8.6), (18.0, 8.2)], "left")
    sketch.desk(19.6, 3.9, 0.8, 1.6)
    return sketch.world(
        "twins", "Twin corridors", "ACRA 2004",
        "Two corridors that look exactly alike: two packets or more, until the robot has come out of one of them.",
        "after Milford, Wyeth: ACRA 2004, corridors that look alike; the plan is ours",
        Start("home", 1.5, 4.3, 0.0),
        Place("lower corridor", 11.0, 1.9), Place("upper corridor", 11.0, 6.7), Place("east hall", 20.9, 7.4),
    )  # fmt: skip


def living() -> World:
    """Rooms behind doors, with every kind of element that an office can have."""
    sketch = Sketch([(0, 0), (14, 0), (14, 9), (0, 9)], seed=1906)
    sketch.wall((0, 5.4), (4.6, 5.4), 2.5)
    sketch.wall((9.2, 5.4), (14, 5.4), 2.3)
    for x1, x2 in ((4.6, 6.4), (7.6, 9.2)):
        sketch.walls.append(Wall(x1, 5.4, x2, 5.4, "glass", 2.6, (150, 185, 200), reflection=0.2))
    for x in (4.6, 9.2):
        sketch.wall((x, 5.4), (x, 9))
    for x, y, w, d in ((0.5, 7.6, 1.6, 0.8), (6.0, 7.2, 1.8, 0.9), (11.8, 7.8, 1.6, 0.8), (3.0, 1.8, 1.6, 0.8),
                       (9.4, 1.8, 1.6, 0.8)):  # fmt: skip
        sketch.desk(x, y, w, d)
    sketch.partition((6.2, 2.2), (8.0, 2.2))
    world = sketch.world(
        "living", "Living office, 14 x 9 m", "ACRA 2004",
        "People walk, doors open and shut, lamps and daylight change, a box is put in the way: each with its switch.",
        "after what Milford, Wyeth: ACRA 2004 had to cope with; plan and pictures are ours",
        Start("home", 1.2, 1.0, 0.0),
        Place("meeting room", 8.4, 6.4), Place("laboratory", 10.4, 7.0), Place("office", 3.6, 7.6),
    )  # fmt: skip
    return replace(
        world,
        doors=(
            Door("office door", 1.9, 5.4, 0.0, DOOR_M, period_s=80.0, open_s=60.0),
            Door("meeting room door", 6.4, 5.4, 0.0, DOOR_M, slides=True),
            Door("laboratory door", 10.9, 5.4, 0.0, DOOR_M, swing_rad=math.pi / 2),
        ),
        lamps=(
            Lamp("hall west", 3.0, 3.2, 4.5, 0.4), Lamp("hall east", 10.5, 3.2, 4.5, 0.4),
            Lamp("office lamp", 2.3, 7.2, 3.0, 0.4), Lamp("meeting room lamp", 6.9, 7.2, 3.0, 0.4),
            Lamp("laboratory lamp", 11.5, 7.2, 3.0, 0.4),
        ),
        daylight=Daylight((0.0, 300.0, 600.0), (0.75, 0.5, 0.75), 600.0),
        boxes=(Box("parcel", 7.0, 3.3, 0.6, 0.5), Box("trolley", 12.9, 4.0, 0.5, 0.8, 0.9, present=False)),
        people=(
            Person("Ada", ((2.0, 4.4), (12.0, 4.4), (12.0, 1.2), (2.0, 1.2)), (2.0, 0.0, 3.0, 0.0), 0.7),
            Person("Alan", ((2.5, 3.6), (2.5, 6.6), (3.8, 6.6)), (4.0, 0.0, 15.0), 0.6, loop=False, colour=(150, 60, 50)),
            Person("Grace", ((12.8, 6.9), (11.5, 6.2), (11.5, 3.2), (8.8, 3.2)), (20.0, 0.0, 0.0, 5.0), 0.8, loop=False,
                   colour=(70, 120, 70)),
        ),
        slow_zones=(SlowZone("carpet", ((4.8, 5.6), (9.0, 5.6), (9.0, 8.8), (4.8, 8.8)), 0.6),),
        script=(
            Event(90.0, "close_door", "meeting room door"), Event(150.0, "open_door", "meeting room door"),
            Event(200.0, "lamp_off", "hall east"), Event(260.0, "lamp_on", "hall east"),
            Event(300.0, "box_appear", "trolley"), Event(420.0, "box_vanish", "trolley"),
        ),
    )  # fmt: skip


def suburb() -> World:
    """Seven by five blocks of houses, for runs of several hours."""
    rng = np.random.default_rng(66)
    width, depth, street, across, down = 26.0, 18.0, 4.0, 7, 5
    size_x, size_y = across * (width + street) + street, down * (depth + street) + street
    sketch = Sketch([(0, 0), (size_x, 0), (size_x, size_y), (0, size_y)], seed=67)
    for row in range(down):
        for column in range(across):
            x, y = street + column * (width + street), street + row * (depth + street)
            sketch.block(_houses(x, y, width, depth, rng))
    middle = (down // 2) * (depth + street) + street / 2
    return sketch.world(
        "suburb", "Suburb, 2.2 km of streets", "",
        "A grid of streets between houses, for runs of hours; after the suburb that RatSLAM mapped in 2008.",
        "ours",
        Start("home", street / 2, middle, 0.0),
        Place("first corner", 2 * street + width - street / 2, middle), Place("park", street / 2, middle + 22.0),
    )  # fmt: skip


def _houses(x: float, y: float, width: float, depth: float, rng: np.random.Generator) -> list[Point]:
    """The corners of a block, clockwise from the lower left: houses 5 to 8 m wide, each set back differently."""
    ring: list[Point] = []
    sides = (((x, y), (0, 1), (1, 0), depth), ((x, y + depth), (1, 0), (0, -1), width),
             ((x + width, y + depth), (0, -1), (-1, 0), depth), ((x + width, y), (-1, 0), (0, 1), width))  # fmt: skip
    for (cx, cy), (ax, ay), (ix, iy), length in sides:
        at, back = 2.0, 0.0
        while at < length - 4.0:
            end = min(at + float(rng.uniform(5.0, 8.0)), length - 2.0)
            back = round(back + float(rng.uniform(0.2, 1.0)), 2) % 1.4
            for along in (at, end):
                ring.append((round(cx + along * ax + back * ix, 3), round(cy + along * ay + back * iy, 3)))
            at = end
    return ring


MADE: tuple[Callable[[], World], ...] = (corridors, campus, open_plan, two_goals, twins, living, suburb)


def main() -> None:
    for make in MADE:
        world = make()
        (Path(__file__).parent / f"{world.name}.json").write_text(world_to_json(world), encoding="utf-8")
        print(f"{world.name}: {len(world.walls)} walls, {sum(len(w.panels) for w in world.walls)} panels")


if __name__ == "__main__":
    main()
