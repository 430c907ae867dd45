"""Foreign files are read by a process of their own, with limits of memory and computing time. [ours]

A file may be made so that reading it never ends or takes all memory: a view of SQLite without an end, a picture of billions
of pixels, a bomb of zeros. Only the process that reads it ends by that; the program says so in a sentence and goes on. It
can be called off, and it ends with whoever asked for it, however that ends. So does its temporary folder, where archives are
unpacked. test_reader_process.py.

The program sends requests, the reader answers each time with one thing: the description of the recording, a few
moments, or the sentence of a ValueError.
"""

from __future__ import annotations

import math
import os
import queue
import resource
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import NamedTuple, NoReturn, cast

from app.recordings.opening import Opening, files_of, open_recording
from app.recordings.recording import About, Moment, Recording, Wanted, every
from disk.limits import TICKS
from ratslam_live import command_of

AT_ONCE, BYTES_AT_ONCE = 64, 2_000_000  # moments in one answer, and bytes of their pictures
POLL_S = 0.1

Moments = tuple[list[Moment], About | None]  # the About: that was all


class Most(NamedTuple):
    """What reading may cost."""

    cpu_s: float = 10.0  # of computing for one answer ...
    cpu_s_a_byte: float = 2e-6  # ... and more for the first, which looks at all of the files
    memory: int = 1 << 30  # bytes of data
    moments: int = TICKS  # each is a tick of the run that plays it


class ReadRequest(NamedTuple):
    """What the program asks of the reader."""

    reading: int  # its number
    goal: int  # the number of the first moment from here on whose picture is wanted; those before come without
    all: bool  # every picture is wanted, and the recording is to report what is wrong with them
    over: tuple[int, ...]  # readings that are not needed any more


class ReaderProcess:
    """A recording that another process reads. To be used from several threads; what they ask for comes in turn."""

    def __init__(
        self,
        path: Path,
        opening: Opening | None = None,
        called_off: threading.Event | None = None,
        most: Most | None = None,
    ) -> None:
        """called_off: set by another thread to end the opening. ValueError: it cannot be played, or was called off."""
        self._name, self._most = path.name, most or Most()
        self._first = os.path.abspath(path), opening or Opening(), self._most
        self._lock = threading.Lock()
        self._begin()
        self.about = cast("About", self._ask(self._first, called_off))

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        """As every recording. ValueError: the reader was ended; the next reading begins with a new one."""
        with self._lock:
            if self._process.poll() is not None:
                self._begin()
                self.about = cast("About", self._ask(self._first))
            reader, number = self._process, cast("int", self._ask(None))
        following, over = 0, None
        try:
            while over is None:
                goal = next((n for n in range(following, following + AT_ONCE) if wanted(n)), following + AT_ONCE)
                with self._lock:
                    if self._process is not reader:
                        raise ValueError(f"{self._name}: it is not being read any more")
                    request = ReadRequest(number, goal, wanted is every, self._left())
                    moments, over = cast("Moments", self._ask(request))
                self.about = over or self.about
                following += len(moments)
                yield from moments
        finally:
            if self._process is reader:
                self._over.append(number)

    # ------------------------------------------------------------ inside

    def _begin(self) -> None:
        ours, theirs = socket.socketpair()
        folder = tempfile.mkdtemp(prefix="ratslam-reader-")
        with theirs:
            self._process = subprocess.Popen(
                command_of("app.recordings.reader_process", str(theirs.fileno()), folder), env={**os.environ, "TMPDIR": folder},
                stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                pass_fds=(theirs.fileno(),), process_group=0,
            )  # fmt: skip
        self._wire = Connection(ours.detach())
        # Readings that are over, sent with the next request: a generator may be closed at any moment, in any thread.
        self._over = list[int]()
        weakref.finalize(self, _end, self._process, self._wire, folder)

    def _left(self) -> tuple[int, ...]:
        over, self._over = tuple(self._over), []
        return over

    def _ask(self, request: object, called_off: threading.Event | None = None) -> object:
        """The answer to a request. ValueError: the reader's own, or that it has ended."""
        try:
            self._wire.send(request)
            while not self._wire.poll(POLL_S):
                if called_off is not None and called_off.is_set():
                    self._process.kill()
                    raise ValueError(f"{self._name}: opening it was called off")
            answer = self._wire.recv()
        except (OSError, EOFError):
            raise ValueError(f"{self._name}: {_why_ended(self._process, self._most)}") from None
        if isinstance(answer, ValueError):
            raise answer
        return answer


