"""The viewer's geometry: frames invert, views stop at walls, pills keep apart, ribbons are valid, paints are exact."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tests.fake_snapshots import fake_snapshot
from web.messages import Packet, Pose
from web.viewer.camera_views import camera_for, seen_by
from web.viewer.fits import (
    DEPTH,
    HEIGHT,
    LARGEST,
    SIDE,
    WIDTH,
    CellFit,
    MapFit,
    OfficeFit,
    broken_where_it_wraps,
    refit,
)
from web.viewer.marks.route import APART, overlap, pill_stops, spread
from web.viewer.plates.plate import point_on_plane
from web.viewer.plates.pose_cell_plate import ORIGIN, PILL_M, pill_places
from web.viewer.plates.sight import FAR_M, distances, fan_of_view, inside, solid_runs, solids
from web.viewer.primitives import images, meshes
from web.viewer.primitives import palette as paint
from web.viewer.primitives.palette import DARK, LARGE, LIGHT, mix, palette_of, rgb

WORLD = fake_snapshot(0).world
metres = st.floats(-60, 60)
angles = st.floats(-math.pi, math.pi)


# ---------------------------------------------------------------- frames


@given(metres, metres, st.floats(0.02, 1.2), angles, metres, metres)
def test_the_map_fit_inverts(x: float, y: float, scale: float, turn: float, cx: float, cy: float) -> None:
    fit = MapFit(scale, turn, (cx, cy))
    assert np.allclose(fit.to_map(fit.to_plate(np.array([[x, y]]))), [[x, y]], atol=1e-6)


@given(st.lists(st.tuples(metres, metres), min_size=1, max_size=40), angles)
def test_a_refitted_map_lies_on_the_floor(points: list[tuple[float, float]], turn: float) -> None:
    placed = refit(MapFit(), np.array(points), turn)
    xy = placed.to_plate(np.array(points))
    assert np.abs(xy[:, 0]).max() <= WIDTH / 2
    assert np.abs(xy[:, 1]).max() <= DEPTH / 2
    assert placed.scale <= LARGEST


def test_the_map_does_not_jitter_while_it_grows() -> None:
    xy = np.asarray(fake_snapshot(0).map.xy, np.float64)
    fit, changes = MapFit(), 0
    for n in range(1, len(xy), 5):
        before, fit = fit, refit(fit, xy[:n] + 0.02 * math.sin(n), 0.3)
        changes += fit is not before
    assert changes <= 8
    assert refit(fit, xy * 0.2, 0.3).scale > fit.scale or fit.scale > 0.7  # and it grows again when the map shrinks
    assert refit(MapFit(0.2, 0.3), xy * 0.3, 0.3).scale > 0.2
    assert refit(fit, np.zeros((0, 2)), 0.3).scale == LARGEST


@given(metres, metres, metres, metres, st.floats(0.5, 80), st.floats(0.5, 80))
def test_the_office_fit_inverts_and_any_world_fits(
    x: float, y: float, low_x: float, low_y: float, width: float, depth: float
) -> None:
    fit = OfficeFit((low_x, low_y, low_x + width, low_y + depth))
    assert np.allclose(fit.to_office(fit.to_plate(np.array([[x, y]]))), [[x, y]], atol=1e-6)
    corners = fit.to_plate(np.array([[low_x, low_y], [low_x + width, low_y + depth]]))
    assert np.all(np.abs(corners) <= np.array([5.0, 4.0]) + 1e-6)


def test_a_ray_beside_or_away_from_the_plate_meets_nothing() -> None:
    for beside_or_away in ([1.0, 0, 0], [0, 0, 1.0]):
        assert point_on_plane(np.array([0, 0, 5.0]), np.array(beside_or_away), (0, 0, 0)) is None


def test_cells_stand_in_the_box_and_the_torus_closes_and_no_path_is_drawn_across_the_box() -> None:
    fit = CellFit((36, 64, 64))
    middles = fit.cells(np.array([[0, 0, 0], [35, 63, 63]]))
    assert np.all(np.abs(middles[:, :2]) < SIDE / 2)
    assert np.all((middles[:, 2] > 0) & (middles[:, 2] < HEIGHT))
    layer = fake_snapshot(430).pose_cells
    edge = replace(layer, packets=(Packet(0, 0, 0, 0.5), Packet(32, 32, math.pi, 0.5)))
    edge = replace(edge, cells=np.array([[35, 63, 63], [18, 32, 32]], np.int32), activity=np.ones(2, np.float32))
    assert edge.owners().tolist() == [0, 1]
    assert replace(edge, packets=()).owners().tolist() == [0, 0]
    path = fit.path(np.array([[63, 5, 0.1], [0.5, 5, 0.1], [2, 5, 0.1], [2, 5, -0.1]]))
    assert len(broken_where_it_wraps(path)) == 1


# ---------------------------------------------------------------- sight


def sides(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
    """On which side of the lines from p to q the points r lie."""
    along, aside = q - p, r - p
    return along[..., 0] * aside[..., 1] - along[..., 1] * aside[..., 0]


@given(st.floats(0.05, 9.95), st.floats(0.05, 7.95), angles, st.floats(0.2, 3.0))
@settings(max_examples=60)
@pytest.mark.slow
def test_the_view_never_passes_a_wall(x: float, y: float, heading: float, fov: float) -> None:
    walls, eye = np.asarray(WORLD.walls, np.float64), np.array([x, y])
    rim = fan_of_view(walls, Pose(x, y, heading), fov, rays=31)
    turns = heading + np.linspace(-fov / 2, fov / 2, 31)
    reach = np.hypot(*(rim - eye).T)
    assert reach.max() <= FAR_M + 1e-9
    ways = 0.98 * reach[:, None] * np.column_stack([np.cos(turns), np.sin(turns)])
    ends, c, d = (eye + ways)[:, None], walls[:, :2], walls[:, 2:]  # an independent look along each ray
    crossed = (sides(eye, ends, c) * sides(eye, ends, d) < -1e-9) & (sides(c, d, eye) * sides(c, d, ends) < -1e-9)
    assert not (crossed & (np.abs(sides(c, d, eye)) >= 1e-6)).any()  # but where the eye stands on a wall's line


def test_without_walls_one_sees_far() -> None:
    assert distances(np.zeros((0, 4)), (0, 0), np.zeros(3)).tolist() == [FAR_M] * 3


def test_solid_furniture_is_found_and_desks_that_lean_on_a_partition_are_solid() -> None:
    assert len(solids(WORLD)) == 6
    assert inside(solids(WORLD)[0], 2.8, 5.7)
    corner = [(4, 2, 4, 2.75), (4, 2.75, 2.85, 2.75)]
    u_shape = [(3.8, 5.3, 3.8, 6.05), (3.8, 6.05, 2.3, 6.05), (2.3, 6.05, 2.3, 5.3)]
    lone, straight = [(8, 1, 9, 1)], [(5, 7, 6, 7), (6, 7, 7, 7)]
    rows = np.array([*corner, *u_shape, *lone, *straight, (0, 0, 1, 0), (1, 0, 1, 1)], np.float32)
    kinds = ("desk",) * 8 + ("partition",) * 2
    world = replace(WORLD, walls=rows, wall_kind=kinds, wall_height_m=np.full(10, 0.75, np.float32))
    runs = solid_runs(world)
    assert [(rows.start, rows.stop, len(outline)) for rows, outline in runs] == [(0, 2, 4), (2, 5, 4)]
    assert inside(runs[0][1], 3.0, 2.2)


# ---------------------------------------------------------------- pills and ribbons


@given(st.lists(st.tuples(st.floats(-4, 4), st.floats(-4, 4)), min_size=1, max_size=6), st.floats(0.6, 3.0))
@settings(max_examples=80)
def test_pills_do_not_overlap(centres: list[tuple[float, float]], width: float) -> None:
    places = spread(np.array(centres), np.full(len(centres), width), 0.6)
    assert not any(overlap(one, other, width, 0.6) for one, other in combinations(places, 2))
    stacked = spread(np.zeros((6, 2)), np.full(6, 2.0), 0.5, rounds=1)
    assert np.all(np.diff(np.sort(stacked[:, 1])) >= 0.5)


@given(st.lists(st.tuples(*(st.floats(-3.5, 3.5),) * 2, st.floats(0, 4.6)), min_size=2, max_size=4))
@settings(max_examples=60)
def test_packets_pills_are_apart_as_the_viewer_sees_them(tops: list[tuple[float, float, float]]) -> None:
    widths = np.full(len(tops), 2.1)
    seen, larger = seen_by(camera_for("all", 1.2), pill_places(np.array(tops), widths) + np.array(ORIGIN))
    for i, j in combinations(range(len(tops)), 2):
        mean = (larger[i] + larger[j]) / 2
        assert not overlap(seen[i], seen[j], 2.1 * mean, PILL_M * mean)


def test_pills_on_a_route_keep_their_distance_and_larger_ones_are_fewer() -> None:
    goal = fake_snapshot(4830).goal
    assert goal is not None
    end = goal.route_xy[-1].astype(float)
    stops = pill_stops(goal.route_xy.astype(float), goal.route_arrival_s.astype(float), end)
    assert 2 <= len(stops) <= 12
    for k, (_, x, y) in enumerate(stops):
        assert all(math.hypot(x - a, y - b) >= APART for _, a, b in stops[:k])
    assert pill_stops(np.array([[0, 0], [9000.0, 0]]), np.array([0, 9000.0]), np.array([9000.0, 0]))[0][0] > 100
    way = np.column_stack([np.linspace(0.0, 9.0, 90), np.zeros(90)])
    usual, larger = (pill_stops(way, np.linspace(0.0, 60.0, 90), way[-1], letters) for letters in (1.0, LARGE))
    assert len(larger) < len(usual)
    assert np.diff([x for _, x, _ in larger]).min() >= APART * LARGE


@given(st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5)), min_size=1, max_size=12))
def test_ribbons_are_finite_flat_and_face_up(line: list[tuple[float, float]]) -> None:
    points = meshes.smoothed(np.array(line), 0.2)
    vertices, faces = meshes.ribbon(points, 0.15, 0.1)
    assert np.isfinite(vertices).all()
    assert faces.max() < len(vertices)
    assert np.allclose(vertices[:, 2], 0.1)


def test_flat_shapes_face_up_and_prisms_outwards() -> None:
    def faces_of(mesh: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Where the faces look, and three times their middles."""
        a, b, c = (mesh[0][mesh[1][:, k]] for k in range(3))
        return np.cross(b - a, c - a), a + b + c

    square, bent = meshes.rounded_rectangle(2, 2, 0.5), np.array([[0.0, 0], [1, 0], [2, 1]])
    flat = meshes.disc((0, 0), 1, 0), meshes.ring(1, 0.2), meshes.flat_polygon(square, 0), meshes.ribbon(bent, 0.2, 0.0)
    for mesh in flat:
        assert np.all(faces_of(mesh)[0][:, 2] > -1e-6)
    outwards, middles = faces_of(meshes.extruded(square, 0, 1))
    assert np.all((outwards * (middles / 3 - [0, 0, 0.5])).sum(1) > -1e-6)
    outwards, middles = faces_of(meshes.sharp(meshes.UNIT_CUBE))
    assert np.all((outwards * middles).sum(1) > 0)


