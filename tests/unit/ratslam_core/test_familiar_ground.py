"""Ground that is known well: what is no longer learnt there, and what still is."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ratslam_core import Odometry, Packet, Pose2, RatSlam, RatSlamParams, Recognition
from ratslam_core.experience_map.experience_map import ExperienceMap
from ratslam_core.extensions import familiar_ground
from ratslam_core.extensions.familiar_ground import ENOUGH, LINKS, OBSERVATIONS, FamiliarGround, NewGround
from ratslam_core.laws import check

from .drives import CELL_M, EXACT, SHAPE, start

CRAWL = Odometry(0.001, 0.0, 0.1)
STILL = Odometry(0.0, 0.0, 0.1)
KNOWN = Recognition(0, False, 0, 0.0, 0.0)


class Visitor:
    """A robot that hardly moves, at a place with one experience of view 0."""

    def __init__(self, observations: int = 0, *, plain: bool = False) -> None:
        """It has recognised the place so many times."""
        self.ground = FamiliarGround()
        ground = NewGround() if plain else self.ground
        self.map = ExperienceMap(SHAPE, CELL_M, replace(EXACT, odometry_drift=0.03), ground=ground)
        self.views = 0
        self.look(Recognition(0, True, -1, math.inf, 0.0))
        for _ in range(observations):
            self.look(KNOWN)

    def look(self, seen: Recognition, odometry: Odometry = CRAWL, *, x: float = 32.0, lost: bool = False) -> bool:
        created = self.map.step(Packet(x, 32.0, 0.0, 1.0), seen, odometry)
        self.map.ground.note(self.map, seen, created, odometry, lost)
        return created

    def unknown(self) -> bool:
        """See what no view is like, as the local view tells it. True when an experience was made of it."""
        if self.map.ground.familiar:
            return self.look(Recognition(-1, False, 0, 50.0, familiar=True))
        self.views += 1
        return self.look(Recognition(self.views, True, 0, 50.0, 0.0))


def test_a_place_becomes_familiar_when_it_is_recognised() -> None:
    """Observations of a robot that stands still do not count."""
    visitor, kept = Visitor(), 1 - 1 / OBSERVATIONS
    for _ in range(200):
        visitor.look(KNOWN, STILL)
    assert (visitor.ground.share[0], visitor.ground.familiar) == (0.0, False)
    needed = math.ceil(math.log(1 - ENOUGH) / math.log(kept))  # the share after k observations is 1 - kept^k
    for seen in range(1, needed + 3):
        visitor.look(KNOWN)
        assert visitor.ground.share[0] == pytest.approx(1 - kept**seen)
        assert visitor.ground.familiar is (seen >= needed)


def test_on_familiar_ground_an_unknown_observation_is_let_go() -> None:
    visitor = Visitor(100)
    assert not visitor.unknown()
    assert (len(visitor.map), visitor.map.active, visitor.ground.let_go["sights"]) == (1, 0, 1)
    assert visitor.map.robot.x == pytest.approx(101 * 1e-4)  # odometry goes on


def test_a_place_that_changes_is_learnt_anew() -> None:
    """Nothing is recognised any more: after some time views are recruited, until they are recognised."""
    visitor = Visitor(200)
    made = [visitor.unknown() for _ in range(100)]
    assert not any(made[:10])
    assert any(made)
    grown = len(visitor.map)
    assert grown < 100
    newest = Recognition(int(visitor.map.views[-1]), False, 0, 0.0, 0.0)
    for _ in range(100):
        visitor.look(newest)
    assert not any(visitor.unknown() for _ in range(5))
    assert len(visitor.map) == grown


@pytest.mark.parametrize("why", ["lost", "unsure", "elsewhere", "turned", "carried"])
def test_ground_is_familiar_only_to_a_robot_that_is_sure_to_be_there(why: str) -> None:
    visitor = Visitor(100)
    assert visitor.ground.familiar
    if why == "carried":
        visitor.map.declare_kidnapped()
    else:
        if why == "unsure":
            visitor.map.pose_filter.forget(1.0)
        if why in ("elsewhere", "turned"):
            visitor.map.pose_filter.local = Pose2(0.5, 0.0, 0.0) if why == "elsewhere" else Pose2(0.0, 0.0, 0.4)
        visitor.ground.note(visitor.map, KNOWN, False, STILL, why == "lost")
    assert not visitor.ground.familiar
    assert len(visitor.ground.near) == 0


def test_a_known_view_at_its_place_makes_no_experience() -> None:
    """The pose cells have drifted by five cells, but the map says that the robot is at the view's experience."""
    visitor = Visitor(1)
    assert not visitor.look(KNOWN, x=37.0)
    assert (len(visitor.map), visitor.ground.let_go["experiences_adopted"]) == (1, 1)
    twin = ExperienceMap(SHAPE, CELL_M, EXACT)  # as in the papers
    for x, made in ((32.0, True), (32.0, False), (37.0, True)):
        assert twin.step(Packet(x, 32.0, 0.0, 1.0), KNOWN, CRAWL) is made


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), min_size=1, max_size=150))
def test_no_place_gets_links_without_end(steps: list[tuple[int, int]]) -> None:
    """Ten experiences, and transitions between them by chance: no more than LINKS a place; those that exist stay."""
    map_ = ExperienceMap(SHAPE, CELL_M, replace(EXACT, link_confidence=0.0), ground=FamiliarGround())
    for view in range(10):
        map_.step(Packet(32.0, 32.0, 0.0, 1.0), Recognition(view, True, -1, math.inf, 0.0), CRAWL)
    chain = map_.link_count
    for pair in steps:
        for view in pair:
            known = {(i, j) for i, j in map_.links.tolist()}
            map_.step(Packet(32.0, 32.0, 0.0, 1.0), Recognition(view, False, view, 0.0, 0.0), CRAWL)
            assert known <= {(i, j) for i, j in map_.links.tolist()}
            assert map_.active == view
    assert map_.link_count <= chain + 10 * LINKS


