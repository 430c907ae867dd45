"""The robot's camera: the buffers and textures for the kernels of `sight` and `painting`, the looks of doors, boxes and
people, and the brightness over the floor: daylight everywhere, plus each lamp that is on, where no wall hides it.
"""

from __future__ import annotations

import math
import zlib
from functools import lru_cache

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim2d.actors.actors import Actors
from sim2d.actors.walkers import PERSON_SIDES
from sim2d.camera.atlas import Atlas
from sim2d.camera.painting import Strips, expose, mirrored, paint_columns
from sim2d.camera.sight import MAX_HITS, MOST_FLAT_RAD, column_hits, lens_rays, round_hits, seen_walls
from sim2d.geometry.segments import differing
from sim2d.geometry.wall_index import WallIndex, build_index, first_wall
from sim2d.params import SimParams
from sim2d.world.world import Box, Door, Lamp, Panel, Person, Rgb, Wall, World

FEW_WALLS = 60  # up to this many, looking at every wall is as quick as searching for the visible ones
_NOTHING = np.zeros(0, np.int64)
_NOISE_BANK = 1 << 17
_MOST_NOISE = 3 * 640 * 480


class Camera:
    """Draws what is seen from a pose. It owns buffers, but an image does not depend on earlier images."""

    def __init__(
        self, world: World, params: SimParams, actors: Actors | None = None, index: WallIndex | None = None,
        before: Camera | None = None,
    ) -> None:  # fmt: skip
        """actors: of the same world; None: new ones. index: of all its walls, as `build_index` makes it.

        before: another camera; what it knows of the looks of the same walls is taken over. Use both from one thread.
        """
        self._noise = np.zeros(_NOISE_BANK + _MOST_NOISE, np.float32)
        if actors is None:
            actors = Actors(world, np.random.default_rng(0), params.tick_s)
        self.set_world(world, actors, build_index(world.segments()) if index is None else index, before)
        self.set_lens(params)

    def set_world(self, world: World, actors: Actors, index: WallIndex, before: Camera | None = None) -> None:
        """From now on draw another world, or the same one after an edit."""
        before = before or self
        walls = (*world.walls, *element_walls(world))
        self._world, self._actors, self._index = world, actors, index
        self._segments = np.concatenate([index.segments, actors.segments])
        self._walls_end = len(index.segments)
        tops = np.array([w.height for w in walls])
        highest = world.highest
        self._full = np.array([w.stands and w.height >= highest and w.kind != "glass" for w in walls])
        self._full[self._walls_end :] = False  # actors move, so none of them is sure to hide what is behind it
        self._glass = np.array([w.kind == "glass" for w in walls])
        self._has_glass = bool(self._glass.any())
        self._atlas = atlas = Atlas(walls, getattr(before, "_atlas", None))
        shades = _shades(np.concatenate([index.segments, _at_first(world)]))
        self._strips = Strips(
            atlas.texels, atlas.first, atlas.columns, atlas.rows, np.array([w.bottom for w in walls]), tops,
            shades, np.array([w.reflection if w.kind == "glass" else -1.0 for w in walls]),
        )  # fmt: skip
        self._lights = Lights(world, index, getattr(before, "_lights", None))
        self._marks = np.zeros(self._walls_end, np.int64)
        self._mark = 0
        self._chosen = np.zeros(len(walls), np.int64)
        self._numbers = np.arange(self._walls_end if self._walls_end <= FEW_WALLS else 0)
        if hasattr(self, "_width"):
            self._background = _background(world, self._height, self._focal, self._eye, self._fade)

    def follow(self, actors: Actors) -> None:
        """From now on draw these actors, of the same world."""
        self._actors = actors

    def set_lens(self, params: SimParams) -> None:
        """Set another field of view, resolution, height or fading of the camera."""
        self._width, self._height = params.image_width, params.image_height
        self._flat = params.camera_fov_rad <= MOST_FLAT_RAD
        self._rays, self._focal = lens_rays(self._width, params.camera_fov_rad)
        self._eye, self._fade = params.camera_height_m, params.fade_m
        self._background = _background(self._world, self._height, self._focal, self._eye, self._fade)
        self._counts = np.zeros(self._width, np.int64)
        self._walls = np.zeros((self._width, MAX_HITS), np.int64)
        self._hits = np.zeros((self._width, MAX_HITS, 3))
        self._glow = np.ones((self._width, MAX_HITS + 1))
        self._panes, self._mirror_strips = np.full(self._width, -1), np.full(self._width, -1)
        self._mirror_hits = np.zeros((self._width, 3))
        self._canvas = np.zeros((self._width, 3 * self._height), np.float32)

    def new_noise(self, rng: np.random.Generator) -> None:
        """Draw the noise of all images to come: 9216 deviates for each would take longer than the image itself."""
        self._noise = rng.standard_normal(_NOISE_BANK + _MOST_NOISE, dtype=np.float32)

    def same_noise(self, other: Camera) -> None:
        """Use the noise that another camera has drawn."""
        self._noise = other._noise

    def image(
        self,
        x: float,
        y: float,
        heading_rad: float,
        light: float,
        noise: float,
        rng: np.random.Generator,
        reflections: bool = True,
    ) -> NDArray[np.uint8]:
        """(height, width, 3) RGB. light: 1 = as painted; noise: sigma in grey levels. One draw from `rng`."""
        elements = self._look(x, y, heading_rad)
        eye = (x, y, heading_rad)
        actors = self._actors
        self._lights.glow(actors.lit, actors.daylight, eye, self._rays, self._counts, self._hits, self._glow)
        if self._has_glass:
            self._panes[:] = -1
        if self._has_glass and reflections:
            mirrored(
                self._index, self._segments, elements, self._glass, *eye, self._rays, self._counts, self._walls, self._hits,
                self._panes, self._mirror_strips, self._mirror_hits,
            )  # fmt: skip
            self._atlas.paint_seen(self._counts, self._walls, self._mirror_strips)
        else:
            self._atlas.paint_seen(self._counts, self._walls)
        paint_columns(
            self._strips, self._eye, self._focal, self._fade, self._background, self._glow, self._counts, self._walls,
            self._hits, self._panes, self._mirror_strips, self._mirror_hits, self._canvas,
        )  # fmt: skip
        out = np.empty((self._height, self._width, 3), np.uint8)
        expose(self._canvas, light, noise, self._noise, int(rng.integers(_NOISE_BANK)), out)
        return out

    def depths(self, x: float, y: float, heading_rad: float) -> NDArray[np.float64]:
        """(width,): distance (m) of the nearest thing in each column, inf where there is none.

        With a flat lens it is measured along the camera's axis, with a round one along the ray.
        """
        self._look(x, y, heading_rad)
        inverse = np.where(self._counts > 0, self._hits[:, 0, 0], 0.0)
        return np.divide(1.0, inverse, out=np.full(self._width, np.inf), where=inverse > 0)

    def _look(self, x: float, y: float, heading: float) -> NDArray[np.int64]:
        """Fill counts, walls and hits. Returns the numbers of the actors' sides that are present."""
        actors, n = self._actors, self._walls_end
        elements = _NOTHING
        if len(actors.segments):
            self._segments[n:] = actors.segments
            elements = n + np.flatnonzero(actors.present)
        if n > FEW_WALLS:
            self._mark += 1
            n = seen_walls(self._index, self._full, x, y, heading, self._rays, self._marks, self._mark, self._chosen)
        else:
            self._chosen[:n] = self._numbers
        chosen = self._chosen[: n + len(elements)]
        if len(elements):
            chosen[n:] = elements
        found = self._counts, self._walls, self._hits
        if self._flat:
            column_hits(self._segments, self._full, chosen, x, y, heading, self._focal, *found)
        else:
            round_hits(self._segments, self._full, chosen, x, y, heading, self._rays, *found)
        return elements


