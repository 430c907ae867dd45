"""The real program as a subprocess, and its API as a person with curl would use it."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable
from typing import Any

import orjson

START = "from app.cli import main; raise SystemExit(main())"


class Program:
    """`ratslam run` with these arguments, alive when the constructor returns."""

    def __init__(self, *arguments: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", START, "run", "--no-browser", *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        assert self.process.stdout is not None
        said = []
        for line in self.process.stdout:
            said.append(line)
            found = re.search(r"alive at (http://\S+:(\d+)/)", line)
            if found:
                self.url, self.port = found[1], int(found[2])
                return
        raise RuntimeError("".join(said))

    def stop(self) -> int:
        """SIGINT, as Ctrl+C; the exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        try:
            self.process.communicate(timeout=10)
        finally:
            self.process.kill()
        return self.process.returncode

    def state(self, full: bool = False) -> dict[str, Any]:
        with urllib.request.urlopen(f"{self.url}api/state" + ("?map=1" if full else ""), timeout=10) as answer:
            return orjson.loads(answer.read())

    def command(self, kind: str, **fields: Any) -> dict[str, Any]:
        body = orjson.dumps({"type": kind, **fields})
        request = urllib.request.Request(f"{self.url}api/commands", body, {"Content-Type": "application/json"})
        with urllib.request.urlopen(request, timeout=10) as answer:
            return orjson.loads(answer.read())

    def wait(self, condition: Callable[[dict[str, Any]], bool], timeout_s: float) -> dict[str, Any]:
        """The first state for which `condition` holds."""
        deadline = time.monotonic() + timeout_s
        while not condition(state := self.state()):
            if time.monotonic() > deadline:
                raise AssertionError(f"not within {timeout_s} s; the last state was {state}")
            time.sleep(0.05)
        return state
