"""Vector maps: a JSON list of wall segments in metres."""

from __future__ import annotations

import math
from typing import Any, cast

import cv2
import numpy as np
from numpy.typing import NDArray

from sim2d.importers.dress import Dresser
from sim2d.importers.plan import plan_world
from sim2d.importers.trace import choose_floor
from sim2d.world.json_lines import line_of
from sim2d.world.world import World
from sim2d.world.world_check import MOST_M
from sim2d.world.world_file import WorldError
from sim2d.world.world_schema import MOST_WALLS

MARGIN_M = 0.3  # from the outermost walls to the fence around them: too narrow for the robot
_LEAST_M = 0.01  # shorter segments are left out; such files may contain some of length 0


def vector_world(name: str, text: str, items: list[Any], seed: int, radius_m: float) -> World:
    """items: each {"p0": {"x", "y"}, "p1": {"x", "y"}}, [x1, y1, x2, y2] or [[x1, y1], [x2, y2]]. Raises WorldError."""
    if len(items) > MOST_WALLS:
        raise WorldError(f"{name}: {len(items)} segments; at most {MOST_WALLS}")
    segments = np.array([_segment(name, text, i, item) for i, item in enumerate(items)]).reshape(-1, 4)
    segments = segments[np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]) >= _LEAST_M]
    if not len(segments):
        raise WorldError(f"{name}: {len(items)} segments, none of them {_LEAST_M} m long or longer; a plan needs walls")
    low = segments.reshape(-1, 2).min(axis=0) - MARGIN_M
    high = segments.reshape(-1, 2).max(axis=0) + MARGIN_M
    if max(high - low) > MOST_M:
        raise WorldError(
            f"{name}: spans {high[0] - low[0]:.0f} by {high[1] - low[1]:.0f} m; at most {MOST_M:g} m each way"
        )
    cell = max(0.05, float(max(high - low)) / 4000)
    floor = choose_floor(name, _free(segments, low, high, cell), cell, radius_m)
    ring = np.array([low, (high[0], low[1]), high, (low[0], high[1]), low])
    dresser = Dresser(seed)
    walls = dresser.line(ring, "left", outer=True)
    for segment in segments:
        walls += dresser.line(segment.reshape(2, 2), "both")
    starts = floor.starts * (cell, cell, 1.0) + (*low, 0.0)
    return plan_world(name, tuple(walls), starts, "a vector map", radius_m)


def _numbers(item: Any) -> list[Any] | None:
    """The numbers of an item in one of the three forms, not yet checked; None if it has none of these forms."""
    if isinstance(item, dict):
        ends: list[Any] = [cast("dict[str, Any]", item).get(end) for end in ("p0", "p1")]
        return (
            [end.get(axis) for end in ends for axis in ("x", "y")] if all(isinstance(e, dict) for e in ends) else None
        )
    if not isinstance(item, list):
        return None
    parts = cast("list[Any]", item)
    if len(parts) == 2 and all(isinstance(end, list) for end in parts):
        return [*parts[0], *parts[1]]
    return parts


def _segment(name: str, text: str, i: int, item: Any) -> tuple[float, ...]:
    numbers = _numbers(item)
    if numbers is None or len(numbers) != 4 or not all(type(n) in (int, float) and abs(n) < 10_000 for n in numbers):
        raise WorldError(
            f"{name}: [{i}]: got {str(item)[:80]}; must be "
            '{"p0": {"x": 0, "y": 0}, "p1": {"x": 1, "y": 0}}, [x1, y1, x2, y2] or [[x1, y1], [x2, y2]]: finite, in metres '
            f"(line {line_of(text, (i,))})"
        )
    return tuple(map(float, numbers))


def _free(
    segments: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64], cell: float
) -> NDArray[np.bool_]:
    """The plan as pixels of `cell` metres, row 0 at the bottom; False where there is a wall."""
    columns, rows = (math.ceil(k) for k in (high - low) / cell)
    plan = np.ones((rows, columns), np.uint8)
    ends = np.floor((segments.reshape(-1, 2) - low) / cell).astype(np.int32).reshape(-1, 2, 2)
    for a, b in ends.tolist():
        cv2.line(plan, a, b, 0)
    return plan.astype(np.bool_)
