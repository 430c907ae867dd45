"""What moves by itself, once, so that one sees why: a correction is played slowly, a robot that is carried is lifted, and a dot
runs along a new route. A page whose reader wants little motion is shown a viewer without.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from web.messages import Snapshot
from web.viewer.primitives import meshes
from web.viewer.primitives.labels import add_mesh
from web.viewer.replay import Replay
from web.viewer.scenery import Scenery

FRESH_S = 2.0  # of simulated time: who has not looked for longer has missed it
REST_S = 20.0  # between two corrections that play by themselves: the map stands still meanwhile
QUICKEST = 2.0  # times real time: who runs faster does not look for single events
LEAST_BEND_M = 0.15  # a smaller correction is not seen on the plate
JUMP_M = 0.6  # more than it drives between two snapshots at that speed
LIFT_S, LIFT_Z = 0.9, 1.6
RUN_S, RUN_Z = 1.1, 0.24

Points = NDArray[np.float64]


@dataclass(frozen=True)
class _Way:
    """points: (n, 2) on a plate."""

    points: Points
    began_s: float
    lasts_s: float

    def at(self, now_s: float) -> tuple[Points, float]:
        """Where on the way, slow at both ends, and which share of the time has passed."""
        share = min(max((now_s - self.began_s) / self.lasts_s, 0.0), 1.0)
        along: Points = np.zeros(len(self.points))
        along[1:] = np.cumsum(np.linalg.norm(np.diff(self.points, axis=0), axis=1))
        far = float(along[-1]) * share * share * (3 - 2 * share)
        x, y = (float(np.interp(far, along, self.points[:, k])) for k in (0, 1))
        return np.array([x, y]), share


class Motion:
    """Used in the viewer's thread. `tell` takes each snapshot, `draw` moves what is under way."""

    def __init__(self, scenery: Scenery, replay: Replay) -> None:
        self._office, self._map, self._replay = scenery.office, scenery.map, replay
        self._last: Snapshot | None = None
        self._lift: _Way | None = None
        self._run: _Way | None = None
        self._awaits = False  # there is a new goal whose route has not come yet
        self._rests_until_s = 0.0
        palette = self._map.palette
        disc = meshes.flat_polygon(meshes.circle(0.3), RUN_Z)
        self._dot = add_mesh(
            self._map.scene, f"{self._map.root}/runner", disc, palette.lit(palette.goal), visible=False
        )

    @property
    def lifts(self) -> bool:
        """The robot is in the air: it is not drawn where it is."""
        return self._lift is not None

    def tell(self, now: Snapshot, now_s: float) -> None:
        """What is new since the last snapshot begins to move."""
        last, self._last = self._last, now
        if last is None or last is now or last.run != now.run or now.tick < last.tick:
            return
        self._await_route(last, now, now_s)
        if now.sought(last) or now.time_s - last.time_s > FRESH_S or not 0 < now.speed <= QUICKEST:
            return
        if last.truth is not None and now.truth is not None:
            jump_m = math.hypot(now.truth.x - last.truth.x, now.truth.y - last.truth.y)
            if jump_m > JUMP_M:
                self._carry(now, now_s)
        if now.running:
            self._straighten(last, now, now_s)

    def _straighten(self, last: Snapshot, now: Snapshot, now_s: float) -> None:
        if not now.closures or self._replay.runs or now_s < self._rests_until_s:
            return
        new = now.closures[-1]
        if new.moved_m >= LEAST_BEND_M and all(new is not known for known in last.closures):
            self._replay.start(new, now_s)
            self._rests_until_s = now_s + REST_S

    def _await_route(self, last: Snapshot, now: Snapshot, now_s: float) -> None:
        before, goal = last.goal, now.goal
        if goal is None:
            self._awaits = False
        elif before is None or before.experience != goal.experience:  # its place moves with each correction of the map
            self._awaits = True
            self._replay.stop()  # whoever sends it somewhere wants to see the way
        if self._awaits and goal is not None and len(goal.route_xy) > 1:
            self._awaits = False
            self._run = _Way(self._map.fit.to_plate(np.asarray(goal.route_xy, np.float64)), now_s, RUN_S)

    def _carry(self, now: Snapshot, now_s: float) -> None:
        assert now.truth is not None
        start = np.array(self._office.robot.frame.position[:2])
        end = self._office.fit.to_plate(np.array([[now.truth.x, now.truth.y]]))[0]
        if np.hypot(*(end - start)) > self._office.robot.radius:  # whoever dragged it has let it go there
            self._lift = _Way(np.stack([start, end]), now_s, LIFT_S)

    def draw(self, now_s: float) -> None:
        if self._run is not None:
            at, share = self._run.at(now_s)
            self._dot.position = (float(at[0]), float(at[1]), 0.0)
            self._dot.visible = share < 1
            self._run = self._run if share < 1 else None
        if self._lift is None:
            return
        at, share = self._lift.at(now_s)
        frame = self._office.robot.frame
        frame.position = (float(at[0]), float(at[1]), LIFT_Z * math.sin(math.pi * share) if share < 1 else 0.0)
        self._lift = self._lift if share < 1 else None
