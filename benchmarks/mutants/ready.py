"""A Python in which what the tests import of others is loaded already: each run of pytest is a fork of it.

    python ready.py        # in a tree; reads a list of pytest's arguments a line, answers each with its exit status

Loading takes a second and a half, which is most of what a mutant costs. Nothing of the tree itself is loaded: it differs.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import signal
import sys
import time

OTHERS = (
    "_hypothesis_pytestplugin", "cv2", "fastapi.testclient", "hypothesis.extra.numpy", "matplotlib.figure", "msgspec",
    "numba", "orjson", "PIL.Image", "psutil", "pydantic", "pymunk", "pytest_cov", "pytest_timeout", "rich", "scipy.sparse.linalg",
    "uvicorn", "viser", "xdist",
)  # fmt: skip
QUIET = ("-W", "ignore::pytest.PytestAssertRewriteWarning")  # of plugins that are loaded before pytest begins
CUT_OFF = 124  # as by timeout(1)


def main() -> None:
    sys.path[0] = os.getcwd()
    for name in OTHERS:
        importlib.import_module(name)
    for line in sys.stdin:
        seconds, arguments = json.loads(line)
        print(_status(seconds, arguments), flush=True)


def _status(seconds: float, arguments: list[str]) -> int:
    child = os.fork()
    if not child:
        _test(arguments)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            _end(child)
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    _end(child)
    os.waitpid(child, 0)
    return CUT_OFF


def _end(child: int) -> None:
    """It and what it has started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)


def _test(arguments: list[str]) -> None:
    """Never returns. What it starts ends with it: they are one group."""
    os.setpgid(0, 0)
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nothing, stream)
    import pytest

    code = 1
    try:
        code = int(pytest.main([*QUIET, *arguments]))
    finally:
        os._exit(code)


if __name__ == "__main__":
    main()
