"""A branch of a run on the disk: a run of its own, with the other's past up to where it left it."""

from __future__ import annotations

import shutil
import time
from dataclasses import replace
from pathlib import Path

from app.runs.folder import BRAIN
from app.runs.header import written
from app.runs.journal import Journal
from app.runs.line_book import LineBook
from app.runs.run_file import KeptRun, open_run


def copy_until(run: KeptRun, tick: int, folder: Path) -> KeptRun:
    """Write the run up to the end of this tick, without the orders given then, into a new folder.

    ValueError: it is not known so far. OSError: the disk does not take it.
    """
    if not 0 <= tick <= run.last_tick:
        raise ValueError(f"the run {run.name} is known up to tick {run.last_tick}, not {tick}")
    journal = Journal(folder)
    try:
        journal.add(written(replace(run.header, made_at=time.time())))
        lines = LineBook(journal, run.header.world, 0)
        orders = [order for order in run.orders if order.tick < tick][::-1]
        for done in range(tick):
            while orders and orders[-1].tick == done:
                lines.order(orders.pop())
            lines.tick(done + 1, run.pulse(done + 1))
            if done + 1 in run.hashes:
                lines.hash(done + 1, run.hashes[done + 1], run.experiences or 0)
        lines.flush()
    finally:
        journal.close()
    if run.header.brain:
        shutil.copyfile(run.folder / BRAIN, folder / BRAIN)
    return open_run(folder)
