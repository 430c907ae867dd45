"""Where a person keeps things: in `.ratslam` in the home directory, or wherever they say."""

from __future__ import annotations

import os
from pathlib import Path


def user_folder(name: str) -> Path:
    """Where a person's own `runs`, `worlds`, `lessons` or `experiments.sqlite` lie: RATSLAM_RUNS and so on, else
    `.ratslam/NAME` in the home directory. It need not exist.

    ValueError when there is no home: an empty HOME is none, and neither is `/`."""
    variable = f"RATSLAM_{name.partition('.')[0].upper()}"
    return Path(os.environ.get(variable) or home_folder() / ".ratslam" / name)


def home_folder() -> Path:
    """The home directory, which need not exist. ValueError: there is none."""
    home = Path(os.environ.get("HOME") or _of_the_account())
    if home.absolute() == Path(home.absolute().anchor):
        raise ValueError(f"there is no home directory (it would be {home}): set HOME to a folder of yours")
    return home


def _of_the_account() -> str:
    """The home directory that the system has on record for this account, if it knows the account."""
    try:
        import pwd

        return pwd.getpwuid(os.getuid()).pw_dir or "/"
    except (ImportError, KeyError):
        return str(Path.home()) if os.name == "nt" else "/"
