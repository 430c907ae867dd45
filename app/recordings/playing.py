"""A recording played through the engine: at each moment the same brain looks, moves and maps as in the simulator, with the
parameters of the office, scaled by rules that survey the recording.

What a robot sees changes with the way it drives, and who drives in the open drives faster. So all lengths grow with the
typical speed; how alike views must be follows from how unlike they are. And who sees wide must not take a view for one
that is turned far: views are shifted by as large an angle as in the office, in columns of the camera that was used.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields
from functools import partial
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from app.config import Config, Value
from app.recordings.motion import COLUMNS, Motion, Profile, profile_of, shift_of, small_grey, typical
from app.recordings.recording import Moment, Recording
from app.recordings.scans import ScanRules, ScanTies, is_laser
from app.sensor_input import SensorInput
from disk import kind
from ratslam_core import Estimate, Odometry, RatSlam
from ratslam_core.local_view.front_ends import FRONT_ENDS, FrontEnd
from ratslam_core.local_view.front_ends.laser import Laser
from ratslam_core.local_view.matcher import Features, least_difference


@dataclass(frozen=True, slots=True)
class Step:
    """One moment, and what the brain made of it."""

    moment: Moment
    estimate: Estimate
    brain: RatSlam
    motion: Odometry


class Player:
    """Plays a recording; each time from the beginning, with a new brain, and with the same result."""

    def __init__(
        self,
        recording: Recording,
        seed: int = 0,
        config: Config | None = None,
        path: Path | None = None,
        scans: ScanRules | None = None,
    ) -> None:
        """config: wins over that of the recording, if it is a run of ours, and over the rules that look at it. seed: that of a
        run of ours wins. path: where the recording lies, if it is opened from there without being told more: its run can
        then be kept."""
        about = recording.about
        self.path = path
        self.recording, self.seed = recording, seed if about.seed is None else about.seed
        ruled, self._motion = rules(recording, scans)
        self._scans = scans or ScanRules()
        self.config = config or about.config or ruled
        angles = recording.about.beam_angles_rad
        # The front end for lasers takes beams from right to left; the order of sonars is that in which they were told.
        self._order = np.argsort(angles, kind="stable") if is_laser(recording.about) else np.arange(len(angles))

    @property
    def beam_angles_rad(self) -> list[float]:
        """Of the ranges, as the brain is given them."""
        return np.array(self.recording.about.beam_angles_rad)[self._order].tolist()

    def brain(self) -> RatSlam:
        """A new one, as a session of this seed would make it."""
        brain_seed, _ = np.random.SeedSequence([self.seed, 1]).spawn(2)
        return RatSlam(self.config.engine, np.random.default_rng(brain_seed), sonar_angles_rad=self.beam_angles_rad)

    def new_ties(self) -> ScanTies | None:
        """What ties the experiences of a new brain by its laser's scans; None: it has no laser."""
        about = self.recording.about
        return ScanTies(about, self._scans) if is_laser(about) else None

    def reader(self) -> MomentReader:
        """What reads the recording, before its first moment."""
        return MomentReader(self._motion.anew(), self._order.copy())

    def steps(self) -> Iterator[Step]:
        """Every moment in turn. It counts moments and not time, so the pace of whoever asks changes nothing."""
        brain, ties, reader = self.brain(), self.new_ties(), self.reader()
        for moment in self.recording.moments():
            sensed = reader.read(moment)
            yield Step(moment, sensed.step(brain, ties), brain, sensed.odometry)


@kind("moment reader/1")
class MomentReader:
    """What the motion of a recording is read with: all that decides what a brain is given of the moments to come."""

    def __init__(self, motion: Motion, order: NDArray[np.int64]) -> None:
        """order: in which the brain gets the ranges."""
        self._motion, self._order = motion, order

    def read(self, moment: Moment) -> SensorInput:
        """The next moment, as a brain is given it."""
        return self.input_of(moment, self._motion.of(moment), gap=self._motion.gap)

    def input_of(self, moment: Moment, moved: Odometry, *, gap: bool = False) -> SensorInput:
        ranges_m = None if moment.ranges_m is None else moment.ranges_m[self._order]
        return SensorInput(moment.image, moved, ranges_m, moment.behaviour, gap=gap, scan_m=moment.ranges_m)


LEAST_SCALE, MOST_SCALE = 0.02, 50.0
UNRELATED, UNRELATED_SCANS = 0.0025, 0.002  # share of unrelated views that may be taken for one another
OBSERVATION_SIGMA_M = 0.35  # of an observation that is only just believed, in the office
LASER_SHIFT = 5  # columns of 3 degrees: a laser sees so well that a turn need not spoil a view
WIDTH_ERROR = 1.1  # the camera's width is measured to a tenth