def _end(process: subprocess.Popen[bytes], wire: Connection, folder: str) -> None:
    wire.close()
    process.kill()
    process.wait()
    shutil.rmtree(folder, ignore_errors=True)


def _why_ended(process: subprocess.Popen[bytes], most: Most) -> str:
    code = process.wait()
    if code == -signal.SIGXCPU:
        return f"more than {most.cpu_s:g} s of computing for what it holds, without an end; no recording needs so much"
    return (
        f"the process that read it has ended (code {code}): too little memory, or a broken file that breaks its reader"
    )


# ------------------------------------------------------------ the reader


def main(descriptor: int, folder: str) -> NoReturn:
    """Answer what comes, until the other end is closed. folder: its temporary one."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    wire, requests = Connection(descriptor), queue.SimpleQueue[object]()
    threading.Thread(target=_listen, args=(wire, requests, folder), daemon=True).start()
    path, opening, most = cast("tuple[str, Opening, Most]", requests.get())
    resource.setrlimit(resource.RLIMIT_DATA, (most.memory, most.memory))
    reader = _Reader(Path(path), opening, most)
    wire.send(_answer(path, reader.opened))
    while True:
        wire.send(_answer(path, partial(reader.to, requests.get())))


def _listen(wire: Connection, requests: queue.SimpleQueue[object], folder: str) -> None:
    """By a thread of its own, so that a reading without an end does not outlive who asked for it."""
    try:
        while True:
            requests.put(wire.recv())
    except (OSError, EOFError):
        shutil.rmtree(folder, ignore_errors=True)  # whoever asked may have been killed
        os._exit(0)


def _answer(path: str, do: Callable[[], object]) -> object:
    """What comes of it, or the sentence why nothing does: whatever a library makes of a broken file."""
    try:
        return do()
    except ValueError as error:
        return ValueError(str(error))
    except MemoryError:
        return ValueError(f"{Path(path).name}: reading it takes more memory than a recording may")
    except Exception as error:
        return ValueError(f"{Path(path).name}: cannot be read: {type(error).__name__}: {error}")


class _Reader:
    """One recording, and the places at which it is being read."""

    def __init__(self, path: Path, opening: Opening, most: Most) -> None:
        self._path, self._opening, self._most = path, opening, most
        self._recording: Recording
        self._readings = list[_Reading | None]()

    def opened(self) -> About:
        size = sum(file.stat().st_size for file in files_of(self._path)) if self._path.exists() else 0
        _allow(self._most.cpu_s + size * self._most.cpu_s_a_byte)
        self._recording = open_recording(self._path, self._opening)
        return self._recording.about

    def to(self, request: object) -> int | Moments:
        """request: None begins a reading, whose number is the answer."""
        _allow(self._most.cpu_s)
        if not isinstance(request, ReadRequest):
            self._readings.append(_Reading(self._recording, self._most.moments))
            return len(self._readings) - 1
        for number in request.over:
            self._readings[number] = None
        reading = self._readings[request.reading]
        assert reading is not None
        moments = reading.next(request)
        return moments, None if moments else self._recording.about


class _Reading:
    """A place at which a recording is being read."""

    def __init__(self, recording: Recording, most: int) -> None:
        self._recording, self._most = recording, most
        self._goal = self._following = 0  # the first picture that is wanted, the number of the moment that comes next
        self._moments: Iterator[Moment] | None = None

    def next(self, request: ReadRequest) -> list[Moment]:
        """A few moments. None of them: that was all."""
        self._goal = request.goal
        if self._moments is None:
            self._moments = self._recording.moments(every if request.all else lambda number: number >= self._goal)
        found, size = list[Moment](), 0
        for moment in self._moments:
            found.append(moment)
            size += 0 if moment.image is None else moment.image.nbytes
            self._following += 1
            if self._following > self._most:
                raise ValueError(
                    f"{self._recording.about.name} has more than {self._most:,} moments; play a part of it"
                )
            if len(found) == AT_ONCE or size > BYTES_AT_ONCE or (self._following > request.goal and not request.all):
                break
        return found


def _allow(seconds: float) -> None:
    """So much computing from now on. Who takes more is ended by the system, even within a library."""
    limit = math.ceil(time.process_time() + seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))


if __name__ == "__main__":  # in the reader's process; what comes and goes there is of the module by its own name
    from app.recordings.reader_process import main as answer

    answer(int(sys.argv[1]), sys.argv[2])
