"""How a command ends: whatever happens to it becomes a sentence and a number, never a traceback.

0 all went well; 2 what was asked for cannot be; 130 and 143 stopped by SIGINT (Ctrl+C) and SIGTERM; 141 nobody reads on.
Loads nothing, so that it is there before anything that takes time.
"""

from __future__ import annotations

import contextlib
import errno
import os
import signal
import sys
import threading
from collections.abc import Callable
from types import FrameType
from typing import TextIO

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_FORBIDDEN = (errno.EACCES, errno.EPERM, errno.EROFS)
HELD_BACK_S = 0.05  # later the destructor is over
_told_to_stop: list[int] = []  # the signals, as they came


def ended(work: Callable[[], int]) -> int:
    """The exit code of `work`, once all that it printed is out."""
    try:
        code = work()
        if sys.stdout is not None:
            sys.stdout.flush()
    except BaseException as error:
        code = _code(error)
    for stream in (sys.stdout, sys.stderr):
        _settle(stream)
    return code


def obey_signals() -> None:
    """From now on SIGINT and SIGTERM end the program wherever it is, in `ended`.

    A library may take the exception for one of its own, or hold it back in a destructor: `ended` knows of the signal all the
    same, and what was held back is raised again.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:  # as nohup and shells want it of what runs in the background
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


def last_words() -> None:
    """The code is known and everything is written: nothing is left that a signal could interrupt."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)


def _leave(number: int, _frame: FrameType | None) -> None:
    _told_to_stop.append(number)
    raise KeyboardInterrupt


def _code(error: BaseException) -> int:
    """What it means for whoever called; raises what is none of ours."""
    if isinstance(error, KeyboardInterrupt) or _told_to_stop:
        _say("stopped")
        return 128 + (_told_to_stop[0] if _told_to_stop else signal.SIGINT)
    if isinstance(error, BrokenPipeError):
        return 128 + signal.SIGPIPE
    if isinstance(error, OSError):
        _say(_words(error))
    elif isinstance(error, ValueError):
        _say(str(error))
    else:
        raise error
    return 2


def _words(error: OSError) -> str:
    """Which file, what is the matter with it, and what to do."""
    number, reason = error.errno, error.strerror or str(error)
    if number in _FULL:
        return f"{error.filename or 'standard output'}: {reason}; make room, or choose another place"
    advice = "; choose a place where you may write" if number in _FORBIDDEN else ""
    return f"{error.filename}: {reason}{advice}" if error.filename else reason


def _say(words: str) -> None:
    with contextlib.suppress(OSError):  # there may be nobody to tell
        print(f"ratslam: {words}", file=sys.stderr)


def _settle(stream: TextIO | None) -> None:
    """What a full disk or a closed pipe did not take goes nowhere, or Python would complain about it in the end."""
    if stream is None:
        return
    try:
        stream.flush()
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
