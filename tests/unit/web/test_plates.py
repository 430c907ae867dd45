"""What the plates show, as a browser receives it: maps, packets, flags, layers over the floors, what is inspected."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from tests.fake_snapshots import fake_reports, fake_snapshot
from tests.unit.web.bench import Bench
from web.messages import Belief, Hypothesis, MapLayer, OccupancyPicture, Pose, Snapshot, TaggedPlace, TimesLayer, Trip
from web.viewer.fits import DEPTH, WIDTH

PLAIN = fake_snapshot(430)
NOTHING = np.zeros(0, np.float32)


def see(stage: Bench, snapshot: Snapshot) -> None:
    """Show a moment until everything of it is drawn."""
    stage.show(snapshot, 5.0)
    stage.settle()


def floor(stage: Bench) -> bytes:
    """The picture on the pose cells' floor, as it travels."""
    return stage.node("/pose_cells/floor")["_data"]


def fixed_nodes(stage: Bench) -> set[str]:
    """All but those of the map's links and dots, of which a larger map has more."""
    return {name for name in stage.nodes() if "/map/links_" not in name and "/map/nodes_" not in name}


# ---------------------------------------------------------------- what is laid over the floors


def test_occupancy_lies_under_the_map_while_it_is_switched_on_and_none_that_comes_late(stage: Bench) -> None:
    for on in (False, True):
        stage.switch("occupancy", on)
        assert stage.visible("/map/occupancy") is on
    layer = PLAIN.occupancy
    assert layer is not None

    def late() -> OccupancyPicture:
        stage.switches.turn("occupancy", False)
        return layer.draw_map()

    stage.switch("occupancy", False)
    stage.switches.turn("occupancy", True)
    see(stage, replace(PLAIN, occupancy=replace(layer, draw_map=late)))
    assert not stage.visible("/map/occupancy")
    stage.switch("occupancy", True)


def test_the_pose_cells_floor_shows_what_is_switched_on(stage: Bench) -> None:
    stage.show(fake_snapshot(2100))
    stage.switch("cell_occupancy", False)
    stage.switch("goal_memory", False)
    bare, marks = floor(stage), ("/pose_cells/way", "/pose_cells/goal")
    assert not any(map(stage.visible, marks))
    stage.switch("goal_memory", True)
    timed = floor(stage)
    assert timed != bare
    assert all(map(stage.visible, marks))
    stage.switch("cell_occupancy", True)
    assert floor(stage) not in (bare, timed)
    stage.switch("cell_occupancy", False)
    assert floor(stage) == timed
    see(stage, fake_snapshot(2100, goal=False))
    assert not stage.visible("/pose_cells/way")
    assert floor(stage) == bare


# ---------------------------------------------------------------- maps, packets, flags


def test_a_map_that_outgrows_its_room_gets_more_and_of_a_large_one_only_what_moves_is_sent(stage: Bench) -> None:
    """One experience of 2,500 moves: the dots and links around it are sent again, and nothing else of the map."""
    snapshot, fixed = fake_snapshot(450, nodes=2500), fixed_nodes(stage)
    see(stage, snapshot)
    assert len(stage.dots()) == 2500
    assert stage.dots("colors").any(1).all()
    assert fixed_nodes(stage) == fixed
    xy = snapshot.map.xy.copy()
    xy[2000] += 0.05
    moved = stage.show(replace(snapshot, map=replace(snapshot.map, xy=xy), tick=snapshot.tick + 1), 5)
    assert {name: n for name, n in moved.items() if name.startswith("/map/nodes_")} == {"/map/nodes_7": 1}
    assert sum(n for name, n in moved.items() if name.startswith("/map/links_")) <= 3
    assert np.abs(stage.dots()[2000, :2].astype(float) - stage.on_map(xy[2000:2001])[0]).max() < 0.02


def test_packets_bear_their_ids_whatever_their_rank(stage: Bench) -> None:
    s = fake_snapshot(440)
    first, second = s.pose_cells.packets
    swapped = replace(second, mass=first.mass), replace(first, mass=second.mass)
    for packets in ((first, second), swapped):
        stage.show(replace(s, pose_cells=replace(s.pose_cells, packets=packets)), 10.0)
        for k, packet in enumerate(packets):
            assert stage.says(f"/pose_cells/packet_{k}", f"{packet.id}: {100 * packet.mass:.0f} %")