def _at_first(world: World) -> NDArray[np.float64]:
    """(n, 4): sides of doors, boxes and people as the world begins.

    They keep the shade of this moment wherever they turn. Otherwise it would depend on when the camera was given the
    world.
    """
    return Actors(world, np.random.default_rng(0), 1.0).segments


def _shades(segments: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2 n,): brightness of each wall's left and right side, by its direction, so that walls that meet differ."""
    dx, dy = segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]
    towards = (-dy * 0.5 + dx * 0.85) / np.hypot(dx, dy)  # of the left side's normal
    return np.stack([1.0 + 0.09 * towards, 1.0 - 0.09 * towards], axis=1).ravel()


def _background(world: World, height: int, focal: float, eye: float, fade: float) -> NDArray[np.float32]:
    """(3 height,): the colours of floor and ceiling, row by row, darker with distance."""
    ceiling = world.highest - eye
    down = np.arange(height) + 0.5 - 0.5 * height
    flat = np.where(np.abs(down) < 0.25, 0.25, down)
    depth = np.where(flat > 0, eye, -ceiling) * focal / flat
    colour = np.where(flat[:, None] > 0, world.floor_colour, world.ceiling_colour)
    return (colour / (1.0 + depth / fade)[:, None]).astype(np.float32).ravel()