def rules(recording: Recording, scans: ScanRules | None = None) -> tuple[Config, Motion]:
    """The parameters for this recording, and how its motion is read."""
    base = Config().with_value("local_view.front_end", _front_end(recording))
    laser = base.local_view.front_end == "laser"
    if laser:
        base = base.with_values({"local_view.shift": LASER_SHIFT, "occupancy.enabled": False})
    end, told = FRONT_ENDS[base.local_view.front_end](), base.local_view
    turned_rad = told.shift * told.field_of_view / end.columns
    shift_at: Callable[[float], int] = (
        (lambda _: LASER_SHIFT) if laser else partial(columns_of, turned_rad, end.columns)
    )
    seen = survey(recording, end, shift_at)
    usual = base.pilot.cruise_speed
    levels_per_m = 1.0
    scale = seen.speed / usual if seen.speed > 0 else 1.0
    if not recording.about.has & {"speed", "throttle"}:
        levels_per_m, scale = scale, 1.0
    scale = min(max(scale, LEAST_SCALE), MOST_SCALE)
    values: dict[str, Value] = {
        **_lengths(base, scale),
        **_views(recording, seen, scale),
        "experience_map.familiar_ground": False,
    }
    motion = Motion(recording.about, seen.dt, seen.field_of_view, levels_per_m, scans=scans or ScanRules())
    return base.with_values(values), motion


def columns_of(turned_rad: float, columns: int, field_of_view: float) -> int:
    """[ours] How many whole columns of such a camera are no more than this angle, or a tenth above it at most.

    A column of a wide camera is many degrees: views under such turns are other views, and shifting them makes
    perceptual aliasing. test_playing.py::test_views_are_shifted_by_the_same_angle_whatever_the_camera.
    `local_view.shift` of a config wins.
    """
    return int(WIDTH_ERROR * turned_rad * columns / field_of_view)


def _front_end(recording: Recording) -> str:
    """The exteroceptive sensors: a camera, beside sonars or not, or a laser."""
    about = recording.about
    if "camera" not in about.has:
        if not is_laser(about):
            raise ValueError(
                f"{about.name}: neither a camera nor a laser, so there is nothing that could be recognised"
            )
        return "laser"
    return "image and sonars" if about.beam_angles_rad and not is_laser(about) else "limited levels"


def _lengths(base: Config, scale: float) -> dict[str, Value]:
    """The lengths of the engine, times the scale, as far as their ranges go. Those of the map are in cells."""
    own = {section.name for section in fields(base.engine)}
    values: dict[str, Value] = {}
    for name, item, value in base.items():
        if name.split(".")[0] in own and item.metadata["unit"] == "m" and isinstance(value, float):
            values[name] = min(max(value * scale, item.metadata["low"]), item.metadata["high"])
    return values


def _views(recording: Recording, seen: Survey, scale: float) -> dict[str, Value]:
    """Field of view and match threshold."""
    values: dict[str, Value] = {"local_view.field_of_view": seen.field_of_view, "local_view.shift": seen.shift}
    if "camera" not in recording.about.has and is_laser(recording.about):
        angles = recording.about.beam_angles_rad  # half a beam to either side is seen, too
        span = (max(angles) - min(angles)) * len(angles) / (len(angles) - 1)
        values["local_view.field_of_view"] = min(span, 2 * np.pi)
    # Pictures of real cameras jump when one is dropped, so a jump is no kidnap: only a gap in the recording is.
    values |= {"local_view.surprise": 100.0, "kidnap.range_surprise": 0.0}
    if len(seen.unlike) == 0:
        return values
    share = UNRELATED if "camera" in recording.about.has else UNRELATED_SCANS
    threshold, own = float(np.quantile(seen.unlike, share)), FRONT_ENDS[_front_end(recording)].threshold
    values["local_view.match_threshold"] = threshold / own
    # Where most views are the same, as of a camera that stood still, the threshold is 0.
    values["experience_map.anchor_sigma"] = min(OBSERVATION_SIGMA_M * scale / threshold, 1.0) if threshold > 0 else 1.0
    return values


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
    """What is found out about a recording: how fast the robot is, how wide it sees, how much its views differ."""

    dt: float  # s between two moments, typically
    speed: float  # m/s while it drives, typically; 0 when it never drives; by pictures alone, grey levels per second
    field_of_view: float  # of the camera, rad
    shift: int  # columns that are tried to either side
    alike: NDArray[np.float64]  # differences of views that are half a second of driving apart, levels
    unlike: NDArray[np.float64]  # differences of views that have nothing to do with each other, levels


def survey(recording: Recording, front_end: FrontEnd, shift_at: Callable[[float], int]) -> Survey:
    """Go through a recording once, with the front end that is to be used.

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
    field_of_view = _field_of_view(profiles, turns)
    shift = shift_at(field_of_view)
    alike = unlike = np.zeros(0)
    if len(views) == len(dts):
        alike, unlike = _differences(views, way, ALIKE_S * speed, np.cumsum(dts), front_end, shift)
    return Survey(typical(dts) or 0.1, speed, field_of_view, shift, alike, unlike)


def _view(moment: Moment, front_end: FrontEnd) -> Features | None:
    """What the front end makes of a moment; None when the moment has nothing for it."""
    if moment.image is None and not (isinstance(front_end, Laser) and moment.ranges_m is not None):
        return None
    return front_end.look(moment.image, None, moment.ranges_m)


def _field_of_view(profiles: list[Profile | None], turns: list[float]) -> float:
    """By how many columns pictures shift when gyro or wheels tell of a turn: the median says how wide they are."""
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
