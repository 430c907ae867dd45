"""The ticks of a run without a server, and what is kept of them for its report."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from app.headless.brain_file import BrainFile
from app.headless.growth import Growth
from app.headless.uncertainty import Uncertainty
from app.session import Session

LOOK_AFTER = 600  # ticks between two checks of the brain's size
TELL_AFTER = 10  # ticks between two calls of `progress`

Progress = Callable[[float, str], None]  # simulated seconds since the last call, what is being done


def silent(_simulated_s: float, _what: str) -> None:
    """Progress that nobody follows."""


class Loop:
    """Ticks a session."""

    def __init__(self, session: Session, progress: Progress = silent, brain_file: BrainFile | None = None) -> None:
        """brain_file: is shown the brain now and then."""
        self.session, self._progress, self._brain_file = session, progress, brain_file
        self.growth, self.uncertainty = Growth(session), Uncertainty()

    def tick(self, what: str) -> None:
        """One tick. what: is being done, in words."""
        session = self.session
        session.tick()
        self.growth.note(session)
        self.uncertainty.note(session)
        if session.tick_count % TELL_AFTER == 0:
            self._progress(TELL_AFTER * session.frame.dt, what)
        if self._brain_file is not None and session.tick_count % LOOK_AFTER == 0:
            self._brain_file.look(session.brain)

    def explore(self, minutes: float, kidnap_at_s: Sequence[float] = ()) -> None:
        """Explore for so many simulated minutes. kidnap_at_s: simulated times (s) at which the robot is kidnapped."""
        session, kidnaps = self.session, sorted(kidnap_at_s)
        for _ in range(round(minutes * 60 / session.frame.dt)):
            while kidnaps and session.time_s >= kidnaps[0] - 1e-9:
                session.kidnap()
                kidnaps.pop(0)
            self.tick("exploring")
