"""The experience map as a vector picture: experiences in the colours of their times, links, route, goal, robot, and all that
people alone know of it."""

from __future__ import annotations

from collections.abc import Sized

import numpy as np
from numpy.typing import NDArray

from web.messages import Pose
from web.messages.robot_status import seconds_words, share_words
from web.viewer.fits import DEPTH, WIDTH, MapFit, on_plate, refit, wheels_alone, wheels_path
from web.viewer.marks.names import MOST
from web.viewer.marks.robot import pale
from web.viewer.marks.route import pill_stops
from web.viewer.plates.map_plate import NO_MAP, grid_step_m, promise, round_up
from web.viewer.vector import layers
from web.viewer.vector.layers import draw_name, draw_occupancy, draw_pin, draw_pins, mark_on_map
from web.viewer.vector.sheet import Entry, Sheet
from web.viewer.vector.subject import Subject

HALF = np.array([WIDTH, DEPTH]) / 2
BESIDE = 0.03  # of the field: room around a robot that has left the floor
SHADES = 24  # of the scale
DOT, ROBOT = 4.0, 16.0  # pixels


def draw_map(subject: Subject) -> str:
    """All of the plate's floor, with the map placed and turned as on the plate."""
    snapshot, palette = subject.snapshot, subject.palette
    layer, times = snapshot.map, snapshot.times
    fit = refit(MapFit(), layer.extent_xy, snapshot.map_turn_rad)
    places, robot = fit.to_plate(layer.xy), on_plate(snapshot.estimate, fit)
    here = np.array([robot.x, robot.y])
    room = BESIDE * max(WIDTH, 2 * float(np.abs(here).max()))
    low, high = np.minimum(-HALF, here - room), np.maximum(HALF, here + room)
    told = "what it built - colour: " + ("time to the goal" if times.to_goal else "time from the robot")
    if len(layer.visited_xy):
        told = "none, as in 2004: the packet's place"
    sheet = subject.sheet("Experience map", told, (*low.tolist(), *high.tolist()))
    legend = draw_occupancy(sheet, subject, fit)
    _draw_grid(sheet, low, high, fit.scale)
    legend += layers.draw_walls(sheet, subject, fit)
    ghost, truth = subject.judged.ghost, snapshot.truth
    if ghost is not None:
        layers.draw_path(sheet, palette, fit.to_plate(wheels_path(ghost)[1]))
    sheet.lines(places[layer.links].reshape(-1, 2, 2), palette.link, 1.4)
    seconds = times.seconds[: len(places)]
    longest = round_up(float(seconds[np.isfinite(seconds)].max(initial=1.0)))
    for place, colour in zip(places.tolist(), palette.times(seconds, longest).tolist(), strict=False):
        sheet.dot(place, DOT, tuple(colour))
    if not np.isfinite(seconds).all():
        legend.append(("area", palette.unknown, "no known route there"))
    if not len(places):
        sheet.label(((low + high) / 2).tolist(), NO_MAP, palette.text_2)
    sheet.avoid(here.tolist(), ROBOT)
    _draw_goal(sheet, subject, fit)
    legend += _draw_trip(sheet, subject, fit)
    legend += layers.draw_spread(sheet, subject, fit)
    legend += mark_on_map(sheet, subject, fit, places)
    _draw_names(sheet, subject, fit)
    legend += layers.draw_closures(sheet, subject, places)
    if ghost is not None and truth is not None:
        _, there, off_m = wheels_alone(ghost, truth)
        layers.draw_ghost(sheet, palette, on_plate(there, fit), off_m, ROBOT)
    legend += layers.ghost_entry(ghost, palette)
    legend += layers.draw_error(sheet, subject, fit)
    legend += _draw_others(sheet, subject, fit)
    sheet.arrow(robot.x, robot.y, robot.heading_rad, palette.robot, ROBOT)
    sheet.scale_bar(palette.ramp[:: max(1, len(palette.ramp) // SHADES)], "0 s", seconds_words(longest))
    sheet.foot(subject.moment, f"{_count(places, 'experience')}, {_count(layer.links, 'link')}")
    sheet.legend(legend)
    return sheet.svg()


def _draw_goal(sheet: Sheet, subject: Subject, fit: MapFit) -> None:
    goal, palette = subject.snapshot.goal, subject.palette
    if goal is None:
        return
    route, at = fit.to_plate(goal.route_xy), fit.to_plate(np.array([[goal.x, goal.y]]))[0]
    sheet.line(route, palette.casing, 7)
    sheet.line(route, palette.route, 3.5)
    for place in fit.to_plate(goal.places_xy).tolist():
        sheet.dot(place, 2 * DOT, None, palette.goal)
    sheet.dot(at.tolist(), 9, palette.goal, palette.casing)
    sheet.avoid(at.tolist(), 10)
    sheet.label(at.tolist(), promise(goal), palette.on_goal, up=26, fill=palette.goal)
    if len(route) > 1:
        for seconds, x, y in pill_stops(route, np.asarray(goal.route_arrival_s, np.float64), at):
            sheet.label((x, y), f"{seconds:.0f} s", palette.casing, size=12, fill=palette.route)


def _draw_trip(sheet: Sheet, subject: Subject, fit: MapFit) -> list[Entry]:
    """Where the robot explores, and why, and what else it might have chosen."""
    trip, palette = subject.snapshot.trip, subject.palette
    if trip is None:
        return []
    for place in fit.to_plate(trip.openings_xy).tolist():
        sheet.dot(place, DOT, pale(palette, palette.goal))
    if not trip.beside:
        draw_pin(sheet, subject, fit.to_plate(np.array([[trip.x, trip.y]]))[0].tolist(), trip.reason)
    return [("ring", pale(palette, palette.goal), "open floor, not yet driven on")] if len(trip.openings_xy) else []


def _draw_names(sheet: Sheet, subject: Subject, fit: MapFit) -> None:
    """Places of the office that the map knows, tagged places, and what a lesson marks."""
    snapshot = subject.snapshot
    known = [(place.name, place.map_xy) for place in snapshot.places if place.map_xy is not None]
    for name, place in known[:MOST]:
        draw_name(sheet, fit.to_plate(np.array([place]))[0].tolist(), name, known=True)
    for tag in snapshot.tags:
        draw_pin(sheet, subject, fit.to_plate(np.array([[tag.x, tag.y]]))[0].tolist(), tag.name)
    draw_pins(sheet, subject, "map", fit)


def _draw_others(sheet: Sheet, subject: Subject, fit: MapFit) -> list[Entry]:
    """Pale arrows in rings, each with how likely it is."""
    palette = subject.palette
    for hypothesis in subject.others:
        other = on_plate(Pose(hypothesis.x, hypothesis.y, hypothesis.heading_rad), fit)
        sheet.arrow(other.x, other.y, other.heading_rad, palette.casing, 0.9 * ROBOT, edge=palette.robot)
        sheet.dot((other.x, other.y), 1.5 * ROBOT, None, palette.robot)
        sheet.avoid((other.x, other.y), 1.5 * ROBOT)
        sheet.label((other.x, other.y), share_words(hypothesis.share), palette.text, size=14, up=24)
    return [("ring", palette.robot, "where it may be instead, and how likely")] if subject.others else []


def _draw_grid(sheet: Sheet, low: NDArray[np.float64], high: NDArray[np.float64], scale: float) -> None:
    """A line per metre, per five or per 25 in large maps, from the middle of the plate."""
    step = scale * grid_step_m(scale)
    first, last = np.ceil(low / step).astype(int), np.floor(high / step).astype(int)
    for k in range(first[0], last[0] + 1):
        sheet.lines([[(k * step, low[1]), (k * step, high[1])]], sheet.palette.grid, 1.2)
    for k in range(first[1], last[1] + 1):
        sheet.lines([[(low[0], k * step), (high[0], k * step)]], sheet.palette.grid, 1.2)


def _count(things: Sized, what: str) -> str:
    return f"{len(things)} {what}{'' if len(things) == 1 else 's'}"
