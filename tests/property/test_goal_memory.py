"""The goal memory against literal loops of its equations, on random activity on small tori."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import GoalMemory, GoalMemoryParams

Iteration = list[tuple[int, int, int, float]]  # x, y, theta, activity


class LiteralMemory:
    """C1-C6 with dictionaries and loops, nothing else."""

    def __init__(self, params: GoalMemoryParams, n_y: int, n_x: int) -> None:
        self.p, self.n_y, self.n_x = params, n_y, n_x
        self.tau: dict[tuple[int, int], float] = {}
        self.before: tuple[dict[int, float], float] | None = None

    def learn(self, active: Iteration, time_s: float) -> None:
        G: dict[int, float] = {}
        for x, y, _, activity in active:
            G[y * self.n_x + x] = G.get(y * self.n_x + x, 0.0) + float(np.float32(activity))
        G = {cell: g for cell, g in G.items() if g > self.p.share * max(G.values())}
        if self.before is not None:
            G_before, time_before = self.before
            most = max(*G.values(), *G_before.values(), 0.0)
            for i, G_i in G_before.items():
                for j, G_j in G.items():
                    if i != j:
                        sigma = self.p.time_weight * (time_s - time_before)
                        mu = self.p.activity_weight * (1 - G_i * G_j / most**2)
                        self._link(i, j, sigma + mu + self.p.distance_weight * self._apart(i, j))
        self.before = G, time_s

    def _link(self, i: int, j: int, new: float) -> None:
        pair = min(i, j), max(i, j)
        old = self.tau.get(pair, math.inf)
        self.tau[pair] = new if math.isinf(old) else (1 - self.p.rate) * old + self.p.rate * new

    def _apart(self, i: int, j: int) -> float:
        dx = abs(i % self.n_x - j % self.n_x)
        dy = abs(i // self.n_x - j // self.n_x)
        return math.hypot(min(dx, self.n_x - dx), min(dy, self.n_y - dy))

    def times_to(self, goal: int) -> list[float]:
        T = [math.inf] * (self.n_y * self.n_x)
        T[goal] = 0.0
        decreasing = True
        while decreasing:
            decreasing = False
            for (i, j), tau in self.tau.items():
                for a, b in ((i, j), (j, i)):
                    if T[b] + tau < T[a]:
                        T[a], decreasing = T[b] + tau, True
        return T


@st.composite
def histories(draw: st.DrawFn) -> tuple[int, int, list[tuple[float, Iteration]]]:
    n_y, n_x = draw(st.integers(1, 12)), draw(st.integers(1, 12))
    cell = st.tuples(
        st.integers(0, n_x - 1), st.integers(0, n_y - 1), st.integers(0, 2), st.floats(2**-6, 1.0, width=32)
    )
    active = st.lists(cell, min_size=1, max_size=25, unique_by=lambda c: c[:3])
    return n_y, n_x, draw(st.lists(st.tuples(st.floats(0.01, 5.0), active), min_size=1, max_size=8))


weights = st.sampled_from([0.0, 0.1, 0.25, 1.0])


@settings(max_examples=100)
@given(histories(), weights, weights, weights, st.sampled_from([0.05, 0.2, 1.0]), st.sampled_from([0.05, 0.5, 0.9]))
@pytest.mark.slow
def test_it_is_the_equations(
    history: tuple[int, int, list[tuple[float, Iteration]]],
    time: float,
    product: float,
    distance: float,
    rate: float,
    share: float,
) -> None:
    n_y, n_x, iterations = history
    params = GoalMemoryParams(
        time_weight=time, activity_weight=product, distance_weight=distance, rate=rate, share=share, stride_m=0.0
    )
    memory, slow = GoalMemory(params, (3, n_y, n_x), 0.25), LiteralMemory(params, n_y, n_x)
    time_s = 0.0
    for elapsed, active in iterations:
        time_s += elapsed
        cells = np.array([(x, y, t, (t * n_y + y) * n_x + x) for x, y, t, _ in active], np.int32)
        memory.learn(cells, np.array([a for *_, a in active], np.float32), time_s)
        slow.learn(active, time_s)
    pairs, tau = memory.links
    got = dict(zip(map(tuple, pairs.tolist()), tau.tolist(), strict=True))
    assert len(memory) == len(got)
    assert got == pytest.approx(slow.tau, rel=1e-5, abs=1e-6)

    goal = int(pairs[0, 0]) if len(pairs) else 0
    T = memory.times_to(goal % n_x, goal // n_x)
    assert T.shape == (n_y, n_x)
    assert T.ravel() == pytest.approx(slow.times_to(goal), rel=1e-4, abs=1e-5)
    T = T.ravel()
    for i in np.flatnonzero(np.isfinite(T) & (T > 0)):  # no local minima: some linked cell is nearer in time
        beside = [j if a == i else a for a, j in got if i in (a, j)]
        assert min(T[j] for j in beside) <= T[i]
        assert T[i] == pytest.approx(min(T[j] + got[min(i, j), max(i, j)] for j in beside), rel=1e-6, abs=1e-9)


@settings(max_examples=4)
@given(st.integers(40, 80), st.integers(0, 2**32 - 1))
@pytest.mark.slow
def test_growing_keeps_what_was_learnt(count: int, seed: int) -> None:
    """Tables grow several times over a few thousand links."""
    rng = np.random.default_rng(seed)
    params = GoalMemoryParams(stride_m=0.0, share=0.05)
    memory, slow = GoalMemory(params, (1, 40, 40), 0.25), LiteralMemory(params, 40, 40)
    before = memory.memory_bytes
    for k in range(4):
        flats = rng.choice(1600, count, replace=False)
        values = rng.uniform(0.5, 1.0, count).astype(np.float32)
        active = [(int(f % 40), int(f // 40), 0, float(v)) for f, v in zip(flats, values, strict=True)]
        memory.learn(np.array([(x, y, 0, y * 40 + x) for x, y, *_ in active], np.int32), values, k + 1.0)
        slow.learn(active, k + 1.0)
    pairs, tau = memory.links
    got = dict(zip(map(tuple, pairs.tolist()), tau.tolist(), strict=True))
    assert got == pytest.approx(slow.tau, rel=1e-5)
    assert memory.memory_bytes > before
