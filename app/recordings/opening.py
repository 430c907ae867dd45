"""Opens a recording: finds out what kind it is, by what is in it rather than by its name. And tells by a fingerprint
whether one on the disk is still that from which a run was made; and looks through one: what is in it, what will be used for
what, and what is wrong with it.
"""

from __future__ import annotations

import hashlib
import math
import re
import shutil
import weakref
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Any

from app.recordings.formats.airsim import FILE as AIRSIM
from app.recordings.formats.airsim import open_airsim
from app.recordings.formats.bags import MAGIC as BAG
from app.recordings.formats.bags import METADATA, Bag, bag_packets, has_bag
from app.recordings.formats.donkey import MANIFEST, open_old_tub, open_tub
from app.recordings.formats.files import ZSTD, is_archive, open_whole, unpack
from app.recordings.formats.image_folder import open_image_folder
from app.recordings.formats.laser_logs import WORDS, open_carmen, open_scans
from app.recordings.formats.lying import files_in, left_over
from app.recordings.formats.mcap_file import MAGIC as MCAP
from app.recordings.formats.mcap_file import mcap_packets, said_of_run
from app.recordings.formats.pictures import PICTURES, within
from app.recordings.formats.ros_recording import open_ros
from app.recordings.formats.ros_topics import Choice
from app.recordings.formats.video import VIDEOS, open_video
from app.recordings.motion import OdometryErrors, WithMadeOdometry, lengths
from app.recordings.recording import About, Moment, Recording, Wanted, every

_READ = (
    "MCAP, a bag of ROS 1 or 2, a video, a folder of pictures, a Donkey tub, AirSim's folder, a CARMEN log, or an archive "
    "(.zip, .tar.gz) of one"
)
_LOOK = 64_000  # bytes at the beginning of a text file
_SINGLE = (".bag", ".clf", ".carmen")


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
        if not path.exists():
            raise ValueError(f"{path}: there is no such file or folder")
        recording = _folder(path, opening) if path.is_dir() else _file(path, opening)
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
        return _Within(recording, path.name, left_over(names, inside, {}))
    alone = next((name for name in names if name.lower().removesuffix(".gz").endswith(_SINGLE)), None)
    if alone is not None:
        return _Within(_file(within(path, alone), opening), path.name, left_over(names, {alone}, {}))
    films = [name for name in names if name.lower().endswith(VIDEOS)]
    if films and len([name for name in names if name.lower().endswith(PICTURES)]) < 2:
        film = within(path, films[0])
        used = {films[0], str(PurePosixPath(films[0]).with_suffix(".csv"))}
        return _Within(_file(film, opening), path.name, left_over(names, used, {}))
    return open_image_folder(path, opening.rate_hz)


_Opener = Callable[[Path, Opening, set[str]], Recording]  # used: is filled with the names of the files that are read


def _found(path: Path, names: list[str]) -> tuple[Path, _Opener | None]:
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


def _bag(home: Path, opening: Opening, used: set[str]) -> Recording:
    bag = Bag(home)
    used |= bag.names
    return open_ros(home, "bag of ROS 2", bag.packets, opening.topics)


_MARKS: tuple[tuple[str, _Opener], ...] = (
    (re.escape(AIRSIM), lambda home, _, used: open_airsim(home, used)),
    (re.escape(MANIFEST), lambda home, _, used: open_tub(home, used)),
    (r".*\.catalog", lambda home, _, used: open_tub(home, used)),
    (r".*\.(db3|mcap)(\.zstd)?", _bag),
    (r"record_\d+\.json", lambda home, _, used: open_old_tub(home, used)),
)


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
        return _OwnRun(recording, said) if said else recording
    if start.startswith(BAG):
        return open_ros(path, "bag of ROS 1", partial(bag_packets, path), opening.topics)
    if start.startswith(b"SQLite format 3\0") or (start.startswith(ZSTD) and has_bag(path)):
        return _bag(path, opening, set())
    if path.name in (AIRSIM, MANIFEST):
        return _folder(path.parent, opening)
    if path.suffix.lower() in VIDEOS:
        return open_video(path)
    if start.lstrip().startswith(b"{"):
        return open_scans(path)
    lines = start.decode("utf-8", errors="replace").splitlines()
    if path.suffix.lower() in (".log", ".clf", ".carmen") or any(line.startswith((*WORDS, "PARAM ")) for line in lines):
        return open_carmen(path)
    raise ValueError(f"{path.name}: not a recording that can be read; expected {_READ}")


def _archive(path: Path, opening: Opening) -> Recording:
    folder, unused = unpack(path)
    try:
        return _Unpacked(_folder(folder, opening), path.name, folder, unused)
    except BaseException as error:
        shutil.rmtree(folder, ignore_errors=True)
        if isinstance(error, ValueError):
            raise ValueError(str(error).replace(str(folder), path.name)) from None
        raise


class _Within:
    """A recording under the name of the larger thing that it was found in. What else lies there is told of."""

    def __init__(self, recording: Recording, name: str, unused: tuple[str, ...] = ()) -> None:
        self._recording, self._name, self._more = recording, name, unused

    @property
    def about(self) -> About:
        about = self._recording.about
        return replace(about, name=self._name, unused=(*about.unused, *self._more))

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        return self._recording.moments(wanted)


