"""What the stage shows beside the map itself is in its pictures too, laid where the same fits put it."""

from __future__ import annotations

import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from tests.unit.web.crowded import FRAME, judged, taught, two_brains
from tests.unit.web.pictures import SVG, Picture, boxes, circles, corners, drawn, filled, ink, on_map, strokes, words
from web.messages import Pose
from web.viewer.fits import compose, into_map, placed
from web.viewer.marks.judged import clipped
from web.viewer.marks.robot import PALE, PATH_PALE, pale
from web.viewer.primitives.palette import BRAINS, DARK, mix
from web.viewer.vector import PlateName
from web.viewer.vector.sheet import EDGE, TOP, WIDTH

WALLS, GHOST = mix(DARK.floor, DARK.wall, 0.75), pale(DARK, DARK.robot, PALE)
JUDGED = judged()


def test_the_outline_is_the_true_walls_by_the_fit_cut_off_at_the_field() -> None:
    assert JUDGED.world is not None
    ends, (width, height) = on_map(JUDGED, into_map(JUDGED.world.walls.reshape(-1, 2).astype(float), FRAME))
    middle = np.array((EDGE + width / 2, TOP + height / 2))
    wanted = clipped((ends - middle).reshape(-1, 4), (width / 2, height / 2)).reshape(-1, 2, 2) + middle
    found = np.array(strokes(drawn("map", JUDGED), WALLS))
    assert found.shape == wanted.shape
    assert 10 < len(found) < len(JUDGED.world.walls) + 1
    assert np.abs(found - wanted).max() < 0.11
    assert strokes(drawn("map", judged(truth=None, world=None)), WALLS) == []


def test_the_ghost_is_at_its_place_with_its_way_and_how_far_off_it_is() -> None:
    ghost, truth, picture = JUDGED.ghost, JUDGED.truth, drawn("map", JUDGED)
    assert ghost is not None
    assert truth is not None
    way, _ = on_map(JUDGED, placed(np.asarray(ghost.path, float), ghost.map_start))
    points = np.vstack(strokes(picture, pale(DARK, DARK.robot, PATH_PALE)))
    assert np.abs(points[0] - way[0]).max() < 0.11
    assert np.abs(points[-1] - way[-1]).max() < 8
    assert np.hypot(*(corners(filled(picture, GHOST)[0]).mean(0) - way[-1])) < 8
    office = compose(ghost.office_start, ghost.pose)
    off_m = np.hypot(office.x - truth.x, office.y - truth.y)
    for plate in ("map", "office"):
        assert f"wheels alone: {off_m:.0f} m off" in words(drawn(plate, JUDGED))


def test_a_ghost_beside_the_field_leaves_its_name_at_the_edge_and_beside_the_walls_it_is_there() -> None:
    """As far as the plate's floor goes."""
    far = drawn("map", judged(off_m=500.0))
    assert filled(far, GHOST) == []
    assert any(re.fullmatch(r"wheels alone: \d+ m off", text) for text in words(far))
    assert JUDGED.world is not None
    narrow = replace(JUDGED.world, bounds=(0.0, 0.0, 4.0, 8.0))  # the ghost is at x = 5 m
    bodies = [filled(drawn("office", replace(judged(off_m=off_m), world=narrow)), GHOST) for off_m in (0.0, 20.0)]
    assert [bool(body) for body in bodies] == [True, False]


def test_error_and_doubt() -> None:
    here, truth, spread, picture = JUDGED.estimate, JUDGED.truth, JUDGED.spread, drawn("map", JUDGED)
    assert truth is not None
    assert spread is not None
    true = into_map(np.array([[truth.x, truth.y]]), FRAME)[0]
    ends, _ = on_map(JUDGED, np.array([(here.x, here.y), true]))
    assert any(line.shape == (2, 2) and np.abs(line - ends).max() < 0.11 for line in strokes(picture, DARK.true_path))
    assert f"{np.hypot(*(true - (here.x, here.y))):.1f} m off" in words(picture)
    (oval,) = [line for line in strokes(picture, DARK.robot) if len(line) > 40]
    along = np.array([np.cos(spread.turn_rad), np.sin(spread.turn_rad)])
    tips = np.array([(here.x, here.y)]) + 2 * np.array([spread.along_m, -spread.along_m])[:, None] * along
    for tip in on_map(JUDGED, tips)[0]:
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
    def said(picture: Picture) -> list[str]:
        return [text for text in words(picture) if text.startswith("loop closed")]

    picture, late = (drawn("map", replace(JUDGED, time_s=JUDGED.time_s + later_s)) for later_s in (0, 60))
    wanted, _ = on_map(JUDGED, JUDGED.map.xy[[closure.end for closure in JUDGED.closures]])
    for shown in (picture, late):
        assert circles(shown, DARK.packets[3]) == pytest.approx(wanted, abs=0.11)
    assert (said(picture), said(late)) == (["loop closed: moved the map by 0.4 m"], [])


def test_a_lesson_marks_what_happened_and_what_was_predicted_on_each_plate() -> None:
    snapshot = taught()
    assert "put down here" in words(drawn("office", snapshot))
    on_the_map, cells = drawn("map", snapshot), drawn("pose", snapshot)
    assert {"felt lost", "the answer", "predicted"} <= set(words(on_the_map))
    wanted, _ = on_map(snapshot, np.array([(2.0, 2.0), (1.0, -0.5), (0.0, 0.8)]))
    assert circles(on_the_map, DARK.text) == pytest.approx(wanted, abs=0.11)
    assert "a snap" in words(cells)
    ways = np.vstack([way for way in strokes(cells, DARK.text) if len(way) == 2 and np.ptp(way, axis=0).max() < 8])
    assert ways[:, 0].min() < 100  # round the torus: it comes in on the left,
    assert ways[:, 0].max() > WIDTH - 130  # and went out on the right
    assert not ((ways[:, 0] > 200) & (ways[:, 0] < 800)).any()


@pytest.mark.parametrize(("plate", "second"), [("pose", "pose_2"), ("map", "map_2")])
def test_each_of_two_brains_has_its_own_plates_under_its_name(plate: PlateName, second: PlateName) -> None:
    """All of the second brain is on the second plate, and nothing of the first."""

    def field(picture: Picture) -> bytes:
        return ElementTree.tostring(next(group for group in picture if group.get("clip-path")))

    snapshot = two_brains()
    beside = snapshot.beside
    assert beside is not None
    one, other = drawn(plate, snapshot), drawn(second, snapshot)
    for k, (picture, figures) in enumerate(((one, beside.first), (other, beside.second))):
        title = next(picture.iter(f"{SVG}text"))
        assert (title.text, title.get("fill")) == (figures.name, ink(BRAINS[True][k]))
    nothing = dict.fromkeys(("beside", "ghost", "map_in_office", "spread", "occupancy", "goal_memory"))
    theirs = replace(
        snapshot, closures=(), **nothing, pose_cells=beside.pose_cells, map=beside.map, times=beside.times,
        estimate=beside.estimate, goal=beside.goal, map_turn_rad=beside.map_turn_rad,
    )  # fmt: skip
    assert field(other) == field(drawn(plate, theirs))
    assert field(other) != field(one)
