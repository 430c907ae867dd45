"""What the plates show, as a browser receives it: maps, packets, flags, layers over the floors, what is inspected."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tests.fake_snapshots import fake_reports, fake_snapshot
from tests.unit.web.bench import Bench
from web.messages import Belief, Hypothesis, MapLayer, OccupancyPicture, Pose, TaggedPlace, TimesLayer
from web.viewer.fits.map_fit import DEPTH, WIDTH
from web.viewer.plates.map_plate import seconds_words


@pytest.fixture
def bench(shared: Bench) -> Bench:
    shared.show(fake_snapshot(430), 10.0)
    shared.settle()
    return shared


def floor(bench: Bench) -> bytes:
    """The picture on the pose cells' floor, as it travels."""
    return bench.node("/pose_cells/floor")["_data"]


# ---------------------------------------------------------------- what is laid over the floors


def test_occupancy_lies_under_the_map_while_it_is_switched_on(bench: Bench) -> None:
    bench.show(fake_snapshot(2000))
    bench.switch("occupancy", False)
    assert not bench.visible("/map/occupancy")
    bench.switch("occupancy", True)
    assert bench.visible("/map/occupancy")


def test_a_picture_that_comes_after_its_switch_was_turned_off_is_dropped(bench: Bench) -> None:
    snapshot = fake_snapshot(430)
    assert snapshot.occupancy is not None
    draw: Callable[[], OccupancyPicture] = snapshot.occupancy.draw_map

    def late() -> OccupancyPicture:
        bench.switches.turn("occupancy", False)
        return draw()

    bench.switch("occupancy", False)
    bench.switches.turn("occupancy", True)
    bench.show(replace(snapshot, occupancy=replace(snapshot.occupancy, draw_map=late)), 5.0)
    bench.settle()
    assert not bench.visible("/map/occupancy")
    bench.switch("occupancy", True)


def test_the_pose_cells_floor_shows_what_is_switched_on(bench: Bench) -> None:
    bench.show(fake_snapshot(2100))
    bench.switch("cell_occupancy", False)
    bench.switch("goal_memory", False)
    bare = floor(bench)
    assert not bench.visible("/pose_cells/way")
    assert not bench.visible("/pose_cells/goal")
    bench.switch("goal_memory", True)
    timed = floor(bench)
    assert timed != bare
    assert bench.visible("/pose_cells/way")
    assert bench.visible("/pose_cells/goal")
    bench.switch("cell_occupancy", True)
    assert floor(bench) not in (bare, timed)
    bench.switch("cell_occupancy", False)
    assert floor(bench) == timed
    bench.show(fake_snapshot(2100, goal=False), 2)
    bench.settle()
    assert not bench.visible("/pose_cells/way")
    assert floor(bench) == bare


# ---------------------------------------------------------------- maps, packets, flags


def test_a_map_that_outgrows_its_room_gets_more(bench: Bench) -> None:
    nodes = len([name for name in bench.nodes() if "/map/links_" not in name and "/map/nodes_" not in name])
    bench.show(fake_snapshot(450, nodes=2500), 5)
    bench.settle()
    assert len(bench.dots()) == 2500
    assert bench.dots("colors").any(1).all()
    assert len([name for name in bench.nodes() if "/map/links_" not in name and "/map/nodes_" not in name]) == nodes


def test_in_a_large_map_only_what_moves_is_sent(bench: Bench) -> None:
    """One experience of 2,500 moves: the dots and links around it are sent again, and nothing else of the map."""
    snapshot = fake_snapshot(450, nodes=2500)
    bench.show(snapshot, 5)
    bench.settle()
    xy = snapshot.map.xy.copy()
    xy[2000] += 0.05
    moved = bench.show(replace(snapshot, map=replace(snapshot.map, xy=xy), tick=snapshot.tick + 1), 5)
    assert moved["/map/nodes_7"] == 1
    assert sum(count for name, count in moved.items() if name.startswith("/map/nodes_")) == 1
    assert sum(count for name, count in moved.items() if name.startswith("/map/links_")) <= 3
    at = bench.viewer._scenery.map.fit.to_plate(xy[2000:2001])[0]
    assert np.abs(bench.dots()[2000, :2].astype(float) - at).max() < 0.02


