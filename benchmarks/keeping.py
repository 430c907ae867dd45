"""What keeping a run costs, in shares of a tick: `python -m benchmarks.keeping [world] [ticks]`.

Blocks of ticks of two equal sessions take turns, one of them kept, so that both see the same load of the machine.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time

from app.runs.folder import LINES, all_runs
from app.runs.header import beginning_of
from app.runs.keeper import RunKeeper
from app.session import Session
from sim2d import load_world

BLOCK = 200  # ticks


def main(world: str = "office", ticks: int = 12_000) -> None:
    with tempfile.TemporaryDirectory() as folder:
        os.environ["RATSLAM_RUNS"] = folder
        plain, kept = Session(load_world(world), 1), Session(load_world(world), 1)
        keeper = RunKeeper(print)
        keeper.start()
        book = keeper.book(kept, beginning_of(kept))
        kept.on_order = book.order
        keeper.begin(book)
        cost = {False: 0.0, True: 0.0}
        for block in range(ticks // BLOCK):
            for keeps in (True, False) if block % 2 else (False, True):
                began = time.thread_time()
                for _ in range(BLOCK):
                    (kept if keeps else plain).tick()
                    if keeps:
                        book.tick(kept)
                if block > 0:  # the first compiles
                    cost[keeps] += time.thread_time() - began
        keeper.stop()
        size = (all_runs()[0] / LINES).stat().st_size
        n = ticks - BLOCK
        print(f"{world}, {ticks} ticks: {1e3 * cost[False] / n:.3f} ms a tick, kept {1e3 * cost[True] / n:.3f} ms: "
              f"{100 * (cost[True] / cost[False] - 1):+.1f} %; {size / 1e3:.0f} kB on disk, "
              f"{size / 1e3 * 36_000 / ticks:.0f} kB an hour")  # fmt: skip


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "office", int(sys.argv[2]) if len(sys.argv) > 2 else 6000)
