"""A recording that is read as a stream: looked through once when it is opened, and played moment by moment.

Its time never goes back, rates are means between two moments, scans lie on the same beams, and pictures have one size.
Wherever something had to be mended or left out, that is told.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from app.recordings.formats.sensed import Beams, Problems, Sensed
from app.recordings.recording import About, Moment, Pose, Wanted, every

SCAN_HELD_S, TRUTH_HELD_S = 0.25, 0.1  # older ones are not those of a picture
DEFAULT_DT = 0.1  # of a single moment
_LOOKED_AT, _SCANS = 1000, 200  # steps and scans, from which the typical one is taken
KINDS = ("camera", "ranges", "speed", "yaw rate", "throttle", "truth")

Source = Callable[[Problems], Iterator[Sensed]]


class StreamedRecording:
    """Moments are those of the camera, or where there is none, of the laser. What lies between them is summed up."""

    def __init__(
        self, name: str, format_: str, source: Source, uses: tuple[str, ...] = (), unused: tuple[str, ...] = ()
    ) -> None:
        """source: gives everything that was sensed, anew each time.

        uses: "speed and yaw rate (how): from where"; what was not sensed after all is not announced. unused: what of the
        recording never comes through `source`, and why. ValueError: there is nothing in it that could be played.
        """
        self._source, self._name = source, name
        self._problems = Problems()
        self._readable: dict[int, bool] = {}  # of the pictures that were unpacked once, by their numbers
        self._raster = Beams()
        self._about = self._look_through(name, format_, uses, unused)
        self._counts = self._problems.counts

    @property
    def about(self) -> About:
        """What is in it. Problems with pictures are found when they are read, so there are more of them later."""
        return replace(self._about, problems=self._problems.sentences, counts=self._counts)

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        """In order of time. Whoever wants all pictures is told what is wrong with them (`about`)."""
        camera = "camera" in self._about.has
        problems = self._problems if wanted is every else Problems()
        problems.begin()
        pictures = _Pictures(problems, self._about.image_shape, wanted, self._readable)
        gathering = _Gathering(problems, pictures if camera else None, self._typical_ns)
        for sensed in self._in_time(problems):
            if (moment := gathering.take(self._on_raster(sensed, problems))) is not None:
                yield moment
        if (moment := gathering.emitted()) is not None:
            yield moment
        if problems is self._problems:
            self._counts = problems.counts

    def _on_raster(self, sensed: Sensed, problems: Problems) -> Sensed:
        """With its scan, if it has one, on the raster. Counts it, unless it makes a moment."""
        if sensed.ranges_m is not None and sensed.beams is not None:
            try:
                sensed = replace(sensed, ranges_m=_laid_on(self._raster, sensed.beams, sensed.ranges_m))
            except ValueError as error:
                problems.add("scans left out", sensed.where, f"left out: {error}")
                return replace(sensed, ranges_m=None)
        if (sensed.image if "camera" in self._about.has else sensed.ranges_m) is None:
            problems.read(sensed.source)
        return sensed

    def _in_time(self, problems: Problems) -> Iterator[Sensed]:
        clock = Clock(problems)
        for sensed in self._source(problems):
            yield replace(sensed, time_ns=clock.at(sensed.time_ns, sensed.where))

    def _look_through(self, name: str, format_: str, uses: tuple[str, ...], unused: tuple[str, ...]) -> About:
        counts, times = {"camera": 0, "ranges": 0}, dict[str, list[int]]()
        has, steps = set[str](), {"camera": list[int](), "ranges": list[int]()}
        shapes, beams = _Shapes(self._problems), list[Beams]()
        for sensed in self._in_time(self._problems):
            for kind, there in (("camera", sensed.image), ("ranges", sensed.ranges_m)):
                if there is None:
                    continue
                if kind == "camera" and not shapes.look(sensed):
                    continue
                counts[kind] += 1
                first_last = times.setdefault(kind, [sensed.time_ns, sensed.time_ns])
                if sensed.time_ns > first_last[1] and len(steps[kind]) < _LOOKED_AT:
                    steps[kind].append(sensed.time_ns - first_last[1])
                first_last[1] = sensed.time_ns
            has.update(_kinds(sensed))
            self._problems.read(sensed.source)
            if sensed.beams is not None and len(beams) < _SCANS:
                beams.append(sensed.beams)
        main = "camera" if counts["camera"] else "ranges"
        if not counts[main]:
            told = "; ".join(self._problems.sentences[:2])
            raise ValueError(
                f"{name}: nothing in it can be played: no picture and no scan could be read. {told}".strip()
            )
        if not counts["camera"]:
            has.discard("camera")
        self._typical_ns = sorted(steps[main])[len(steps[main]) // 2] if steps[main] else round(DEFAULT_DT * 1e9)
        seconds = (times[main][1] - times[main][0]) / 1e9
        uses = tuple(sentence for sentence in uses if _sensed(sentence, has))
        if beams:
            self._raster = _typical(beams)
            least, most = (rule(len(b.angles_rad) for b in beams) for rule in (min, max))
            if any(b.angles_rad != self._raster.angles_rad for b in beams):
                uses += (f"scans of {least} to {most} ranges: laid by angle on {len(self._raster.angles_rad)} beams",)
        angles, limit = self._raster.angles_rad, self._raster.limit_m
        return About(
            name, format_, counts[main], seconds, frozenset(has), shapes.usual, angles, limit, uses, unused=unused
        )


def _sensed(sentence: str, has: set[str]) -> bool:
    """Whether something of what "speed and yaw rate (how): from where" announces was sensed; other sentences stand."""
    kinds = sentence.partition(":")[0].partition(" (")[0].split(" and ")
    return not all(kind in KINDS for kind in kinds) or any(kind in has for kind in kinds)


def _kinds(sensed: Sensed) -> Iterator[str]:
    """What it has, by the names of `About.has`."""
    values = sensed.image, sensed.ranges_m, sensed.speed, sensed.yaw_rate, sensed.throttle, sensed.truth
    return (kind for kind, value in zip(KINDS, values, strict=True) if value is not None)


class _Shapes:
    """What shape the pictures have: the usual one of the first, second, third, fifth, ninth, ... that can be read."""

    def __init__(self, problems: Problems) -> None:
        self._problems = problems
        self._seen = 0
        self._found: Counter[tuple[int, int]] = Counter()
        self.usual: tuple[int, int] | None = None

    def look(self, sensed: Sensed) -> bool:
        """Whether a picture has been readable up to now."""
        assert sensed.image is not None
        if not self._found or self._seen & (self._seen - 1) == 0:
            try:
                height, width = sensed.image().shape[:2]
            except ValueError as error:
                self._problems.add("pictures left out", sensed.where, f"left out: {error}")
                return self.usual is not None
            self._found[height, width] += 1
            if self.usual is None or self._found[height, width] >= self._found[self.usual]:
                self.usual = height, width
        self._seen += 1
        return True


class _Gathering:
    """Gathers what was sensed up to the time of a picture, then makes the moment."""

    def __init__(self, problems: Problems, pictures: _Pictures | None, typical_ns: int) -> None:
        """pictures: None: moments are those of the laser."""
        self._problems, self._pictures, self._typical_ns = problems, pictures, typical_ns
        self._rates = {"speed": Held(), "yaw_rate": Held(), "throttle": Held()}
        self._truth: tuple[int, Pose] | None = None
        self._scan: tuple[int, NDArray[np.float64]] | None = None
        self._behaviour = 0
        self._waiting: tuple[int, Sensed] | None = None  # number and picture of a moment that is not complete yet
        self._seen = 0
        self._first_ns = self._last_ns = -1
        self._begun = False

    def take(self, sensed: Sensed) -> Moment | None:
        """The moment that is complete, now that something later has come."""
        moment = None
        if self._waiting is not None and sensed.time_ns > self._waiting[1].time_ns:
            moment = self.emitted()
        camera = self._pictures is not None
        if (sensed.image if camera else sensed.ranges_m) is not None:
            self._wait(sensed)
        for name, held in self._rates.items():
            if (value := getattr(sensed, name)) is not None:
                held.add(sensed.time_ns, value)
        if sensed.truth is not None:
            self._truth = sensed.time_ns, sensed.truth
        if sensed.ranges_m is not None and (camera or self._waiting is None or self._waiting[1] is sensed):
            self._scan = sensed.time_ns, sensed.ranges_m
        if sensed.behaviour is not None:
            self._behaviour = sensed.behaviour
        return moment

    def _wait(self, sensed: Sensed) -> None:
        number = self._seen if sensed.frame is None else sensed.frame
        self._seen = number + 1
        if self._waiting is not None or (self._begun and sensed.time_ns <= self._last_ns):
            self._problems.add(
                "moments without time", sensed.where, "left out: no time has passed since the one before"
            )
        else:
            self._waiting = number, sensed

    def emitted(self) -> Moment | None:
        """The moment that is waiting; None if there is none, or if its picture cannot be read."""
        if self._waiting is None:
            return None
        (number, sensed), self._waiting = self._waiting, None
        image = None
        if self._pictures is not None:
            good, image = self._pictures.next(sensed)
            if not good:
                return None
        self._problems.read(sensed.source)
        now = sensed.time_ns
        if not self._begun:
            self._begun, self._first_ns, self._last_ns = True, now, now - self._typical_ns
        begin, self._last_ns = self._last_ns, now
        rates = {name: held.mean(begin, now) for name, held in self._rates.items()}
        scan, truth, age = self._scan, self._truth, SCAN_HELD_S * 1e9
        return Moment(
            number, (now - self._first_ns) / 1e9, (now - begin) / 1e9, image,
            **rates,
            ranges_m=scan[1] if scan is not None and now - scan[0] <= age else None,
            truth=truth[1] if truth is not None and now - truth[0] <= TRUTH_HELD_S * 1e9 else None,
            behaviour=self._behaviour,
        )  # fmt: skip


_SAME_RATIO = 0.02  # pictures whose sides' ratios differ by no more show the same


class _Pictures:
    """Unpacks the pictures of moments, one after the other, as far as they are wanted."""

    def __init__(
        self, problems: Problems, shape: tuple[int, int] | None, wanted: Wanted, readable: dict[int, bool]
    ) -> None:
        """readable: what is known of the pictures by their numbers, to which more is added."""
        self._problems, self._shape, self._wanted, self._readable = problems, shape, wanted, readable
        self._number = -1  # of the picture
        self._good = 0  # pictures so far that can be read: the number of the next moment

    def next(self, sensed: Sensed) -> tuple[bool, NDArray[np.uint8] | None]:
        """Whether the next picture can be read, which has to be tried once; and the picture if it is wanted."""
        self._number += 1
        image, was_good = None, self._readable.get(self._number, False)
        good = was_good
        if not was_good or self._wanted(self._good):
            image = self._unpacked(sensed)
            good = self._readable[self._number] = image is not None
        if was_good and not good:  # without it, all that follow would have other numbers
            raise ValueError(f"{sensed.where}: it could be read before, and cannot be any more")
        self._good += good
        return good, image

    def _unpacked(self, sensed: Sensed) -> NDArray[np.uint8] | None:
        assert sensed.image is not None
        try:
            image = sensed.image()
            fits = self._shape is None or image.shape[:2] == self._shape
            return image if fits else self._resized(image, sensed.where)
        except ValueError as error:
            self._problems.add("pictures left out", sensed.where, f"left out: {error}")
            return None

    def _resized(self, image: NDArray[np.uint8], where: str) -> NDArray[np.uint8]:
        """As large as the others. ValueError: it shows something else."""
        assert self._shape is not None
        (height, width), (rows, columns) = self._shape, image.shape[:2]
        told = f"{columns} x {rows} pixels, but most pictures have {width} x {height}"
        if abs(columns * height / (rows * width) - 1) > _SAME_RATIO:
            raise ValueError(told)
        self._problems.add("pictures resized", where, f"resized: {told}")
        how = cv2.INTER_AREA if rows > height else cv2.INTER_LINEAR
        return np.asarray(cv2.resize(image, (width, height), interpolation=how), np.uint8)


LATE_S = 1.0  # a message may come so much out of order
BREAK_S = 60.0  # a longer silence is taken as a break, or as a clock that was set
GOES_ON_S = 0.1  # so much passes in a break


class Clock:
    """[ours] The time of a recording made one that never goes back.

    Clocks of robots are set while they drive, and recordings are paused: time goes on after a break.
    test_recording_parts.py::test_a_clock_that_was_set_goes_on.
    """

    def __init__(self, problems: Problems) -> None:
        self._problems = problems
        self._shift = 0
        self._now: int | None = None

    def at(self, time_ns: int, where: str) -> int:
        """The mended time (ns)."""
        now = self._now
        if now is None:
            self._shift = -time_ns
            self._now = 0
            return 0
        time = time_ns + self._shift
        off = (time - now) / 1e9
        if off > BREAK_S or off < -LATE_S:
            way = f"{off:.6g} s on" if off > 0 else f"{-off:.6g} s back"
            self._problems.add(
                "jumps of the clock", where, f"the time jumps {way}; it is taken as a break of {GOES_ON_S:g} s"
            )
            time = now + round(GOES_ON_S * 1e9)
            self._shift = time - time_ns
        self._now = max(now, time)
        return self._now


HELD_S = 1.0  # so long does the last value hold when no other comes


class Held:
    """A rate, measured now and then. Each value is that of the time since the one before; times never go back."""

    def __init__(self) -> None:
        self._samples: list[tuple[int, float]] = []  # those that may still matter
        self._before: int | None = None  # time of the sample before these

    def add(self, time_ns: int, value: float) -> None:
        if self._samples and time_ns <= self._samples[-1][0]:
            return
        self._samples.append((time_ns, value))

    def mean(self, begin_ns: int, end_ns: int) -> float | None:
        """The mean of (begin, end]; None where nothing was measured. Forgets what lies before the end.

        A value that covers all of it is returned as it is, bit for bit.
        """
        total, covered, pieces = 0.0, 0, set[float]()
        start = begin_ns if self._before is None else max(begin_ns, self._before)
        for time, value in self._samples:
            stop = min(time, end_ns)
            if stop > start:
                total, covered, start = total + value * (stop - start), covered + stop - start, stop
                pieces.add(value)
        if self._samples and start < end_ns:
            time, value = self._samples[-1]
            stop, start = min(end_ns, time + round(HELD_S * 1e9)), max(start, time)
            if stop > start:
                total, covered = total + value * (stop - start), covered + stop - start
                pieces.add(value)
        self._forget(end_ns)
        if not covered:
            return None
        return pieces.pop() if len(pieces) == 1 else total / covered

    def _forget(self, end_ns: int) -> None:
        """Keep the samples after `end_ns` and the last one before, which may have to hold on."""
        while len(self._samples) > 1 and self._samples[0][0] <= end_ns and self._samples[1][0] <= end_ns:
            self._before = self._samples.pop(0)[0]
        if len(self._samples) > 1 and self._samples[0][0] <= end_ns:
            self._before = self._samples.pop(0)[0]


LEAST = 0.5  # a scan that looks at less of the field is no scan of it


def _typical(beams: Sequence[Beams]) -> Beams:
    """[ours] The middle one by number, first and last angle: the usual one where there is one, never the odd one."""
    ranked = sorted(beams, key=lambda b: (len(b.angles_rad), b.angles_rad[:1], b.angles_rad[-1:], b.limit_m or 0))
    return ranked[len(beams) // 2]


def _laid_on(raster: Beams, beams: Beams, ranges_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Each beam of the raster, on which all scans are laid by their angles, gets the range of the nearest
    beam, and inf where there is none. ranges_m: of `beams`. ValueError: it looks somewhere else.
    """
    if beams.angles_rad == raster.angles_rad:
        return ranges_m
    own, wanted = np.mod(beams.angles_rad, math.tau), np.mod(raster.angles_rad, math.tau)
    order = np.argsort(own, kind="stable")
    round_ = np.concatenate(([own[order[-1]] - math.tau], own[order], [own[order[0]] + math.tau]))
    number = np.concatenate(([order[-1]], order, [order[0]]))
    after = np.clip(np.searchsorted(round_, wanted), 1, len(round_) - 1)
    nearest = np.where(wanted - round_[after - 1] <= round_[after] - wanted, after - 1, after)
    seen = np.abs(round_[nearest] - wanted) <= 0.501 * max(_step(beams), _step(raster))
    if seen.mean() < LEAST:
        raise ValueError(f"its {len(own)} ranges cover less than half of where the other scans look")
    return np.where(seen, ranges_m[number[nearest]], np.inf)


def _step(beams: Beams) -> float:
    """The usual angle between neighbours (rad)."""
    return float(np.median(np.abs(np.diff(beams.angles_rad)))) if len(beams.angles_rad) > 1 else 0.0