def test_empty_plates_say_why(stage: Bench) -> None:
    s = fake_snapshot(432, goal=False)
    nothing = MapLayer(np.zeros(0, np.int32), np.zeros((0, 2), np.float32), NOTHING, np.zeros((0, 2), np.int32))
    cells = replace(
        s.pose_cells, cells=s.pose_cells.cells[:0], activity=s.pose_cells.activity[:0], packets=(), last_snap=None
    )
    bare = replace(s, run=9, map=nothing, times=TimesLayer(False, NOTHING), pose_cells=cells, trail=s.trail[:1])
    names, seen = ("/map/empty", "/pose_cells/empty", "/pose_cells/snap_S"), []
    for moment in (bare, fake_snapshot(433)):
        stage.show(moment, 5.0)
        seen.append((*map(stage.visible, names), stage.node("/pose_cells/subtitle")["_data"]))
    assert [one[:3] for one in seen] == [(True, True, False), (False, False, True)]
    assert seen[0][3] != seen[1][3]  # it says what S and F are


def test_a_larger_world_is_scaled_and_low(stage: Bench) -> None:
    s = fake_snapshot(434)
    corners = [(30, 30), (30.5, 30), (30.5, 30.5), (30, 30.5), (30, 30)]  # a desk too small for a screen
    desk = [(*a, *b) for a, b in itertools.pairwise(corners)]
    walls = np.vstack([s.world.walls * 4, [(20, 5, 20, 9)], desk]).astype(np.float32)
    on_front_wall, screen = (3, 0, 4, 0, 1, 2), (10, 22.6, 10.5, 22.6, 0.8, 1.2)
    world = replace(
        s.world, bounds=(0, 0, 40, 32), walls=walls, wall_kind=(*s.world.wall_kind, "pillar", *("desk",) * 4),
        wall_height_m=np.append(s.world.wall_height_m, np.ones(5)).astype(np.float32), places=(),
        panels=np.array([on_front_wall, screen], np.float32), panel_rgb=s.world.panel_rgb[:2],
    )  # fmt: skip
    small, nodes = stage.node("/office/furniture_boxes")["batched_scales"], set(stage.nodes())
    stage.show(replace(s, world=world), 10)
    large = stage.node("/office/furniture_boxes")["batched_scales"]
    assert large[:, 2].max() < small[:, 2].max()  # lower, so that walls hide less
    bare = replace(world, walls=walls[:0], wall_kind=(), wall_height_m=world.wall_height_m[:0], panels=world.panels[:0])
    stage.show(replace(s, world=bare), 10)
    stage.show(s, 10)
    assert {name for name in stage.nodes() if "links" not in name} <= nodes


@pytest.mark.parametrize(
    ("state", "eta", "words"),
    [
        ("tracking", 7.4, "7 s"),
        ("tracking", 119.0, "119 s"),
        ("tracking", 300.0, "5 min"),
        ("exploring", None, "no route yet: on another submap"),
        ("arrived", 0.0, "arrived"),
        ("unreachable", None, "no route: on another submap"),
        ("arrived", 0.0, "arrived?"),
    ],
)
def test_the_flag_says_how_long(stage: Bench, state: str, eta: float | None, words: str) -> None:
    assert PLAIN.goal is not None
    way, arrival, lost = PLAIN.goal.route_xy[:1], PLAIN.goal.route_arrival_s[:1], words.endswith("?")
    why = "on another submap" if "route" in words else ""
    short = replace(PLAIN.goal, state=state, eta_s=eta, route_xy=way, route_arrival_s=arrival, lost=lost, why=why)
    stage.show(replace(PLAIN, goal=short))
    assert stage.says("/map/flag/pill", words)


def test_a_dot_marks_each_experience_that_stands_for_the_goal(stage: Bench) -> None:
    assert PLAIN.goal is not None
    stage.show(replace(PLAIN, goal=replace(PLAIN.goal, places_xy=PLAIN.map.xy[:3])), 5)
    dots = stage.drawn("/map/flag_places", "vertices")
    near = np.hypot(*(dots[:, None, :2] - stage.on_map(PLAIN.map.xy[:3])).T).T.min(1)
    assert near.max() < 0.1
    assert len(dots) % 3 == 0
    stage.show(replace(PLAIN, goal=None), 5)
    assert len(stage.drawn("/map/flag_places", "vertices")) == 0


