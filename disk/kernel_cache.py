"""Where numba keeps the compiled kernels: beside the sources, where one may write there; else in the cache of a home; else in a
temporary folder of this user's; else nowhere, and they are compiled anew at each start.

It is decided before numba is imported, which gives up with a traceback where it may write nowhere. Matplotlib and Dask get a
folder there as well where no home can be written: they would complain, fail, or make a folder named `~`.
"""

from __future__ import annotations

import os
import shutil
import stat
import sys
from collections.abc import Iterator
from pathlib import Path

from disk.kept import home_folder

VARIABLE = "NUMBA_CACHE_DIR"
ROOM_BYTES = 64 << 20  # the kernels take a third of it
_ROOT = Path(__file__).resolve().parents[1]
_ROOMS = ("app", "ratslam_core", "sim2d")
_TEMPORARY = ("/tmp", "/var/tmp", "/dev/shm")
_IN_VAIN = "neither the program's folder nor a home can be written"

words = ""  # what is to be said of it when something is compiled
in_memory = False  # nothing can be kept


def choose() -> None:
    """Decide it for this process and those that it starts."""
    given = os.environ.get(VARIABLE)
    if not _writable_home():
        _away_from_home()
    if given and _takes(Path(given)):
        return
    if all(map(_may_write, _with_sources())) and _has_room(_ROOT):
        _keep_in(
            None, f"{VARIABLE}={given} cannot be written: what is compiled is kept beside the program" * bool(given)
        )
        return
    home = _cache_of_home()
    if home is not None and _takes(home):
        _keep_in(home, "")
        return
    folder = next(_temporary(), None)
    if folder is None:
        _keep_nothing()
    else:
        _keep_in(folder, f"{_IN_VAIN}: what is compiled is kept in {folder}; {VARIABLE} names a better place")


def _keep_in(folder: Path | None, said: str) -> None:
    """None: where numba itself keeps it, beside the sources."""
    global words
    words = said
    if folder is None:
        os.environ.pop(VARIABLE, None)
    else:
        os.environ[VARIABLE] = str(folder)
    if "numba" in sys.modules:  # a notebook was first
        sys.modules["numba"].config.CACHE_DIR = "" if folder is None else str(folder)


def _keep_nothing() -> None:
    global words, in_memory
    os.environ.pop(VARIABLE, None)
    in_memory = True
    words = (
        f"{_IN_VAIN}, nor any other folder: the engine is compiled anew at each start; {VARIABLE} names a folder for it"
    )
    from numba.core.dispatcher import Dispatcher  # the one thing that `cache=True` calls

    Dispatcher.enable_caching = lambda self: None  # noqa: ARG005


def _away_from_home() -> None:
    for folder in _temporary():
        os.environ.setdefault("MPLCONFIGDIR", str(folder / "matplotlib"))
        os.environ.setdefault("DASK_CONFIG", str(folder / "dask"))
        return


def _with_sources() -> Iterator[Path]:
    for room in _ROOMS:
        for folder, inner, _ in os.walk(_ROOT / room):
            if "__pycache__" in inner:
                inner.remove("__pycache__")
            cache = Path(folder, "__pycache__")
            yield cache if cache.exists() else Path(folder)


def _may_write(folder: Path) -> bool:
    return os.access(folder, os.W_OK | os.X_OK)


def _takes(folder: Path) -> bool:
    """Whether files can be made there. The folder is made first."""
    probe = folder / f".probe-{os.getpid()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe.touch()
        probe.unlink()
    except OSError:
        return False
    return _has_room(folder)


def _has_room(folder: Path) -> bool:
    """Or what is to be kept lies there already."""
    return shutil.disk_usage(folder).free > ROOM_BYTES or any(folder.glob("**/*.nbi"))


def _writable_home() -> bool:
    try:
        return os.access(home_folder(), os.W_OK | os.X_OK)
    except ValueError:
        return False


def _cache_of_home() -> Path | None:
    """None: there is no home."""
    cache = Path(os.environ.get("XDG_CACHE_HOME", ""))
    try:
        return (cache if cache.is_absolute() else home_folder() / ".cache") / "ratslam"
    except ValueError:
        return None


def _temporary() -> Iterator[Path]:
    """Folders that can be written, and only by this user: what numba keeps is code, which it runs."""
    user = os.getuid() if hasattr(os, "getuid") else 0
    named = [os.environ.get(name) for name in ("TMPDIR", "TEMP", "TMP")]
    for parent in (*filter(None, named), *_TEMPORARY):
        folder = Path(parent, f"ratslam-{user}")
        try:
            folder.mkdir(mode=0o700, exist_ok=True)
            about = folder.lstat()
        except OSError:
            continue
        theirs = os.name == "posix" and (about.st_uid != user or about.st_mode & 0o077)
        if stat.S_ISDIR(about.st_mode) and not theirs and _takes(folder):
            yield folder
