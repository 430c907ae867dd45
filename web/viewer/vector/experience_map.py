"""The experience map as a vector picture: experiences in the colours of their times, links, route, goal and robot."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from web.messages import Snapshot
from web.viewer.plates.map_plate import round_up, seconds_words
from web.viewer.primitives.palette import Palette
from web.viewer.vector.sheet import Sheet
from web.viewer.vector.words import moment_words

ROOM_M = 0.6  # around the map
LEAST_M = 3.0
SHADES = 24  # of the scale


def draw_map(snapshot: Snapshot, palette: Palette) -> str:
    """Turned as on the plate, so that it lies as the office does."""
    layer, times, robot = snapshot.map, snapshot.times, snapshot.estimate
    turn = snapshot.map_turn_rad
    places = _turned(layer.xy, turn)
    here = _turned([(robot.x, robot.y)], turn)[0]
    seen = np.vstack([places, here])
    middle, half = (seen.min(0) + seen.max(0)) / 2, np.maximum((seen.max(0) - seen.min(0)) / 2 + ROOM_M, LEAST_M / 2)
    low, high = middle - half, middle + half
    told = "time to the goal" if times.to_goal else "time from the robot"
    sheet = Sheet(palette, "Experience map", f"what it built - colour: {told}", (*low.tolist(), *high.tolist()))
    _draw_grid(sheet, low, high, palette)
    sheet.lines(places[layer.links].reshape(-1, 2, 2), palette.link, 1.6)
    seconds = times.seconds[: len(places)]
    longest = round_up(float(seconds[np.isfinite(seconds)].max(initial=1.0)))
    for place, colour in zip(places.tolist(), palette.times(seconds, longest).tolist(), strict=False):
        sheet.dot(place, 5, tuple(colour))
    _draw_goal(sheet, snapshot, palette)
    for tag in snapshot.tags:
        sheet.label(_turned([(tag.x, tag.y)], turn)[0].tolist(), tag.name, palette.text, up=16)
    sheet.arrow(float(here[0]), float(here[1]), robot.heading_rad + turn, palette.robot, 16)
    sheet.scale_bar(palette.ramp[:: max(1, len(palette.ramp) // SHADES)], "0 s", seconds_words(longest))
    right = f"{len(places)} experiences, {len(layer.links)} links"
    sheet.foot(moment_words(snapshot), right)
    return sheet.svg()


def _draw_goal(sheet: Sheet, snapshot: Snapshot, palette: Palette) -> None:
    goal, turn = snapshot.goal, snapshot.map_turn_rad
    if goal is None:
        return
    route = _turned(goal.route_xy, turn)
    sheet.line(route, palette.casing, 7)
    sheet.line(route, palette.route, 3.5)
    at = _turned([(goal.x, goal.y)], turn)[0].tolist()
    for place in _turned(goal.places_xy, turn).tolist():
        sheet.dot(place, 9, None, palette.goal)
    sheet.dot(at, 9, palette.goal, palette.casing)
    arrives = goal.eta_s is not None and math.isfinite(goal.eta_s)
    sheet.label(at, seconds_words(goal.eta_s or 0.0) if arrives else goal.state, palette.goal, up=22)


def _draw_grid(sheet: Sheet, low: NDArray[np.float64], high: NDArray[np.float64], palette: Palette) -> None:
    """A line per metre, per five or per 25 in large maps."""
    step = 1.0 if sheet.scale > 35 else 5.0 if sheet.scale > 8 else 25.0
    for k in range(math.ceil(low[0] / step), math.floor(high[0] / step) + 1):
        sheet.lines([[(k * step, low[1]), (k * step, high[1])]], palette.grid, 1.2)
    for k in range(math.ceil(low[1] / step), math.floor(high[1] / step) + 1):
        sheet.lines([[(low[0], k * step), (high[0], k * step)]], palette.grid, 1.2)


def _turned(points: ArrayLike, turn_rad: float) -> NDArray[np.float64]:
    c, s = math.cos(turn_rad), math.sin(turn_rad)
    return np.asarray(points, np.float64).reshape(-1, 2) @ np.array([(c, s), (-s, c)])