_SKIN: tuple[Rgb, ...] = ((236, 200, 172), (198, 146, 108), (134, 92, 66))
_HAIR: tuple[Rgb, ...] = ((40, 32, 28), (96, 64, 40), (170, 140, 90), (150, 150, 152))


def element_walls(world: World) -> tuple[Wall, ...]:
    """A wall of the right size for each row of `Actors.segments`, in the same order. Its position has no meaning."""
    return _walls(world.doors, world.boxes, world.people)


@lru_cache(maxsize=8)
def _walls(doors: tuple[Door, ...], boxes: tuple[Box, ...], people: tuple[Person, ...]) -> tuple[Wall, ...]:
    """The same elements give the same objects, so that an edit of something else does not change them."""
    walls = [_leaf(door) for door in doors]
    for box in boxes:
        walls += _sides(box)
    for person in people:
        walls += _figure(person)
    return tuple(walls)


def _seed(name: str) -> int:
    return zlib.crc32(name.encode())


def _upright(width: float, height: float, kind: str, colour: Rgb, panels: tuple[Panel, ...]) -> Wall:
    return Wall(0.0, 0.0, width, 0.0, kind, height, colour, panels=panels)


def _leaf(door: Door) -> Wall:
    panel = Panel(0.0, door.width, 0.0, door.height, "door", door.colour, _seed(door.name), "both")
    return _upright(door.width, door.height, "door", door.colour, (panel,))


def _sides(box: Box) -> list[Wall]:
    walls: list[Wall] = []
    for k, width in enumerate((box.width, box.depth, box.width, box.depth)):
        label = Panel(
            0.15 * width,
            0.7 * width,
            0.2 * box.height,
            0.8 * box.height,
            "poster",
            box.colour,
            _seed(box.name) + k,
            "both",
        )
        walls.append(_upright(width, box.height, "box", box.colour, (label,)))
    return walls


