from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sim2d import Panel, SimParams, Wall, World, load_world
from sim2d.camera import atlas, camera, column_hits, painting
from sim2d.camera.atlas import Atlas
from sim2d.camera.camera import Camera
from sim2d.world.texture import paint_strip

from .literal import ray_length
from .rooms import GREY, room

PARAMS = SimParams()
RNG = np.random.default_rng(0)


def still(world: World, x: float, y: float, heading: float, params: SimParams = PARAMS) -> np.ndarray:
    return Camera(world, params).image(x, y, heading, 1.0, 0.0, RNG)


@pytest.fixture
def in_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """The kernels as plain Python, which coverage can see."""
    for name in ("_mean_along", "_paint_rows", "paint_columns", "expose"):
        monkeypatch.setattr(painting, name, getattr(painting, name).py_func)
    monkeypatch.setattr(camera, "paint_columns", painting.paint_columns)
    monkeypatch.setattr(camera, "expose", painting.expose)
    monkeypatch.setattr(camera, "column_hits", column_hits.column_hits.py_func)


def test_depth_is_the_analytic_distance() -> None:
    cam = Camera(room(), PARAMS)
    assert cam.depths(1.0, 2.0, 0.0) == pytest.approx(np.full(64, 3.0))  # a wall seen straight on: one depth
    assert cam.depths(1.0, 2.0, math.pi) == pytest.approx(np.full(64, 1.0))
    focal = 32 / math.tan(math.radians(25))
    off = (31.5 - np.arange(64)) / focal  # towards a corner: depth = d / (cos 45 + |off| sin 45)
    expected = 2.0 / (math.sqrt(0.5) * (1 + np.abs(off)))
    assert cam.depths(2.0, 2.0, math.pi / 4) == pytest.approx(expected)


def test_the_floor_line_carries_distance() -> None:
    """A wall d metres away meets the floor focal x eye / d pixels below the middle."""
    focal = 32 / math.tan(math.radians(25))
    for x in (1.0, 2.0):
        line = 24 + focal * PARAMS.camera_height_m / (4.0 - x)
        row = int(line)
        skirting, both, floor = still(room(), x, 2.0, 0.0)[row - 1 : row + 2, 32, 0].astype(float)
        assert floor - skirting > 20
        assert (floor - both) / (floor - skirting) == pytest.approx(line - row, abs=0.15)  # blended by the share


def test_low_things_do_not_hide_high_ones() -> None:
    desk = Wall(3, 1, 3, 3, "desk", 0.75, (20, 20, 20))
    bright = (Panel(0.0, 4.0, 1.0, 2.6, "paint", (250, 250, 250), 1, "left"),)
    image = still(room(desk, panels=bright), 1.0, 2.0, 0.0)
    middle = image[:, 32].mean(axis=1)
    assert middle[2] > 150  # above the desk: the wall behind it
    assert middle[26] < 40  # the desk
    assert middle[47] < middle[2]


def test_screens_float() -> None:
    screen = Wall(3, 1.5, 3, 2.5, "screen", 1.2, (5, 5, 5), bottom=0.8)
    image = still(room(screen), 0.5, 2.0, 0.0)[:, 32].mean(axis=1)
    rows = np.flatnonzero(image < 20)
    focal = 32 / math.tan(math.radians(25))
    assert rows[0] == pytest.approx(24 - 0.75 * focal / 2.5, abs=1.01)
    assert rows[-1] + 1 == pytest.approx(24 - 0.35 * focal / 2.5, abs=1.01)


