"""Which views, by their links to the pose cells, made the packet that won a snap. ACRA 2004 5.2, ACRA 2005 3.4."""

from __future__ import annotations

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from ratslam_core import Packet
from web.messages import SnapCause

TICKS = 600  # how far back it is looked for, a minute at 10 Hz
NEAR_CELLS, NEAR_LAYERS = 3.0, 3.0  # what is injected nearer to a packet than this feeds it
MOST = 8  # causes that are told

_Entry = tuple[float, dict[int, Packet], "tuple[int, NDArray[np.int32], NDArray[np.float32]] | None"]


class SnapCauses:
    """Call `watch` after each tick. It keeps references to what was injected, and computes nothing before a snap."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._ticks: deque[_Entry] = deque(maxlen=TICKS)
        self.since_s = session.time_s  # when the first of the causes told last put activity there

    def watch(self) -> None:
        brain = self._session.brain
        injection = brain.association.injection
        injected = None if injection is None else (injection.view, injection.cells, injection.values)
        self._ticks.append((self._session.time_s, {packet.id: packet for packet in brain.pose_cells.packets}, injected))

    def of(self, winner: Packet) -> tuple[SnapCause, ...]:
        """The views that injected around this packet since it came into being, those that injected most first.

        A packet moves as the robot drives. So each injection is compared with where the packet was in its tick.
        """
        amounts: dict[int, float] = {}
        looks: dict[int, int] = {}
        at, self.since_s = winner, self._session.time_s
        for time_s, packets, injected in reversed(self._ticks):
            then = packets.get(winner.id)
            if then is None or self._apart(then, at) > NEAR_CELLS:
                break
            at = then
            if injected is None:
                continue
            view, cells, values = injected
            amount = float(values[self._near(cells, at)].sum(dtype=np.float64))
            if amount > 0:
                amounts[view] = amounts.get(view, 0.0) + amount
                looks[view] = looks.get(view, 0) + 1
                self.since_s = time_s
        whole = sum(amounts.values())
        most = sorted(amounts, key=lambda view: -amounts[view])[:MOST]
        return tuple(self._cause(view, looks[view], amounts[view], amounts[view] / whole, winner) for view in most)

    def _cause(self, view: int, looks: int, amount: float, share: float, winner: Packet) -> SnapCause:
        association = self._session.brain.association
        cells, strength = association.links.of(view)
        there = strength[self._near(cells, winner)]
        return SnapCause(
            view, looks, amount, share, len(there), float(there.max(initial=0.0)), association.age_s(view)
        )  # fmt: skip

    def _apart(self, a: Packet, b: Packet) -> float:
        return self._session.brain.pose_cells.cells_apart(a.x, a.y, b.x, b.y)

    def _near(self, cells: NDArray[np.int32], packet: Packet) -> NDArray[np.bool_]:
        """Which of these cells (flat indices) are near a packet, round the network's edges."""
        n_theta, n_y, n_x = self._session.brain.pose_cells.shape
        theta, y, x = np.unravel_index(cells, (n_theta, n_y, n_x))
        across, up = _gap(x, packet.x, n_x), _gap(y, packet.y, n_y)
        turned = _gap(theta, packet.heading_rad * n_theta / math.tau, n_theta)
        return (across**2 + up**2 <= NEAR_CELLS**2) & (turned <= NEAR_LAYERS)


def _gap(cells: NDArray[np.integer], at: float, size: int) -> NDArray[np.float64]:
    away = np.abs(cells - at) % size
    return np.minimum(away, size - away)


def words_of(causes: tuple[SnapCause, ...]) -> str:
    """The causes in a few words."""
    if not causes:
        return "no view put activity there"
    first, more = causes[0], len(causes) - 1
    looks = "1 look" if first.looks == 1 else f"{first.looks} looks"
    others = f" and {more} more" if more else ""
    about = f"{looks}, {first.share:.2f} of the injected activity, learnt {first.age_s:.0f} s before"
    return f"by view {first.view} ({about}){others}"
