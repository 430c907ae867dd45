"""What the stage shows beside the map itself is in its pictures too: laid where the same fits put it, while its switch is on."""

from __future__ import annotations

import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from tests.unit.web.crowded import FRAME, judged, taught, two_brains
from tests.unit.web.read_pictures import SVG, boxes, circles, drawn, ink, on_map, strokes, words
from web.messages import Pose
from web.switches import NAMES
from web.themes import THEMES
from web.viewer.fits.poses import compose, into_map, placed
from web.viewer.marks.ghost import PALE, PATH_PALE, pale
from web.viewer.marks.outline import clipped
from web.viewer.primitives.palette import BRAINS, DARK, mix
from web.viewer.vector import PlateName, vector_picture
from web.viewer.vector.sheet import EDGE, TOP, WIDTH

WALLS = mix(DARK.floor, DARK.wall, 0.75)


def test_the_outline_is_the_true_walls_by_the_fit_cut_off_at_the_field() -> None:
    snapshot = judged()
    assert snapshot.world is not None
    ends, (width, height) = on_map(snapshot, into_map(snapshot.world.walls.reshape(-1, 2).astype(float), FRAME))
    middle = np.array((EDGE + width / 2, TOP + height / 2))
    wanted = clipped((ends - middle).reshape(-1, 4), (width / 2, height / 2)).reshape(-1, 2, 2) + middle
    found = np.array(strokes(drawn("map", snapshot), WALLS))
    assert found.shape == wanted.shape
    assert 10 < len(found) < len(snapshot.world.walls) + 1
    assert np.abs(found - wanted).max() < 0.11


def test_the_ghost_is_at_its_place_with_its_way_and_how_far_off_it_is() -> None:
    snapshot = judged()
    assert snapshot.ghost is not None
    assert snapshot.truth is not None
    picture = drawn("map", snapshot)
    path = placed(np.asarray(snapshot.ghost.path, float), snapshot.ghost.map_start)
    way, _ = on_map(snapshot, path)
    points = np.vstack(strokes(picture, pale(DARK, DARK.robot, PATH_PALE)))
    assert np.abs(points[0] - way[0]).max() < 0.11
    assert np.abs(points[-1] - way[-1]).max() < 8
    body = next(p for p in picture.iter(f"{SVG}path") if p.get("fill") == ink(pale(DARK, DARK.robot, PALE)))
    corners = np.array(re.findall(r"-?\d+\.\d+", body.get("d", "")), float).reshape(-1, 2)
    assert np.hypot(*(corners.mean(0) - way[-1])) < 8
    office = compose(snapshot.ghost.office_start, snapshot.ghost.pose)
    off_m = np.hypot(office.x - snapshot.truth.x, office.y - snapshot.truth.y)
    for plate in ("map", "office"):
        assert f"wheels alone: {off_m:.0f} m off" in words(drawn(plate, snapshot))


def test_a_ghost_beside_the_field_leaves_its_name_at_the_edge() -> None:
    picture = drawn("map", judged(off_m=500.0))
    assert not any(path.get("fill") == ink(pale(DARK, DARK.robot, PALE)) for path in picture.iter(f"{SVG}path"))
    assert any(re.fullmatch(r"wheels alone: \d+ m off", text) for text in words(picture))


def test_a_ghost_beside_the_walls_is_there_as_far_as_the_plate_s_floor_goes() -> None:
    snapshot = judged()
    assert snapshot.world is not None
    narrow = replace(snapshot, world=replace(snapshot.world, bounds=(0.0, 0.0, 4.0, 8.0)))  # the ghost is at x = 5 m
    for off_m, there in ((0.0, True), (20.0, False)):
        way = replace(judged(off_m=off_m), world=narrow.world)
        picture = drawn("office", way)
        body = [p for p in picture.iter(f"{SVG}path") if p.get("fill") == ink(pale(DARK, DARK.robot, PALE))]
        assert bool(body) == there


def test_error_and_doubt() -> None:
    snapshot = judged()
    here, truth, spread = snapshot.estimate, snapshot.truth, snapshot.spread
    assert truth is not None
    assert spread is not None
    true = into_map(np.array([[truth.x, truth.y]]), FRAME)[0]
    ends, _ = on_map(snapshot, np.array([(here.x, here.y), true]))
    picture = drawn("map", snapshot)
    assert any(line.shape == (2, 2) and np.abs(line - ends).max() < 0.11 for line in strokes(picture, DARK.true_path))
    assert f"{np.hypot(*(true - (here.x, here.y))):.1f} m off" in words(picture)
    (oval,) = [line for line in strokes(picture, DARK.robot) if len(line) > 40]
    along = np.array([np.cos(spread.turn_rad), np.sin(spread.turn_rad)])
    tips = np.array([(here.x, here.y)]) + 2 * np.array([spread.along_m, -spread.along_m])[:, None] * along
    wanted, _ = on_map(snapshot, tips)
    for tip in wanted:
        assert np.hypot(*(oval - tip).T).min() < 0.2
    far = np.hypot(*(oval - ends[0]).T)
    assert far.max() / far.min() == pytest.approx(spread.along_m / spread.across_m, rel=0.02)


