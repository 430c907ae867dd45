"""Pose cells: a three-dimensional continuous attractor network that represents where the robot is. ACRA 2004 section 4.

Activity P[theta, y, x] >= 0 sums to 1 and wraps in all directions. Packets of activity move with the odometry (path
integration), are pulled by recognised scenes (visual calibration) and compete (attractor).
"""

# Callers may not be type-checked.
# pyright: reportUnnecessaryIsInstance=false

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.params import PoseCellParams
from ratslam_core.pose_cells import activity_kernels as kernels
from ratslam_core.pose_cells import attractor_kernels as attractor
from ratslam_core.pose_cells import packet_kernels
from ratslam_core.types import Ints32, Packet, Singles, grown, require_finite, wrap_angle

MAX_PACKETS = 8  # reported; all are tracked
WINDOW = 6  # cells: half-width of the window that holds one packet
ROOM = 4096  # active cells there is room for at first; grows when needed


@kind("pose cells/3")
class PoseCells:
    """The network. `step` is one path integration and attractor iteration; RatSlam calls the stages one by one."""

    def __init__(self, params: PoseCellParams | None = None) -> None:
        self.params = p = params or PoseCellParams()
        self.shape = (p.n_theta, p.n_y, p.n_x)
        self._slot = np.zeros(p.n_theta * p.n_y * p.n_x, np.int32)
        self._cells = np.zeros((ROOM, 4), np.int32)
        self._values = np.zeros(ROOM, np.float32)
        self._spare_cells, self._spare_values = self._cells.copy(), self._values.copy()
        self._owner, self._peaks = (np.zeros(ROOM, np.int32) for _ in range(2))
        self._bounds = np.zeros((ROOM, 6), np.int8)
        self._rows, self._ids = np.zeros((MAX_PACKETS, packet_kernels.ROW)), np.zeros(MAX_PACKETS, np.int64)
        self._spare_rows, self._spare_ids = self._rows.copy(), self._ids.copy()
        self._patch = np.zeros((kernels.PATCH, kernels.PATCH), np.float32)
        turns = np.arange(p.n_theta) * 2 * math.pi / p.n_theta
        self._headings = np.column_stack([np.cos(turns), np.sin(turns)])
        self._n, self._found = 0, 0
        self._weights()
        self.place(p.n_x // 2, p.n_y // 2, 0)

    # ------------------------------------------------------------ reading

    @property
    def activity(self) -> Singles:
        """P as a dense array, shape (n_theta, n_y, n_x), no unit, sums to 1. A copy: for inspection, not for every step."""
        dense = np.zeros(self._slot.size, np.float32)
        dense[self._cells[: self._n, kernels.FLAT]] = self._values[: self._n]
        return dense.reshape(self.shape)

    @property
    def active(self) -> tuple[Ints32, Singles]:
        """The n cells with activity, in no promised order: rows (x, y, theta, flat index), shape (n, 4), in cells and layers,
        and their activities, shape (n,), no unit, > 0, summing to 1. Views that hold until the next change."""
        return self._cells[: self._n], self._values[: self._n]

    @property
    def slot(self) -> Ints32:
        """For each cell by its flat index (theta * n_y + y) * n_x + x, shape (n_theta * n_y * n_x,): 1 + its row in `active`,
        0 when it is not active."""
        return self._slot

    @property
    def memory_bytes(self) -> int:
        """Memory of all arrays: 4 bytes per cell for `slot`; the room for active cells does not grow with the network."""
        return sum(a.nbytes for a in vars(self).values() if isinstance(a, np.ndarray))

    @property
    def packets(self) -> tuple[Packet, ...]:
        """All packets, the heaviest first: the competing hypotheses."""
        return tuple(self._packet(rank) for rank in range(min(self._found, MAX_PACKETS)))

    @property
    def winner(self) -> Packet:
        """The packet with the most activity: where the network believes the robot is."""
        return self._packet(0)

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
        """Put all activity into one cell, as a new packet. Whole numbers of cells; ValueError outside the network."""
        for name, value, size in (("theta", theta, 0), ("y", y, 1), ("x", x, 2)):
            if isinstance(value, bool) or not (isinstance(value, int | np.integer) and 0 <= value < self.shape[size]):
                raise ValueError(f"{name} must be a cell from 0 to {self.shape[size] - 1}, got {value!r}")
        flat = (int(theta) * self.shape[1] + int(y)) * self.shape[2] + int(x)
        self._put(np.array([[x, y, theta, flat]], np.int32), np.ones(1, np.float32))
        self._found = 0
        self._find()

    def settle(self) -> None:
        """Make packets of what was injected at once, without the attractor. The activity then sums to 1 again."""
        self._n = attractor.inhibit_and_normalise(self._cells, self._values, self._n, self._slot, np.float32(0))
        self._find()

    def inject(self, cells: Ints32, values: Singles) -> None:
        """Visual calibration, P <- P + injection. ACRA 2004 eq. 4. It acts with the next `attract`.

        cells: flat indices, int32 of shape (k,); values: what they get, float32 of shape (k,), finite and >= 0. A cell named
        twice gets both. ValueError otherwise, and then nothing is injected.
        """
        if not (isinstance(cells, np.ndarray) and cells.dtype == np.int32 and cells.ndim == 1):
            raise ValueError(f"cells must be an int32 array of shape (k,), got {_kind(cells)}")
        if not (isinstance(values, np.ndarray) and values.dtype == np.float32 and values.shape == cells.shape):
            raise ValueError(f"values must be a float32 array of shape {cells.shape}, got {_kind(values)}")
        bad = kernels.first_bad(cells, values, self._slot.size)
        if bad >= 0:
            raise ValueError(
                f"cells must be from 0 to {self._slot.size - 1} and values finite and >= 0, "
                f"got cell {cells[bad]} with {values[bad]:g} in row {bad}"
            )
        self._make_room(self._n + cells.size)
        self._n = kernels.inject(cells, values, self._cells, self._values, self._n, self._slot, self.shape)

    def integrate(self, distance_m: float, turn_rad: float) -> None:
        """Shift the activity as the wheels say, each layer along its own heading. ACRA 2004 eqs. 5-9."""
        along = require_finite("distance_m", distance_m) / self.params.cell_m
        layers = require_finite("turn_rad", turn_rad) * self.params.n_theta / (2 * math.pi)
        packet_kernels.advance(self._rows, self._found, self.shape, along, layers)
        self._make_room(self._n * 8)
        m = kernels.shift(
            self._cells, self._values, self._n, along, layers, self._headings, self._spare_cells, self._spare_values,
            self._slot, self.shape, self._patch,
        )  # fmt: skip
        self._swap(m)

    def attract(self) -> Packet:
        """Excite, inhibit, normalise. ACRA 2004 eqs. 10-12. Returns the winner."""
        p, n = self.params, self._n
        inhibit = np.float32(p.inhibit)
        self._excite_all(inhibit)
        self._n = attractor.inhibit_and_normalise(self._cells, self._values, self._n, self._slot, inhibit)
        gone = self._n == 0
        if gone:
            self._put(self._spare_cells[:n], self._spare_values[:n])  # as they were before
        self._find()
        if gone:
            raise ValueError(
                f"inhibit = {p.inhibit} is above the activity of every cell; take less (nothing was changed)"
            )
        return self.winner

    def set_params(self, params: PoseCellParams) -> None:
        """Take new live parameters; the size cannot change."""
        p = self.params
        if (params.n_theta, params.n_y, params.n_x, params.cell_m) != (p.n_theta, p.n_y, p.n_x, p.cell_m):
            raise ValueError(f"the size of the pose cells is fixed at {p.n_x} x {p.n_y} x {p.n_theta} until a reset")
        self.params = params
        self._weights()

    def cells_apart(self, x1: float, y1: float, x2: float, y2: float) -> float:
        """Distance in the x', y' plane, around the torus, in cells."""
        n_y, n_x = self.shape[1:]
        return math.hypot(math.remainder(x1 - x2, n_x), math.remainder(y1 - y2, n_y))

    # ------------------------------------------------------------ inside

    def _weights(self) -> None:
        self._excite = attractor.gaussian(self.params.excite_sigma)
        side = 2 * WINDOW + self._excite.size
        self._box_a, self._box_b = np.zeros(side**3, np.float32), np.zeros(side**3, np.float32)

    def _excite_all(self, floor: np.float32) -> None:
        m = -1
        while m < 0:
            m, room = attractor.excite(
                self._cells, self._values, self._n, self._owner, self._peaks, self._bounds, self._spare_cells,
                self._spare_values, self._slot, self.shape, WINDOW, self._excite, floor, self._box_a, self._box_b,
            )  # fmt: skip
            self._make_room(room)
        self._swap(m)

    def _put(self, cells: Ints32, values: Singles) -> None:
        """Make these the active cells."""
        kernels.clear(self._cells, self._n, self._slot)
        self._n = len(values)
        self._cells[: self._n], self._values[: self._n] = cells, values
        kernels.index(self._cells, self._n, self._slot)

    def _swap(self, n: int) -> None:
        self._cells, self._spare_cells = self._spare_cells, self._cells
        self._values, self._spare_values = self._spare_values, self._values
        self._n = n

    def _make_room(self, wanted: int) -> None:
        wanted = min(wanted, self._slot.size)
        if wanted <= len(self._cells):
            return
        rows = max(wanted, 2 * len(self._cells))
        for name in ("_cells", "_values", "_bounds", "_spare_cells", "_spare_values", "_owner", "_peaks"):
            setattr(self, name, grown(getattr(self, name), rows))

    def _find(self) -> None:
        """Find the packets in the activity as it is now. Each has the id of the one that was expected there."""
        found = -1
        while found < 0:
            clusters, found = packet_kernels.find(
                self._cells, self._values, self._n, self._slot, self.shape, WINDOW, self._owner, self._peaks,
                self._bounds, self._headings, self._rows, self._ids, self._found, self._spare_rows, self._spare_ids,
            )  # fmt: skip
            if clusters > len(self._spare_rows):
                self._spare_rows = np.zeros((2 * clusters, packet_kernels.ROW))
                self._spare_ids = np.zeros(2 * clusters, np.int64)
        self._rows, self._spare_rows = self._spare_rows, self._rows
        self._ids, self._spare_ids = self._spare_ids, self._ids
        self._found = found

    def _packet(self, rank: int) -> Packet:
        x, y, theta, mass = self._rows[rank, :4].tolist()
        return Packet(x, y, wrap_angle(theta * 2 * math.pi / self.shape[0]), mass, int(self._ids[rank]))


def _kind(value: NDArray[Any]) -> str:
    return f"{value.dtype} {value.shape}" if isinstance(value, np.ndarray) else repr(value)
