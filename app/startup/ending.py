"""How a command ends: expected failures become a sentence and an exit code, not a traceback.

0: all went well. 2: the request cannot be carried out. 130 and 143: stopped by SIGINT (Ctrl+C) or SIGTERM. 141: the
reader of a pipe has gone. This module imports nothing heavy, so that it is in place before anything that takes time.
"""

from __future__ import annotations

import contextlib
import errno
import os
import signal
import stat
import sys
import threading
from collections.abc import Callable
from io import TextIOWrapper
from types import FrameType, TracebackType
from typing import TextIO, cast

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_FORBIDDEN = (errno.EACCES, errno.EPERM, errno.EROFS)
HELD_BACK_S = 0.05  # after this time the destructor that swallowed the exception is over
_told_to_stop: list[int] = []  # the signals received, in order


def ended(work: Callable[[], int]) -> int:
    """Do `work` and return its exit code, after everything it printed has been written."""
    try:
        code = work()
        if sys.stdout is not None:
            sys.stdout.flush()
    except BaseException as error:
        code = _code(error)
    for stream in (sys.stdout, sys.stderr):
        _settle(stream)
    return code


def command(work: Callable[[], int]) -> int:
    """The whole life of a command: obey signals, do `work`, and return the exit code, which nothing changes any more."""
    obey_signals()
    ready_to_print()
    code = ended(work)
    last_words()
    return code


def end_in_words() -> None:
    """For a module that is run by itself (`python -m`): whatever ends it, also while it is being imported, ends it as in
    `ended`."""
    obey_signals()
    ready_to_print()
    usual = sys.excepthook

    def hook(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        def again() -> int:
            raise error.with_traceback(trace)

        try:
            code = ended(again)
        except BaseException:
            usual(kind, error, trace)
            code = 1
        last_words()
        raise SystemExit(code)

    sys.excepthook = hook


def obey_signals() -> None:
    """From now on SIGINT and SIGTERM raise KeyboardInterrupt wherever the program is, and `ended` turns that into an
    exit code.

    A library may catch the exception as one of its own, or Python may swallow it in a destructor. The signal is
    therefore recorded for `ended`, and a swallowed one is sent again.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:  # nohup and shells have background jobs ignore it
            signal.signal(number, _leave)
    usual = sys.unraisablehook

    def held_back(what: sys.UnraisableHookArgs) -> None:
        if isinstance(what.exc_value, KeyboardInterrupt) and _told_to_stop:
            again = threading.Timer(HELD_BACK_S, os.kill, (os.getpid(), _told_to_stop[-1]))
            again.daemon = True
            again.start()
        else:
            usual(what)

    sys.unraisablehook = held_back


def ready_to_print() -> None:
    """From now on printing cannot fail for a letter or a missing stream, and so cannot undo what was done before it.

    A letter that the terminal lacks becomes `?`. A file is UTF-8, as whoever reads it again expects. A stream that was closed
    (`>&-`) goes nowhere: the next file that is opened would have its number, and get what is printed.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
    sys.stdout = sys.stdout or open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stderr = sys.stderr or open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    printed: object = sys.stdout
    if isinstance(printed, TextIOWrapper):
        file = stat.S_ISREG(os.fstat(1).st_mode)
        cast("TextIOWrapper", printed).reconfigure(errors="replace", encoding="utf-8" if file else None)


def last_words() -> None:
    """Ignore signals from now on: the exit code is known and everything is written."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)


def _leave(number: int, _frame: FrameType | None) -> None:
    _told_to_stop.append(number)
    raise KeyboardInterrupt


def _code(error: BaseException) -> int:
    """The exit code for an exception, after a sentence about it. Raises it again if it is not an expected failure."""
    if isinstance(error, KeyboardInterrupt) or _told_to_stop:
        _say("stopped")
        return 128 + (_told_to_stop[0] if _told_to_stop else signal.SIGINT)
    if isinstance(error, BrokenPipeError):
        return 128 + signal.SIGPIPE
    if isinstance(error, OSError):
        _say(_words(error))
    elif isinstance(error, ImportError):
        _say(
            f"a part of the program cannot be loaded: {error}; `make setup` installs what is missing into {sys.prefix}"
        )
    elif isinstance(error, ValueError):
        _say(str(error))
    else:
        raise error
    return 2


def _words(error: OSError) -> str:
    """The file, the reason and what to do about it."""
    number, reason = error.errno, error.strerror or str(error)
    if number in _FULL:
        return f"{error.filename or 'standard output'}: {reason}; make room, or choose another place"
    advice = "; choose a place where you may write" if number in _FORBIDDEN else ""
    return f"{error.filename}: {reason}{advice}" if error.filename else reason


def _say(words: str) -> None:
    from disk.words import shown

    with contextlib.suppress(OSError):  # there may be nobody to tell
        print(shown(f"ratslam: {words}"), file=sys.stderr)


def _settle(stream: TextIO | None) -> None:
    """Discard what a full disk or a closed pipe did not accept; Python would complain about it at exit."""
    if stream is None:
        return
    try:
        stream.flush()
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
