"""Any moment of a long run again, session and history, without a browser: `python -m benchmarks.moments [--hours 10]`.

Time on the clock, and of the processor, which does not depend on what else the machine does. What a page adds:
`benchmarks.seeking`. Moments between keyframes are run again, so where these lie farther apart it takes longer.
"""

from __future__ import annotations

import argparse
import random
import statistics
import time

import numpy as np

from app.cli.run import PAST_DISK_MB, PAST_MB
from app.run_record.folder import runs_folder
from app.run_record.keyframes import Moment, PastRoom, TimeMachine
from app.session import Session
from app.views.history import History
from benchmarks.machine import verdict
from sim2d import load_world

HOUR_TICKS, REPORT_AFTER = 36_000, 18_000
LONG_HOURS, BAR_S, LONG_BAR_S = 1.0, 0.3, 1.0  # longer runs than this have another bar


def make_run(world: str, hours: float, room: PastRoom) -> TimeMachine:
    """Run for so long, as fast as possible. Tells how it goes now and then."""
    session = Session(load_world(world), 1)
    history = History(session)
    machine = TimeMachine(session, history, room)
    session.on_order = machine.note_order
    began_s, cpu_s, keeping_s = time.monotonic(), time.process_time(), 0.0
    for tick in range(1, round(HOUR_TICKS * hours) + 1):
        session.tick()
        history.watch()
        before = time.thread_time()
        machine.ticked()
        keeping_s += time.thread_time() - before
        if tick % REPORT_AFTER == 0:
            ticks = np.diff([frame.tick for frame in machine.live.keyframes])
            print(
                f"{tick / HOUR_TICKS:4.1f} h: {time.monotonic() - began_s:.0f} s on the clock, "
                f"{time.process_time() - cpu_s:.0f} s of the processor, {1e3 * keeping_s / tick:.2f} ms a tick for "
                f"keyframes; {len(ticks) + 1} of them with {machine.nbytes / 1e6:.0f} MB and "
                f"{machine.disk_nbytes / 1e6:.0f} MB on the disk, {np.median(ticks) / 10:.0f} s apart, "
                f"{ticks.max() / 10:.0f} s at most; {len(session.brain.experience_map)} experiences",
                flush=True,
            )
    return machine


def seek(machine: TimeMachine, tick: int) -> tuple[float, float, float]:
    """(On the clock, of the processor, of that to restore the keyframe), in seconds."""
    clock_s, cpu_s = time.monotonic(), time.thread_time()
    moment = Moment(machine.live, tick)
    restored_s = time.thread_time() - cpu_s
    moment.go_to(tick)
    return time.monotonic() - clock_s, time.thread_time() - cpu_s, restored_s


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split(":")[0])
    parser.add_argument("--hours", type=float, default=1.0, help="of simulated time (default 1)")
    parser.add_argument("--count", type=int, default=100, help="of moments (default 100)")
    parser.add_argument("--world", default="office")
    parser.add_argument("--keep-past", type=float, default=PAST_MB, help=f"megabytes (default {PAST_MB:g})")
    parser.add_argument(
        "--keep-past-disk", type=float, default=PAST_DISK_MB, help=f"the same (default {PAST_DISK_MB:g})"
    )
    options = parser.parse_args()
    room = PastRoom(round(1e6 * options.keep_past), round(1e6 * options.keep_past_disk), runs_folder())
    machine, rng = make_run(options.world, options.hours, room), random.Random(1)
    found = [seek(machine, rng.randrange(machine.live.end_tick)) for _ in range(options.count)]
    p95 = 0.0
    for name, times in zip(("on the clock", "processor", "of it, restored"), zip(*found, strict=True), strict=True):
        at = statistics.quantiles(times, n=20)[-1]
        p95 = p95 or at
        print(f"{name:16} median {statistics.median(times):.3f} s   p95 {at:.3f} s   worst {max(times):.3f} s")
    bar_s = BAR_S if options.hours <= LONG_HOURS else LONG_BAR_S
    print(f"p95 {p95:.2f} s, bar {bar_s:g} s: {verdict(p95 <= bar_s)}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
