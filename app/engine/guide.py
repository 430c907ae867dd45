"""Who leads a run, tick by tick: a trial that is watched, a lesson, a situation that is played, a wait for something."""

from __future__ import annotations


class Guide:
    """runs_ahead: the run is to go as fast as possible now. pauses: it has come to something that is to be seen in peace."""

    pauses = False

    @property
    def runs_ahead(self) -> bool:
        return False

    def before_tick(self) -> None:
        """The run goes on."""

    def advance(self) -> None:
        """A tick has been run: give the robot its orders for the next one, and note what has happened."""

    def stop_running_ahead(self) -> None: ...

    def ordered(self, why: str) -> None:
        """Somebody has given the robot orders: it has one master only."""

    def alter(self) -> None:
        """Somebody has changed office or parameters: it goes on, but is no longer what it was."""
