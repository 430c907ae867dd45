"""IROS 2005 V.D, point B: of two ways of one length, the robot takes the one that it could drive quickly.

In the world `two-goals` the wheels slip on the lower way. The robot is driven round both ways in both directions and then
goes from goal to goal by itself.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.config import Config
from app.protocol.course import Course
from app.protocol.steps import Drive, Tag, Visit
from app.session import Session
from sim2d import World, load_world

Place = str | tuple[float, float]
ROUND: list[Place] = [
    (20.0, 7.4), (18.2, 8.8), (5.8, 8.8), (4.0, 7.4), (2.2, 6.0), (4.0, 4.6), (5.8, 3.2), (18.2, 3.2), (20.0, 4.6), (21.8, 6.0),
]  # fmt: skip
BACK: list[Place] = [*ROUND[-2::-1], ROUND[-1]]
MIDDLE_Y = 6.0
TAGGED_M = 1.5  # which way it takes is asked, not where it stops; see docs/findings.md, What went in November


def slow_above() -> World:
    """The world with its slow floor on the upper way instead."""
    world = load_world("two-goals")
    (zone,) = world.slow_zones
    return replace(world, slow_zones=(replace(zone, corners=tuple((x, 2 * MIDDLE_Y - y) for x, y in zone.corners)),))


def ways(seed: int, world: World) -> tuple[Course, dict[str, float]]:
    """The course when it is over, and how high (y, m) the robot drove in the middle of each of its trips."""
    session = Session(world, seed, Config())
    course = Course(
        session,
        [
            Tag(do="tag", places=["goal 1", "goal 2"], within_m=TAGGED_M),
            Drive(do="drive", path=ROUND, laps=2, speed=0.36),
            Drive(do="drive", path=BACK, laps=2, speed=0.36),
            Visit(do="visit", places=["goal 1", "goal 2"], timeout_s=300, near_m=TAGGED_M),
        ],
    )
    heights: dict[str, list[float]] = {"goal 1": [], "goal 2": []}
    for what in course.ticks():
        session.tick()
        truth = session.simulator.truth
        if what.startswith("on the way to") and 9 < truth.x < 15:
            heights[what.removeprefix("on the way to ")].append(truth.y)
    return course, {name: float(np.mean(ys)) for name, ys in heights.items()}


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("upper", [True, False])
def test_the_slow_zone_flips_the_choice(seed: int, upper: bool) -> None:
    """upper: which way is quick. Without a slow floor both are, and either is taken."""
    course, heights = ways(seed, load_world("two-goals") if upper else slow_above())
    assert [visit.why for visit in course.visits] == ["", ""]
    assert max(visit.time_s for visit in course.visits) < 100  # as the slow way takes at least
    assert len(heights) == 2
    assert all((height > MIDDLE_Y) is upper and abs(height - MIDDLE_Y) > 1.5 for height in heights.values())
