"""What views have in common: read-only arrays, parts that are rebuilt seldom, the angle by which maps are drawn, and
pictures and packets as people are shown them.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from app.evaluation import Evaluation, alignment
from app.session import Session
from ratslam_core import ExperienceMap, Packet, RatSlam
from sim2d import Truth
from web import messages as m

Kind = TypeVar("Kind", bound=np.generic)


def frozen(array: NDArray[Kind]) -> NDArray[Kind]:
    """The same array, read-only from now on, since a snapshot shares it with other threads."""
    array.setflags(write=False)
    return array


REST = 30.0  # a part is built again only after this many times the time it took to build: a large map costs 3 % at most

Part = TypeVar("Part")


class Slow(Generic[Part]):
    """An expensive part of a snapshot: when the session has moved on, rebuilt as often as people can see a change."""

    def __init__(self, every_s: float, build: Callable[[], Part]) -> None:
        self.due = -math.inf
        self._every_s, self._build = every_s, build
        self._built: tuple[int, Part] | None = None

    def refresh(self) -> None:
        """Rebuild the part when it is next asked for."""
        self.due = -math.inf

    def part(self, tick: int) -> Part:
        began = time.perf_counter()
        if self._built is None or began >= self.due:
            if self._built is None or self._built[0] != tick or self.due == -math.inf:
                self._built = (tick, self._build())
            now = time.perf_counter()
            self.due = now + max(self._every_s, REST * (now - began))
        return self._built[1]


SPREAD_M = 1.0  # RMS distance of the path from its middle; a path with less hardly has a direction
CALM_RAD = math.radians(3.0)  # smaller changes are ignored: a map under correction does not make the plate swing


def map_turn(shown_rad: float | None, evaluation: Evaluation, experiences: ExperienceMap, truth: Truth | None) -> float:
    """The angle (rad) of the map's frame in the office's, by which it is drawn turned to lie like the office; still
    `shown_rad` while that is near enough. 0 without truth. For people only; the robot never learns it."""
    if truth is None:
        return shown_rad or 0.0
    true, mapped, _ = evaluation.trajectories(experiences)
    if min(_spread(true), _spread(mapped)) >= SPREAD_M:
        return calm(shown_rad, alignment(mapped, true).heading_rad)
    made = evaluation.heading_at(0)
    if made is None:  # the brain came with its map, so where that began in this office is unknown
        return calm(shown_rad, truth.heading_rad - experiences.robot.heading_rad)
    return calm(shown_rad, made - float(experiences.poses[0, 2]))


def calm(shown_rad: float | None, wanted_rad: float) -> float:
    """`shown_rad` if it is within CALM_RAD of `wanted_rad`, else `wanted_rad`, wrapped."""
    if shown_rad is not None and abs(math.remainder(shown_rad - wanted_rad, math.tau)) <= CALM_RAD:
        return shown_rad
    return math.remainder(wanted_rad, math.tau)


def _spread(points: NDArray[np.float64]) -> float:
    return float(np.sqrt(points.var(axis=0).sum())) if len(points) else 0.0


_NO_PICTURE: NDArray[np.uint8] = frozen(np.zeros((0, 0, 3), np.uint8))


def camera_image(session: Session) -> NDArray[np.uint8]:
    """(h, w, 3) what the camera sees; without pixels while it is off."""
    return session.frame.image if session.config.robot.camera else _NO_PICTURE


def stored_picture(brain: RatSlam, view: int) -> NDArray[np.uint8]:
    """A stored view as an image for people."""
    return frozen(brain.local_view.front_end.picture(brain.local_view.stored(view)).copy())


def present_picture(brain: RatSlam) -> NDArray[np.uint8]:
    return frozen(brain.local_view.front_end.picture(brain.local_view.features).copy())


def packet_of(packet: Packet) -> m.Packet:
    """A packet of the engine as one that is shown."""
    return m.Packet(packet.x, packet.y, packet.heading_rad, packet.mass, packet.id)
