"""What is true of the pose cells between two steps."""

# Laws look at all of a state, and take nothing for granted.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

import numpy as np

from ratslam_core.laws.measures import array, number, true, whole, within
from ratslam_core.pose_cells import activity_kernels as kernels
from ratslam_core.pose_cells import packet_kernels
from ratslam_core.pose_cells.network import PoseCells

MOST_ACTIVITY = 1e6  # packets injected by hand add to the sum of 1 until the next step


def pose_cells(cells: PoseCells, fresh: PoseCells) -> None:
    """ValueError names the first law that does not hold. fresh: a network that was just made with the same parameters."""
    _buffers(cells)
    _derived(cells, fresh)
    _activity(cells)
    _packets(cells)


def _buffers(cells: PoseCells) -> None:
    p = cells.params
    true(cells.shape == (p.n_theta, p.n_y, p.n_x), f"the pose cells' shape must be {(p.n_theta, p.n_y, p.n_x)}")
    room = len(array("cells", cells._cells, np.int32, (None, 4)))
    array("slot", cells._slot, np.int32, (p.n_theta * p.n_y * p.n_x,))
    array("spare cells", cells._spare_cells, np.int32, (room, 4))
    for name in ("_values", "_spare_values"):
        array(name[1:], getattr(cells, name), np.float32, (room,))
    for name in ("_owner", "_spare_owner", "_peaks"):
        array(name[1:], getattr(cells, name), np.int32, (room,))
    array("bounds", cells._bounds, np.int8, (room, 6))


def _derived(cells: PoseCells, fresh: PoseCells) -> None:
    """Arrays that follow from the parameters, and scratch arrays between two steps."""
    for name in ("_patch", "_headings", "_excite"):
        wanted = getattr(fresh, name)
        found = array(name[1:], getattr(cells, name), wanted.dtype, wanted.shape)
        true(np.array_equal(found, wanted), f"{name[1:]} must be as in a network that was just made")
    for name in ("_box_a", "_box_b"):
        array(name[1:], getattr(cells, name), np.float32, getattr(fresh, name).shape)


def _activity(cells: PoseCells) -> None:
    n_theta, n_y, n_x = cells.shape
    n = whole("the number of active cells", cells._n, 1, min(len(cells._cells), cells._slot.size))
    rows, values = cells.active
    for column, size in ((kernels.X, n_x), (kernels.Y, n_y), (kernels.THETA, n_theta)):
        within(f"column {column} of the active cells", rows[:, column], 0, size - 1)
    x, y, theta, flat = rows.astype(np.int64).T
    true((flat == (theta * n_y + y) * n_x + x).all(), "each active cell's index must be that of its place")
    true((cells._slot[flat] == np.arange(1, n + 1)).all(), "slot must name the row of each active cell")
    true(np.count_nonzero(cells._slot) == n, "slot must name no cell that is not active")
    within("activity", values, 0.0, MOST_ACTIVITY)
    number("the sum of all activity", float(values.sum(dtype=np.float64)), 0.99, MOST_ACTIVITY)


def _packets(cells: PoseCells) -> None:
    k, spare = len(array("packets", cells._rows, np.float64, (None, packet_kernels.ROW))), len(cells._spare_rows)
    array("spare packets", cells._spare_rows, np.float64, (None, packet_kernels.ROW))
    moves = len(array("moves", cells._moves, np.float64, (None, 4)))
    array("yaws", cells._yaws, np.float64, (moves,))
    ids = array("ids", cells._ids, np.int64, (k,))
    array("spare ids", cells._spare_ids, np.int64, (spare,))
    found = whole("the number of packets", cells._found, 1, min(k, moves, cells._n))
    within("owner", cells._owner[: cells._n], 0, found - 1)
    within("ids", ids[:found], 1, np.iinfo(np.int32).max)
    rows = cells._rows[:found]
    for axis in range(3):
        within("a packet's place", rows[:, axis], 0.0, cells.shape[2 - axis])
    within("a packet's mass", rows[:, packet_kernels.MASS], 0.0, MOST_ACTIVITY)
    within("a packet's headings", rows[:, [packet_kernels.COS, packet_kernels.SIN]], -1.001, 1.001)
    within("a packet's carry", rows[:, packet_kernels.CARRY :], -float(max(cells.shape)), float(max(cells.shape)))
