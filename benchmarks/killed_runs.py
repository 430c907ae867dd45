"""Kills programs at random moments and opens the runs that they kept: `python -m benchmarks.killed_runs --count 500`.

Each is a process with the dashboard's engine, as fast as it runs, under random orders. With `--full` its disk is a small one
that is full after a while, and sometimes has room again; that takes the right to mount one. The exit code is 1 when a run did
not open up to its last whole line, or came out differently.
"""

from __future__ import annotations

import argparse
import contextlib
import mmap
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Generator
from pathlib import Path
from random import Random

import numpy as np
from numpy.typing import NDArray

from app.code_version import code_version
from app.config import Config
from app.engine_thread import EngineThread
from app.run_record.folder import LINES, all_runs
from app.run_record.header import Beginning, beginning_of, header_of, written
from app.run_record.reader import KeptRun, open_run
from app.run_record.resume import replayed
from app.run_record.run_log import line_of
from app.run_record.states import newest_state
from app.run_record.writer import RunFeed, RunKeeper
from app.session import Session
from sim2d import load_world
from web import messages as m

WORLDS = ("living", "loop", "office")
LONGEST_S = 2.0  # from its first tick to its death
MOST_TICKS = 60_000
BLOCK = 4096  # bytes: a disk of a few of them
BEGUN_S = 60.0
ORDERS: tuple[m.Command, ...] = (
    m.Kidnap(type="kidnap"), m.SetMode(type="set_mode", mode="manual"), m.Pause(type="pause"),
    m.Drive(type="drive", speed=0.3, yaw_rate=-0.4), m.SetMode(type="set_mode", mode="explore"),
)  # fmt: skip


class ClockedKeeper(RunKeeper):
    """Writes down when each tick was told, where another process can read it after this one was killed."""

    def __init__(self, moments: NDArray[np.float64]) -> None:
        super().__init__(lambda _words: None)
        self._moments = moments

    def feed(self, session: Session, beginning: Beginning | KeptRun | object) -> RunFeed:
        feed = super().feed(session, beginning)  # type: ignore[arg-type]
        tick = feed.tick

        def clocked(session: Session) -> None:
            self._moments[session.tick_count] = time.monotonic()  # before: what is kept must not be newer
            tick(session)

        feed.tick = clocked
        return feed


def live(world: str, seed: int, moments: NDArray[np.float64], told: int) -> None:
    """A program until it is killed. told: a byte is written there once its run has begun."""
    chance, keeper = Random(seed), ClockedKeeper(moments)
    engine = EngineThread(load_world(world), seed, Config(), speed=0.0, keeper=keeper)
    keeper.start()
    engine.start()
    while not moments[1]:
        time.sleep(0.001)
    os.write(told, b"1")
    while True:
        time.sleep(chance.uniform(0.0, 0.2))
        engine.submit(chance.choice(ORDERS))
        engine.submit(m.Resume(type="resume"))


def killed(world: str, seed: int, chance: Random, folder: Path, full: bool) -> tuple[int, float, NDArray[np.float64]]:
    """Ticks that the program had run, when it died, and when it had run each tick."""
    moments = np.frombuffer(mmap.mmap(-1, 8 * MOST_TICKS), np.float64)
    listen, told = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            with open(os.devnull, "w") as nowhere:
                os.dup2(nowhere.fileno(), 2)
            live(world, seed, moments, told)
        finally:
            os._exit(1)
    os.close(told)
    begun = os.read(listen, 1)
    os.close(listen)
    assert begun, "the program did not begin"
    lives_s = chance.uniform(0.0, LONGEST_S)
    if full and chance.random() < 0.3:  # there is room again before it dies
        time.sleep(0.7 * lives_s)
        subprocess.run(["mount", "-o", "remount,size=16m", folder], check=True)
        lives_s *= 0.3
    time.sleep(lives_s)
    os.kill(child, signal.SIGKILL)
    died = time.monotonic()
    os.waitpid(child, 0)
    return int(np.flatnonzero(moments)[-1]), died, moments


@contextlib.contextmanager
def disk(folder: Path, full: bool, chance: Random, header: int) -> Generator[None]:
    """A folder to keep runs in; with full, a disk that holds the header of a run and little more, or not even that."""
    folder.mkdir()
    if not full:
        yield
        return
    blocks = chance.choice((0, header // BLOCK, *(header // BLOCK + k for k in range(2, 8))))
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={BLOCK * (blocks + 1)}", "tmpfs", folder], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", folder], check=True)


def opened(before: Counter[str], folder: Path) -> KeptRun | None:
    """The run, up to its last whole line; None when not even its first line was whole."""
    runs = all_runs()
    data = (runs[0] / LINES).read_bytes() if runs else b""
    if b"\n" not in data:
        before["not a whole line was kept"] += 1
        return None
    run = open_run(runs[0])
    assert run.size == data.rfind(b"\n") + 1, f"{folder}: {run.damage}, {run.size} of {len(data)} bytes"
    before["opened up to the last whole line"] += 1
    before["with half a line behind it"] += run.size < len(data)
    return run


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.killed_runs", description=__doc__)
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--full", action="store_true", help="on a disk that is full after a while")
    parser.add_argument("--replay", type=float, default=0.2, help="share of the runs that are run again")
    args = parser.parse_args()
    chance, counts, faults = Random(args.seed), Counter[str](), 0
    lost_ticks, lost_s = [0], [0.0]
    code_version()
    headers: dict[str, int] = {}
    for name in WORLDS:  # whatever is compiled is compiled before the first fork
        session = Session(load_world(name), 1)
        headers[name] = len(line_of(written(header_of(beginning_of(session))), 0)[0])
        for _ in range(30):
            session.tick()
    with tempfile.TemporaryDirectory() as home:
        for number in range(args.count):
            world, seed, folder = chance.choice(WORLDS), chance.randrange(1000), Path(home) / str(number)
            os.environ["RATSLAM_RUNS"] = str(folder)
            with disk(folder, args.full, chance, headers[world]):
                ticks, died, moments = killed(world, seed, chance, folder, args.full)
                again = chance.random() < args.replay
                try:
                    run = opened(counts, folder)
                    if run is not None:
                        assert run.tick <= ticks, f"tick {run.tick} of {ticks}"
                        if run.tick < ticks and not args.full:
                            lost_ticks.append(ticks - run.tick)
                            lost_s.append(died - float(moments[run.tick + 1]))
                        if again:
                            counts["with a state beside them"] += newest_state(run) is not None
                            replayed(run)
                            counts["came out the same when run again"] += 1
                except (AssertionError, ValueError) as error:
                    faults += 1
                    print(f"number {number}, {world}, seed {seed}: {error}", flush=True)
            if number % 50 == 49:
                print(f"{number + 1} killed, {faults} faults", flush=True)
    for what, count in counts.items():
        print(f"{count:5} {what}")
    if not args.full:
        print(f"lost at most {max(lost_ticks)} ticks, {max(lost_s):.2f} s of wall time; "
              f"{np.median(lost_s):.2f} s in the median")  # fmt: skip
    print(f"{faults} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
