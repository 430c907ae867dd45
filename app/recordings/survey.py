"""What a first look over a recording tells: how fast the robot is, how wide its camera sees, how much its views differ."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from app.recordings.motion import Motion, typical
from app.recordings.recording import Moment, Recording
from app.recordings.visual_odometry import COLUMNS, Profile, profile_of, shift_of, small_grey
from ratslam_core.local_view.front_ends import FrontEnd
from ratslam_core.local_view.front_ends.laser import Laser
from ratslam_core.local_view.matcher import Features, least_difference

MOST_MOMENTS = 6000  # that are looked at, from the beginning
USUAL_VIEW = math.radians(60)  # of a camera of which nothing is known
NARROWEST, WIDEST = math.radians(20), math.radians(170)
LEAST_TURN = math.radians(1.0)  # between two pictures, to measure the field of view by it
LEAST_TURNS = 20  # so many must tell of it
ALIKE_S = 0.5  # of driving, between two views that are nearly of one place
APART_S = 5.0  # views so long apart count as unrelated
PAIRS = 20_000  # that are drawn of them


@dataclass(frozen=True, slots=True)
class Survey:
    """Of one recording."""

    dt: float  # s between two moments, typically
    speed: float  # m/s while it drives, typically; 0 when it never drives; by pictures alone, grey levels per second
    field_of_view: float  # of the camera, rad
    shift: int  # columns that are tried to either side
    alike: NDArray[np.float64]  # differences of views that are half a second of driving apart, levels
    unlike: NDArray[np.float64]  # differences of views that have nothing to do with each other, levels


def survey(recording: Recording, front_end: FrontEnd, shift_at: Callable[[float], int]) -> Survey:
    """Look over a recording once, with the front end that is to be used.

    shift_at: how many columns are to be tried to either side, when the camera sees so wide (rad).
    """
    motion = Motion(recording.about, 1.0, 1.0)
    dts: list[float] = []
    speeds: list[float] = []
    turns: list[float] = []
    profiles: list[Profile | None] = []
    views: list[Features] = []
    for moment in islice(recording.moments(), MOST_MOMENTS):
        dts.append(moment.dt)
        speeds.append(abs(motion.of(moment).speed))
        turns.append((moment.yaw_rate or 0.0) * moment.dt)
        profiles.append(None if moment.image is None else profile_of(small_grey(moment.image)))
        seen = _view(moment, front_end)
        if seen is not None:
            views.append(seen)
    speed = typical(speeds)
    way = np.cumsum(np.multiply(speeds, np.minimum(dts, 1.0)))
    complete = len(views) == len(dts)
    field_of_view = _field_of_view(profiles, turns)
    shift = shift_at(field_of_view)
    alike, unlike = _differences(views, way, ALIKE_S * speed, np.cumsum(dts), front_end, shift) if complete else _NONE
    return Survey(typical(dts) or 0.1, speed, field_of_view, shift, alike, unlike)


_NONE = np.zeros(0), np.zeros(0)


def _view(moment: Moment, front_end: FrontEnd) -> Features | None:
    """What the front end makes of a moment; None when the moment has nothing for it."""
    if moment.image is None and not (isinstance(front_end, Laser) and moment.ranges_m is not None):
        return None
    return front_end.look(moment.image, None, moment.ranges_m)


def _field_of_view(profiles: list[Profile | None], turns: list[float]) -> float:
    """By how many columns pictures shift when the gyro or the wheels tell of a turn: the median says how wide they are."""
    widths: list[float] = []
    for before, now, turn in zip(profiles, profiles[1:], turns[1:], strict=False):
        if abs(turn) < LEAST_TURN or before is None or now is None:
            continue
        shift = shift_of(now, before)[0]
        if shift != 0:
            widths.append(turn * COLUMNS / shift)
    if len(widths) < LEAST_TURNS:
        return USUAL_VIEW
    width = float(np.median(widths))
    return min(max(width, NARROWEST), WIDEST) if width > 0 else USUAL_VIEW


def _differences(
    views: list[Features], way: NDArray[np.float64], step: float, time: NDArray[np.float64], end: FrontEnd, shift: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Differences of views one step of driving apart, and of views drawn at random, in levels."""

    def apart(i: int, j: int) -> float:
        return end.scale * least_difference(views[i], views[j], shift, end.columns, end.rows)

    after = np.searchsorted(way, way + step)
    alike = [apart(i, int(j)) for i, j in enumerate(after) if j < len(views) and j > i]
    pairs = np.random.default_rng(0).integers(0, len(views), (PAIRS, 2))
    unlike = [apart(int(i), int(j)) for i, j in pairs if abs(time[i] - time[j]) > APART_S]
    return np.array(alike), np.array(unlike)
