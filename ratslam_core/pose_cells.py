"""Pose cells: a three-dimensional continuous attractor network that holds where the robot is. ACRA 2004 section 4.

Activity P[theta, y, x] >= 0 sums to 1 and wraps in all directions. Packets of activity move with the odometry (path
integration), are pulled by recognised scenes (visual calibration) and compete (attractor).
"""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ratslam_core import kernels
from ratslam_core.params import PoseCellParams
from ratslam_core.types import Packet, require_finite, wrap_angle

MAX_PACKETS = 8
Cell = TypeVar("Cell", np.int32, np.float32)
ROOM = 4096  # active cells there is room for at first; grows when needed


class PoseCells:
    """The network. `step` is one path integration and attractor iteration; RatSlam calls the stages one by one."""

    def __init__(self, params: PoseCellParams | None = None) -> None:
        self.params = p = params or PoseCellParams()
        self.shape = (p.n_theta, p.n_y, p.n_x)
        self._slot = np.zeros(p.n_theta * p.n_y * p.n_x, np.int32)
        self._cells = np.zeros((ROOM, 4), np.int32)
        self._values = np.zeros(ROOM, np.float32)
        self._spare_cells, self._spare_values = self._cells.copy(), self._values.copy()
        self._owner, self._peaks = np.zeros(ROOM, np.int32), np.zeros(ROOM, np.int32)
        self._rows = np.zeros((MAX_PACKETS, 5))
        self._carry = (0.0, 0.0, 0.0)
        self._weights()
        self._n = 1
        self.place(p.n_x // 2, p.n_y // 2, 0)

    # ------------------------------------------------------------ reading

    @property
    def activity(self) -> NDArray[np.float32]:
        """P as a dense array, shape (n_theta, n_y, n_x), sums to 1. A copy: for looking, not for every step."""
        dense = np.zeros(self._slot.size, np.float32)
        dense[self._cells[: self._n, kernels.FLAT]] = self._values[: self._n]
        return dense.reshape(self.shape)

    @property
    def active(self) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Rows (x, y, theta, flat index), shape (n, 4), and activities, shape (n,): views that hold until the next change."""
        return self._cells[: self._n], self._values[: self._n]

    @property
    def slot(self) -> NDArray[np.int32]:
        """For each cell 1 + its place in `active`, 0 when it is not active."""
        return self._slot

    @property
    def carry(self) -> tuple[float, float, float]:
        """What the attractor swallowed of the last motion: cells in x', y' and layers."""
        return self._carry

    @property
    def packets(self) -> tuple[Packet, ...]:
        """All packets, the heaviest first: the competing hypotheses."""
        return tuple(self._packet(row) for row in self._rows[: self._found])

    @property
    def winner(self) -> Packet:
        """The packet with the most activity: where the network believes the robot is."""
        return self._packet(self._rows[0])

    # ------------------------------------------------------------ stages

    def step(self, *, speed: float, yaw_rate: float, dt: float) -> Packet:
        """Path integration, then one attractor iteration. m/s, rad/s counter-clockwise, s; returns the winner."""
        require_finite("speed", speed)
        require_finite("yaw_rate", yaw_rate)
        if not (math.isfinite(dt) and dt > 0):
            raise ValueError(f"dt must be a positive number of seconds, got {dt!r}")
        self.integrate(speed * dt, yaw_rate * dt)
        return self.attract()

    def place(self, x: int, y: int, theta: int) -> None:
        """All activity in one cell."""
        for name, value, size in (("theta", theta, 0), ("y", y, 1), ("x", x, 2)):
            if not 0 <= value < self.shape[size]:
                raise ValueError(f"{name} must be a cell from 0 to {self.shape[size] - 1}, got {value!r}")
        kernels.clear(self._cells, self._n, self._slot)
        self._cells[0] = (x, y, theta, (theta * self.shape[1] + y) * self.shape[2] + x)
        self._values[0] = 1.0
        self._n = 1
        kernels.index(self._cells, 1, self._slot)
        self._carry = (0.0, 0.0, 0.0)
        self._find()

    def inject(self, cells: NDArray[np.int32], values: NDArray[np.float32]) -> None:
        """Visual calibration, P <- P + injection. ACRA 2004 eq. 4. Flat cell indices, each at most once."""
        self._make_room(self._n + cells.size)
        self._n = kernels.inject(cells, values, self._cells, self._values, self._n, self._slot, self.shape)

    def integrate(self, distance_m: float, turn_rad: float) -> None:
        """Shift the activity as the wheels say: each layer along its own heading. ACRA 2004 eqs. 5-9.

        [ours] The distance is divided by the winner's mean resultant length, because headings spread over a packet
        shorten its move, and what the last attractor iteration pulled the packet back (`carry`) is added again.
        test_pose_cells.py::test_gain_is_one_from_crawl_to_three_cells pins both.
        """
        n_theta = self.shape[0]
        along = distance_m / self.params.cell_m / self._rows[0, 4]
        yaw = turn_rad * n_theta / (2 * math.pi) + self._carry[2]
        self._make_room(self._n * 8)
        m = kernels.shift(
            self._cells, self._values, self._n, self._spare_cells, self._spare_values, self._slot, self.shape,
            along, yaw, self._carry[0], self._carry[1],
        )  # fmt: skip
        self._swap(m)
        heading = self._rows[0, 2] * 2 * math.pi / n_theta
        self._rows[0, 0] = (self._rows[0, 0] + along * math.cos(heading) + self._carry[0]) % self.shape[2]
        self._rows[0, 1] = (self._rows[0, 1] + along * math.sin(heading) + self._carry[1]) % self.shape[1]
        self._rows[0, 2] = (self._rows[0, 2] + yaw) % n_theta

    def attract(self) -> Packet:
        """Excite, inhibit, normalise. ACRA 2004 eqs. 10-12. Returns the winner."""
        near = (self.shape, self.params.window, *self._rows[0, :3])
        before = kernels.centre_near(self._cells, self._values, self._n, *near)
        self._convolve(self._excite)
        if self.params.local_inhibit > 0:
            self._inhibit_locally()
        self._n = kernels.inhibit_and_normalise(
            self._cells, self._values, self._n, self._slot, np.float32(self.params.inhibit)
        )
        if self._n == 0:
            raise ValueError(
                f"inhibit = {self.params.inhibit} is above the activity of every cell: all activity is gone; take less"
            )
        after = kernels.centre_near(self._cells, self._values, self._n, *near)
        self._carry = (before[0] - after[0], before[1] - after[1], before[2] - after[2])
        if not self.params.carry or after[3] == 0.0:
            self._carry = (0.0, 0.0, 0.0)
        x, y = self._rows[0, 0], self._rows[0, 1]
        self._find()
        if self.cells_apart(x, y, self._rows[0, 0], self._rows[0, 1]) > self.params.window:
            self._carry = (0.0, 0.0, 0.0)
        return self.winner

    def set_params(self, params: PoseCellParams) -> None:
        """Take new live parameters; the size stays what it is."""
        p = self.params
        if (params.n_theta, params.n_y, params.n_x, params.cell_m) != (p.n_theta, p.n_y, p.n_x, p.cell_m):
            raise ValueError(f"the size of the pose cells is fixed at {p.n_x} x {p.n_y} x {p.n_theta} until a reset")
        self.params = params
        self._weights()

    def cells_apart(self, x1: float, y1: float, x2: float, y2: float) -> float:
        """Distance in the x', y' plane, around the torus, in cells."""
        n_y, n_x = self.shape[1:]
        return math.hypot((x1 - x2 + n_x / 2) % n_x - n_x / 2, (y1 - y2 + n_y / 2) % n_y - n_y / 2)

    # ------------------------------------------------------------ inside

    def _weights(self) -> None:
        self._excite = gaussian(self.params.excite_sigma, self.params.excite_radius)
        self._inhibit = gaussian(self.params.local_inhibit_sigma, self.params.local_inhibit_radius)
        side = 2 * self.params.window + 2 * max(self.params.excite_radius, self.params.local_inhibit_radius) + 1
        self._box_a, self._box_b = np.zeros(side**3, np.float32), np.zeros(side**3, np.float32)

    def _convolve(self, weights: NDArray[np.float32]) -> None:
        clusters, window = self._cluster(), self.params.window
        self._make_room(clusters * (2 * window + weights.size) ** 3)
        m = kernels.convolve(
            self._cells, self._values, self._n, self._owner, self._peaks, clusters,
            self._spare_cells, self._spare_values, self._slot, self.shape, window, weights, self._box_a, self._box_b,
        )  # fmt: skip
        self._swap(m)

    def _cluster(self) -> int:
        return kernels.cluster(
            self._cells, self._values, self._n, self.shape, self.params.window, self._owner, self._peaks
        )

    def _inhibit_locally(self) -> None:
        cells, values, n = self._cells[: self._n].copy(), self._values[: self._n].copy(), self._n
        self._convolve(self._inhibit)
        wide_cells, wide_values, m = self._cells[: self._n].copy(), self._values[: self._n].copy(), self._n
        kernels.clear(self._cells, self._n, self._slot)
        self._cells[:n], self._values[:n], self._n = cells, values, n
        kernels.index(self._cells, n, self._slot)
        gain = np.float32(self.params.local_inhibit)
        kernels.subtract(self._values, self._slot, wide_cells, wide_values, m, gain)

    def _swap(self, n: int) -> None:
        self._cells, self._spare_cells = self._spare_cells, self._cells
        self._values, self._spare_values = self._spare_values, self._values
        self._n = n

    def _make_room(self, wanted: int) -> None:
        wanted = min(wanted, self._slot.size)
        if wanted <= len(self._cells):
            return
        extra = max(wanted, 2 * len(self._cells)) - len(self._cells)

        def grow(array: NDArray[Cell]) -> NDArray[Cell]:
            return np.concatenate([array, np.zeros((extra, *array.shape[1:]), array.dtype)])

        self._cells, self._values = grow(self._cells), grow(self._values)
        self._spare_cells, self._spare_values = grow(self._spare_cells), grow(self._spare_values)
        self._owner, self._peaks = grow(self._owner), grow(self._peaks)

    def _find(self) -> None:
        self._found = kernels.packet_rows(
            self._cells, self._values, self._n, self.shape, self._owner, self._peaks, self._cluster(), self._rows
        )

    def _packet(self, row: NDArray[np.float64]) -> Packet:
        return Packet(
            float(row[0]), float(row[1]), wrap_angle(float(row[2]) * 2 * math.pi / self.shape[0]), float(row[3])
        )


def gaussian(sigma: float, radius: int) -> NDArray[np.float32]:
    """A normalised Gaussian over 2 radius + 1 cells."""
    at = np.arange(-radius, radius + 1)
    weights = np.exp(-0.5 * (at / sigma) ** 2)
    return (weights / weights.sum()).astype(np.float32)
