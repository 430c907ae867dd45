"""The second brains that the page offers: those that would differ from the first, and each with one addition the other way."""

from __future__ import annotations

from collections.abc import Iterator

from app.config import Config
from app.config.pairs import pairs_beside, without
from ratslam_core.params.additions import ADDITIONS
from web.messages import AdditionsOff, PairChoice


class PairChoices:
    """Made anew only when a config has changed."""

    def __init__(self) -> None:
        self._configs: tuple[Config, Config] | None = None
        self._choices: tuple[tuple[PairChoice, ...], AdditionsOff] = (), AdditionsOff()

    def of(self, beginning: Config, now: Config) -> tuple[tuple[PairChoice, ...], AdditionsOff]:
        """beginning: the config with which the run would begin anew; now: that with which it runs."""
        before = self._configs
        if before is None or before[0] is not beginning or before[1] is not now:
            self._configs = beginning, now
            self._choices = tuple(_choices(beginning, now)), AdditionsOff(_off(beginning), _off(now))
        return self._choices


def _choices(beginning: Config, now: Config) -> Iterator[PairChoice]:
    for pair in pairs_beside(beginning):
        yield PairChoice(pair.name, pair.title, pair.about, "beginning")
    live = {dotted for dotted, item, _ in now.items() if item.metadata["live"]}
    for pair in pairs_beside(now):
        if pair.values.keys() <= live:
            yield PairChoice(pair.name, pair.title, pair.about, "now")


def _off(config: Config) -> tuple[str, ...]:
    return tuple(addition.name for addition in ADDITIONS if without(addition, config))
