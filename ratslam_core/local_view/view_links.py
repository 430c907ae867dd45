"""Hebbian links from local view cells to pose cells. ACRA 2004 equations 2-4.

Links are sparse: each view has a block of (pose cell, strength) in one arena. A full block moves to the end, with a
quarter more room. When the arena is full, the blocks are copied without gaps into a new one, a third larger than all of
them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from disk import kind
from ratslam_core.params import LocalViewParams
from ratslam_core.parts import PoseCellsPart
from ratslam_core.pose_cells.activity_kernels import FLAT
from ratslam_core.types import Flags, Ints, Ints32, Recognition, Singles, grown

LOST = 0.5  # what all links of a view inject together while the robot knows that it is lost


@kind("view links/2")
class ViewLinks:
    """beta_i,xyz for every view i."""

    def __init__(self, params: LocalViewParams | None = None) -> None:
        self.params = params or LocalViewParams()
        self._cells = np.zeros(65_536, np.int32)
        self._strength = np.zeros(65_536, np.float32)
        self._blocks = np.zeros((1024, 3), np.int64)  # start, used, room of each view
        self._end = 0
        self.forgotten = 0  # links so far that were weaker than the strongest
        self._seen = np.zeros(4096, np.bool_)

    def of(self, view: int) -> tuple[Ints32, Singles]:
        """The pose cells that a view is linked to, flat indices, and the strengths."""
        start, used, _ = self._blocks[view] if view < len(self._blocks) else (0, 0, 0)
        return self._cells[start : start + used], self._strength[start : start + used]

    @property
    def room(self) -> int:
        """How many links the arena has room for."""
        return self._cells.size

    @property
    def count(self) -> int:
        """How many links there are."""
        return int(self._blocks[:, 1].sum())

    def views_at(self, column: int, columns: int, views: int) -> tuple[Ints32, Singles]:
        """The views, of the first `views`, that are linked to pose cells at one place x', y', and the sums of those links.

        column: the place, a flat index modulo `columns`. For inspection only: it goes through all links.
        """
        start, used, _ = self._blocks[:views].T
        at = in_use(start, used)
        strength = np.zeros(views, np.float32)
        here = self._cells[at] % columns == column
        np.add.at(strength, np.repeat(np.arange(len(used)), used)[here], self._strength[at][here])
        linked = np.flatnonzero(strength).astype(np.int32)
        return linked, strength[linked]

    def learn(self, view: int, cells: Ints32, activity: Singles, slot: Ints32, rate: float | None = None) -> None:
        """beta <- (1 - delta) beta + eta P for all active pose cells. ACRA 2004 eqs. 2-3.

        cells, activity, slot: the active set of the pose cells (`PoseCells.active`, `PoseCells.slot`). rate: eta, without it
        the parameter `learning_rate`.
        """
        eta = self.params.learning_rate if rate is None else rate
        self._make_room(view, len(cells), slot)
        block = self._blocks[view]
        block[1] = _learn(
            self._cells[block[0] : block[0] + block[2]], self._strength[block[0] : block[0] + block[2]], block[1],
            cells, activity, slot, self._seen, np.float32(eta), np.float32(self.params.decay),
        )  # fmt: skip
        most = self.params.most_links
        if most and block[1] > most + most // 4:  # not with every observation, since to find the weakest takes time
            self._forget_weakest(view, most)

    def _forget_weakest(self, view: int, most: int) -> None:
        """[ours] Keep the strongest links of a view, of equals those learnt first.

        A view is linked to every cell that was ever active while it was seen, however faintly. The weak ones would be
        most of the memory, and blur what the view injects.
        test_view_links.py::test_a_view_keeps_its_strongest_links.
        """
        start, used = self._blocks[view, :2].tolist()
        cells, strength = self._cells[start : start + used], self._strength[start : start + used]
        least = np.partition(strength, used - most)[used - most]
        kept = strength > least
        kept[np.flatnonzero(strength == least)[: most - np.count_nonzero(kept)]] = True
        cells[:most], strength[:most] = cells[kept], strength[kept]
        self._blocks[view, 1] = most
        self.forgotten += used - most

    def forget(self, view: int) -> None:
        """Drop all links of a view."""
        self._blocks[view, 1] = 0

    def recall(self, view: int, lost: bool = False) -> tuple[Ints32, Singles]:
        """What the active view injects: min(beta, s_max) per link. ACRA 2004 eq. 4.

        [ours] A lost robot's view injects LOST in sum. test_view_links.py::test_a_lost_robot_s_view_injects_more.
        """
        cells, strength = self.of(view)
        values = np.minimum(strength, np.float32(self.params.saturation))
        if lost and (total := float(values.sum(dtype=np.float64))) > 0:
            values *= np.float32(LOST / total)
        return cells, values

    def _make_room(self, view: int, active: int, slot: Ints32) -> None:
        while view >= len(self._blocks):
            self._blocks = grown(self._blocks)
        if active > len(self._seen):
            self._seen = np.zeros(2 * active, np.bool_)
        start, used, room = self._blocks[view].tolist()
        needed = used + active - _count_active(self._cells[start : start + used], slot)
        if needed <= room:
            return
        wanted = needed + room // 4
        if self._end + wanted > self._cells.size:
            self._move_together(wanted)
            start = self._blocks[view, 0]
        self._cells[self._end : self._end + used] = self._cells[start : start + used]
        self._strength[self._end : self._end + used] = self._strength[start : start + used]
        self._blocks[view] = self._end, used, wanted
        self._end += wanted

    def _move_together(self, wanted: int) -> None:
        """Copy the blocks without gaps into a new arena that has room for `wanted` more."""
        size = (int(self._blocks[:, 2].sum()) + wanted) * 4 // 3
        cells, strength = np.zeros(size, np.int32), np.zeros(size, np.float32)
        self._end = _move(self._cells, self._strength, self._blocks, cells, strength)
        self._cells, self._strength = cells, strength


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

        [ours] A view younger than `rest` does not inject. Otherwise it would hold the packet back where it has just been
        learnt. test_visual_association.py::test_a_young_view_does_not_hold_the_packet_back.
        """
        self._time_s += dt
        self.injection = None
        if seen.recruited:
            self._begin(seen.view)
        if seen.view < 0:
            return
        self.learning_rate = self._rate(strength, 0.0 if lost else min(1.0, pose_cells.winner.mass))
        self.links.learn(seen.view, *pose_cells.active, pose_cells.slot, self.learning_rate)
        if self.age_s(seen.view) < self.params.rest:
            return
        cells, injection = self.links.recall(seen.view, lost)
        pose_cells.inject(cells, injection)
        self.injection = Injection(seen.view, cells.copy(), injection)

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
    cells: Ints32  # (k,) flat indices
    values: Singles  # (k,) activity added to each