def test_no_more_segments_than_there_are_and_one_at_least() -> None:
    lines = meshes.open_line(np.arange(15, dtype=float).reshape(5, 3))
    assert np.array_equal(meshes.some(lines, 6), lines)
    assert np.array_equal(meshes.some(lines, 2), lines[-2:])
    assert meshes.some(lines[:0], 6).shape == (1, 2, 3)
    assert len(meshes.dashes(np.zeros(3), np.array([1.0, 0, 0]), 0.2, 0.1)) == 4


@given(arrays(np.float64, (40, 2), elements=st.floats(-3, 3)), st.floats(0.01, 1.0))
def test_a_thinned_way_has_both_ends_and_no_near_neighbours(way: np.ndarray, apart: float) -> None:
    kept = meshes.thinned(way, apart)
    assert np.array_equal(kept[[0, -1]], way[[0, -1]])
    assert np.all(np.hypot(*np.diff(kept[:-1], axis=0).T) >= apart)


# ---------------------------------------------------------------- colours


@given(st.tuples(*(st.integers(0, 235),) * 3))
def test_light_before_the_film_is_inverted(colour: tuple[int, int, int]) -> None:
    light = paint.before_film(paint.to_linear(np.array(colour) * 0.5 + 40))
    again = paint.before_film(paint.film(light))
    assert np.allclose(paint.film(again), paint.film(light), atol=2e-3)