def test_packets_bear_their_ids_whatever_their_rank(bench: Bench) -> None:
    s = fake_snapshot(440)
    first, second = s.pose_cells.packets
    swapped = replace(second, mass=first.mass), replace(first, mass=second.mass)
    for packets in ((first, second), swapped):
        bench.show(replace(s, pose_cells=replace(s.pose_cells, packets=packets)), 10.0)
        for k, packet in enumerate(packets):
            assert bench.says(f"/pose_cells/packet_{k}", f"{packet.id}   {100 * packet.mass:.0f} %")


def test_empty_plates_say_why(bench: Bench) -> None:
    s = fake_snapshot(432, goal=False)
    none = np.zeros(0, np.float32)
    nothing = MapLayer(np.zeros(0, np.int32), np.zeros((0, 2), np.float32), none, np.zeros((0, 2), np.int32))
    cells = replace(
        s.pose_cells, cells=s.pose_cells.cells[:0], activity=s.pose_cells.activity[:0], packets=(), last_snap=None
    )
    bare = replace(s, run=9, map=nothing, times=TimesLayer(False, none), pose_cells=cells, goal=None, trail=s.trail[:1])
    bench.show(bare, 5.0)
    assert bench.visible("/map/empty")
    assert bench.visible("/pose_cells/empty")
    assert not bench.visible("/pose_cells/snap_S")
    without = bench.node("/pose_cells/subtitle")["_data"]
    bench.show(fake_snapshot(433), 5.0)
    assert not bench.visible("/map/empty")
    assert bench.visible("/pose_cells/snap_S")
    assert bench.node("/pose_cells/subtitle")["_data"] != without  # it says what S and F are


def test_a_larger_world_is_scaled_and_low(bench: Bench) -> None:
    s = fake_snapshot(434)
    corners = [(30, 30), (30.5, 30), (30.5, 30.5), (30, 30.5), (30, 30)]  # a desk too small for a screen
    desk = [(*a, *b) for a, b in itertools.pairwise(corners)]
    walls = np.vstack([s.world.walls * 4, [(20, 5, 20, 9)], desk]).astype(np.float32)
    on_front_wall, screen = (3, 0, 4, 0, 1, 2), (10, 22.6, 10.5, 22.6, 0.8, 1.2)
    world = replace(
        s.world,
        bounds=(0, 0, 40, 32),
        walls=walls,
        wall_kind=(*s.world.wall_kind, "pillar", *("desk",) * 4),
        wall_height_m=np.append(s.world.wall_height_m, np.ones(5)).astype(np.float32),
        panels=np.array([on_front_wall, screen], np.float32),
        panel_rgb=s.world.panel_rgb[:2],
        places=(),
    )
    small = bench.node("/office/furniture_boxes")["batched_scales"]
    nodes = set(bench.nodes())
    bench.show(replace(s, world=world), 10)
    large = bench.node("/office/furniture_boxes")["batched_scales"]
    assert large[:, 2].max() < small[:, 2].max()  # lower, so that walls hide less
    bare = replace(world, walls=walls[:0], wall_kind=(), wall_height_m=world.wall_height_m[:0], panels=world.panels[:0])
    bench.show(replace(s, world=bare), 10)
    bench.show(s, 10)
    assert {name for name in bench.nodes() if "links" not in name} <= nodes


@pytest.mark.parametrize(
    ("state", "eta", "words"),
    [
        ("tracking", 7.4, "7 s"),
        ("tracking", 300.0, "5 min"),
        ("exploring", None, "? s"),
        ("arrived", 0.0, "arrived"),
        ("unreachable", None, "no way known"),
        ("arrived", 0.0, "arrived?"),
    ],
)
def test_the_flag_says_how_long(bench: Bench, state: str, eta: float | None, words: str) -> None:
    s = fake_snapshot(435)
    assert s.goal is not None
    short = replace(
        s.goal,
        state=state,
        eta_s=eta,
        route_xy=s.goal.route_xy[:1],
        route_arrival_s=s.goal.route_arrival_s[:1],
        lost=words.endswith("?"),
    )
    bench.show(replace(s, goal=short))
    assert bench.says("/map/flag/pill", words)


def test_a_dot_marks_each_experience_that_stands_for_the_goal(bench: Bench) -> None:
    s = fake_snapshot(436)
    assert s.goal is not None
    bench.show(replace(s, goal=replace(s.goal, places_xy=s.map.xy[:3])), 5)
    dots = bench.drawn("/map/flag_places", "vertices")
    middles = bench.viewer._scenery.map.fit.to_plate(s.map.xy[:3])
    near = np.hypot(*(dots[:, None, :2] - middles).T).T.min(1)
    assert near.max() < 0.1
    assert len(dots) % 3 == 0
    bench.show(replace(s, goal=None), 5)
    assert len(bench.drawn("/map/flag_places", "vertices")) == 0