def in_use(start: Ints, used: Ints) -> Ints:
    """Where in an arena the blocks' entries in use lie, block after block."""
    begins = np.cumsum(used) - used
    return np.arange(int(used.sum())) + np.repeat(start - begins, used)


@njit(cache=True, nogil=True)
def _count_active(linked: Ints32, slot: Ints32) -> int:
    count = 0
    for k in range(len(linked)):
        if slot[linked[k]] > 0:
            count += 1
    return count


@njit(cache=True, nogil=True)
def _move(cells: Ints32, strength: Singles, blocks: Ints, to_cells: Ints32, to_strength: Singles) -> int:
    """Copy each view's links, one block behind the other, to another arena. Returns where the last one ends."""
    end = 0
    for view in range(len(blocks)):
        start, used, room = blocks[view, 0], blocks[view, 1], blocks[view, 2]
        to_cells[end : end + used] = cells[start : start + used]
        to_strength[end : end + used] = strength[start : start + used]
        blocks[view, 0] = end
        end += room
    return end


@njit(cache=True, nogil=True)
def _learn(
    linked: Ints32, strength: Singles, used: int, cells: Ints32, activity: Singles, slot: Ints32, seen: Flags,
    eta: np.float32, delta: np.float32,
) -> int:  # fmt: skip
    """beta <- (1 - delta) beta + eta P in one view's block; returns how much of the block is used then."""
    n = len(cells)
    seen[:n] = False
    for k in range(used):
        strength[k] *= 1 - delta
        at = slot[linked[k]]
        if at > 0:
            strength[k] += eta * activity[at - 1]
            seen[at - 1] = True
    for i in range(n):
        if not seen[i]:
            linked[used] = cells[i, FLAT]
            strength[used] = eta * activity[i]
            used += 1
    return used