class _Unpacked(_Within):
    """One that was unpacked into a folder, which is deleted when nobody has the recording any more."""

    def __init__(self, recording: Recording, name: str, folder: Path, unused: tuple[str, ...]) -> None:
        super().__init__(recording, name, unused)
        self._gone = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)

    @property
    def about(self) -> About:
        about = super().about
        return replace(about, format=f"{about.format}, unpacked")

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        yield from super().moments(wanted)  # so that the folder is there until the last of them


class _OwnRun:
    """A run of ours that was exported. It brings its parameters and its seed: with these, the same views, experiences
    and links come out as in the run."""

    def __init__(self, recording: Recording, said: dict[str, str]) -> None:
        """said: what the run says of itself, as `app/export/mcap_file.py` writes it."""
        from app.config.toml_file import from_toml  # which needs the engine, and most recordings do not

        self._recording = recording
        self._problems: tuple[str, ...] = ()
        self._config, self._seed = None, None
        try:
            self._config, self._seed = from_toml(said["config"]), int(said["seed"])
        except (KeyError, ValueError) as error:
            self._problems = (f"the parameters of this run cannot be used, and rules take their place: {error}",)

    @property
    def about(self) -> About:
        about = self._recording.about
        uses = about.uses if self._config is None else (*about.uses, "parameters and seed: those of the run")
        return replace(
            about, uses=uses, problems=(*about.problems, *self._problems), config=self._config, seed=self._seed
        )

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        return self._recording.moments(wanted)


WHOLE_BYTES = 64 << 20  # of files up to this size everything counts
PIECE_BYTES, PIECES = 1 << 20, 32


def fingerprint(path: Path) -> str:
    """[ours] SHA-256 over the names, lengths and contents of all files that belong to it. OSError: one cannot be read.

    A small file counts as a whole; of a large one its length and pieces from all over it, since bags may have many
    gigabytes. test_kept_recordings.py.
    """
    whole = hashlib.sha256()
    home = path if path.is_dir() else path.parent
    for file in files_of(path):
        size = file.stat().st_size
        whole.update(f"{file.relative_to(home).as_posix()}\0{size}\0".encode())
        with file.open("rb") as data:
            if size <= WHOLE_BYTES:
                whole.update(data.read())
                continue
            for k in range(PIECES):
                data.seek(k * (size - PIECE_BYTES) // (PIECES - 1))
                whole.update(data.read(PIECE_BYTES))
    return whole.hexdigest()


def files_of(path: Path) -> list[Path]:
    """The files of a recording, in the order of their names: those of a folder; or a file and the table beside it."""
    if not path.is_dir():
        if path.name in (AIRSIM, MANIFEST):
            return files_of(path.parent)
        table = path.with_suffix(".csv")
        return [path, *([table] if table != path and table.is_file() else [])]
    return sorted(file for file in path.rglob("*") if file.is_file())


@dataclass(frozen=True, slots=True)
class Checked:
    """A recording after every moment of it was read."""

    about: About
    moments: int  # that can be played
    seconds: float
    longest_gap_s: float  # between two moments

    @property
    def report(self) -> dict[str, Any]:
        """As JSON."""
        about = self.about
        report: dict[str, Any] = {
            "recording": about.name,
            "format": about.format,
            "moments": self.moments,
            "seconds": round(self.seconds, 3),
            "longest_gap_s": round(self.longest_gap_s, 3),
            "has": sorted(about.has),
            "uses": list(about.uses),
            "problems": list(about.problems),
            "counts": [{"what": count.what, "read": count.read, "of": count.there} for count in about.counts],
            "unused": list(about.unused),
            "lengths": lengths(about) or "metres",
        }
        if about.image_shape is not None:
            report["image_shape"] = list(about.image_shape)
        if about.beam_angles_rad:
            report["beams"] = len(about.beam_angles_rad)
        return report

    @property
    def lines(self) -> list[str]:
        """For people."""
        about = self.about
        rate = f", {(self.moments - 1) / self.seconds:.3g} a second" if self.seconds > 0 else ""
        lines = [f"{about.name}: {about.format}; {self.moments} moments in {self.seconds:.6g} s{rate}"]
        if about.image_shape is not None:
            lines.append(f"  pictures of {about.image_shape[1]} x {about.image_shape[0]} pixels")
        if about.beam_angles_rad:
            limit = "" if about.range_limit_m is None else f" up to {about.range_limit_m:g} m"
            lines.append(f"  scans of {len(about.beam_angles_rad)} beams{limit}")
        lines += [f"  {sentence}" for sentence in about.uses]
        lines += [f"  read {count.read} of {count.there} {count.what}" for count in about.counts]
        lines += [f"  not used: {sentence}" for sentence in about.unused]
        if (told := lengths(about)) is not None:
            lines.append(f"  {told}")
        if missing := [kind for kind in ("camera", "speed", "yaw rate", "ranges", "truth") if kind not in about.has]:
            lines.append(f"  not in it: {', '.join(missing)}")
        return lines


def check(recording: Recording) -> Checked:
    """Read all of it. ValueError: nothing in it can be played."""
    moments, seconds, longest = 0, 0.0, 0.0
    for moment in recording.moments():
        longest = max(longest, moment.time_s - seconds)
        moments, seconds = moments + 1, moment.time_s
    if not moments:
        told = " ".join(recording.about.problems[:2])
        raise ValueError(f"{recording.about.name}: none of its moments can be played. {told}".strip())
    return Checked(recording.about, moments, seconds, longest)