def test_where_half_of_the_observations_are_recognised_memory_stops_growing() -> None:
    """As in an office at a fine grain: every other observation is a little unlike all views. The twin keeps them all."""
    visitor, twin = Visitor(), Visitor(plain=True)
    sizes = []
    for seen in range(400):
        for robot in (visitor, twin):
            robot.look(KNOWN) if seen % 2 else robot.unknown()
        sizes.append((len(visitor.map), len(twin.map)))
    assert sizes[-1][0] == sizes[99][0] < 60
    assert sizes[-1][1] == 201


def test_without_an_experience_map_every_observation_is_learnt() -> None:
    params = RatSlamParams()
    brain = RatSlam(replace(params, experience_map=replace(params.experience_map, enabled=False)))
    assert isinstance(brain.experience_map.ground, NewGround)
    image = np.random.default_rng(0).integers(0, 255, (48, 64), np.uint8)
    brain.step(image, STILL)
    assert not brain.experience_map.ground.familiar


def test_a_place_has_room_for_so_many_views_and_the_oldest_fades(monkeypatch: pytest.MonkeyPatch) -> None:
    """A place that looks different at every observation: of its four views the one longest not recognised makes room."""
    monkeypatch.setattr(familiar_ground, "VIEWS", 4)
    monkeypatch.setattr(familiar_ground, "OBSERVATIONS", 1000)
    visitor = Visitor()
    for _ in range(3):
        visitor.unknown()
    visitor.look(KNOWN)
    visitor.unknown()
    ground, first = visitor.ground, visitor.map.views.tolist()
    assert ground.faded == 1  # view 0 was recognised since
    assert visitor.look(Recognition(1, True, 0, 50.0, 0.0))
    assert ground.let_go["views_faded"] == 1
    assert visitor.map.views.tolist() == [first[0], -1, *first[2:], 1]
    assert ground.faded == 2


def test_what_takes_the_room_of_a_view_is_new() -> None:
    """It has no links of the old one, rests as a new one, and looks as what was seen."""
    circle, brain = start()
    circle.advance(brain, 120)
    view, views = int(brain.experience_map.views[0]), len(brain.local_view)
    assert len(brain.view_links.of(view)[0]) > 0
    ground = brain.experience_map.ground
    assert isinstance(ground, FamiliarGround)
    ground.familiar, ground.faded = False, view
    image = np.random.default_rng(3).integers(0, 255, (6, 8), np.uint8).repeat(8, 0).repeat(8, 1)
    seen = brain.step(image, STILL).recognition
    assert (seen.view, seen.recruited, len(brain.local_view)) == (view, True, views)
    assert np.array_equal(brain.local_view.stored(view), brain.local_view.features)
    assert brain.view_links.of(view)[1].sum() == pytest.approx(brain.params.local_view.learning_rate, rel=0.01)
    assert [i for i in range(len(brain.experience_map)) if brain.experience_map.views[i] == view] == [
        len(brain.experience_map) - 1
    ]
    check(brain)