def test_left_is_left() -> None:
    red = (Panel(2.2, 1.0, 0.2, 2.0, "paint", (255, 0, 0), 1, "left"),)  # on the east wall, north of its middle
    image = still(room(panels=red), 1.0, 2.0, 0.0).astype(int)
    redness = (image[:, :, 0] - image[:, :, 2]).sum(axis=0)
    assert redness[:32].sum() > 10 * max(1, redness[32:].sum())


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
    focal = 32 / math.tan(math.radians(25))
    floor = PARAMS.camera_height_m * focal / 23.5
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
    width, height = params.image_width, params.image_height
    focal = 0.5 * width / math.tan(0.5 * params.camera_fov_rad)
    strips = [(paint_strip(w, "left"), paint_strip(w, "right")) for w in world.walls]
    cos, sin = math.cos(heading), math.sin(heading)
    ceiling = max(w.height for w in world.walls)
    out = np.zeros((height, width, 3))
    for r in range(height * sub):
        up = (0.5 * height - (r + 0.5) / sub) / focal
        for c in range(width * sub):
            left = (0.5 * width - (c + 0.5) / sub) / focal
            dx, dy = cos - left * sin, sin + left * cos
            best, colour = math.inf, None
            for wall, (ahead, back) in zip(world.walls, strips, strict=True):
                ex, ey = wall.x2 - wall.x1, wall.y2 - wall.y1
                cross = dx * ey - dy * ex
                if abs(cross) < 1e-12:
                    continue
                px, py = wall.x1 - x, wall.y1 - y
                depth, u = (px * ey - py * ex) / cross, (px * dy - py * dx) / cross
                z = params.camera_height_m + up * depth
                if 0.02 < depth < best and 0 <= u < 1 and wall.bottom <= z < wall.height:
                    on_left = ex * -py + ey * px > 0
                    strip = ahead if on_left else back
                    i, j = int(u * len(strip)), int((wall.height - z) / (wall.height - wall.bottom) * strip.shape[1])
                    tone = (0.85 * ex - 0.5 * ey) / wall.length * (0.09 if on_left else -0.09) + 1.0
                    best, colour = depth, strip[i, min(j, strip.shape[1] - 1)] * tone / (1 + depth / params.fade_m)
            if colour is None:
                depth = (params.camera_height_m if up < 0 else params.camera_height_m - ceiling) / -up
                colour = np.array(world.floor_colour if up < 0 else world.ceiling_colour) / (1 + depth / params.fade_m)
            out[r // sub, c // sub] += colour / sub**2
    return out


POSES = [("office", 1.0, 1.0, 0.0), ("office", 5.2, 4.4, 3.0), ("office", 9.0, 7.0, -2.6), ("loop", 5.3, 0.8, 1.9)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "x", "y", "heading", "fade"), [*((*at, 14.0) for at in POSES), (*POSES[2], 3.0)])
def test_agrees_with_a_slow_ray_caster(name: str, x: float, y: float, heading: float, fade: float) -> None:
    """The whole image against an independent, supersampled one. Two differences are allowed: a column's middle ray
    decides which wall hides which, so silhouettes may be half a column off; and floor and ceiling fade by the middle of
    a row."""
    params = SimParams(image_width=32, image_height=24, fade_m=fade)
    world = load_world(name)
    fast = still(world, x, y, heading, params).astype(float)
    slow = slow_image(world, x, y, heading, params)
    difference = np.abs(fast - slow)
    assert np.median(difference) < 1.0
    assert difference.mean() < 4.5


