"""What the camera makes of walls, and of light: against plane geometry, and against a slow ray caster."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sim2d import SimParams, World, load_world
from sim2d.camera import atlas
from sim2d.camera.atlas import Atlas
from sim2d.camera.camera import Camera
from sim2d.world.texture import paint_strip

from .literal import ray_length
from .rooms import room, wall

PARAMS = SimParams()
FOCAL = 32 / math.tan(math.radians(25))
RNG = np.random.default_rng(0)


def still(world: World, x: float, y: float, heading: float, params: SimParams = PARAMS) -> np.ndarray:
    return Camera(world, params).image(x, y, heading, 1.0, 0.0, RNG)


def test_depth_is_the_analytic_distance() -> None:
    cam = Camera(room(), PARAMS)
    assert cam.depths(1.0, 2.0, 0.0) == pytest.approx(np.full(64, 3.0))  # a wall seen straight on: one depth
    assert cam.depths(1.0, 2.0, math.pi) == pytest.approx(np.full(64, 1.0))
    off = (31.5 - np.arange(64)) / FOCAL  # towards a corner: depth = d / (cos 45 + |off| sin 45)
    assert cam.depths(2.0, 2.0, math.pi / 4) == pytest.approx(2.0 / (math.sqrt(0.5) * (1 + np.abs(off))))
    assert np.isinf(cam.depths(5.0, 2.0, 0.0)).all()  # no wall in sight


def test_the_floor_line_carries_distance() -> None:
    """A wall d metres away meets the floor focal x eye / d pixels below the middle."""
    for x in (1.0, 2.0):
        line = 24 + FOCAL * PARAMS.camera_height_m / (4.0 - x)
        row = int(line)
        skirting, both, floor = still(room(), x, 2.0, 0.0)[row - 1 : row + 2, 32, 0].astype(float)
        assert floor - skirting > 20
        assert (floor - both) / (floor - skirting) == pytest.approx(line - row, abs=0.15)  # blended by the share


def test_noise_and_light() -> None:
    cam = Camera(room(), PARAMS)
    cam.new_noise(np.random.default_rng(1))
    plain = cam.image(1.0, 2.0, 0.0, 1.0, 0.0, RNG).astype(float)
    noisy = cam.image(1.0, 2.0, 0.0, 1.0, 3.0, RNG).astype(float)
    assert (noisy - plain).std() == pytest.approx(3.0, rel=0.05)
    dark = cam.image(1.0, 2.0, 0.0, 0.5, 0.0, RNG)
    assert dark == pytest.approx(plain / 2, abs=1.0)
    assert cam.image(1.0, 2.0, 0.0, 2.0, 50.0, RNG).max() == 255


def test_what_is_as_deep_as_the_fade_is_half_as_bright() -> None:
    """And in general 1 / (1 + depth / fade): a wall 1 and 3 m ahead, and the floor that the lowest row shows."""
    floor = PARAMS.camera_height_m * FOCAL / 23.5
    for row, depth, x in ((24, 3.0, 1.0), (24, 1.0, 3.0), (47, floor, 1.0)):
        seen = {
            fade: still(room(), x, 2.0, 0.0, SimParams(fade_m=fade))[row, 32].astype(float)
            for fade in (depth, 1.5, 14.0, 1000.0)
        }
        painted = seen[1000.0] * (1 + depth / 1000.0)
        assert seen[depth] == pytest.approx(painted / 2, abs=1.0)
        for fade, colour in seen.items():
            assert colour == pytest.approx(painted / (1 + depth / fade), abs=1.0)


def slow_image(world: World, x: float, y: float, heading: float, params: SimParams, sub: int = 4) -> np.ndarray:
    """The same picture the long way: sub x sub rays per pixel in three dimensions, each against every wall."""
    width, height, eye = params.image_width, params.image_height, params.camera_height_m
    focal = 0.5 * width / math.tan(0.5 * params.camera_fov_rad)
    up = (0.5 * height - (np.arange(height * sub)[:, None] + 0.5) / sub) / focal
    left = (0.5 * width - (np.arange(width * sub)[None] + 0.5) / sub) / focal
    dx, dy = math.cos(heading) - left * math.sin(heading), math.sin(heading) + left * math.cos(heading)
    ceiling = max(w.height for w in world.walls)
    level = np.where(up < 0, eye, eye - ceiling) / -up
    below = (
        np.where(up[..., None] < 0, world.floor_colour, world.ceiling_colour) / (1 + level / params.fade_m)[..., None]
    )
    shape = (height * sub, width * sub)
    best, colour = np.full(shape, math.inf), np.broadcast_to(below, (*shape, 3)).copy()
    for each in world.walls:
        ex, ey, px, py = each.x2 - each.x1, each.y2 - each.y1, each.x1 - x, each.y1 - y
        on_left = ex * -py + ey * px > 0
        strip = paint_strip(each, "left" if on_left else "right")
        tone = (0.85 * ex - 0.5 * ey) / each.length * (0.09 if on_left else -0.09) + 1.0
        with np.errstate(divide="ignore", invalid="ignore"):  # a ray along the wall
            depth, u = ((a / (dx * ey - dy * ex)) for a in (px * ey - py * ex, px * dy - py * dx))
            z = eye + up * depth
            seen = (depth > 0.02) & (depth < best) & (u >= 0) & (u < 1) & (each.bottom <= z) & (z < each.height)
        columns = np.nonzero(seen)[1]
        i = (u[0, columns] * len(strip)).astype(int)
        j = ((each.height - z[seen]) / (each.height - each.bottom) * strip.shape[1]).astype(int)
        far = depth[0, columns]
        colour[seen] = strip[i, np.minimum(j, strip.shape[1] - 1)] * tone / (1 + far / params.fade_m)[:, None]
        best[seen] = far
    return colour.reshape(height, sub, width, sub, 3).mean(axis=(1, 3))


def test_agrees_with_a_slow_ray_caster(subtests: pytest.Subtests) -> None:
    """The whole image against an independent, supersampled one. Two differences are allowed: a column's middle ray
    decides which wall hides which, so silhouettes may be half a column off; and floor and ceiling fade by the middle of
    a row."""
    for name, x, y, heading, fade in (
        ("office", 1.0, 1.0, 0.0, 14.0), ("office", 5.2, 4.4, 3.0, 14.0), ("office", 9.0, 7.0, -2.6, 14.0),
        ("loop", 5.3, 0.8, 1.9, 14.0), ("office", 9.0, 7.0, -2.6, 3.0),
    ):  # fmt: skip
        with subtests.test(f"{name}, {x}, {y}, {fade}"):
            world, params = load_world(name), SimParams(image_width=32, image_height=24, fade_m=fade)
            difference = np.abs(still(world, x, y, heading, params) - slow_image(world, x, y, heading, params))
            assert np.median(difference) < 1.0
            assert difference.mean() < 4.5


def test_a_wall_through_the_camera_and_too_many_hits() -> None:
    """A wall that passes beside the camera is cut at the near plane; of twelve low walls the eight nearest are kept."""
    rows = [wall(2.0 + 0.15 * k, 0.5, 2.0 + 0.15 * k, 3.5, kind="desk", height=0.3) for k in range(12)]
    beside = [wall(*ends, kind="partition", height=1.4) for ends in ((0.5, 2.3, 3.9, 2.3), (3.9, 1.7, 0.5, 1.7))]
    for walls in (rows, rows[::-1], beside):
        world = room(*walls)
        cam, segments = Camera(world, PARAMS), world.segments()
        for x in (1.0, 1.9):
            angles = [math.atan((31.5 - c) / FOCAL) for c in range(64)]
            slow = [ray_length(segments, x, 2.0, angle, 99.0) * math.cos(angle) for angle in angles]
            assert cam.depths(x, 2.0, 0.0) == pytest.approx(slow, rel=1e-6)
            cam.image(x, 2.0, 0.0, 1.0, 0.0, RNG)


def test_equal_sides_share_texels() -> None:
    made = Atlas(room(wall(1, 1, 2, 1, kind="partition", height=1.4)).walls)
    assert (made.first[8] == made.first[9]).all()
    assert made.texels.dtype == np.float32


def test_a_side_is_painted_when_it_is_first_seen_and_by_one_camera_for_all(monkeypatch: pytest.MonkeyPatch) -> None:
    painted, paint = list[object](), atlas.paint_strip

    def counted(*side: Any) -> Any:
        painted.append(side)
        return paint(*side)

    monkeypatch.setattr(atlas, "paint_strip", counted)
    world, other = load_world(), load_world("loop")
    place = (world.starts[0].x, world.starts[0].y)
    fresh, used = Camera(world, PARAMS), Camera(world, PARAMS)
    assert painted == []
    picture = fresh.image(*place, 0.3, 1.0, 0.0, RNG)
    at_once = len(painted)
    for heading in np.linspace(0, 2 * math.pi, 9).tolist():
        used.image(*place, heading, 1.0, 0.0, RNG)
    assert 0 < at_once < len(painted) - at_once < 2 * len(world.walls)
    assert np.array_equal(used.image(*place, 0.3, 1.0, 0.0, RNG), picture)
    painted.clear()
    elsewhere = Camera(other, PARAMS, before=used)
    assert np.array_equal(Camera(world, PARAMS, before=fresh).image(*place, 0.3, 1.0, 0.0, RNG), picture)
    assert painted == []
    start = other.starts[0]
    assert np.array_equal(elsewhere.image(start.x, start.y, 0.3, 1.0, 0.0, RNG), still(other, start.x, start.y, 0.3))


def test_of_two_walls_in_one_place_always_the_first_is_seen() -> None:
    """A plan may draw a line twice; in real plans hundreds of metres are. What is seen must not change with every tick."""
    red, blue = wall(0.0, 3.0, 4.0, 3.0, colour=(250, 0, 0)), wall(3.7, 3.0, 0.3, 3.0, colour=(0, 0, 250))
    for first, second, k in ((red, blue, 0), (blue, red, 2)):
        world = room(first, second)
        for x, y, heading in np.random.default_rng(3).uniform((1.7, 0.5, 1.3), (2.3, 2.0, 1.8), (100, 3)):
            row = still(world, x, y, heading)[24, 16:48].astype(int)
            assert (row[:, k] > row[:, 2 - k] + 50).all()
