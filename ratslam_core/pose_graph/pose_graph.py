"""The pose graph: experiences with their poses in the map, and the links between them that map correction works on.

How it is learnt is in experience_map.py; `places.py` and `temporal_map.py` read it. ACRA 2006 sections 3.2 and 3.3.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ratslam_core.params import ExperienceMapParams
from ratslam_core.pose_graph.experiences import Experiences
from ratslam_core.pose_graph.transitions import Link, Transitions
from ratslam_core.types import Floats, Ints, Ints32, Packet, Pose2, pose_of

STEP_SIGMA = 0.04  # cells: error of odometry over one step, the least that a link is taken to have
TURN_CELLS = 0.175  # rad a cell: an error in heading that counts as much as an error of a cell


class PoseGraph:
    """Experiences with their poses, links with their times."""

    def __init__(self, shape: tuple[int, int, int], cell_m: float, params: ExperienceMapParams | None = None) -> None:
        """shape: layers, cells along y' and x' of the pose cells; cell_m: side of one cell."""
        self.params = params or ExperienceMapParams()
        self.shape, self.cell_m = shape, cell_m
        self._experiences = Experiences(shape)
        self.transitions = Transitions()
        self.yaw_bias = 0.0  # rad/s, learnt: odometry turns too far by so much
        self.closures = 0  # loop closures: links made to experiences that existed before
        self.steps = 0  # of correction
        self._driven_m = self._driving_s = 0.0

    def __len__(self) -> int:
        return self._experiences.count

    @property
    def step_sigma_m(self) -> float:
        """Error of odometry over one step, m."""
        return STEP_SIGMA * self.cell_m

    # ------------------------------------------------------------ experiences

    @property
    def poses(self) -> Floats:
        """x, y (m), heading (rad) of every experience in the map, shape (n, 3). A view."""
        return self._experiences.pose[: self._experiences.count]

    @property
    def cell_states(self) -> Floats:
        """x', y' (cells), theta' (layers) of every experience, shape (n, 3). A view."""
        return self._experiences.at[: self._experiences.count]

    @property
    def views(self) -> Ints:
        """The scene of every experience, -1 for nothing to see, shape (n,). A view."""
        return self._experiences.view[: self._experiences.count]

    @property
    def submap_of(self) -> Ints32:
        """The number of the submap that each experience lies on, shape (n,): extensions/submaps.py. A view."""
        return self._experiences.submap[: self._experiences.count]

    def pose(self, experience: int) -> Pose2:
        """An experience's place in the map."""
        return pose_of(*self._experiences.pose[self._require(experience)].tolist())

    def cell_state(self, experience: int) -> tuple[float, float, float, int]:
        """x', y' (cells), theta' (layers) and the scene of one experience."""
        x, y, theta = self.cell_states[self._require(experience)]
        return float(x), float(y), float(theta), int(self.views[experience])

    def energy(self, experience: int, packet: Packet, view: int) -> float:
        """How well this state of pose cells and scene fits an experience; at most 2. See `Experiences.energy`."""
        return self._experiences.energy(self._require(experience), packet, view, self.params)

    def _require(self, experience: int) -> int:
        n = self._experiences.count
        if n == 0:
            raise ValueError(f"there is no experience yet, got {experience!r}")
        if not 0 <= experience < n:
            raise ValueError(f"experience must be from 0 to {len(self) - 1}, got {experience!r}")
        return experience

    # ------------------------------------------------------------ links

    @property
    def link_count(self) -> int:
        return len(self.transitions.row_of)

    @property
    def links(self) -> Ints:
        """From and to of every link, shape (m, 2)."""
        return self.transitions.ends[self._travelled]

    @property
    def moves(self) -> Floats:
        """dx, dy (m) in the frame of the first experience and change of facing (rad) of every link, shape (m, 3)."""
        return self.transitions.move[self._travelled]

    @property
    def behaviours(self) -> NDArray[np.int8]:
        """The behaviour under which each link was learnt, shape (m,)."""
        return self.transitions.behaviour[self._travelled]

    @property
    def confidences(self) -> Floats:
        """c_ij of every link, shape (m,). ACRA 2006 eq. 9."""
        return self.transitions.confidence[self._travelled]

    @property
    def link_times(self) -> Floats:
        """Seconds that each transition takes, shape (m,).

        [ours] Never less than its length in the map takes at the robot's average pace. From the edge of one zone into
        the next it is only a step, and a route over many such links would promise to arrive in half the time.
        test_experience_map_transitions.py::test_no_link_is_quicker_than_the_robot.
        """
        return self.transitions.seconds(self.poses, self.pace)[self._travelled]

    @property
    def pace(self) -> float:
        """Seconds per metre, averaged over all driving so far; 0 before the robot has driven and when `pace_floor` is off."""
        return self._driving_s / self._driven_m if self._driven_m > 0 and self.params.pace_floor else 0.0

    def link(self, i: int, j: int) -> Link:
        """The link from experience i to j; ValueError when there is none."""
        row = self.transitions.row_of.get((i, j))
        if row is None:
            raise ValueError(f"there is no link from experience {i!r} to {j!r}")
        return self.transitions.link(row)

    @property
    def residual(self) -> tuple[float, float]:
        """By how much links and map disagree: distance (m) and angle (rad) between where a link says its end is and
        where the map has it. Root mean squares over the links, weighted by `believed`; 0 without links."""
        t, rows = self.transitions, self._travelled
        weight = t.believed[rows]
        if weight.sum() <= 0:
            return 0.0, 0.0
        apart = disagreement(self.poses, t.ends[rows], t.move[rows]) ** 2 * weight[:, None]
        total = weight.sum()
        return float(np.sqrt(apart[:, :2].sum() / total)), float(np.sqrt(apart[:, 2].sum() / total))

    @property
    def dropped_links(self) -> tuple[tuple[int, int], ...]:
        """From and to of every link that was deleted, in order. One that was driven again may be among `links`, too."""
        return tuple(self.transitions.dropped)

    @property
    def _travelled(self) -> Ints:
        return np.flatnonzero(self.transitions.travelled[: self.transitions.count])


@njit(cache=True, nogil=True, inline="always")
def wrapped(angle: float) -> float:
    if angle > math.pi or angle <= -math.pi:
        angle -= 2.0 * math.pi * math.ceil(angle / (2.0 * math.pi) - 0.5)
    return angle


@njit(cache=True, nogil=True)
def disagreement(poses: Floats, links: Ints, moves: Floats) -> Floats:
    """Where each link says its end is, minus where the map has it: dx, dy (m) in the map's frame, angle (rad), shape (m, 3)."""
    out = np.empty((len(links), 3))
    for row in range(len(links)):
        i, j = links[row]
        c, s = math.cos(poses[i, 2]), math.sin(poses[i, 2])
        out[row, 0] = poses[i, 0] + c * moves[row, 0] - s * moves[row, 1] - poses[j, 0]
        out[row, 1] = poses[i, 1] + s * moves[row, 0] + c * moves[row, 1] - poses[j, 1]
        out[row, 2] = wrapped(poses[i, 2] + moves[row, 2] - poses[j, 2])
    return out
