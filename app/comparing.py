"""The orders that begin and end a second brain beside the first of a session. [ours]"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from app.companion import SECTIONS, Companion, Heard
from app.config import Config, Value
from app.evaluation import Evaluation
from app.order_book import Order, order
from app.recordings.scan_ties import ScanTies
from disk import copy_state
from disk.words import one_line
from ratslam_core import Estimate, RatSlam
from sim2d import Truth

LONGEST_NAME = 40


class Comparing:
    """What a session needs to have a companion."""

    config: Config
    brain: RatSlam
    evaluation: Evaluation
    estimate: Estimate
    heard: Heard  # what the brain was given in its last step
    companion: Companion | None = (
        None  # an attribute of those sessions only that have one: states of others are as ever
    )
    on_order: Callable[[Order], object]
    under_orders: bool

    @property
    def tick_count(self) -> int:
        raise NotImplementedError

    @property
    def time_s(self) -> float:
        raise NotImplementedError

    @property
    def truth(self) -> Truth | None:
        raise NotImplementedError

    def new_brain(self, config: Config) -> RatSlam:
        """One that knows nothing, as a session of this seed would make it."""
        raise NotImplementedError

    def new_ties(self) -> ScanTies | None:
        """What ties the experiences of a new brain; None: nothing, since there is no laser."""
        return None

    @property
    def ties(self) -> ScanTies | None:
        """The same of the first brain."""
        return None

    @order
    def begin_companion(self, first: str, name: str, values: Mapping[str, Value], anew: bool) -> None:
        """Give a second brain the same senses from now on. It replaces one that there is.

        first, name: what the two are called. values: the parameters that make the difference; all others are those of the
        first, now and later. anew: it knows nothing, which is possible before the first tick only; otherwise it begins as
        a copy of the first.
        """
        names = first.strip(), name.strip()
        for given in names:
            if not 0 < len(one_line(given)) <= LONGEST_NAME:
                raise ValueError(
                    f"a brain that is compared needs a name of 1 to {LONGEST_NAME} characters, got {given!r}"
                )
        config = config_beside(self.config, values)
        self.companion = self._anew(names, values, config) if anew else self._copy(names, values, config)

    @order
    def end_companion(self) -> None:
        if self.companion is None:
            raise ValueError("there is no second brain to be ended")
        del self.companion

    def _anew(self, names: tuple[str, str], values: Mapping[str, Value], config: Config) -> Companion:
        if self.tick_count > 0:
            raise ValueError("a new brain begins together with the run: restart it, or compare with a copy from now on")
        companion = Companion(names, dict(values), config, self.new_brain(config), Evaluation(), self.time_s)
        companion.ties = self.new_ties()
        companion.follow(self.heard, self.time_s, 0, self.truth, self.brain, self.estimate)
        return companion

    def _copy(self, names: tuple[str, str], values: Mapping[str, Value], config: Config) -> Companion:
        fixed = [
            dotted
            for (dotted, item, old), (_, _, new) in zip(self.config.items(), config.items(), strict=True)
            if old != new and not item.metadata["live"]
        ]
        if fixed:
            raise ValueError(
                f"{', '.join(fixed)} cannot change while a brain runs: compare from the beginning of a run"
            )
        brain = copy_state(self.brain)
        companion = Companion(names, dict(values), self.config, brain, copy_state(self.evaluation), self.time_s)
        companion.counterpart = list(range(len(brain.experience_map)))
        companion.estimate, companion.ties = self.estimate, copy_state(self.ties)
        companion.change(self.config, config)
        return companion


def config_beside(config: Config, values: Mapping[str, Value]) -> Config:
    """All parameters of a second brain that differs from the first in these. ValueError: it cannot differ in them."""
    foreign = [dotted for dotted in values if dotted.split(".")[0] not in SECTIONS]
    if foreign:
        raise ValueError(f"{foreign[0]} cannot differ between two brains: they have one robot, office and pilot")
    return config.with_values(values)
