"""A recording that is read as a stream: looked through once when it is opened, and played moment by moment."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from app.recordings.formats.clock import Clock
from app.recordings.formats.held import Held
from app.recordings.formats.problems import Problems
from app.recordings.formats.sensed import Sensed
from app.recordings.recording import About, Moment, Pose, Wanted, every

SCAN_HELD_S, TRUTH_HELD_S = 0.25, 0.1  # older ones are not those of a picture
DEFAULT_DT = 0.1  # of a single moment
_LOOKED_AT = 1000  # steps, from which the typical one is taken

KINDS = ("camera", "ranges", "speed", "yaw rate", "throttle", "truth")

Source = Callable[[Problems], Iterator[Sensed]]


@dataclass(frozen=True, slots=True)
class Beams:
    """Of a laser or of sonars: angles from straight ahead (rad, left positive), and how far it sees (m)."""

    angles_rad: tuple[float, ...] = ()
    limit_m: float | None = None


class StreamedRecording:
    """Moments are those of the camera, or where there is none, of the laser. What lies between them is summed up."""

    def __init__(
        self, name: str, format_: str, source: Source, beams: Callable[[], Beams] = Beams, uses: tuple[str, ...] = (),
        unused: tuple[str, ...] = (),
    ) -> None:  # fmt: skip
        """source: gives everything that was sensed, anew each time; beams: asked after it has been read once.

        ValueError: there is nothing in it that could be played.
        """
        self._source, self._beams, self._name = source, beams, name
        self._problems = Problems()
        self._readable: dict[int, bool] = {}  # of the pictures that were unpacked once, by their numbers
        self._about = replace(self._look_through(name, format_, uses), unused=unused)
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
            if (sensed.image if camera else sensed.ranges_m) is None:
                problems.read(sensed.source)
            if (moment := gathering.take(sensed)) is not None:
                yield moment
        if (moment := gathering.emitted()) is not None:
            yield moment
        if problems is self._problems:
            self._counts = problems.counts

    def _in_time(self, problems: Problems) -> Iterator[Sensed]:
        clock = Clock(problems)
        for sensed in self._source(problems):
            yield replace(sensed, time_ns=clock.at(sensed.time_ns, sensed.where))

    def _look_through(self, name: str, format_: str, uses: tuple[str, ...]) -> About:
        counts, times = {"camera": 0, "ranges": 0}, dict[str, list[int]]()
        has, steps = set[str](), {"camera": list[int](), "ranges": list[int]()}
        shape: tuple[int, int] | None = None
        for sensed in self._in_time(self._problems):
            for kind, there in (("camera", sensed.image), ("ranges", sensed.ranges_m)):
                if there is None:
                    continue
                if kind == "camera" and shape is None and (shape := self._shape(sensed)) is None:
                    continue
                counts[kind] += 1
                first_last = times.setdefault(kind, [sensed.time_ns, sensed.time_ns])
                if sensed.time_ns > first_last[1] and len(steps[kind]) < _LOOKED_AT:
                    steps[kind].append(sensed.time_ns - first_last[1])
                first_last[1] = sensed.time_ns
            has.update(_kinds(sensed))
            self._problems.read(sensed.source)
        main = "camera" if counts["camera"] else "ranges"
        if not counts[main]:
            told = "; ".join(self._problems.sentences[:2])
            raise ValueError(
                f"{name}: nothing in it can be played: no picture and no scan could be read. {told}".strip()
            )
        if not counts["camera"]:
            has.discard("camera")
        self._typical_ns = sorted(steps[main])[len(steps[main]) // 2] if steps[main] else round(DEFAULT_DT * 1e9)
        beams = self._beams()
        seconds = (times[main][1] - times[main][0]) / 1e9
        uses = tuple(
            sentence
            for sentence in uses
            if sentence.partition(":")[0] in has or sentence.partition(":")[0] not in KINDS
        )
        return About(name, format_, counts[main], seconds, frozenset(has), shape, beams.angles_rad, beams.limit_m, uses)

    def _shape(self, sensed: Sensed) -> tuple[int, int] | None:
        assert sensed.image is not None
        try:
            height, width = sensed.image().shape[:2]
        except ValueError as error:
            self._problems.add("pictures left out", sensed.where, f"left out: {error}")
            return None
        return height, width


def _kinds(sensed: Sensed) -> Iterator[str]:
    """What it has, by the names of `About.has`."""
    for kind, value in (
        ("camera", sensed.image), ("ranges", sensed.ranges_m), ("speed", sensed.speed), ("yaw rate", sensed.yaw_rate),
        ("throttle", sensed.throttle), ("truth", sensed.truth),
    ):  # fmt: skip
        if value is not None:
            yield kind


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
            if image.shape[:2] != self._shape and self._shape is not None:
                height, width = self._shape
                raise ValueError(
                    f"{image.shape[1]} x {image.shape[0]} pixels, but the first picture has {width} x {height}"
                )
        except ValueError as error:
            self._problems.add("pictures left out", sensed.where, f"left out: {error}")
            return None
        return image
