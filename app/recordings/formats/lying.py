"""What lies in a folder: its files by name, its pictures by camera, and what of it was left unused."""

from __future__ import annotations

import os
import re
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path, PurePosixPath

from app.recordings.formats.cells import date_ns
from app.recordings.formats.pictures import PICTURES
from disk.words import plain

MOST_FILES = 2_000_000
_NO_CAMERA = re.compile(
    r"depth|disp|mask|seg|semantic|label|flow|normal|conf|thumb|debug|infra|therm|instance|annot|uncert|overlay"
)
_RANKS = (  # the words by which cameras are told apart, the one to be played first
    (0, re.compile(r"(^|[^a-z])(cent(er|re)|rgb|colou?r|front)([^a-z]|$)")),
    (4, re.compile(r"(^|[^a-z])(right|rear|back|(cam(era)?|image)_?0?[13])([^a-z0-9]|$)")),
    (1, re.compile(r"(^|[^a-z])(left|cam(era)?_?0*|image_?0?2)([^a-z0-9]|$)")),
    (2, re.compile(r"(^|[^a-z])image_?0+([^a-z0-9]|$)")),
)
_FEW = 0.1  # of as many pictures as another camera has: no camera
_KINDS = 12  # different names in one folder: no cameras, but names that mean something else
_RECORDED = (
    ".bag", ".db3", ".mcap", ".zip", ".7z", ".rar", ".tar", ".gz", ".tgz", ".bz2", ".xz", ".zst", ".mp4", ".avi", ".mkv",
)  # fmt: skip
_DATE = re.compile(
    r"(?<!\d)(\d{4})[-_]?(\d\d)[-_]?(\d\d)[-_T ]+(\d\d)[-_:.]?(\d\d)[-_:.]?(\d\d)(?:[-_.](\d{1,9}))?(?!\d)"
)
_EPOCH = re.compile(r"(?<!\d)(\d{10})(?:[._](\d{1,9}))?(?!\d)|(?<!\d)(\d{13}|\d{16}|\d{19})(?!\d)")
_SECONDS = re.compile(r"(\d+)[._](\d+)")
_UNIT = re.compile(r"(?<![\d.])(\d+(?:\.\d+)?) ?(ns|us|ms|s|sec)(?![a-z])", re.IGNORECASE)
_UNITS_NS = {"ns": 1, "us": 1000, "ms": 10**6, "s": 10**9, "sec": 10**9}
_SINCE_2001_S = 978_307_200, 4_102_444_800  # to 2100


def by_number(name: str) -> list[tuple[int, int, str]]:
    """Orders `img2` before `img10`."""
    parts = re.split(r"([0-9]+)", name)
    return [(1, int(part[:300]), "") if k % 2 else (0, 0, part) for k, part in enumerate(parts)] + [(0, 0, name)]


def files_in(folder: Path) -> list[str]:
    """All files below a folder, with / between, in the order of the numbers in their names; without hidden ones. ValueError."""
    names: list[str] = []
    for place, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith(".") and name != "__MACOSX"]
        under = Path(place).relative_to(folder).as_posix()
        names += [name if under == "." else f"{under}/{name}" for name in files if not name.startswith(".")]
        if len(names) > MOST_FILES:
            raise ValueError(f"{folder}: more than {MOST_FILES} files")
    return sorted(names, key=by_number)


def cameras_of(names: Iterable[str]) -> dict[str, list[str]]:
    """The pictures of each camera: those of one folder whose names differ in their numbers only. The one to be played is
    the first."""
    folders: defaultdict[str, defaultdict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for name in names:
        if name.lower().endswith(PICTURES):
            path = PurePosixPath(name)
            folders[str(path.parent)][re.sub(r"[\d.]+", "", path.stem).strip("_- ")].append(name)
    cameras: dict[str, list[str]] = {}
    for folder, kinds in folders.items():
        if len(kinds) > _KINDS or len(kinds) * 2 > sum(map(len, kinds.values())):
            kinds = {"": sorted((name for some in kinds.values() for name in some), key=by_number)}
        for kind, some in kinds.items():
            cameras[f"{folder}/{kind}" if len(kinds) > 1 else folder] = some
    most = max(map(len, cameras.values()), default=0)

    def rank(camera: str) -> tuple[int, int, int]:
        few = len(cameras[camera]) < _FEW * most
        return 10 if few else rank_of(camera), -len(cameras[camera]), camera.count("/")

    return {camera: cameras[camera] for camera in sorted(cameras, key=rank)}


def rank_of(camera: str) -> int:
    """By the words in its name: the lower, the sooner it is played; 9: no camera."""
    words = camera.lower()
    if _NO_CAMERA.search(words):
        return 9
    return next((rank for rank, pattern in _RANKS if pattern.search(words)), 3)


def times_in_names(names: list[str]) -> list[int] | None:
    """Nanoseconds, if each name has a time and they are all different: a date, or a number of s, ms, us or ns since 1970, or
    one with a point or a unit."""
    for read in (_dated, _since_1970, _with_unit, _with_point):
        times = [read(PurePosixPath(name).stem) for name in names]
        told = [time for time in times if time is not None]
        if len(told) == len(names) == len(set(told)):
            return told
    return None


def _dated(stem: str) -> int | None:
    found = _DATE.search(stem)
    return None if found is None else date_ns(*found.groups())


def _since_1970(stem: str) -> int | None:
    for found in _EPOCH.finditer(stem):
        if found[1]:
            time = int(found[1]) * 10**9 + int((found[2] or "0").ljust(9, "0"))
        else:
            time = int(found[3]) * 10 ** (19 - len(found[3]))
        if _SINCE_2001_S[0] <= time // 10**9 <= _SINCE_2001_S[1]:
            return time
    return None


def _with_unit(stem: str) -> int | None:
    found = _UNIT.search(stem)
    return None if found is None else round(float(found[1]) * _UNITS_NS[found[2].lower()])


def _with_point(stem: str) -> int | None:
    found = _SECONDS.fullmatch(stem) if "." in stem else None
    return None if found is None else int(found[1][:10]) * 10**9 + int(found[2][:9].ljust(9, "0"))


def left_over(names: Iterable[str], used: set[str], reasons: dict[str, str]) -> tuple[str, ...]:
    """A sentence for each file that is not used; one for many of a kind in one folder.

    reasons: of files of which one is known.
    """
    alike: defaultdict[tuple[str, str, str], list[str]] = defaultdict(list)
    for name in names:
        if name not in used:
            path = PurePosixPath(name)
            why = reasons.get(name) or _why(name)
            alike[str(path.parent), path.suffix.lower(), why].append(name)
    lines: list[str] = []
    for (folder, suffix, why), some in alike.items():
        here = "" if folder == "." else f" in {plain(folder, 80)}"
        what = plain(some[0], 80) if len(some) == 1 else f"{len(some)} files {suffix or 'without ending'}{here}"
        lines.append(f"{what}: {plain(why)}")
    return tuple(lines)


def _why(name: str) -> str:
    if name.lower().endswith(PICTURES):
        return "pictures of no camera that is played"
    if name.lower().endswith(_RECORDED):
        return "may be a recording of its own; open it by itself"
    if name.lower().endswith((".xlsx", ".xls", ".ods", ".numbers")):
        return "a spreadsheet; save it as CSV"
    return "nothing that is known here reads it"
