"""A recording made from a simulated run, in memory: its pictures, odometry, echoes and, if wanted, its truth."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from app.recordings.recording import About, Moment, Wanted, every
from app.session import Session
from sim2d import SONAR_ANGLES_RAD, load_world


class MadeRecording:
    """Moments that are kept in memory."""

    def __init__(self, moments: list[Moment], name: str = "made") -> None:
        first = moments[0]
        lacks = {"truth"} if first.truth is None else set[str]()
        has = frozenset({"camera", "speed", "yaw rate", "ranges", "truth"} - lacks)
        shape = None if first.image is None else (first.image.shape[0], first.image.shape[1])
        self.about = About(
            name, "made", len(moments), moments[-1].time_s, has, shape, SONAR_ANGLES_RAD, range_limit_m=5.0
        )
        self._moments = moments

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        for number, moment in enumerate(self._moments):
            yield moment if wanted(number) else replace(moment, image=None)


def recorded(ticks: int, truth: bool = True, world: str = "office") -> MadeRecording:
    """The first ticks of a run with seed 1."""
    session, moments = Session(load_world(world), 1), list[Moment]()
    for k in range(ticks):
        session.tick()
        frame, true = session.frame, session.truth
        assert true is not None
        moments.append(
            Moment(
                frame=k,
                time_s=round(k * frame.dt, 6),
                dt=frame.dt,
                image=frame.image,
                speed=frame.odometry_speed,
                yaw_rate=frame.odometry_yaw_rate,
                ranges_m=frame.ranges_m.astype(np.float64),
                truth=(true.x, true.y, true.heading_rad) if truth else None,
            )
        )
    return MadeRecording(moments)
