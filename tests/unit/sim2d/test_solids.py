"""Walls in the space of the physics: all that the robot can touch before they are chosen anew."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest

from sim2d import load_world
from sim2d.geometry import nearest_segment
from sim2d.living import Living
from sim2d.solids import Solids

REACH_M = 2.5  # half a metre of robot, and two metres a second for a second: the most that parameters allow


@pytest.mark.parametrize("name", ["office", "living", "suburb"])
def test_the_robot_meets_every_wall(name: str) -> None:
    """Wherever it goes, on foot or carried, whatever is within its reach in the next tick stands in the space."""
    world, rng, space = load_world(name), np.random.default_rng(0), pymunk.Space()
    living = Living(world, np.random.default_rng(0), 0.1)
    solids = Solids(space, world, living)
    x0, y0, x1, y1 = world.bounds
    place, most = np.array([x0, y0]), 0
    for tick in range(400):
        if tick % 40 == 0:
            place = rng.uniform((x0, y0), (x1, y1))
        place = np.clip(place + rng.uniform(-1, 1, 2), (x0, y0), (x1, y1))
        solids.follow((float(place[0]), float(place[1])))
        if tick % 97 == 0:
            solids.furnish(world, living)  # as after an edit
            solids.follow((float(place[0]), float(place[1])))
        segments = [shape for shape in space.shapes if isinstance(shape, pymunk.Segment)]
        standing = {(*shape.a, *shape.b) for shape in segments}
        assert len(standing) == len(segments)
        for wall in world.segments()[list(world.obstacles)]:
            if nearest_segment(wall[None], *place)[1] <= REACH_M:
                assert tuple(wall) in standing
        most = max(most, len(segments))
    assert most < 150  # of the suburb's 828
