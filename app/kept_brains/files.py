"""Brains of running sessions, kept in a folder of their own, so that a crash loses a minute of learning and not an
hour.

Each process writes files of its own, so two at once never overwrite each other's. The comment of a file's first zip
entry says which world, seed and time the brain is from; it can be read without unpacking the file.
"""

from __future__ import annotations

import contextlib
import json
import os
import time
import zipfile
from dataclasses import asdict, dataclass
from pathlib import Path

from disk import encode, kept_folder, whole_file, write_state
from ratslam_core import RatSlam

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
