"""The brain of the running session, kept every minute and when the program ends, in a folder of its own: a crash loses a
minute of learning and not an hour. The engine only makes the copy.

Each process writes files of its own, so two at once never overwrite each other's. The comment of a file's first zip entry
says which world, seed and time the brain is from; it can be read without unpacking the file.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
import threading
import time
import zipfile
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import asdict, dataclass
from pathlib import Path

from disk import encode, kept_folder, whole_file, write_state
from ratslam_core import RatSlam
from web import messages as m
from web.latest import Latest

MOST_KEPT = 6
HEAD = "json.npy"


@dataclass(frozen=True, slots=True)
class About:
    """What a kept brain is from."""

    world: str
    seed: int
    time_s: float  # simulated
    experiences: int
    kept_at: float  # seconds since 1970


@dataclass(frozen=True, slots=True)
class KeptBrain:
    path: Path
    about: About

    @property
    def words(self) -> str:
        a = self.about
        day = "%H:%M" if time.time() - a.kept_at < 12 * 3600 else "%Y-%m-%d %H:%M"
        when = time.strftime(day, time.localtime(a.kept_at))
        return f"a brain of {a.world}, seed {a.seed}, {a.time_s / 60:.0f} min, {a.experiences} experiences, kept {when}"


def folder() -> Path:
    """RATSLAM_BRAINS, or `.ratslam/brains` in the home directory; it need not exist. ValueError without a home."""
    return Path(os.environ.get("RATSLAM_BRAINS") or kept_folder() / "brains")


def keep(name: str, brain: RatSlam, about: About) -> str | None:
    """Write a brain over the one of this name. Returns a warning if it is becoming too large for a file.

    No session may be using the brain. OSError, ValueError: it cannot be kept, and the old file stays. A crash at any
    moment leaves either the new file or the old one.
    """
    path, snapshot = folder() / f"{name}.npz", encode(brain)
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as file:
        write_state(snapshot, file, json.dumps(asdict(about)))
    _prune()
    return snapshot.outgrowing


def newest() -> KeptBrain | None:
    """The brain that was kept last, among all files that can be read."""
    try:
        found = [kept for path in folder().glob("*.npz") if (kept := _read(path)) is not None]
    except ValueError:  # no home directory: nothing is kept
        return None
    return max(found, key=lambda kept: kept.about.kept_at, default=None)


def _read(path: Path) -> KeptBrain | None:
    """What is kept in a file, without unpacking it; None if it cannot be read."""
    try:
        with zipfile.ZipFile(path) as archive:
            return KeptBrain(path, About(**json.loads(archive.getinfo(HEAD).comment)))
    except (OSError, ValueError, TypeError, KeyError, zipfile.BadZipFile):
        return None


def _prune() -> None:
    """Delete all but the newest MOST_KEPT files. What cannot be deleted stays."""
    with contextlib.suppress(OSError):
        by_age = sorted(folder().glob("*.npz"), key=lambda path: path.stat().st_mtime, reverse=True)
        for path in by_age[MOST_KEPT:]:
            path.unlink(missing_ok=True)


EVERY_S = 60.0
LEAST_S = 60.0  # simulated time; a younger brain is soon learnt again, and would push out an older one
PATIENCE_S = 10.0  # how long to wait for the engine, which may be in a long tick
LEAVING_S = 1.5  # how long leaving waits for the disk, and before that for the engine, once each

Submit = Callable[[m.Command | m.EngineRequest], "Future[m.Accepted | m.Refused]"]


class BrainKeeper:
    """Writes in a thread of its own, so that only this thread waits for the disk."""

    def __init__(self, latest: Latest[m.Snapshot], submit: Submit) -> None:
        self._latest, self._submit = latest, submit
        self._name = f"{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}"
        self._kept: tuple[int, int] | None = None  # run and tick
        self._complained: str | None = None
        self._leaving, self._read = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._work, name="brain keeper", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def leave(self) -> None:
        """Read the brain once more before the engine ends. What is written takes longer; `stop` waits for that."""
        self._leaving.set()
        if self._thread.ident is not None:
            self._read.wait(LEAVING_S)

    def stop(self) -> None:
        """To be called when the engine has ended, which leaves the writing more of the machine. If it takes too long, the file
        kept last stays."""
        self._leaving.set()
        self._thread.join(LEAVING_S)
        if self._thread.is_alive():
            print("ratslam: the brain cannot be written in time; the one kept last stays", file=sys.stderr)

    def _work(self) -> None:
        while not self._leaving.wait(EVERY_S):
            self.keep_now()
        self.keep_now()
        self._read.set()

    def keep_now(self) -> None:
        """Keep the brain if it has changed, is old enough and its session has no fault."""
        _, now = self._latest.get()
        if now is None or now.fault is not None or now.time_s < LEAST_S or (now.run, now.tick) == self._kept:
            return
        if now.world is None or now.recording is not None:
            return  # a recorded place cannot be opened at the next start
        try:
            answer = self._submit(m.ReadBrain()).result(PATIENCE_S)
        except Exception as error:  # the engine has reported it already, or has ended
            self._complain("engine", f"the brain cannot be read: {error or type(error).__name__}")
            return
        if not (isinstance(answer, m.Accepted) and isinstance(answer.result, RatSlam)):
            return
        brain = answer.result
        if self._leaving.is_set():
            self._read.set()
        about = About(now.world.name, now.seed, now.time_s, len(brain.experience_map), time.time())
        try:
            warning = keep(f"{self._name}-{now.run}", brain, about)
        except OSError as error:
            self._complain("disk", f"the brain cannot be kept in {folder()}: {error.strerror or error}")
        except ValueError as error:
            self._complain("size", f"the brain cannot be kept: {error}")
        else:
            self._kept = now.run, now.tick
            self._complain(warning and "growth", warning)

    def _complain(self, about: str | None, words: str | None) -> None:
        """Print and show a complaint once, until there is another one or none."""
        if words and about != self._complained:
            print(f"ratslam: {words}", file=sys.stderr, flush=True)
            self._submit(m.Warn(words))
        self._complained = about
