"""The space of a tick: everything that the robot can touch in it, and nothing left from an earlier tick."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

from disk import copy_state
from sim2d import Drive, Simulator, load_world
from sim2d.actors.actors import Actors
from sim2d.geometry.segments import nearest_segment
from sim2d.physics.surroundings import Surroundings

REACH_M = 2.5  # half a metre of robot, and two metres a second for a second: the most that parameters allow


@pytest.mark.parametrize("name", ["office", "living", "suburb"])
def test_the_robot_meets_every_wall(name: str) -> None:
    """Wherever the robot is, everything within its reach in the next tick is in the space."""
    world, rng = load_world(name), np.random.default_rng(0)
    actors = Actors(world, np.random.default_rng(0), 0.1)
    surroundings, most = Surroundings(world, actors), 0
    x0, y0, x1, y1 = world.bounds
    solid = [*world.segments()[list(world.obstacles)], *actors.segments[: actors.first_box]]
    for _ in range(200):
        place = rng.uniform((x0, y0), (x1, y1))
        space = surroundings.space(*place.tolist(), REACH_M, 0.3)
        segments = [shape for shape in space.shapes if isinstance(shape, pymunk.Segment)]
        standing = {(*shape.a, *shape.b) for shape in segments}
        assert len(standing) == len(segments)
        for wall in solid:
            if nearest_segment(wall[None], *place)[1] <= REACH_M:
                assert tuple(wall) in standing
        for x, y, radius in actors.walkers.discs():
            near = [s for s in space.shapes if isinstance(s, pymunk.Circle) and s.offset == (x, y)]
            assert near or math.dist((x, y), place) > REACH_M + radius
        most = max(most, len(segments))
    assert most < 150  # of the suburb's 828


def test_boxes_stand_in_it_only_while_they_are_there() -> None:
    world = load_world("living")
    actors = Actors(world, np.random.default_rng(0), 0.1)
    surroundings = Surroundings(world, actors)

    def boxes() -> int:
        return sum(isinstance(shape, pymunk.Poly) for shape in surroundings.space(7.0, 3.3, 1.0, 0.3).shapes)

    assert boxes() == sum(box.present for box in world.boxes)
    actors.box_present[:] = False
    assert boxes() == 0


@pytest.mark.parametrize("turn", [0.0, 0.7, -1.2])
@pytest.mark.slow
def test_pressed_into_a_corner_a_copy_goes_on_bit_for_bit(turn: float) -> None:
    """Two contacts at once, where a solver that remembers earlier ticks would differ from one that does not."""
    world = load_world("office")
    simulator = Simulator(world, seed=4)
    simulator.teleport(0.4, 0.4, math.radians(225) + turn)
    touched, all_of_them = 0, [simulator]
    for tick in range(30):
        if tick % 3 == 0:
            copy = copy_state(simulator)
            copy.settle(world)
            all_of_them.append(copy)
        drive = Drive(0.5, 0.3 if tick < 20 else -0.2)
        frames = [each.step(drive) for each in all_of_them]
        touched += frames[0].bumped
        assert len({each.digest() for each in all_of_them}) == 1
    assert touched > 20
