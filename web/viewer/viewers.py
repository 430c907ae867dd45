"""A viewer for each look, so that every page is shown its own: two themes, each also with large letters for those who present.
All but the first are built when they are first needed."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future

from web.latest import Latest
from web.messages import Accepted, Command, Refused, Snapshot
from web.switches import Switches
from web.themes import Look, Theme
from web.viewer.viewer import Viewer


class Viewers:
    """May be used from any thread. A viewer that nobody looks at draws nothing."""

    def __init__(self, latest: Latest[Snapshot], submit: Callable[[Command], Future[Accepted | Refused]]) -> None:
        self._latest, self._submit = latest, submit
        self._lock = threading.Lock()
        self._built: dict[Look, Viewer] = {}
        self._started = self._stopped = False
        self.switches = Switches()  # one set for all pages, in all looks
        self.of("dark")  # at once: if viser is not available or cannot be guarded, that is said before the robot drives

    def of(self, theme: Theme, large: bool = False) -> Viewer:
        """The viewer in a look; takes a second when it has to be built. Raises ConnectionError after `stop`."""
        with self._lock:
            if self._stopped:
                raise ConnectionError("the viewers are closed")
            look = Look(theme, large)
            if look not in self._built:
                self._built[look] = self._build(look)
            return self._built[look]

    def start(self) -> None:
        with self._lock:
            self._started = True
            for viewer in self._built.values():
                viewer.start()

    def stop(self) -> None:
        """May be called twice."""
        with self._lock:
            self._stopped = True
            for viewer in self._built.values():
                viewer.stop()

    def _build(self, look: Look) -> Viewer:
        viewer = Viewer(self._latest, self._submit, self.switches, *look)
        if self._started:
            viewer.start()
        return viewer
