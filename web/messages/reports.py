"""What an inspector shows: an experience with its links, a view, a pose cell. Parts of a snapshot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from web.messages.brain import Packet, Pose


@dataclass(frozen=True, slots=True)
class LinkReport:
    """One transition of the experience map. ACRA 2005 4.2, ACRA 2006 3.2."""

    start: int  # experience where it begins
    end: int
    distance_m: float
    bearing_rad: float  # to the end, relative to the start's facing
    facing_rad: float  # change of facing
    time_s: float  # mean over the passages
    behaviour: str  # under which it was learnt
    passages: int
    trials: int
    confidence: float  # share of the trials in which the robot arrived


@dataclass(frozen=True, slots=True)
class Times:
    """When something was met, in seconds since the reset; None: not in this run."""

    first_s: float | None
    last_s: float | None
    visits: int  # how often it became active


@dataclass(frozen=True, slots=True, eq=False)
class HebbianReport:
    """What a view is linked to. ACRA 2004 eqs. 2-4."""

    count: int  # links to pose cells
    cells: NDArray[np.int32]  # (k, 3) theta, y, x of the strongest, strongest first, k <= 300
    strength: NDArray[np.float32]  # (k,)
    saturation: float  # a link injects no more than this


@dataclass(frozen=True, slots=True, eq=False)
class ExperienceReport:
    """One experience with its links, its view and its times."""

    id: int
    cell: tuple[float, float, float]  # x', y' (cells), theta' (layers)
    view: int  # -1: made where there was nothing to see
    picture: NDArray[np.uint8] | None  # (h, w) or (h, w, 3) its stored view
    pose: Pose  # map frame
    zone_xy: float  # radius of its zone of influence, cells
    zone_theta: float  # layers
    energy: float  # how well the present state fits it, at most 2
    active: bool
    links: tuple[LinkReport, ...]  # first those that begin here, then those that end here
    hebbian: HebbianReport  # of its view
    times: Times


@dataclass(frozen=True, slots=True, eq=False)
class ViewReport:
    """One local view cell: the view it stands for, beside what is seen now."""

    id: int
    picture: NDArray[np.uint8]  # (h, w) or (h, w, 3) as it is stored
    now: NDArray[np.uint8]  # the same for what is seen now
    camera: NDArray[np.uint8]  # (h, w, 3) the image from which `now` was made
    difference: float  # between the two at the best shift, as in Senses
    threshold: float
    active: bool
    experiences: tuple[int, ...]  # those that were made with it
    hebbian: HebbianReport
    times: Times


@dataclass(frozen=True, slots=True, eq=False)
class CellReport:
    """All pose cells above one x', y'."""

    x: int
    y: int
    by_heading: NDArray[np.float32]  # (n_theta,) activity
    packet: Packet | None  # to which most of it belongs; None: nothing is active here
    views: tuple[tuple[int, float], ...]  # views linked here, with the sum of their links, strongest first, at most 24
    view_count: int  # how many are linked here
    experiences: tuple[int, ...]  # those in whose zone of influence this is


@dataclass(frozen=True, slots=True, eq=False)
class SeenView:
    """A view that played a part in an event."""

    view: int
    words: str  # which part
    picture: NDArray[np.uint8]  # (h, w) or (h, w, 3) as it was stored then


@dataclass(frozen=True, slots=True, eq=False)
class WhyReport:
    """Why something happened: the chain that led to it, from what was seen to what changed."""

    event: int  # its number
    time_s: float
    kind: str  # of the event
    text: str  # of the event
    chain: tuple[tuple[float, str], ...]  # when (s) and what, in order
    camera: NDArray[np.uint8]  # (h, w, 3) what was seen when it happened
    views: tuple[SeenView, ...]  # those that count most first, at most 4
    shape: tuple[int, int, int]  # of the pose cells: n_theta, n_y, n_x
    before: tuple[Packet, ...]  # packets in the tick before, strongest first
    after: tuple[Packet, ...]
    experiences: tuple[int, ...]  # that were linked, or became active
    since_s: float  # when the chain began; a run without it differs from here on
    without: tuple[int, ...]  # views; had they led nowhere, this would not have happened
    said: tuple[tuple[float, float], ...] = ()  # when (s), and what spoke for a place (nats; negative: against it)


Report = ExperienceReport | ViewReport | CellReport | WhyReport
