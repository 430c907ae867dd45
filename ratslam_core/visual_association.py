"""Visual association and calibration: a view learns where it is seen, and later puts activity there.

ACRA 2004 section 4, eqs. 2-4.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.local_view.view_links import ViewLinks
from ratslam_core.params import LocalViewParams
from ratslam_core.parts import PoseCellsPart
from ratslam_core.types import Recognition


@dataclass(frozen=True, slots=True, eq=False)
class Injection:
    """What a view put into the pose cells in one step."""

    view: int
    cells: NDArray[np.int32]  # (k,) flat indices
    values: NDArray[np.float32]  # (k,) activity added to each


@kind("visual association/2")
class VisualAssociation:
    """Links the active view with the pose cells, once per step."""

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
