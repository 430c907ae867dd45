"""The robot's camera: the buffers and textures for the kernels of `sight` and `painting`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim2d.actors.actors import Actors
from sim2d.camera.atlas import Atlas
from sim2d.camera.element_walls import element_walls
from sim2d.camera.lights import Lights
from sim2d.camera.painting import Strips, expose, mirrored, paint_columns
from sim2d.camera.sight import MAX_HITS, MOST_FLAT_RAD, column_hits, lens_rays, round_hits, seen_walls
from sim2d.geometry.wall_index import WallIndex, build_index
from sim2d.params import SimParams
from sim2d.world.world import World

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
