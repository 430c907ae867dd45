"""A viewer for each theme, so that every page is shown its own. The second is built when it is first needed."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future

from web.latest import Latest
from web.messages import Accepted, Command, Refused, Snapshot
from web.switches import Switches
from web.themes import Theme
from web.viewer.viewer import Viewer


class Viewers:
    """May be used from any thread. A viewer that nobody looks at draws nothing."""

    def __init__(self, latest: Latest[Snapshot], submit: Callable[[Command], Future[Accepted | Refused]]) -> None:
        self._latest, self._submit = latest, submit
        self._lock = threading.Lock()
        self._built: dict[Theme, Viewer] = {}
        self._started = self._stopped = False
        self.switches = Switches()  # one set for all pages, in both themes
        self.of("dark")  # at once: if viser is not available or cannot be guarded, that is said before the robot drives

    def of(self, theme: Theme) -> Viewer:
        """The viewer in a theme; takes a second when it has to be built. Raises ConnectionError after `stop`."""
        with self._lock:
            if self._stopped:
                raise ConnectionError("the viewers are closed")
            if theme not in self._built:
                self._built[theme] = self._build(theme)
            return self._built[theme]

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

    def _build(self, theme: Theme) -> Viewer:
        viewer = Viewer(self._latest, self._submit, self.switches, theme)
        if self._started:
            viewer.start()
        return viewer
