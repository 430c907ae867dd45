"""Six minutes of wild driving in every world, people walking and doors working; ten hours of it: benchmarks/random_drive.py."""

from __future__ import annotations

import pytest

from benchmarks.random_drive import BAR_M, drive, with_people
from sim2d import load_world, world_names


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name, _ in world_names()])
def test_never_a_centimetre_into_a_wall(name: str) -> None:
    deepest = drive(with_people(load_world(name), seed=11), hours=0.1, seed=11)
    assert 0.0 < deepest.wall_m <= BAR_M  # the robot did drive against walls
    assert deepest.thing_m <= BAR_M


def test_the_same_seed_gets_as_deep_at_the_same_place_and_never_a_centimetre() -> None:
    world = load_world("living")
    deepest = drive(world, 0.05, 3)
    assert deepest == drive(world, 0.05, 3) != drive(world, 0.05, 4)
    for each in (deepest, drive(with_people(load_world("office"), 1), 0.05, 1)):
        assert 0.0 < each.wall_m <= BAR_M
        assert each.thing_m <= BAR_M
