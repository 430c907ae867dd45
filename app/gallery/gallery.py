"""The gallery: the catalogue's experiments, with figures and trials from the user's folder where there are some."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import TypeVar

from app.experiments.results import published_cells
from app.experiments.store import Store, default_path
from app.experiments.summary import CellSummary
from app.gallery.plan import plan_of
from app.gallery.results import results_of
from app.trials.chosen import first_levels
from app.trials.code_version import code_version
from app.trials.experiment import Experiment, catalogue
from sim2d import World
from sim2d.importers import open_world
from web.http.experiments import Axis, Card, Detail

_T = TypeVar("_T")
PICTURES = Path(__file__).parents[2] / "docs" / "pictures" / "experiments"  # those that come with the program
FIGURES = "figures"  # the folder beside the store for those that are drawn here


class StoredGallery:
    """Reads the catalogue and the store anew each time, so that what another program writes is seen."""

    def __init__(self, store: Path | None = None, pictures: Path = PICTURES) -> None:
        self._store, self._pictures = store, pictures

    def cards(self) -> list[Card]:
        code_version()  # takes a second the first time: better here than when somebody presses "Watch it"
        counts: dict[str, int] = {}
        with contextlib.suppress(ValueError):  # each experiment says what is wrong with the store
            counts = self._read(lambda store: store.counts()) or {}
        return [self._card(experiment, counts.get(experiment.name, 0)) for experiment in catalogue()]

    def detail(self, name: str) -> Detail | None:
        experiment = _experiments().get(name)
        if experiment is None:
            return None
        why = ""
        try:
            trials = self._read(lambda store: store.of_experiment(name)) or []
        except ValueError as error:
            trials, why = [], str(error)
        done = sum(not trial.error for trial in trials)
        results = results_of(experiment, trials, _published(name))
        if why:
            results.note = f"The trials that were run here cannot be shown: {why}. {results.note}".strip()
        return Detail(card=self._card(experiment, done), results=results)

    def picture(self, name: str) -> Path | None:
        """The newest figure drawn here, the first of its experiment; else the one that comes with the program."""
        if name not in _experiments():
            return None
        drawn: list[Path] = []
        with contextlib.suppress(ValueError):  # there is no home, and so none drawn
            drawn = [*self._folder.glob(f"{name}-1-*.svg"), *self._folder.glob(f"{name}-1-*.png")]
        if drawn:
            return max(drawn, key=lambda path: (path.stat().st_mtime, path.suffix))
        shipped = [self._pictures / f"{name}{suffix}" for suffix in (".svg", ".png")]
        return next((path for path in shipped if path.is_file()), None)

    @property
    def _path(self) -> Path:
        return self._store or default_path()

    @property
    def _folder(self) -> Path:
        return self._path.parent / FIGURES

    def _read(self, question: Callable[[Store], _T]) -> _T | None:
        """The store's answer; None if nothing was run yet, and then no file is made. ValueError says why it cannot be read."""
        if not self._has_store():
            return None
        with Store(self._path, reading=True) as store:
            return question(store)

    def _has_store(self) -> bool:
        with contextlib.suppress(ValueError):  # there is no home, and so no store
            return self._path.is_file()
        return False

    def _card(self, experiment: Experiment, done: int) -> Card:
        world = _world(experiment.world)
        picture = self.picture(experiment.name)
        return Card(
            name=experiment.name,
            title=experiment.title,
            paper=experiment.paper,
            asks=experiment.asks,
            found=experiment.found,
            world=world.title,
            engines=list(experiment.engines),
            axes=[Axis(name=axis.name, levels=[level.label for level in axis.levels]) for axis in experiment.axes],
            watch=list(first_levels(experiment)),
            seed=experiment.seed,
            trials=experiment.trials,
            seconds=experiment.seconds(),
            done=done,
            picture=None if picture is None else f"/api/experiments/{experiment.name}/picture",
            plan=plan_of(experiment, world),
        )


def _experiments() -> dict[str, Experiment]:
    return {experiment.name: experiment for experiment in catalogue()}


def _published(name: str) -> list[CellSummary]:
    with contextlib.suppress(ValueError):  # an installed program may come without its documents
        return published_cells(name)
    return []


@lru_cache
def _world(name: str) -> World:
    return open_world(name)
