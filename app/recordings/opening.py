"""Opens a recording: finds out what kind it is, by what is in it rather than by its name."""

from __future__ import annotations

import math
import re
import shutil
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path, PurePosixPath

from app.recordings.beside import Unpacked, Within
from app.recordings.formats.airsim import FILE as AIRSIM
from app.recordings.formats.airsim import open_airsim
from app.recordings.formats.archive import is_archive, unpack
from app.recordings.formats.bag_file import MAGIC as BAG
from app.recordings.formats.bag_file import bag_packets
from app.recordings.formats.bag_folder import METADATA, Bag, has_bag
from app.recordings.formats.carmen import WORDS, open_carmen
from app.recordings.formats.donkey import MANIFEST, open_old_tub, open_tub
from app.recordings.formats.image_folder import open_image_folder
from app.recordings.formats.lines import open_whole
from app.recordings.formats.lying import files_in, left_over
from app.recordings.formats.mcap_file import MAGIC as MCAP
from app.recordings.formats.mcap_file import mcap_packets, said_of_run
from app.recordings.formats.packed import ZSTD
from app.recordings.formats.pictures import PICTURES, within
from app.recordings.formats.ros_recording import open_ros
from app.recordings.formats.ros_topics import Choice
from app.recordings.formats.scan_json import open_scans
from app.recordings.formats.video import VIDEOS, open_video
from app.recordings.made_odometry import OdometryErrors, WithMadeOdometry
from app.recordings.own_run import OwnRun
from app.recordings.recording import Recording

READ = (
    "MCAP, a bag of ROS 1 or 2, a video, a folder of pictures, a Donkey tub, AirSim's folder, a CARMEN log, or an archive "
    "(.zip, .tar.gz) of one"
)
_LOOK = 64_000  # bytes at the beginning of a text file


@dataclass(frozen=True, slots=True)
class Opening:
    """What somebody may say about a recording."""

    topics: Choice = field(default_factory=Choice)
    rate_hz: float | None = None  # pictures a second, where no file tells their times
    made: OdometryErrors | None = None  # odometry is made from the truth with these errors
    seed: int = 0  # of those errors

    def __post_init__(self) -> None:
        if self.rate_hz is not None and not (math.isfinite(self.rate_hz) and 0.01 <= self.rate_hz <= 1000):
            raise ValueError(f"--rate must be from 0.01 to 1000 pictures a second, got {self.rate_hz!r}")


def open_recording(path: Path | str, opening: Opening | None = None) -> Recording:
    """The recording in a file or a folder. ValueError says in one sentence why it cannot be played."""
    path, opening = Path(path), opening or Opening()
    try:
        folder, there = path.is_dir(), path.exists()
        if not there:
            raise ValueError(f"{path}: there is no such file or folder")
        recording = _folder(path, opening) if folder else _file(path, opening)
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror or error}") from None
    return recording if opening.made is None else WithMadeOdometry(recording, opening.made, opening.seed)


def _folder(path: Path, opening: Opening) -> Recording:
    """What is found in a folder, at whatever depth it begins; of several recordings the one that lies highest."""
    names = files_in(path)
    home, opened = _found(path, names)
    if opened is not None:
        used = set[str]()
        recording = opened(home, opening, used)
        inside = {f"{home.relative_to(path).as_posix()}/{name}".removeprefix("./") for name in used}
        return Within(recording, path.name, left_over(names, inside, {}))
    alone = next((name for name in names if name.lower().removesuffix(".gz").endswith(_SINGLE)), None)
    if alone is not None:
        return Within(_file(within(path, alone), opening), path.name, left_over(names, {alone}, {}))
    films = [name for name in names if name.lower().endswith(VIDEOS)]
    if films and len([name for name in names if name.lower().endswith(PICTURES)]) < 2:
        film = within(path, films[0])
        used = {films[0], str(PurePosixPath(films[0]).with_suffix(".csv"))}
        return Within(_file(film, opening), path.name, left_over(names, used, {}))
    return open_image_folder(path, opening.rate_hz)


Opened = Callable[[Path, Opening, set[str]], Recording]  # used: is filled with the names of the files that are read
_SINGLE = (".bag", ".clf", ".carmen")


def _found(path: Path, names: list[str]) -> tuple[Path, Opened | None]:
    """Where a recording begins that is known by the names of its files, and what opens it."""
    found = [
        (name.count("/"), order, name, opened)
        for name in names
        for order, (pattern, opened) in enumerate(_MARKS)
        if re.fullmatch(pattern, name.rpartition("/")[2])
    ]
    if not found:
        return path, _bag if METADATA in names and (path / METADATA).is_file() else None
    _, _, name, opened = min(found, key=lambda each: each[:3])
    return (path / name).parent, opened


def _airsim(home: Path, _opening: Opening, used: set[str]) -> Recording:
    return open_airsim(home, used)


def _tub(home: Path, _opening: Opening, used: set[str]) -> Recording:
    return open_tub(home, used)


def _old_tub(home: Path, _opening: Opening, used: set[str]) -> Recording:
    return open_old_tub(home, used)


def _bag(home: Path, opening: Opening, used: set[str]) -> Recording:
    bag = Bag(home)
    used |= bag.names
    return open_ros(home, "bag of ROS 2", bag.packets, opening.topics)


_MARKS: tuple[tuple[str, Opened], ...] = (
    (re.escape(AIRSIM), _airsim),
    (re.escape(MANIFEST), _tub),
    (r".*\.catalog", _tub),
    (r".*\.(db3|mcap)(\.zstd)?", _bag),
    (r"record_\d+\.json", _old_tub),
)


def _archive(path: Path, opening: Opening) -> Recording:
    folder, unused = unpack(path)
    try:
        return Unpacked(_folder(folder, opening), path.name, folder, unused)
    except BaseException as error:
        shutil.rmtree(folder, ignore_errors=True)
        if isinstance(error, ValueError):
            raise ValueError(str(error).replace(str(folder), path.name)) from None
        raise


def _file(path: Path, opening: Opening) -> Recording:
    with open_whole(path):
        if not has_bag(path) and is_archive(path):
            return _archive(path, opening)
    with open_whole(path) as file:
        try:
            start = file.read(_LOOK)
        except (OSError, EOFError, zlib.error) as error:
            raise ValueError(f"{path.name}: cannot be unpacked: {error}") from None
    if start.startswith(MCAP):
        recording, said = open_ros(path, "MCAP", partial(mcap_packets, path), opening.topics), said_of_run(path)
        return OwnRun(recording, said) if said else recording
    if start.startswith(BAG):
        return open_ros(path, "bag of ROS 1", partial(bag_packets, path), opening.topics)
    if start.startswith(b"SQLite format 3\0") or (start.startswith(ZSTD) and has_bag(path)):
        return _bag(path, opening, set())
    if path.name == AIRSIM or path.name == MANIFEST:
        return _folder(path.parent, opening)
    if path.suffix.lower() in VIDEOS:
        return open_video(path)
    if start.lstrip().startswith(b"{"):
        return open_scans(path)
    lines = start.decode("utf-8", errors="replace").splitlines()
    if path.suffix.lower() in (".log", ".clf", ".carmen") or any(line.startswith((*WORDS, "PARAM ")) for line in lines):
        return open_carmen(path)
    raise ValueError(f"{path.name}: not a recording that can be read; expected {READ}")
