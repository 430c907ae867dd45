"""Opens a recording: finds out what kind it is, by what is in it rather than by its name."""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from app.recordings.formats.airsim import FILE as AIRSIM
from app.recordings.formats.airsim import open_airsim
from app.recordings.formats.bag_file import MAGIC as BAG
from app.recordings.formats.bag_file import bag_packets
from app.recordings.formats.bag_folder import METADATA, Bag, has_bag
from app.recordings.formats.carmen import WORDS, open_carmen
from app.recordings.formats.donkey import MANIFEST, open_old_tub, open_tub
from app.recordings.formats.image_folder import open_image_folder, pictures_in
from app.recordings.formats.lines import open_whole
from app.recordings.formats.mcap_file import MAGIC as MCAP
from app.recordings.formats.mcap_file import mcap_packets, said_of_run
from app.recordings.formats.packed import ZSTD
from app.recordings.formats.ros_recording import open_ros
from app.recordings.formats.ros_topics import Choice
from app.recordings.formats.scan_json import open_scans
from app.recordings.formats.video import VIDEOS, open_video
from app.recordings.made_odometry import OdometryErrors, WithMadeOdometry
from app.recordings.own_run import OwnRun
from app.recordings.recording import Recording

READ = "MCAP, a bag of ROS 1 or 2, a video, a folder of pictures, a Donkey tub, AirSim's folder, a CARMEN log"
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
    if (path / AIRSIM).is_file():
        return open_airsim(path)
    if (path / MANIFEST).is_file():
        return open_tub(path)
    if (path / METADATA).is_file() or has_bag(path):
        return _bag(path, opening)
    if next(path.glob("record_*.json"), None) is not None:
        return open_old_tub(path)
    if pictures_in(path) or any(path.glob("*.csv")):
        return open_image_folder(path, opening.rate_hz)
    if path.name == "data" or not (path / "data").is_dir():
        raise ValueError(f"{path}: nothing in this folder can be played; expected {READ}")
    return _folder(path / "data", opening)  # as Donkey's own folders and EuRoC's are laid out


def _bag(path: Path, opening: Opening) -> Recording:
    bag = Bag(path)
    return open_ros(path, "bag of ROS 2", bag.packets, opening.topics, bag.unused)


def _file(path: Path, opening: Opening) -> Recording:
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
        return _bag(path, opening)
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