def _figure(person: Person) -> list[Wall]:
    """A person's sides, with shoes, trousers, shirt, head and hair; those in front have a face."""
    seed, h = _seed(person.name), person.height
    skin, hair = _SKIN[seed % len(_SKIN)], _HAIR[seed // 7 % len(_HAIR)]
    trousers = (38 + seed % 60, 40 + seed % 50, 52 + seed % 70)
    width = 2 * person.radius * math.sin(math.pi / PERSON_SIDES)
    walls: list[Wall] = []
    for k in range(PERSON_SIDES):
        face = min(k, PERSON_SIDES - k) <= 1
        bands = (
            (0.0, 0.05, (20, 20, 22)),
            (0.05, 0.47, trousers),
            (0.84, 0.95, skin if face else hair),
            (0.95, 1.0, hair),
        )
        panels = tuple(Panel(0.0, width, a * h, b * h, "paint", c, 0, "both") for a, b, c in bands)
        stripe = Panel(0.3 * width, 0.4 * width, 0.5 * h, 0.8 * h, "poster", person.colour, seed + k, "both")
        walls.append(_upright(width, h, "person", person.colour, (*panels, stripe)))
    return walls


_CELL_M = 0.25
_MOST_CELLS = 1_000_000
_STEP_BACK_M = 0.15  # a wall is as bright as the floor this far in front of it

Spot = tuple[slice, slice, NDArray[np.float64]]  # rows and columns of the grid, and the light there


class Lights:
    """The light of the lamps of one world, on a grid over its floor. A world without lamps has no grid."""

    def __init__(self, world: World, index: WallIndex, before: Lights | None = None) -> None:
        """before: of a world that may differ in a few walls; lamps that none of these is near are taken over."""
        x0, y0, x1, y1 = world.bounds
        self._lamps = world.lamps
        self._cell = max(_CELL_M, math.sqrt((x1 - x0) * (y1 - y0) / _MOST_CELLS))
        self._corner = (x0, y0)
        self._shape = (int((y1 - y0) / self._cell) + 2, int((x1 - x0) / self._cell) + 2) if world.lamps else (0, 0)
        self._segments = index.segments
        known = {} if before is None else self._unchanged(before)
        self._spots = [known.get(lamp) or self._spot(lamp, index) for lamp in world.lamps]
        self._on: tuple[bool, ...] = ()
        self._total = np.zeros(self._shape)

    def glow(
        self,
        lamp_on: NDArray[np.bool_],
        daylight: float,
        eye: tuple[float, float, float],
        rays: NDArray[np.float64],
        counts: NDArray[np.int64],
        hits: NDArray[np.float64],
        out: NDArray[np.float64],
    ) -> None:
        """Fill out, (w, k + 1): the brightness of every hit and, last, of each column's floor and ceiling."""
        if not self._lamps:
            out[:] = daylight
            return
        on = tuple(lamp_on.tolist())
        if on != self._on:
            self._on = on
            self._total = np.zeros(self._shape)
            for is_on, (rows, columns, light) in zip(on, self._spots, strict=True):
                if is_on:
                    self._total[rows, columns] += light
        _glow(self._total, *self._corner, self._cell, daylight, *eye, rays, counts, hits, out)

    def _unchanged(self, before: Lights) -> dict[Lamp, Spot]:
        """The light of those lamps in whose reach no wall has changed."""
        if (before._cell, before._corner, before._shape) != (self._cell, self._corner, self._shape):
            return {}
        changed = np.array(differing(before._segments, self._segments)).reshape(-1, 2, 2)
        low, high = changed.min(axis=1), changed.max(axis=1)
        return {
            lamp: spot
            for lamp, spot in zip(before._lamps, before._spots, strict=True)
            if not ((low <= np.add((lamp.x, lamp.y), lamp.reach)) & (high >= np.subtract((lamp.x, lamp.y), lamp.reach)))
            .all(axis=1)
            .any()
        }

    def _spot(self, lamp: Lamp, index: WallIndex) -> Spot:
        """The part of the grid that a lamp reaches, and its light: b (1 - (d / reach)^2)^2 if no wall hides it."""
        x0, y0 = self._corner
        left, low = (max(0, int((p - lamp.reach - q) / self._cell)) for p, q in ((lamp.x, x0), (lamp.y, y0)))
        right = min(self._shape[1], int((lamp.x + lamp.reach - x0) / self._cell) + 1)
        high = min(self._shape[0], int((lamp.y + lamp.reach - y0) / self._cell) + 1)
        xs = np.asarray(x0 + (np.arange(left, right) + 0.5) * self._cell, np.float64)
        ys = np.asarray(y0 + (np.arange(low, high) + 0.5) * self._cell, np.float64)
        light = _lamp_light(index, lamp.x, lamp.y, lamp.reach, lamp.brightness, xs, ys)
        return slice(low, high), slice(left, right), light


@njit(cache=True, nogil=True)
def _lamp_light(
    index: WallIndex,
    x: float,
    y: float,
    reach: float,
    brightness: float,
    xs: NDArray[np.float64],
    ys: NDArray[np.float64],
) -> NDArray[np.float64]:
    out = np.zeros((ys.size, xs.size))
    for j in range(ys.size):
        for i in range(xs.size):
            dx, dy = xs[i] - x, ys[j] - y
            share = (dx * dx + dy * dy) / (reach * reach)
            if share < 1.0 and first_wall(index, x, y, dx, dy, 1.0)[1] >= 1.0:
                out[j, i] = brightness * (1.0 - share) ** 2
    return out


@njit(cache=True, nogil=True)
def _glow(
    total: NDArray[np.float64],
    x0: float,
    y0: float,
    cell: float,
    daylight: float,
    x: float,
    y: float,
    heading: float,
    rays: NDArray[np.float64],
    counts: NDArray[np.int64],
    hits: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    cos, sin = math.cos(heading), math.sin(heading)
    here = _at(total, (x - x0) / cell, (y - y0) / cell)
    for c in range(counts.size):
        ux, uy = rays[c, 0, 0] * cos - rays[c, 0, 1] * sin, rays[c, 0, 0] * sin + rays[c, 0, 1] * cos
        back = _STEP_BACK_M / math.hypot(ux, uy)
        light = here
        for k in range(counts[c]):
            t = max(1.0 / hits[c, k, 0] - back, 0.0)
            light = _at(total, (x + t * ux - x0) / cell, (y + t * uy - y0) / cell)
            out[c, k] = daylight + light
        out[c, out.shape[1] - 1] = daylight + 0.5 * (here + light)


@njit(cache=True, nogil=True)
def _at(total: NDArray[np.float64], u: float, v: float) -> float:
    """Bilinear interpolation between the centres of the four nearest cells."""
    u, v = min(max(u - 0.5, 0.0), total.shape[1] - 1.001), min(max(v - 0.5, 0.0), total.shape[0] - 1.001)
    i, j = int(u), int(v)
    f, g = u - i, v - j
    low = total[j, i] * (1.0 - f) + total[j, i + 1] * f
    high = total[j + 1, i] * (1.0 - f) + total[j + 1, i + 1] * f
    return low * (1.0 - g) + high * g
