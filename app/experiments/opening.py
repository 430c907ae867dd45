"""A stored trial, made again: the same run, bit for bit, as long as the program and the world are the same."""

from __future__ import annotations

from dataclasses import dataclass

from app.code_version import code_version
from app.experiments.store import Store
from app.protocol.trial import Trial, text_of
from sim2d.importers import open_world


@dataclass(frozen=True, slots=True)
class OpenedTrial:
    """A trial, the moment that decided it (simulated s, words), and warnings: why the run may differ from the stored one."""

    trial: Trial
    moment_s: float
    moment_words: str
    warnings: tuple[str, ...]


def open_trial(trial_id: str, store: Store) -> OpenedTrial:
    """The trial with this id, or whose id alone begins so. ValueError if there is none, or its world has gone."""
    trial = store.trial(trial_id)
    moment_s, words = store.moment(trial.id)
    return OpenedTrial(trial, moment_s, words, tuple(_warnings(trial)))


def _warnings(trial: Trial) -> list[str]:
    warnings: list[str] = []
    if trial.version != code_version():
        warnings.append(
            f"the trial was run by version {trial.version} of the program, this is {code_version()}: the run may differ"
        )
    if text_of(open_world(trial.world)) != trial.world_text:
        warnings.append(f"the world {trial.world} has changed since the trial: the run may differ")
    return warnings
