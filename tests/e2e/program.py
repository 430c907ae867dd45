"""The real program as a subprocess, and its API as a person with curl would use it."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from typing import Any

import orjson

from tests.patience import PATIENCE_S

# The engine may take longer to answer than a person would wait: it compiles itself, perhaps on a busy machine.
START = (
    f"import web.http.asking; web.http.asking.ANSWER_TIMEOUT_S = {PATIENCE_S}; "
    "from app.__main__ import main; raise SystemExit(main())"
)


class Program:
    """`ratslam run` with these arguments, alive when the constructor returns."""

    def __init__(self, *arguments: str, start: str = START, **environment: str) -> None:
        self._runs = tempfile.TemporaryDirectory()  # where the program keeps them; removed afterwards
        self.process = subprocess.Popen(
            [sys.executable, "-c", start, "run", "--no-browser", *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1", "RATSLAM_RUNS": self._runs.name, **environment},
        )
        self.said: list[str] = []
        self.begun = ""  # what its session was when it began, as a hash
        try:
            self._begin()
        except BaseException:  # nobody else could stop it, after Ctrl+C neither
            self.process.kill()
            self.process.wait()
            self._runs.cleanup()
            raise

    def _begin(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.said.append(line)
            found = re.search(r"alive at (http://\S+:(\d+)/)", line)
            if found:
                self.url, self.port = found[1], int(found[2])
                self._listener = threading.Thread(target=self.said.extend, args=(self.process.stdout,), daemon=True)
                self._listener.start()  # so that the program never waits for a full pipe
                self._awake()
                return
        raise RuntimeError("".join(self.said))

    def _awake(self) -> None:
        """Wait for the first tick. At a first start the page is there long before it."""
        deadline = time.monotonic() + PATIENCE_S
        while True:
            try:
                with urllib.request.urlopen(f"{self.url}healthz", timeout=PATIENCE_S):
                    return
            except urllib.error.HTTPError:  # 503: it is starting
                if time.monotonic() > deadline:
                    raise
            time.sleep(0.05)

    def stop(self) -> int:
        """SIGINT, as Ctrl+C; the exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        try:
            self.process.wait(timeout=PATIENCE_S)
        finally:
            self.process.kill()
            self._listener.join()
            self._runs.cleanup()
        if self.process.returncode:
            print("".join(self.said[-40:]))  # pytest shows it beside the code that is not 0
        return self.process.returncode

    def state(self, full: bool = False) -> dict[str, Any]:
        with urllib.request.urlopen(f"{self.url}api/state" + ("?map=1" if full else ""), timeout=PATIENCE_S) as answer:
            return orjson.loads(answer.read())

    def places(self) -> dict[str, Any]:
        with urllib.request.urlopen(f"{self.url}api/places", timeout=PATIENCE_S) as answer:
            return orjson.loads(answer.read())

    def command(self, kind: str, **fields: Any) -> dict[str, Any]:
        return self.post("commands", {"type": kind, **fields})

    def post(self, route: str, body: dict[str, Any]) -> dict[str, Any]:
        where, json = f"{self.url}api/{route}", {"Content-Type": "application/json"}
        request = urllib.request.Request(where, orjson.dumps(body), json)
        while True:
            try:
                with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
                    return orjson.loads(answer.read())
            except urllib.error.HTTPError as error:
                if error.code != 429:
                    raise
                time.sleep(0.1)  # "wait a moment and send it again"

    def wait(self, condition: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """The first state for which `condition` holds."""
        end = time.monotonic() + PATIENCE_S
        while not condition(state := self.state()):
            assert time.monotonic() < end, f"not within {PATIENCE_S:g} s; the last state was {state}"
            time.sleep(0.05)
        return state
