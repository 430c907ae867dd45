"""What keeping a run costs, in shares of a tick: `python -m benchmarks.keeping [world] [ticks] [rounds]`.

Blocks of ticks of two equal sessions take turns, one of them kept, so that both see the same load of the machine. Computing
time is counted, not that on the clock: of the thread that runs the ticks, and apart from it of those that write and hash.
"""

from __future__ import annotations

import os
import statistics
import sys
import tempfile
import time

from app.run_record.folder import LINES, all_runs
from app.run_record.header import beginning_of
from app.run_record.writer import RunKeeper
from app.session import Session
from disk import copy_state
from sim2d import load_world

BLOCK = 200  # ticks


def main(world: str = "office", ticks: int = 6000, rounds: int = 5) -> None:
    shares, besides = list[float](), list[float]()
    for number in range(-1, rounds):  # the first is not counted: it compiles
        with tempfile.TemporaryDirectory() as folder:
            os.environ["RATSLAM_RUNS"] = folder
            plain_s, kept_s, others_s = one_round(world, ticks)
            size = (all_runs()[0] / LINES).stat().st_size
        if number < 0:
            continue
        shares.append(100 * (kept_s / plain_s - 1))
        besides.append(100 * others_s / plain_s)
        n = ticks - BLOCK
        print(f"{world}, round {number + 1}: {1e3 * plain_s / n:.3f} ms a tick, kept {1e3 * kept_s / n:.3f} ms: "
              f"{shares[-1]:+.1f} %, and {besides[-1]:.1f} % in other threads; {size / 1e3:.0f} kB on disk, "
              f"{size / 1e3 * 36_000 / ticks:.0f} kB an hour", flush=True)  # fmt: skip
    print(f"{statistics.median(shares):+.1f} % in the median ({min(shares):+.1f} to {max(shares):+.1f}), and "
          f"{statistics.median(besides):.1f} % in other threads ({min(besides):.1f} to {max(besides):.1f})")  # fmt: skip


def one_round(world: str, ticks: int) -> tuple[float, float, float]:
    """Computing time of the plain ticks, of the kept ones, and of the keeper's threads, in seconds."""
    plain, kept = Session(load_world(world), 1), Session(load_world(world), 1)
    for session in (
        plain,
        kept,
    ):  # reading an object's attributes slows it for good; keyframes do so in every dashboard
        copy_state(session)
    keeper = RunKeeper(print)
    keeper.start()
    feed = keeper.feed(kept, beginning_of(kept))
    kept.on_order = feed.order
    keeper.begin(feed)
    cost = {False: 0.0, True: 0.0}
    others_s = 0.0
    for block in range(ticks // BLOCK):
        for keeps in (True, False) if block % 2 else (False, True):
            began, all_began = time.thread_time(), time.process_time()
            for _ in range(BLOCK):
                (kept if keeps else plain).tick()
                if keeps:
                    feed.tick(kept)
            if block > 0:  # the first compiles
                spent_s = time.thread_time() - began
                cost[keeps] += spent_s
                others_s += time.process_time() - all_began - spent_s
    keeper.stop()
    return cost[False], cost[True], others_s


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "office", *(int(word) for word in sys.argv[2:4]))