@pytest.mark.parametrize(("name", "x", "y", "heading"), POSES)
@pytest.mark.usefixtures("in_python")
def test_python_and_compiled_agree(
    name: str, x: float, y: float, heading: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    world = load_world(name)
    params = SimParams(image_width=24, image_height=18)
    slow = still(world, x, y, heading, params)
    monkeypatch.undo()
    assert np.abs(still(world, x, y, heading, params).astype(int) - slow).max() <= 1


@pytest.mark.usefixtures("in_python")
def test_a_wall_through_the_camera_and_too_many_hits() -> None:
    """A wall that passes beside the camera is cut at the near plane; of twelve low walls the eight nearest are kept."""
    rows = [Wall(2.0 + 0.15 * k, 0.5, 2.0 + 0.15 * k, 3.5, "desk", 0.3, GREY) for k in range(12)]
    beside = [Wall(0.5, 2.3, 3.9, 2.3, "partition", 1.4, GREY), Wall(3.9, 1.7, 0.5, 1.7, "partition", 1.4, GREY)]
    for walls in (rows, rows[::-1], beside):
        cam = Camera(room(*walls), PARAMS)
        for x in (1.0, 1.9):
            got = cam.depths(x, 2.0, 0.0)
            segments = room(*walls).segments()
            focal = 32 / math.tan(math.radians(25))
            for c in range(64):
                angle = math.atan((31.5 - c) / focal)
                assert got[c] == pytest.approx(ray_length(segments, x, 2.0, angle, 99.0) * math.cos(angle), rel=1e-6)
            cam.image(x, 2.0, 0.0, 1.0, 0.0, RNG)


def test_no_wall_in_sight() -> None:
    assert np.isinf(Camera(room(), PARAMS).depths(5.0, 2.0, 0.0)).all()


def test_images_keep_still_where_the_robot_does_and_change_where_it_moves() -> None:
    """12 x 8 grey means, as recognition sees them. At the same place they differ by under 1 grey level; 0.3 m or 20
    degrees away, by over 8."""
    world = load_world("office")
    cam = Camera(world, PARAMS)
    cam.new_noise(np.random.default_rng(3))

    def template(x: float, y: float, heading: float) -> np.ndarray:
        image = cam.image(x, y, heading, 1.0, 1.0, RNG)[:, 2:62].mean(axis=2)
        return image.reshape(8, 6, 12, 5).mean(axis=(1, 3))

    rng = np.random.default_rng(5)
    same, moved, turned = [], [], []
    for _ in range(60):
        x, y, heading = rng.uniform(4.5, 5.8), rng.uniform(0.8, 7.2), rng.uniform(-3, 3)
        here = template(x, y, heading)
        same.append(np.abs(here - template(x, y, heading)).mean())
        moved.append(np.abs(here - template(x + 0.3 * math.sin(heading), y - 0.3 * math.cos(heading), heading)).mean())
        turned.append(np.abs(here - template(x, y, heading + math.radians(20))).mean())
    assert max(same) < 1.0
    assert np.median(moved) > 8.0
    assert np.median(turned) > 12.0


def test_equal_sides_share_texels() -> None:
    made = Atlas(room(Wall(1, 1, 2, 1, "partition", 1.4, GREY)).walls)
    assert (made.first[8] == made.first[9]).all()
    assert made.texels.dtype == np.float32


def test_a_side_is_painted_when_it_is_first_seen_and_never_otherwise() -> None:
    world = load_world()
    fresh, used = Camera(world, PARAMS), Camera(world, PARAMS)
    place = (world.starts[0].x, world.starts[0].y)
    rng = np.random.default_rng(0)
    for heading in np.linspace(0, 2 * math.pi, 9):
        used.image(*place, float(heading), 1.0, 0.0, rng)
    assert not fresh._atlas._painted.any()
    picture = fresh.image(*place, 0.3, 1.0, 0.0, rng)
    assert np.array_equal(picture, used.image(*place, 0.3, 1.0, 0.0, rng))
    assert 0 < fresh._atlas._painted.sum() < used._atlas._painted.sum() < used._atlas._painted.size


def test_what_another_camera_has_painted_of_the_same_walls_is_not_painted_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    world, other = load_world(), load_world("loop")
    used = Camera(world, PARAMS)
    place, rng = (world.starts[0].x, world.starts[0].y), np.random.default_rng(0)
    picture = used.image(*place, 0.3, 1.0, 0.0, rng)
    elsewhere = Camera(other, PARAMS, before=used)
    assert not elsewhere._atlas._painted.any()
    monkeypatch.setattr(atlas, "paint_strip", None)
    assert np.array_equal(Camera(world, PARAMS, before=used).image(*place, 0.3, 1.0, 0.0, rng), picture)


def test_of_two_walls_in_one_place_always_the_first_is_seen() -> None:
    """A plan may draw a line twice; in real plans hundreds of metres are. What is seen must not change with every tick."""
    red = Wall(0.0, 3.0, 4.0, 3.0, "wall", 2.6, (250, 0, 0))
    blue = Wall(3.7, 3.0, 0.3, 3.0, "wall", 2.6, (0, 0, 250))
    for first, second, k in ((red, blue, 0), (blue, red, 2)):
        world = replace(room(), walls=(*room().walls, first, second))
        for x, y, heading in np.random.default_rng(3).uniform((1.7, 0.5, 1.3), (2.3, 2.0, 1.8), (100, 3)):
            row = still(world, x, y, heading)[24, 16:48].astype(int)
            assert (row[:, k] > row[:, 2 - k] + 50).all()
