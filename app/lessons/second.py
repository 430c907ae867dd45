"""The second brain of a lesson that compares two: how it begins, and what is measured of it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from app.config.pairs import Pair
from app.lessons.findings import Values

if TYPE_CHECKING:
    from app.companion import Companion
    from app.session import Session
    from app.views.history import History
    from ratslam_core import RatSlam


OF_SECOND = (
    "error_m", "error_before_m", "off_m", "off_most_m", "astray_m", "views", "views_new", "experiences", "experiences_new",
)  # fmt: skip


def begin_second(pair: Pair, session: Session, history: History, *, anew: bool) -> None:
    """From now on it hears what the first hears. anew: both begin; otherwise it is a copy. ValueError says why it cannot."""
    session.begin_companion(pair.first, pair.second, pair.values, anew)
    history.watch_companion()
    history.log.note("brain", f"two brains on the same senses: {pair.first} and {pair.second}")


class SecondNotes:
    """Made when the showing begins; call `note` after each tick of it."""

    def __init__(self, session: Session) -> None:
        self._session, self._off_most = session, 0.0
        brain, evaluation = self._companion.brain, self._companion.evaluation
        self._map_in_office = evaluation.map_in_office(brain.experience_map)
        self._error_m, self._known = evaluation.errors(brain.experience_map)[0], _size(brain)

    def note(self) -> None:
        """ValueError: somebody has ended the comparison."""
        off = self._off()
        self._off_most = self._off_most if math.isnan(off) else max(self._off_most, off)

    def values(self) -> Values:
        """All of OF_SECOND, with the meanings of units.MEASURED."""
        truth, companion = self._session.simulator.truth, self._companion
        map_, size = companion.brain.experience_map, _size(companion.brain)
        believed = self._map_in_office.compose(map_.robot)
        return {
            "error_m": companion.evaluation.errors(map_)[0],
            "error_before_m": self._error_m,
            "off_m": self._off(),
            "off_most_m": self._off_most,
            "astray_m": math.dist((truth.x, truth.y), (believed.x, believed.y)),
            "views": float(size[0]),
            "views_new": float(size[0] - self._known[0]),
            "experiences": float(size[1]),
            "experiences_new": float(size[1] - self._known[1]),
        }

    def _off(self) -> float:
        companion = self._companion
        return companion.evaluation.belief_off(self._session.simulator.truth, companion.brain.experience_map)[0]

    @property
    def _companion(self) -> Companion:
        companion = self._session.companion
        if companion is None:
            raise ValueError("the second brain is no longer there")
        return companion


def _size(brain: RatSlam) -> tuple[int, int]:
    return len(brain.local_view), len(brain.experience_map)