def test_tagged_places_have_their_names_on_the_map(bench: Bench) -> None:
    s = fake_snapshot(437)
    tags = tuple(TaggedPlace(name, k, *s.map.xy[k].tolist()) for k, name in enumerate(("kitchen", "desk")))
    bench.show(replace(s, tags=tags), 5)
    assert bench.says("/map/tags_0_pill", "kitchen")
    assert bench.says("/map/tags_1_pill", "desk")
    assert bench.visible("/map/tags_1/ring")
    at = bench.node("/map/tags_1")["position"][:2]
    assert at == pytest.approx(bench.viewer._scenery.map.fit.to_plate(s.map.xy[1:2])[0], abs=0.02)
    assert not any("tags" in name for name in bench.show(replace(s, tags=tuple(tags)), 5))  # nothing has changed
    bench.show(replace(s, tags=tags[1:]), 5)
    assert bench.says("/map/tags_0_pill", "desk")
    assert not bench.visible("/map/tags_1/ring")
    assert not bench.visible("/map/tags_1_pill")


def test_seconds_in_words() -> None:
    assert seconds_words(119.0) == "119 s"


# ---------------------------------------------------------------- what is inspected


@pytest.mark.parametrize("kind", ["experience", "view", "cell", "why"])
def test_what_is_inspected_is_marked(bench: Bench, kind: str) -> None:
    bench.switch("goal_memory", False)
    bare = floor(bench)
    bench.show(replace(fake_snapshot(430), inspected=fake_reports()[kind]), 5)
    bench.settle()
    assert bench.visible("/map/inspected") == (kind == "experience")
    assert bench.visible("/map/inspected_name") == (kind == "experience")
    assert len(bench.drawn("/map/inspected_links"))
    assert bool(len(bench.drawn("/pose_cells/zone"))) == (kind not in ("view", "why"))
    assert bool(len(bench.drawn("/pose_cells/view_cells", "batched_positions"))) == (kind not in ("cell", "why"))
    assert (floor(bench) == bare) == (kind != "experience")  # where its zone of influence is
    bench.show(replace(fake_snapshot(430), inspected=None), 5)
    bench.settle()
    assert not bench.visible("/map/inspected")
    assert not len(bench.drawn("/map/inspected_links"))
    bench.switch("goal_memory", True)


def test_where_the_robot_may_be_instead_are_pale_arrows_with_how_likely_that_is(bench: Bench) -> None:
    snapshot = fake_snapshot(450)
    bench.show(snapshot, 5)
    bench.settle()
    assert not bench.visible("/map/other_0")
    here = snapshot.estimate
    other = Hypothesis(here.x, here.y, here.heading_rad, 0.3, (8.0, 12.0, 1.0))
    doubt = Belief(0.1, (other, replace(other, x=here.x + 1.0, share=0.1, cells=None)), 0, 0, 0, 0, 0, 0)
    bench.show(replace(snapshot, belief=doubt), 5)
    bench.settle()
    assert [bench.visible(f"/map/other_{k}") for k in range(3)] == [True, True, False]
    assert [bench.visible(f"/map/other_{k}_label") for k in range(3)] == [True, True, False]
    assert len(bench.drawn("/pose_cells/other")) == 24  # the sides of a ring: of the other place it has no state
    assert bench.node("/map/other_0")["position"][:2] == bench.node("/map/arrow")["position"][:2]
    bench.show(replace(snapshot, belief=replace(doubt, others=())), 5)
    bench.settle()
    assert not bench.visible("/map/other_0")


def test_without_a_map_the_robot_stays_on_the_plate_wherever_its_packet_is(bench: Bench) -> None:
    corners = np.array([(-8, -8), (8, -8), (8, 8), (-8, 8)], np.float32)
    one = np.zeros((1, 2), np.float32)
    only = MapLayer(np.zeros(1, np.int32), one, np.zeros(1, np.float32), np.zeros((0, 2), np.int32), corners)
    times = TimesLayer(False, np.zeros(1, np.float32))
    for x, y in corners.tolist():
        bench.show(replace(fake_snapshot(430), map=only, times=times, goal=None, estimate=Pose(x, y, 0.0)), 10.0)
        bench.settle()
        at = bench.node("/map/arrow")["position"]
        assert abs(at[0]) < WIDTH / 2
        assert abs(at[1]) < DEPTH / 2
