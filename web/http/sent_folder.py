"""A folder that is on its way from a page to the server, file by file: its files lie where they lay, and nowhere else."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
from collections.abc import Generator
from pathlib import Path

from web.http.commands import Declined, Malformed, wrong
from web.http.security import MAX_RECORDING_BYTES

MOST_FILES, DEEPEST = 100_000, 8
LONGEST = 200  # bytes of a name; most disks take 255


class Room:
    """Bytes that a recording may still have."""

    def __init__(self, most: int) -> None:
        self.most = self.left = most

    def take(self, size: int) -> None:
        """Declined when there are not so many."""
        if size > self.left:
            raise Declined.of(413, f"a recording may have at most {self.most} bytes")
        self.left -= size


class SentFolder:
    """One transfer. The folder is made at once; whoever asked for it deletes it (`forget`) or takes it over (`home`)."""

    def __init__(self, token: str, name: str) -> None:
        """name: of the folder, as the page tells it."""
        self.token = token
        with kept():
            self.home = tempfile.mkdtemp(prefix="ratslam-recording-")
        self.path = Path(self.home) / plain(name)
        try:
            with kept():
                self.path.mkdir()
        except Declined:
            self.forget()
            raise
        self.room = Room(MAX_RECORDING_BYTES)
        self._files = 0

    def place(self, name: str) -> Path:
        """Where a file of this name belongs, its folder made. Malformed: it would lie elsewhere, or there are too many."""
        parts = name.replace("\\", "/").split("/")
        if not all(map(is_plain, parts)) or len(parts) > DEEPEST:
            reason = f"a file's name in a folder must be up to {DEEPEST} plain names of at most {LONGEST} bytes with / between"
            raise Malformed([wrong("name", name[:80], reason)])
        self._files += 1
        if self._files > MOST_FILES:
            raise Malformed([wrong("name", name[:80], f"a folder with more than {MOST_FILES} files")])
        path = self.path.joinpath(*parts)
        try:
            with kept():
                path.parent.mkdir(parents=True, exist_ok=True)
        except (FileExistsError, NotADirectoryError):
            raise Malformed(
                [wrong("name", name[:80], "a file of this folder has the name of one of its folders")]
            ) from None
        if path.is_dir():
            raise Malformed([wrong("name", name[:80], "a folder of this folder has this name")])
        return path

    def forget(self) -> None:
        shutil.rmtree(self.home, ignore_errors=True)


def is_plain(name: str) -> bool:
    """Whether this can be the name of a file or a folder on any disk."""
    return name.strip(". ") != "" and name.isprintable() and len(name.encode(errors="replace")) <= LONGEST


def plain(name: str) -> str:
    """The bare name in what a browser calls a file, without folders and control characters; of a long one the end, which tells
    the format."""
    bare = "".join(c for c in name.replace("\\", "/").rpartition("/")[2] if c.isprintable())
    while len(bare.encode(errors="replace")) > LONGEST:
        bare = bare[1:]
    return bare if is_plain(bare) else "recording"


@contextlib.contextmanager
def kept() -> Generator[None]:
    """What is written here is kept, or Declined says why not. Names that are taken are for the caller."""
    try:
        yield
    except (FileExistsError, NotADirectoryError):
        raise
    except OSError as error:
        raise Declined.of(507, f"the recording cannot be kept: {error.strerror or error}") from None