def test_an_error_that_leaves_the_field_is_told_where_it_does() -> None:
    """Also with a ring there, on which no words lie."""
    snapshot = judged(truth=Pose(400.0, 300.0, 0.0))
    true = into_map(np.array([[400.0, 300.0]]), FRAME)[0]
    here = np.array((snapshot.estimate.x, snapshot.estimate.y))
    (start, end), (width, height) = on_map(snapshot, np.stack([here, true]))
    picture = drawn("map", snapshot)
    (text,) = [text for text in picture.iter(f"{SVG}text") if re.fullmatch(r"[\d.]+ m off", text.text or "")]
    share = min(
        (edge - at) / along
        for at, along, low, high in zip(start, end - start, (EDGE, TOP), (EDGE + width, TOP + height), strict=True)
        for edge in (low, high)
        if (edge - at) / along > 0
    )
    leaves = start + share * (end - start)
    assert np.hypot(float(text.get("x", 0)) - leaves[0], float(text.get("y", 0)) - leaves[1]) < 90
    rings = circles(picture, DARK.packets[3])
    for left, top, right, bottom in boxes(picture):
        near = np.clip(rings, (left, top), (right, bottom))
        assert (np.hypot(*(near - rings).T) > 9).all()


def test_a_ring_at_each_closed_loop_and_the_newest_says_what_it_did() -> None:
    snapshot = judged()
    rows = [closure.end for closure in snapshot.closures]
    wanted, _ = on_map(snapshot, snapshot.map.xy[rows])
    picture = drawn("map", snapshot)
    assert circles(picture, DARK.packets[3]) == pytest.approx(wanted, abs=0.11)
    assert [text for text in words(picture) if text.startswith("loop closed")] == [
        "loop closed: moved the map by 0.4 m"
    ]
    late = drawn("map", replace(snapshot, time_s=snapshot.time_s + 60))
    assert len(circles(late, DARK.packets[3])) == 2
    assert not any(text.startswith("loop closed") for text in words(late))


def test_each_is_absent_while_its_switch_is_off() -> None:
    marks = {
        "outline": lambda picture: len(strokes(picture, WALLS)),
        "ghost": lambda picture: any("wheels alone" in text for text in words(picture)),
        "doubt": lambda picture: any(len(line) > 40 for line in strokes(picture, DARK.robot)),
        "closures": lambda picture: len(circles(picture, DARK.packets[3])),
    }
    for name in marks:
        picture = drawn("map", judged(), tuple(other for other in NAMES if other != name))
        assert [bool(found(picture)) for found in marks.values()] == [other != name for other in marks]
    plain = drawn("office", judged(), ())
    assert not any("wheels alone" in text for text in words(plain))
    nobody = judged(truth=None, world=None)
    for theme in THEMES:
        assert len(strokes(drawn("map", nobody, theme=theme), WALLS)) == 0


def test_a_lesson_marks_what_happened_and_what_was_predicted_on_each_plate() -> None:
    snapshot = taught()
    assert "put down here" in words(drawn("office", snapshot))
    told = words(drawn("map", snapshot))
    assert {"felt lost", "the answer", "predicted"} <= set(told)
    rings = circles(drawn("map", snapshot), DARK.text)
    wanted, _ = on_map(snapshot, np.array([(2.0, 2.0), (1.0, -0.5), (0.0, 0.8)]))
    assert rings == pytest.approx(wanted, abs=0.11)
    cells = drawn("pose", snapshot)
    assert "a snap" in words(cells)
    ways = np.vstack([way for way in strokes(cells, DARK.text) if len(way) == 2 and np.ptp(way, axis=0).max() < 8])
    assert ways[:, 0].min() < 100  # round the torus: it comes in on the left,
    assert ways[:, 0].max() > WIDTH - 130  # and went out on the right
    assert not ((ways[:, 0] > 200) & (ways[:, 0] < 800)).any()


# ---------------------------------------------------------------- two brains


@pytest.mark.parametrize(("plate", "second"), [("pose", "pose_2"), ("map", "map_2")])
def test_each_of_two_brains_has_its_own_plates_under_its_name(plate: PlateName, second: PlateName) -> None:
    snapshot = two_brains()
    assert snapshot.beside is not None
    one, other = drawn(plate, snapshot), drawn(second, snapshot)
    for k, (picture, figures) in enumerate(((one, snapshot.beside.first), (other, snapshot.beside.second))):
        title = next(picture.iter(f"{SVG}text"))
        assert title.text == figures.name
        assert title.get("fill") == ink(BRAINS[True][k])
    nothing = dict.fromkeys(("beside", "ghost", "map_in_office", "spread", "occupancy", "goal_memory"))
    alone = replace(snapshot, closures=(), **nothing)
    theirs = replace(
        alone, pose_cells=snapshot.beside.pose_cells, map=snapshot.beside.map, times=snapshot.beside.times,
        estimate=snapshot.beside.estimate, goal=snapshot.beside.goal, map_turn_rad=snapshot.beside.map_turn_rad,
    )  # fmt: skip
    field, wanted = (next(g for g in picture if g.get("clip-path")) for picture in (other, drawn(plate, theirs)))
    assert ElementTree.tostring(field) == ElementTree.tostring(
        wanted
    )  # all of the second brain, and nothing of the first
    assert ElementTree.tostring(field) != ElementTree.tostring(next(g for g in one if g.get("clip-path")))


def test_of_one_brain_there_is_no_second_plate() -> None:
    with pytest.raises(ValueError, match="there is one brain only"):
        vector_picture("map_2", judged(), "dark", NAMES)
