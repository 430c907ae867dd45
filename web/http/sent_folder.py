"""A folder that is on its way from a page to the server, file by file: its files lie where they lay, and nowhere else."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from web.http.commands import Declined, Malformed, wrong
from web.http.security import MAX_RECORDING_BYTES

MOST_FILES, DEEPEST, LONGEST = 100_000, 8, 200


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
        self.home = tempfile.mkdtemp(prefix="ratslam-recording-")
        self.path = Path(self.home) / plain(name)
        self.path.mkdir()
        self.room = Room(MAX_RECORDING_BYTES)
        self._files = 0

    def place(self, name: str) -> Path:
        """Where a file of this name belongs, its folder made. Malformed: it would lie elsewhere, or there are too many."""
        parts = name.replace("\\", "/").split("/")
        odd = any(part in ("", ".", "..") or len(part) > LONGEST or not part.isprintable() for part in parts)
        if odd or len(parts) > DEEPEST:
            reason = f"a file's name in a folder must be up to {DEEPEST} plain names with / between them"
            raise Malformed([wrong("name", name[:80], reason)])
        self._files += 1
        if self._files > MOST_FILES:
            raise Malformed([wrong("name", name[:80], f"a folder with more than {MOST_FILES} files")])
        path = self.path.joinpath(*parts)
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def forget(self) -> None:
        shutil.rmtree(self.home, ignore_errors=True)


def plain(name: str) -> str:
    """The bare name in what a browser calls a file, without folders and control characters."""
    bare = "".join(c for c in name.replace("\\", "/").rpartition("/")[2] if c.isprintable())
    return bare if bare.strip(". ") else "recording"
