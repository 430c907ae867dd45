"""The sensors seen from above: field of view, echoes of the sonars, and whether the robot would fit at a place."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from web.messages import Pose, WorldDrawing

Array = NDArray[np.float64]
FAR_M = 30.0
RAYS = 61
TOUCHING_M = 1e-3


def distances(walls: Array, origin: tuple[float, float], angles: Array) -> Array:
    """(n,) metres to the nearest of `walls` (m, 4) along each angle; `FAR_M` where there is none."""
    if not len(walls):
        return np.full(len(angles), FAR_M)
    start, edge = walls[:, :2] - np.array(origin), walls[:, 2:] - walls[:, :2]
    cosine, sine = np.cos(angles)[:, None], np.sin(angles)[:, None]
    cross = cosine * edge[:, 1] - sine * edge[:, 0]
    safe = np.where(np.abs(cross) < 1e-12, 1.0, cross)
    along = (start[:, 0] * edge[:, 1] - start[:, 1] * edge[:, 0]) / safe
    part = (start[:, 0] * sine - start[:, 1] * cosine) / safe
    hits = (np.abs(cross) >= 1e-12) & (along >= 0) & (part >= -1e-9) & (part <= 1 + 1e-9)
    return np.minimum(np.where(hits, along, FAR_M).min(1), FAR_M)


def fan_of_view(walls: Array, pose: Pose, fov_rad: float, rays: int = RAYS) -> Array:
    """(rays, 2) where the rays of the view meet the walls, from right to left, so that a fan of them faces up."""
    angles = pose.heading_rad + np.linspace(-fov_rad / 2, fov_rad / 2, rays)
    offset = walls.reshape(-1, 2, 2) - (pose.x, pose.y)
    within = ((offset.min(1) <= FAR_M) & (offset.max(1) >= -FAR_M)).all(1)  # walls in reach
    reach = distances(walls[within], (pose.x, pose.y), angles)
    return np.column_stack([pose.x + reach * np.cos(angles), pose.y + reach * np.sin(angles)])


def echoes_at(pose: Pose, angles_rad: NDArray[np.float32], ranges_m: NDArray[np.float32]) -> Array:
    """(k, 2) where the sonars' beams met something."""
    echoed = np.isfinite(ranges_m)
    angles, reach = pose.heading_rad + angles_rad[echoed], ranges_m[echoed]
    xy = [pose.x + reach * np.cos(angles), pose.y + reach * np.sin(angles)]
    return np.column_stack(xy).astype(np.float64)


def solids(world: WorldDrawing) -> list[Array]:
    """Closed outlines (n, 2) of furniture, counter-clockwise: runs of segments that return to their start."""
    return [outline for _, outline in solid_runs(world)]


def solid_runs(world: WorldDrawing) -> list[tuple[range, Array]]:
    """`solids` with the rows of `world.walls` that make them. Desks that stand against a partition are closed along it."""
    walls = np.asarray(world.walls, np.float64)
    low_x, low_y, high_x, high_y = world.bounds
    largest = 0.25 * (high_x - low_x) * (high_y - low_y)
    found: list[tuple[range, Array]] = []
    for rows in _chains(walls, world.wall_kind):
        outline = walls[rows.start : rows.stop, :2]
        if math.dist(walls[rows.stop - 1, 2:], outline[0]) > TOUCHING_M:
            if world.wall_kind[rows.start] != "desk" or len(rows) < 2:
                continue
            outline = np.vstack([outline, walls[rows.stop - 1, 2:]])
            if len(rows) == 2:  # a corner: the other half of a parallelogram is behind the partition
                outline = np.vstack([outline, outline[0] + outline[2] - outline[1]])
        area = _area(outline)
        if 1e-6 < abs(area) < largest:
            found.append((rows, outline if area > 0 else outline[::-1]))
    return found


def _chains(walls: Array, kinds: tuple[str, ...]) -> list[range]:
    """Longest runs of rows of one kind in which each wall begins where the one before ends. A run that closes ends there."""
    chains: list[range] = []
    first = 0
    for row in range(1, len(walls) + 1):
        goes_on = (
            row < len(walls)
            and kinds[row] == kinds[first]
            and math.dist(walls[row, :2], walls[row - 1, 2:]) < TOUCHING_M
            and math.dist(walls[first, :2], walls[row - 1, 2:]) > TOUCHING_M
        )
        if not goes_on:
            chains.append(range(first, row))
            first = row
    return chains


def inside(outline: Array, x: float, y: float) -> bool:
    """Whether (x, y) lies in a polygon (n, 2): then an odd number of its edges lie to the right."""
    after = np.roll(outline, -1, 0)
    spans = (outline[:, 1] > y) != (after[:, 1] > y)
    rise = np.where(spans, after[:, 1] - outline[:, 1], 1.0)
    cut = outline[:, 0] + (y - outline[:, 1]) / rise * (after[:, 0] - outline[:, 0])
    return bool((spans & (cut > x)).sum() % 2)


def _area(outline: Array) -> float:
    after = np.roll(outline, -1, 0)
    return float((outline[:, 0] * after[:, 1] - after[:, 0] * outline[:, 1]).sum() / 2)
