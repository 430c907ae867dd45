"""Where the pose cells say that the robot is: path integration, visual association and attractor. ACRA 2004 section 4."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.beats import Tick
from ratslam_core.local_view.view_links import ViewLinks
from ratslam_core.params import LocalViewParams, PoseCellParams
from ratslam_core.parts import PoseCellsPart
from ratslam_core.types import Odometry, Packet, Recognition

SNAP_CELLS = 3.0  # a longer jump of the winning packet is a relocalisation


@kind("localisation/1")
class Localisation:
    """Moves the packets, lets views put activity there, and lets the packets compete."""

    def __init__(self, pose_cells: PoseCellsPart, association: VisualAssociation, params: PoseCellParams) -> None:
        self.pose_cells, self.association, self.params = pose_cells, association, params

    def step(
        self, seen: Recognition, strength: float, tick: Tick, lost: bool, watch: Callable[[str], None]
    ) -> tuple[Packet, bool]:
        """The winning packet at the end of the tick, and whether it has jumped.

        strength: how sure the recognition is, 0 to 1; lost: the robot knows that it was carried away; watch: called
        with the name of each stage after it.

        Several beats in one tick: what is seen at its end is seen in the last of them. The way up to there is driven beat
        by beat, then the image is associated once for each; the attractor follows every such part of a stage.
        """
        jumped = False
        for _ in range(tick.beats - 1):
            self._integrate(tick.moved)
            jumped |= self._attract()[1]
        for beat in range(tick.beats):
            if beat:
                jumped |= self._attract()[1]
            self.association.step(again(seen) if beat else seen, strength, tick.moved.dt, self.pose_cells, lost)
        watch("injection")
        self._integrate(tick.moved)
        watch("path integration")
        packet, jumps = self._attract()
        watch("attractor")
        return packet, jumped or jumps

    def _integrate(self, moved: Odometry) -> None:
        """With `yaw_bias`, the cells turn too far and the map does not: ACRA 2005 5.2, figures 8 to 10. test_biased_loop.py."""
        yaw_rate = moved.yaw_rate + (0.0 if moved.still else self.params.yaw_bias)
        self.pose_cells.integrate(moved.speed * moved.dt, yaw_rate * moved.dt)

    def _attract(self) -> tuple[Packet, bool]:
        """One step of the attractor. Returns the winner, and whether it has jumped from where it was."""
        expected, packet = self.pose_cells.winner, self.pose_cells.attract()
        jump = self.pose_cells.cells_apart(expected.x, expected.y, packet.x, packet.y)
        return packet, jump > SNAP_CELLS


def again(seen: Recognition) -> Recognition:
    """The same observation a beat later. A view that was just recruited is known by then, and equal to itself."""
    return replace(seen, recruited=False, best_view=seen.view, difference=0.0) if seen.recruited else seen


@kind("visual association/2")
class VisualAssociation:
    """A view learns where it is seen, and later puts activity there (visual calibration). ACRA 2004 section 4, eqs. 2-4."""

    CACHES = ("injection",)

    def __init__(self, params: LocalViewParams) -> None:
        self.params = params
        self.links = ViewLinks(params)
        self.learning_rate = 0.0  # of the last association
        self.injection: Injection | None = None  # of the last step, for who watches; nothing here depends on it
        self._time_s = 0.0
        self._learnt_s: list[float] = []  # when each view was recruited

    def set_params(self, params: LocalViewParams) -> None:
        self.params = self.links.params = params

    def step(self, seen: Recognition, strength: float, dt: float, pose_cells: PoseCellsPart, lost: bool) -> None:
        """Link the active view to the active pose cells, and inject activity into the cells it is linked to.

        strength: how sure the recognition is, 0 to 1; lost: the robot knows that it was carried away.

        [ours] What is injected was learnt before this step, and a view younger than `rest` neither injects nor learns on.
        Otherwise it would hold the packet back where it has just been learnt. The plain twin is `learn_first`, with
        `rest` 0.
        test_visual_association.py::test_a_young_view_does_not_hold_the_packet_back.
        """
        self._time_s += dt
        self.injection = None
        if seen.recruited:
            self._begin(seen.view)
        if seen.view < 0:
            return
        self.learning_rate = self._rate(strength, 0.0 if lost else min(1.0, pose_cells.winner.mass))
        young = self._time_s - self._learnt_s[seen.view] < self.params.rest
        learns_first = self.params.learn_first or seen.recruited
        if learns_first:
            self._learn(seen.view, pose_cells)
        if young:
            return
        cells, injection = self.links.recall(seen.view, lost)
        cells = cells.copy()
        if not learns_first:
            self._learn(seen.view, pose_cells)
        pose_cells.inject(cells, injection)
        self.injection = Injection(seen.view, cells, injection)

    def age_s(self, view: int) -> float:
        """How long ago a view was recruited, seconds of the engine's time."""
        return self._time_s - self._learnt_s[view]

    def _begin(self, view: int) -> None:
        """A view was recruited, perhaps in the room of one that has faded."""
        if view == len(self._learnt_s):
            self._learnt_s.append(self._time_s)
            return
        self._learnt_s[view] = self._time_s
        self.links.forget(view)

    def _learn(self, view: int, pose_cells: PoseCellsPart) -> None:
        self.links.learn(view, *pose_cells.active, pose_cells.slot, self.learning_rate)

    def _rate(self, strength: float, confidence: float) -> float:
        """The Hebbian learning rate of this step: fixed, or adaptive.

        [ours] Adaptive, which ACRA 2004 section 6.3 names as future work: twice the rate x strength of vision (1 for a
        view equal to the known one, 0 at the threshold) x confidence (the winning packet's share of all activity, 0
        while lost). A view that is hardly recognised, or seen while hypotheses compete, is hardly learnt; a clear one
        at a certain place is learnt twice as fast.
        test_visual_association.py::test_the_adaptive_rate_follows_vision_and_confidence.
        """
        p = self.params
        return 2 * p.learning_rate * strength * confidence if p.adaptive else p.learning_rate


@dataclass(frozen=True, slots=True, eq=False)
class Injection:
    """What a view put into the pose cells in one step."""

    view: int
    cells: NDArray[np.int32]  # (k,) flat indices
    values: NDArray[np.float32]  # (k,) activity added to each
