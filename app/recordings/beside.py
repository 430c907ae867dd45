"""A recording that was found within something larger: what else lies there is told of, and an archive's folder goes with it."""

from __future__ import annotations

import shutil
import weakref
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from app.recordings.recording import About, Moment, Recording, Wanted, every


class Within:
    """The same recording under the name of what it was found in."""

    def __init__(self, recording: Recording, name: str, unused: tuple[str, ...] = ()) -> None:
        self._recording, self._name, self._more = recording, name, unused

    @property
    def about(self) -> About:
        about = self._recording.about
        return replace(about, name=self._name, unused=(*about.unused, *self._more))

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        return self._recording.moments(wanted)


class Unpacked(Within):
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
