"""Geometry as arrays for viser: ribbons along a line, discs, rings, fans, dashes, prisms.

A mesh is (vertices (v, 3) float32, faces (f, 3) uint32), wound so that flat ones face up.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Mesh = tuple[NDArray[np.float32], NDArray[np.uint32]]

NOWHERE = np.array([[(-50.0, -50.0, -50.0), (-50.0, -50.1, -50.0)]], np.float32)  # a segment far below the plates
NOTHING: Mesh = (np.full((3, 3), -50.0, np.float32), np.array([[0, 1, 2]], np.uint32))  # far below the plates
UNIT_CUBE: Mesh = (
    np.array([[x, y, z] for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)], np.float32),
    np.array(
        [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5],
        np.uint32,
    ).reshape(-1, 3),
)


def open_cube(ends: bool = True) -> Mesh:
    """`UNIT_CUBE` for use on a floor: no bottom, sharp edges, four corners per face. ends: with the faces across x."""
    corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    quads = [[(x, y, 0.5) for x, y in corners]]
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        if ends or ay == by:
            quads.append([(ax, ay, -0.5), (bx, by, -0.5), (bx, by, 0.5), (ax, ay, 0.5)])
    first = 4 * np.arange(len(quads), dtype=np.uint32)[:, None]
    faces = np.hstack([first, first + 1, first + 2, first, first + 2, first + 3]).reshape(-1, 3)
    return np.array(quads, np.float32).reshape(-1, 3), faces


def turned_box(centre: tuple[float, float, float], size: tuple[float, float, float], turn_rad: float) -> Mesh:
    """A box turned about the upright through its middle."""
    vertices, faces = UNIT_CUBE
    c, s = math.cos(turn_rad), math.sin(turn_rad)
    x, y, z = (vertices * np.array(size, np.float32)).T
    return np.column_stack([x * c - y * s, x * s + y * c, z]).astype(np.float32) + np.array(centre, np.float32), faces


def sharp(mesh: Mesh) -> Mesh:
    """The same mesh with separate corners for each face, so that edges stay sharp under smooth shading."""
    vertices, faces = mesh
    return vertices[faces.reshape(-1)], np.arange(faces.size, dtype=np.uint32).reshape(-1, 3)


def joined(*meshes: Mesh) -> Mesh:
    offsets = np.cumsum([0] + [len(vertices) for vertices, _ in meshes])
    faces = [faces + np.uint32(offset) for (_, faces), offset in zip(meshes, offsets, strict=False)]
    return np.vstack([vertices for vertices, _ in meshes]), np.vstack(faces).astype(np.uint32)


def lifted(xy: Points, z: float) -> Points:
    """(n, 2) as (n, 3) at height `z`."""
    return np.column_stack([xy, np.full(len(xy), z)])


def smoothed(xy: Points, step: float, rounds: int = 2) -> Points:
    """The line through (n, 2) with its corners cut (Chaikin), then resampled every `step`; the ends stay where they are."""
    line = np.asarray(xy, np.float64)
    for _ in range(rounds):
        if len(line) < 3:
            break
        near, far = line[:-1] * 0.75 + line[1:] * 0.25, line[:-1] * 0.25 + line[1:] * 0.75
        line = np.vstack([line[:1], np.stack([near, far], 1).reshape(-1, 2), line[-1:]])
    return resampled(line, step)


def resampled(xy: Points, step: float) -> Points:
    """A point every `step` along the line, and its end; at least two points."""
    arc = arc_length(xy)
    places = np.append(np.arange(0, arc[-1], step), arc[-1]) if arc[-1] > 0 else np.zeros(2)
    return np.column_stack([np.interp(places, arc, xy[:, k]) for k in range(xy.shape[1])])


def arc_length(xy: Points) -> Points:
    """(n,) distance from the first point along the line."""
    return np.append(0.0, np.cumsum(np.hypot(*np.diff(xy[:, :2], axis=0).T)))


def ribbon(xy: Points, width: float, z: float) -> Mesh:
    """A flat band of `width` along (n, 2), with round ends and joints without gaps."""
    line = _distinct(np.asarray(xy, np.float64))
    if len(line) < 2:
        return disc((float(line[0, 0]), float(line[0, 1])), width / 2, z)
    ahead = np.diff(line, axis=0)
    ahead /= np.hypot(*ahead.T)[:, None]
    before, after = np.vstack([ahead[:1], ahead]), np.vstack([ahead, ahead[-1:]])
    middle = before + after
    size = np.maximum(np.hypot(*middle.T), 0.6)[:, None]  # a mitre at most 3 times the width
    middle = middle / size * (2 / size)
    normal = np.column_stack([-middle[:, 1], middle[:, 0]]) * width / 2
    corners = np.stack([line + normal, line - normal], 1).reshape(-1, 2)
    first = np.arange(len(line) - 1, dtype=np.uint32)[:, None] * 2
    faces = np.hstack([first, first + 1, first + 2, first + 1, first + 3, first + 2]).reshape(-1, 3)
    body = (lifted(corners, z).astype(np.float32), faces.astype(np.uint32))
    ends = [disc((float(x), float(y)), width / 2, z) for x, y in (line[0], line[-1])]
    return joined(body, *ends)


def _distinct(line: Points) -> Points:
    keep = np.append(True, np.hypot(*np.diff(line, axis=0).T) > 1e-4)
    return line[keep]


def disc(centre: tuple[float, float], radius: float, z: float, corners: int = 20) -> Mesh:
    rim = circle(radius, centre, corners)
    index = np.arange(corners, dtype=np.uint32)
    faces = np.column_stack([np.full(corners, corners, np.uint32), index, (index + 1) % corners])
    return lifted(np.vstack([rim, [centre]]), z).astype(np.float32), faces.astype(np.uint32)


def ring(radius: float, width: float, z: float = 0.0, corners: int = 48) -> Mesh:
    """A flat ring around the origin; `radius` is that of its centre line."""
    unit = circle(1.0, corners=corners)
    points = np.stack([unit * (radius + width / 2), unit * (radius - width / 2)], 1).reshape(-1, 2)
    first = np.arange(corners, dtype=np.uint32)[:, None] * 2
    following = (first + 2) % (2 * corners)
    faces = np.hstack([first, following, first + 1, following, following + 1, first + 1]).reshape(-1, 3)
    return lifted(points, z).astype(np.float32), faces.astype(np.uint32)


def circle(radius: float, centre: tuple[float, float] = (0.0, 0.0), corners: int = 36) -> Points:
    """(n, 2) counter-clockwise outline, not closed."""
    angle = np.linspace(0, math.tau, corners, endpoint=False)
    return np.array(centre) + radius * np.column_stack([np.cos(angle), np.sin(angle)])


def rounded_rectangle(
    width: float, depth: float, radius: float, corners: int = 10, centre: tuple[float, float] = (0.0, 0.0)
) -> Points:
    """(n, 2) counter-clockwise outline, not closed."""
    turn = np.linspace(0, math.pi / 2, corners)
    centres = [(1, 1, 0), (-1, 1, 1), (-1, -1, 2), (1, -1, 3)]
    parts = [
        np.column_stack([np.cos(turn + q * math.pi / 2), np.sin(turn + q * math.pi / 2)]) * radius
        + (sx * (width / 2 - radius), sy * (depth / 2 - radius))
        for sx, sy, q in centres
    ]
    return np.vstack(parts) + np.array(centre)


def extruded(outline: Points, bottom: float, top: float) -> Mesh:
    """A prism over a convex counter-clockwise outline (n, 2): sides and top, with sharp edges."""
    return joined(sides(outline, bottom, top), flat_polygon(outline, top))


def sides(outline: Points, bottom: float, top: float) -> Mesh:
    """The same without its top."""
    n = len(outline)
    index = np.arange(n, dtype=np.uint32)
    following = (index + 1) % n
    quads = np.column_stack([index, following, index + n, following, following + n, index + n]).reshape(-1, 3)
    corners = np.vstack([lifted(outline, bottom), lifted(outline, top)])
    return sharp((corners.astype(np.float32), quads.astype(np.uint32)))


def flat_polygon(outline: Points, z: float) -> Mesh:
    """A convex counter-clockwise outline (n, 2), filled."""
    n = len(outline)
    fan = np.column_stack([np.zeros(n - 2), np.arange(1, n - 1), np.arange(2, n)]).astype(np.uint32)
    return lifted(outline, z).astype(np.float32), fan


def flat_fan(centre: tuple[float, float], rim: Points, z: float) -> Mesh:
    """Triangles from `centre` to neighbours on `rim` (n, 2), counter-clockwise."""
    n = len(rim)
    faces = np.column_stack([np.full(n - 1, n), np.arange(n - 1), np.arange(1, n)]).astype(np.uint32)
    return lifted(np.vstack([rim, [centre]]), z).astype(np.float32), faces


def heading_arrow(size: float, z: float) -> Mesh:
    """A flat arrow that points along x, with a notch behind."""
    return flat_fan((-0.2 * size, 0.0), size * np.array([(-0.4, -0.3), (0.5, 0.0), (-0.4, 0.3)]), z)


def closed_line(outline: Points, z: float) -> NDArray[np.float32]:
    """(n, 2, 3) segments around an outline."""
    points = lifted(outline, z)
    return np.stack([points, np.roll(points, -1, 0)], 1).astype(np.float32)


def open_line(points: Points) -> NDArray[np.float32]:
    """(n - 1, 2, 3) segments along (n, 3)."""
    return np.stack([points[:-1], points[1:]], 1).astype(np.float32)


def dashes(a: Points, b: Points, on: float, off: float) -> NDArray[np.float32]:
    """(k, 2, 3) dashes of length `on` from `a` to `b`, at least one."""
    length = float(np.linalg.norm(b - a))
    starts = np.arange(0, max(length, 1e-6), on + off)
    ends = np.minimum(starts + on, length)
    scale = max(length, 1e-9)
    return np.stack([a + (b - a) * (starts / scale)[:, None], a + (b - a) * (ends / scale)[:, None]], 1).astype(
        np.float32
    )


def some(segments: NDArray[np.floating], most: int) -> NDArray[np.float32]:
    """The last `most` segments; one far below the plates when there are none, since viser needs at least one.

    No more are sent than are seen: each costs 24 bytes, and drawing it takes time in a browser without a graphics card.
    """
    return segments[-most:].astype(np.float32) if len(segments) else NOWHERE


def stepped(points: Points) -> Points:
    """Points in steps of a 256th. What moves by less than can be seen stays the same and is not sent again."""
    return np.rint(np.asarray(points, np.float64) * 256) / 256


def thinned(points: Points, apart: float) -> Points:
    """Those of the (n, k) points along a way that are `apart` or farther from the one kept before, and the last point."""
    kept: list[int] = []
    last = None
    for row, point in enumerate(points.tolist()):
        if last is None or math.dist(point, last) >= apart or row == len(points) - 1:
            kept.append(row)
            last = point
    return points[kept]
