"""RatSLAM as the papers print it, slow and literal: dense arrays, lists and dictionaries, and nothing that is ours.

Equations: A = ACRA 2004, B = ACRA 2005, D = ACRA 2006. Nothing of ratslam_core is used but its parameters.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ratslam_core import RatSlamParams

Array = NDArray[np.float64]
THRESHOLD = 6.0  # grey levels
WINDOW = 6  # cells


@dataclass
class Transition:
    start: int
    end: int
    behaviour: int
    move: tuple[float, float, float]  # dx, dy in the frame of its start, change of facing: D eq. 5
    time_s: float
    passages: int = 1
    trials: int = 0
    arrivals: int = 0
    deleted: bool = False


@dataclass
class PaperTwin:
    """One step: association, calibration, path integration, attractor (A 4), then experience and correction (D 3)."""

    p: RatSlamParams
    views: list[Array] = field(default_factory=list)
    experiences: list[tuple[float, float, float, int]] = field(default_factory=list)  # x', y', theta', V
    poses: list[list[float]] = field(default_factory=list)
    transitions: list[Transition] = field(default_factory=list)
    active: int = -1

    def __post_init__(self) -> None:
        c = self.p.pose_cells
        self.P = np.zeros((c.n_theta, c.n_y, c.n_x))
        self.P[0, c.n_y // 2, c.n_x // 2] = 1.0
        self.beta: list[Array] = []
        self.since = (0.0, 0.0, 0.0)  # odometry since the active experience was entered
        self.since_s = 0.0

    def step(self, image: NDArray[np.uint8], speed: float, yaw_rate: float, dt: float, behaviour: int) -> int:
        """One step; returns the active view. image: (8, 12)."""
        view = self._recognise(image.astype(float))
        self.beta[view] = (1 - self.p.local_view.decay) * self.beta[
            view
        ] + self.p.local_view.learning_rate * self.P  # A2-3
        self.P = self.P + np.minimum(self.beta[view], self.p.local_view.saturation)  # A4
        self.P = self._shifted(speed * dt / self.p.pose_cells.cell_m, yaw_rate * dt)
        self.P = self._attracted()
        self._experience(view, speed * dt, yaw_rate * dt, dt, behaviour)
        self._correct()
        return view

    # ------------------------------------------------------------ views, D 7

    def _recognise(self, image: Array) -> int:
        apart = [self._difference(image, known) for known in self.views]
        if apart and min(apart) <= THRESHOLD * self.p.local_view.match_threshold:
            return int(np.argmin(apart))
        self.views.append(image)
        self.beta.append(np.zeros_like(self.P))
        return len(self.views) - 1

    def _difference(self, new: Array, known: Array) -> float:
        """The least mean absolute difference over all shifts by columns."""
        most, width = self.p.local_view.shift, new.shape[1]
        pairs = [
            (new[:, max(s, 0) : width + min(s, 0)], known[:, max(-s, 0) : width + min(-s, 0)])
            for s in range(-most, most + 1)
        ]
        return min(float(np.abs(a - b).mean()) for a, b in pairs)

    # ------------------------------------------------------------ pose cells, A 4

    def _shifted(self, along: float, turn: float) -> Array:
        """A5-9: each layer moves along its own heading and is divided over the 2 x 2 x 2 cells where it comes to lie."""
        n_theta = len(self.P)
        unit = 2 * math.pi / n_theta
        result = np.zeros_like(self.P)
        for t in range(n_theta):
            dx, dy, dt = along * math.cos(t * unit), along * math.sin(t * unit), turn / unit
            wx, wy, wt = math.floor(dx), math.floor(dy), math.floor(dt)
            for a, ax in ((0, 1 - (dx - wx)), (1, dx - wx)):
                for b, by in ((0, 1 - (dy - wy)), (1, dy - wy)):
                    for c, ct in ((0, 1 - (dt - wt)), (1, dt - wt)):
                        moved = np.roll(self.P[t], (wy + b, wx + a), axis=(0, 1))
                        result[(t + wt + c) % n_theta] += ax * by * ct * moved
        return result

    def _attracted(self) -> Array:
        """A10: excitation by a Gaussian; A11: global inhibition; A12: normalisation."""
        c = self.p.pose_cells
        most = max(2, math.ceil(3 * c.excite_sigma))
        reach = np.arange(-most, most + 1)
        weights = np.exp(-0.5 * (reach / c.excite_sigma) ** 2)
        weights /= weights.sum()
        P = self.P
        for axis in range(3):
            P = sum(w * np.roll(P, k, axis=axis) for k, w in zip(reach, weights, strict=True))
        P = np.maximum(P - c.inhibit, 0)
        return P / P.sum()

    def winner(self) -> tuple[float, float, float, float]:
        """x', y', theta' and mass of the heaviest packet, read off its centre.

        Repeatedly, the strongest free cell and all free cells within WINDOW of it form a packet. If that cell has a
        stronger neighbour in another packet, it is a flank of that packet.
        """
        size, owner, peaks = np.array(self.P.shape), np.full(self.P.shape, -1), []
        cells = [tuple(cell) for cell in np.argwhere(self.P > 0)]
        cells.sort(key=lambda cell: -self.P[cell])
        for cell in cells:
            if owner[cell] < 0:
                gaps = (np.array(cells) - np.array(cell) + size // 2) % size - size // 2
                for other, gap in zip(cells, gaps, strict=True):
                    if owner[other] < 0 and np.all(np.abs(gap) <= np.minimum(WINDOW, (size - 1) // 2)):
                        owner[other] = len(peaks)
                peaks.append(cell)
        root = list(range(len(peaks)))
        for k, peak in enumerate(peaks):
            near = [tuple((np.array(peak) + d) % size) for d in np.ndindex(3, 3, 3) for d in [np.array(d) - 1]]
            strongest = max(near, key=lambda cell: self.P[cell])
            if k and self.P[strongest] > self.P[peak]:
                root[k] = root[owner[strongest]]
        mass = {r: sum(self.P[cell] for cell in cells if root[owner[cell]] == r) for r in set(root)}
        best = max(mass, key=lambda r: mass[r])
        own = [cell for cell in cells if root[owner[cell]] == best]
        gaps = (np.array(own) - np.array(peaks[best]) + size / 2) % size - size / 2
        weights = np.array([self.P[cell] for cell in own])
        theta, y, x = (np.array(peaks[best]) + weights @ gaps / weights.sum()) % size
        return float(x), float(y), float(theta), mass[best]

    # ------------------------------------------------------------ experiences, D 3.1 and B 4.1

    def _energy(self, i: int, x: float, y: float, theta: float, view: int) -> float:
        m, (n_theta, n_y, n_x) = self.p.experience_map, self.P.shape
        own_x, own_y, own_theta, own_view = self.experiences[i]
        r = math.hypot(math.remainder(x - own_x, n_x), math.remainder(y - own_y, n_y)) / m.zone_xy  # D2
        q = abs(math.remainder(theta - own_theta, n_theta)) / m.zone_theta  # D3
        if view != own_view:
            return 0.0
        return 0.0 if r > 1 or q > 1 else 2 - r - q  # D1, D4

    def _experience(self, view: int, way: float, turn: float, dt: float, behaviour: int) -> None:
        x, y, theta, _ = self.winner()
        if self.active < 0:
            self._make(x, y, theta, view, [0.0, 0.0, 0.0])
            return
        self.since = _compose(self.since, (way * math.cos(turn / 2), way * math.sin(turn / 2), turn))
        self.since_s += dt
        energies = [self._energy(i, x, y, theta, view) for i in range(len(self.experiences))]
        before, best = self.active, int(np.argmax(energies))
        if energies[best] <= self.p.experience_map.threshold:
            self._make(x, y, theta, view, list(_compose(tuple(self.poses[before]), self.since)))
        elif best == before:
            return
        else:
            self.active = best
        self._learn(before, behaviour)
        self.since, self.since_s = (0.0, 0.0, 0.0), 0.0

    def _make(self, x: float, y: float, theta: float, view: int, pose: list[float]) -> None:
        self.experiences.append((x, y, theta, view))
        self.poses.append(pose)
        self.active = len(self.poses) - 1

    @property
    def robot(self) -> tuple[float, float, float]:
        return _compose(tuple(self.poses[self.active]), self.since)

    # ------------------------------------------------------------ transitions, D 3.2 and 3.4

    def _learn(self, before: int, behaviour: int) -> None:
        found = [t for t in self.transitions if (t.start, t.end) == (before, self.active) and not t.deleted]
        if found:
            link = found[0]
            share = 1 / (link.passages + 1)  # D6: the running mean
            turn = _wrapped(self.since[2] - link.move[2])
            link.move = (
                link.move[0] + share * (self.since[0] - link.move[0]),
                link.move[1] + share * (self.since[1] - link.move[1]),
                _wrapped(link.move[2] + share * turn),
            )
            link.time_s += share * (self.since_s - link.time_s)
            link.passages += 1
        else:
            link = Transition(before, self.active, behaviour, self.since, self.since_s)
            self.transitions.append(link)
        departures = [t for t in self.transitions if t.start == before and t.behaviour == behaviour and not t.deleted]
        for tried in departures:  # D9
            tried.trials += 1
            tried.arrivals += tried is link
            m = self.p.experience_map
            if tried.trials >= m.link_trials and tried.arrivals / tried.trials < m.link_confidence:
                tried.deleted = True

    # ------------------------------------------------------------ map correction, B 12-14 and D 3.3

    def _correct(self) -> None:
        """Link by link: each moves one end by alpha times its residual. Bearings use the headings from before the sweep."""
        alpha = self.p.experience_map.correction
        for _ in range(self.p.experience_map.sweeps):
            facing = [pose[2] for pose in self.poses]
            for i in range(1, len(self.poses)):
                for t in self.transitions:
                    if t.deleted or i not in (t.start, t.end):
                        continue
                    c, s = math.cos(facing[t.start]), math.sin(facing[t.start])
                    dx, dy = c * t.move[0] - s * t.move[1], s * t.move[0] + c * t.move[1]
                    j, sign = (t.start, 1) if i == t.end else (t.end, -1)
                    me, other = self.poses[i], self.poses[j]
                    me[0] += alpha * (other[0] + sign * dx - me[0])
                    me[1] += alpha * (other[1] + sign * dy - me[1])
                    me[2] = _wrapped(me[2] + alpha * _wrapped(other[2] + sign * t.move[2] - me[2]))


def _wrapped(angle: float) -> float:
    return math.remainder(angle, 2 * math.pi)


def _compose(a: tuple[float, ...], b: tuple[float, float, float]) -> tuple[float, float, float]:
    c, s = math.cos(a[2]), math.sin(a[2])
    return a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], _wrapped(a[2] + b[2])
