"""A pilot in a simulated room, on a map made by hand."""

from __future__ import annotations

from collections import Counter

import numpy as np

from app.pilot import Pilot, PilotParams
from app.pilot.local_movement import LocalMovement
from app.pilot.route_following import RouteFollower
from ratslam_core import Odometry
from sim2d import SONAR_ANGLES_RAD, Drive, Simulator

from .worlds import HandMadeMap

DT = 0.1


USUAL, NEAR = PilotParams(), PilotParams(clearance=0.2)


ANGLES = np.array(SONAR_ANGLES_RAD)


FAR = np.full(8, 5.0, np.float32)


STILL = Odometry(0.0, 0.0, DT)


EXPLORING = {"following the wall", "crossing", "turning back to look"}


def a_pilot(seed: int = 0, **params: float) -> Pilot:
    return Pilot(PilotParams(**params), ANGLES, np.random.default_rng(seed))


def follow(follower: RouteFollower, map_: HandMadeMap, p: PilotParams = USUAL) -> tuple[float, float] | None:
    """One step of a follower whose robot has heard no echo."""
    return follower.step(map_, LocalMovement(ANGLES, 1), DT, p)  # type: ignore[arg-type]


class Run:
    """A pilot in a simulated room, on a map made by hand."""

    def __init__(self, simulator: Simulator, pilot: Pilot, map_: HandMadeMap | None = None) -> None:
        self.simulator, self.pilot = simulator, pilot
        self.map = map_ or HandMadeMap([(0.0, 0.0)], [])
        self.doing: Counter[str] = Counter()
        self.frame = simulator.observe()
        self.track: list[tuple[float, float]] = []
        self.bumps = 0

    def tick(self) -> None:
        frame = self.frame
        self.map.know(self.simulator)
        odometry = Odometry(frame.odometry_speed, frame.odometry_yaw_rate, frame.dt)
        speed, yaw_rate = self.pilot.step(frame.ranges_m, frame.bumped, odometry, self.map)  # type: ignore[arg-type]
        self.doing[self.pilot.doing] += 1
        self.frame = self.simulator.step(Drive(speed, yaw_rate))
        self.bumps += self.frame.bumped
        self.track.append((self.simulator.truth.x, self.simulator.truth.y))

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / DT)):
            self.tick()

    @property
    def truth(self) -> tuple[float, float]:
        return self.simulator.truth.x, self.simulator.truth.y
