"""What steers a run tick by tick: a watched trial, a lesson, the replay of a situation, a wait for a condition."""

from __future__ import annotations


class Supervisor:
    """runs_ahead: the run is to go as fast as possible now. pause_requested: a one-shot pause, cleared when it is taken."""

    pause_requested = False

    @property
    def runs_ahead(self) -> bool:
        return False

    def before_tick(self) -> None:
        """The next tick is about to be run."""

    def after_tick(self) -> None:
        """A tick has been run: give the orders for the next one, and note what has happened."""

    def stop_running_ahead(self) -> None: ...

    def ordered(self, why: str) -> None:
        """A user has given the robot orders, which end those of the supervisor."""

    def alter(self) -> None:
        """A user has changed office or parameters: it goes on, but is no longer the run that was defined."""