def test_greys_show_as_wanted() -> None:
    for grey in (40, 90, 160, 220):
        light = paint.before_film(paint.to_linear((grey,) * 3))
        assert np.abs(paint.to_srgb(paint.film(light)).astype(int) - grey).max() <= 1


def test_times_run_from_bright_to_deep_and_unknown_is_grey() -> None:
    for palette in (DARK, LIGHT):
        colours = palette.times(np.array([0, 20, 40, np.inf], np.float32), 40.0)
        assert colours[3].tolist() == list(palette.unknown)
        assert colours[0].sum() > colours[1].sum() > colours[2].sum()
        assert len(palette.drawn(palette.rim)) == 3
        assert palette.batched(np.array([palette.desk])).shape == (1, 3)
    assert palette_of("light") is LIGHT
    assert mix(rgb("#000000"), rgb("#FFFFFF"), 0.5) == (128, 128, 128)


def test_a_floor_is_darker_beside_a_wall() -> None:
    floor = images.gridded_floor((4, 2), 40, (100, 100, 100), (120, 120, 120))
    wall, desk = np.array([[0.0, 40, 0, 80]]), [np.array([[100.0, 20], [140, 20], [140, 60]])]
    shaded = images.contact_shadow(floor, wall, desk, 8, 0.5)
    assert shaded[60, 2, 0] < shaded[60, 60, 0]
    assert shaded[30, 130, 0] < 80
    canvas = np.zeros((10, 10, 3), np.uint8)
    images.paste(canvas, np.full((4, 20, 3), 9, np.uint8), 5, 8)
    assert canvas[9, 9, 0] == 9
    assert images.sky((0, 0, 0), (9, 9, 9)).shape[2] == 3
    assert images.text("", (0, 0, 0)).shape[1] >= 1
