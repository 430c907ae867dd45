"""The engine's speed. Each part is timed beside a reference in the same run: `ratslam bench [--json FILE]`.

Rows: work, size, ms, reference, reference_ms, bar, holds. Times are medians over repetitions on this machine.
"""

# SciPy tells no types; what is measured is set up from within.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownMemberType=false
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false, reportPrivateUsage=false

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
from scipy.ndimage import convolve1d
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from ratslam_core import (
    ExperienceMap,
    ExperienceMapParams,
    LocalView,
    LocalViewParams,
    Odometry,
    Packet,
    PoseCellParams,
    PoseCells,
    RatSlam,
    Recognition,
    ViewLinks,
)
from ratslam_core.experience_map.experience_map import Senses
from ratslam_core.pose_cells.attractor_kernels import gaussian

Row = dict[str, Any]
SEEN = Recognition(0, False, 0, 2.0)
QUICK = 100  # how many times smaller things are in a quick run


def rows(quick: bool = False) -> Iterator[Row]:
    """The rows, each as soon as it has been measured. quick: of a hundredth of the size, to see that all of it works."""
    part = QUICK if quick else 1
    yield from _pose_cells((21, 61) if quick else (21, 61, 150, 540))
    yield from _memory()
    yield from _views(50_000 // part)
    yield _hebbian()
    yield from _map(50_000 // part, 60_000 // part)
    for views, bar in ((5_000, 0.5), (50_000, 1.5)):
        yield whole_step(views // part, bar)
    yield _start(1 if quick else 3)


def _pose_cells(sizes: tuple[int, ...]) -> Iterator[Row]:
    flat = None
    for n in sizes:
        cells = _settled(n, packets=1)
        ms = _median(lambda c=cells: c.step(speed=0.3, yaw_rate=0.1, dt=0.1), 400)
        flat = flat or ms
        reference = _dense(n, 1 if n > 150 else 5)
        holds = ms <= 0.1 and ms <= 1.5 * flat and (n != 150 or reference >= 50 * ms)
        yield _row(
            "pose-cell iteration, one packet",
            f"{n} x {n} x 36",
            ms,
            "SciPy dense convolution",
            reference,
            "0.1 ms, flat",
            holds,
        )
    one, ten = _settled(150, packets=1), _settled(150, packets=10)
    one_ms = _median(lambda: one.step(speed=0.3, yaw_rate=0.1, dt=0.1), 300)
    ten_ms = _ten_packets(ten)
    yield _row(
        "pose-cell iteration, ten packets", "150 x 150 x 36", ten_ms, "one packet", one_ms, "10 times one packet",
        ten_ms <= 10 * one_ms,
    )  # fmt: skip


def _memory() -> Iterator[Row]:
    """The memory of a network that has driven. The bytes are in the column size, since they are not a time."""
    n = 540
    bytes_a_cell = _settled(n, packets=1).memory_bytes / (n * n * 36)
    size = f"{n} x {n} x 36: {bytes_a_cell:.2f} B a cell"
    yield _row("memory, pose cells", size, None, "-", None, "6 B a cell", bytes_a_cell <= 6)
    view = LocalView(LocalViewParams(match_threshold=0.0, surprise=100.0))
    rng, most = np.random.default_rng(6), 0.0
    for count in range(1, 50_001):  # with as little room to spare as a growing memory has, and as much
        view._recruit(rng.integers(0, 256, view.features.size, dtype=np.uint8), faded=-1)
        most = max(most, view.memory_bytes / count) if count >= 2000 else 0.0
    yield _row("memory, views", f"2,000 to 50,000: {most:.0f} B a view", None, "-", None, "250 B a view", most <= 250)


def _settled(n: int, packets: int) -> PoseCells:
    cells = PoseCells(PoseCellParams(n_x=n, n_y=n))
    for _ in range(20):
        cells.step(speed=0.3, yaw_rate=0.1, dt=0.1)
    if packets > 1:
        rows, values = cells.active[0].copy(), cells.active[1].copy()
        for k in range(1, packets):
            y, x = (rows[:, 1] + 30 * (k % 5)) % n, (rows[:, 0] + 60 * (k // 5) + 20) % n
            cells.inject(((rows[:, 2] * n + y) * n + x).astype(np.int32), values)
        cells.attract()
    return cells


def _ten_packets(cells: PoseCells) -> float:
    """Median time of an iteration with ten packets; all are put back each time, since one wins in the long run."""
    rows, values = cells.active[0].copy(), cells.active[1].copy()
    times: list[float] = []
    for _ in range(100):
        now, _ = cells.active
        gone = ~np.isin(rows[:, 3], now[:, 3])
        cells.inject(rows[gone, 3].astype(np.int32), values[gone])
        began = time.perf_counter()
        cells.step(speed=0.0, yaw_rate=0.0, dt=0.1)
        times.append(time.perf_counter() - began)
    assert len(cells.packets) >= 8
    return 1e3 * statistics.median(times)


def _dense(n: int, repetitions: int) -> float:
    activity = np.random.default_rng(0).random((36, n, n), dtype=np.float32)
    weights = gaussian(0.5)

    def convolve() -> None:
        out = activity
        for axis in range(3):
            out = convolve1d(out, weights, axis=axis, mode="wrap")

    return _median(convolve, repetitions)


def _views(views: int) -> Iterator[Row]:
    rng = np.random.default_rng(1)
    known = rng.integers(0, 256, (views, 96), dtype=np.uint8)
    image = rng.integers(0, 256, (8, 12), dtype=np.uint8)
    flat = np.ascontiguousarray(image.T).reshape(1, -1)
    bare = _median(lambda: cv2.batchDistance(flat, known, cv2.CV_32S, normType=cv2.NORM_L1, K=1), 40)
    for shift, most in ((0, 1.5), (2, 5.0)):
        view = LocalView(LocalViewParams(front_end="template", shift=shift, match_threshold=100.0, surprise=100.0))
        view._templates, view._count = known.copy(), len(known)
        ms = _median(lambda v=view: v.observe(image), 40)
        name = f"view match 12 x 8, shifts +-{shift}"
        yield _row(name, f"{views:,} views", ms, "bare batchDistance", bare, f"{most:g} times", ms <= most * bare)


def _hebbian() -> Row:
    cells = PoseCells()
    links = ViewLinks()
    rng = np.random.default_rng(2)
    linked = rng.choice(64 * 64 * 36, 3000, replace=False).astype(np.int32)
    rows = np.zeros((3000, 4), np.int32)
    rows[:, 3] = linked
    slot = np.zeros(64 * 64 * 36, np.int32)
    slot[linked] = np.arange(1, 3001)
    links.learn(0, rows, np.full(3000, 1 / 3000, np.float32), slot)
    active, activity = cells.active

    def both() -> None:
        links.recall(0)
        links.learn(0, active, activity, cells.slot)

    dense = np.zeros(64 * 64 * 36, np.float32)
    reference = _median(lambda: np.add(dense, np.float32(0.15) * cells.activity.ravel(), out=dense), 100)
    ms = _median(both, 400)
    return _row(
        "Hebbian recall and learning", "3,000 linked cells", ms, "NumPy, dense", reference, "0.05 ms", ms <= 0.05
    )


def _map(experiences: int, links: int) -> Iterator[Row]:
    made = _long_map(experiences, links)
    ms = _median(made.correct, 15)
    yield _row("map correction, one sweep", f"{experiences:,} experiences", ms, "-", None, "1.0 ms", ms <= 1.0)
    rng = np.random.default_rng(5)
    made.temporal_map.times_to(7)
    i, j = made.links.T
    ready = csr_matrix((made.link_times, (i, j)), (experiences, experiences))
    ready = ready.maximum(ready.T).tocsr()
    reference = _median(lambda: dijkstra(ready, indices=7), 5)
    ms = _median(lambda: _linked_and_asked(made, rng), 9)
    yield _row(
        "times from one place to all",
        f"{experiences:,} experiences",
        ms,
        "SciPy's Dijkstra, ready matrix",
        reference,
        "1.5 times",
        ms <= 1.5 * reference,
    )
    packet = Packet(10.0, 10.0, 0.0, 1.0)
    ms = _median(lambda: made._seen_experience(packet, Recognition(17, False, 17, 2.0), Senses()), 400)
    yield _row("choosing the experience", f"{experiences:,} experiences", ms, "-", None, "0.05 ms", ms <= 0.05)


def _linked_and_asked(made: ExperienceMap, rng: np.random.Generator) -> None:
    """A loop is closed, then the times are asked for. They are updated, not computed anew."""
    _close(made, rng, Odometry(0.3, 0.05, 0.1))
    made.temporal_map.times_to(7)


def _close(made: ExperienceMap, rng: np.random.Generator, odometry: Odometry) -> None:
    """A closure between two of its experiences, chosen at random."""
    before, (a, b) = len(made), (int(v) for v in rng.integers(0, len(made), 2))
    x, y, _theta, view = made.cell_state(b)
    made.here = a
    made.step(Packet(x, y, 0.0, 1.0), Recognition(view, False, view, 2.0), odometry)
    if len(made) > before:
        raise AssertionError(f"a look from {a} to {b} made a new experience where a loop was to be closed")


def _long_map(experiences: int, links: int) -> ExperienceMap:
    """A map of so many experiences from a random walk, with closures between random pairs."""
    rng = np.random.default_rng(3)
    believing = ExperienceMapParams(submaps=False)  # or closures of places far away would be new places
    made = ExperienceMap((36, 64, 64), 0.25, believing)
    odometry = Odometry(0.3, 0.05, 0.1)
    for k in range(experiences):
        made.step(
            Packet(float(rng.uniform(0, 64)), float(rng.uniform(0, 64)), 0.0, 1.0),
            Recognition(k, True, -1, 0.0),
            odometry,
        )
    while made.link_count < links:
        _close(made, rng, odometry)
    made.params = replace(made.params, solve_every=0)
    return made


def whole_step(views: int, bar: float) -> Row:
    """A brain that knows so many views and experiences and drives along a known way."""
    rng = np.random.default_rng(4)
    brain = RatSlam()
    made = _long_map(views, views + views // 5)
    brain.experience_map = made
    brain.local_view._templates = rng.integers(0, 256, (views + 4096, brain.local_view.features.size), dtype=np.uint8)
    brain.local_view._count = views
    brain.association._learnt_s = [0.0] * views
    images = rng.integers(0, 256, (50, 48, 64), dtype=np.uint8)
    number = iter(range(10**9))
    ms = _median(lambda: brain.step(images[next(number) % 50], Odometry(0.3, 0.1, 0.1)), 200)
    return _row("whole RatSlam.step", f"{views:,} views and experiences", ms, "-", None, f"{bar:g} ms", ms <= bar)


def _start(repetitions: int) -> Row:
    code = (
        "import numpy as np; from ratslam_core import RatSlam, Odometry; "
        "RatSlam().step(np.zeros((48, 64), np.uint8), Odometry(0.1, 0.0, 0.1))"
    )
    with tempfile.TemporaryDirectory() as bytecode:  # as any installation keeps it
        warm = {**os.environ, "PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": bytecode}

        def start(code: str) -> float:
            return _median(lambda: subprocess.run([sys.executable, "-c", code], check=True, env=warm), repetitions)

        ms, bare = start(code), start("import numpy, numba, cv2")
    return _row("import and first step, warm cache", "-", ms, "its libraries alone", bare, "1500 ms", ms <= 1500)


def _median(work: Callable[[], object], repetitions: int) -> float:
    """Milliseconds, after one call to warm up."""
    work()
    times: list[float] = []
    for _ in range(repetitions):
        began = time.perf_counter()
        work()
        times.append(time.perf_counter() - began)
    return 1e3 * statistics.median(times)


def _row(
    work: str, size: str, ms: float | None, reference: str, reference_ms: float | None, bar: str, holds: bool
) -> Row:
    return {
        "work": work,
        "size": size,
        "ms": None if ms is None else round(ms, 4),
        "reference": reference,
        "reference_ms": None if reference_ms is None else round(reference_ms, 4),
        "bar": bar,
        "holds": bool(holds),
    }


def line(row: Row) -> str:
    """One row of the table."""
    beside = "" if row["reference_ms"] is None else f"{row['reference_ms']:10.3f} ms  {row['reference']}"
    verdict = "holds" if row["holds"] else "MISSED"
    took = " " * 13 if row["ms"] is None else f"{row['ms']:10.3f} ms"
    return f"{row['work']:34} {row['size']:28} {took}  bar {row['bar']:20} {verdict:7} {beside}"