def test_tagged_places_have_their_names_on_the_map(stage: Bench) -> None:
    tags = tuple(TaggedPlace(name, k, *PLAIN.map.xy[k].tolist()) for k, name in enumerate(("kitchen", "desk")))
    stage.show(replace(PLAIN, tags=tags), 5)
    assert stage.says("/map/tags_0_pill", "kitchen")
    assert stage.says("/map/tags_1_pill", "desk")
    assert stage.visible("/map/tags_1/ring")
    assert stage.node("/map/tags_1")["position"][:2] == pytest.approx(stage.on_map(PLAIN.map.xy[1:2])[0], abs=0.02)
    assert not any("tags" in name for name in stage.show(replace(PLAIN, tags=tuple(tags)), 5))  # nothing has changed
    stage.show(replace(PLAIN, tags=tags[1:]), 5)
    assert stage.says("/map/tags_0_pill", "desk")
    assert not stage.visible("/map/tags_1/ring")
    assert not stage.visible("/map/tags_1_pill")


def test_why_it_goes_there_is_written_at_the_target_unless_that_lies_over_the_robot(stage: Bench) -> None:
    x, y = PLAIN.map.xy[0].tolist()
    trip = Trip(x, y, "new ground, 14 m away", np.array([[x, y], [x + 1, y]], np.float32))
    for beside in (False, True):
        stage.show(replace(PLAIN, trip=replace(trip, beside=beside)), 5)
        assert stage.visible("/map/trip_0_pill") is not beside
    assert stage.says("/map/trip_0_pill", trip.reason)


# ---------------------------------------------------------------- what is inspected, and doubt


@pytest.mark.parametrize("kind", ["experience", "view", "cell", "why"])
def test_what_is_inspected_is_marked(stage: Bench, kind: str) -> None:
    stage.switch("goal_memory", False)
    bare = floor(stage)
    see(stage, replace(PLAIN, inspected=fake_reports()[kind]))
    assert stage.visible("/map/inspected") == stage.visible("/map/inspected_name") == (kind == "experience")
    assert len(stage.drawn("/map/inspected_links"))
    assert bool(len(stage.drawn("/pose_cells/zone"))) == (kind not in ("view", "why"))
    assert bool(len(stage.drawn("/pose_cells/view_cells", "batched_positions"))) == (kind not in ("cell", "why"))
    assert (floor(stage) == bare) == (kind != "experience")  # where its zone of influence is
    see(stage, replace(PLAIN, inspected=None))
    assert not stage.visible("/map/inspected")
    assert not len(stage.drawn("/map/inspected_links"))
    stage.switch("goal_memory", True)


def test_where_the_robot_may_be_instead_are_pale_arrows_with_how_likely_that_is(stage: Bench) -> None:
    here = PLAIN.estimate
    other = Hypothesis(here.x, here.y, here.heading_rad, 0.3, (8.0, 12.0, 1.0))
    doubt = Belief(0.1, (other, replace(other, x=here.x + 1.0, share=0.1, cells=None)), 0, 0, 0, 0, 0, 0)
    for belief, arrows in ((None, 0), (doubt, 2), (replace(doubt, others=()), 0)):
        see(stage, replace(PLAIN, belief=belief))
        for name in ("/map/other_{}", "/map/other_{}_label"):
            assert [stage.visible(name.format(k)) for k in range(3)] == [k < arrows for k in range(3)]
        if arrows:
            assert stage.node("/map/other_0")["position"][:2] == stage.node("/map/arrow")["position"][:2]
            assert (
                len(stage.drawn("/pose_cells/other")) == 24
            )  # the sides of a ring: of the other place it has no state


def test_without_a_map_the_robot_stays_on_the_plate_wherever_its_packet_is(stage: Bench) -> None:
    corners = np.array([(-8, -8), (8, -8), (8, 8), (-8, 8)], np.float32)
    one = np.zeros((1, 2), np.float32)
    only = MapLayer(np.zeros(1, np.int32), one, np.zeros(1, np.float32), np.zeros((0, 2), np.int32), corners)
    times = TimesLayer(False, np.zeros(1, np.float32))
    for x, y in corners.tolist():
        see(stage, replace(PLAIN, map=only, times=times, goal=None, estimate=Pose(x, y, 0.0)))
        at = stage.node("/map/arrow")["position"]
        assert abs(at[0]) < WIDTH / 2
        assert abs(at[1]) < DEPTH / 2
