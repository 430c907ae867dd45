"""A trial as text, from which it can be made again even when its experiment's file has changed."""

from __future__ import annotations

import json
from typing import Any

from pydantic import TypeAdapter

from app.trials.steps import Step
from app.trials.trial import Trial

_STEPS: TypeAdapter[tuple[Step, ...]] = TypeAdapter(tuple[Step, ...])


def definition_of(trial: Trial) -> str:
    """All of a trial but its seed, as JSON: the trials of a cell share it."""
    tree = {
        "experiment": trial.experiment,
        "engine": trial.engine,
        "levels": trial.levels,
        "world": trial.world,
        "world_text": trial.world_text,
        "values": trial.values,
        "protocol": _STEPS.dump_python(trial.protocol, mode="json"),
        "measures": trial.measures,
        "version": trial.version,
        "quick": trial.quick,
    }
    return json.dumps(tree, sort_keys=True, separators=(",", ":"))


def trial_from(definition: str, seed: int) -> Trial:
    """The trial whose definition this is."""
    tree: dict[str, Any] = json.loads(definition)
    return Trial(
        tree["experiment"], tree["engine"], tuple(tree["levels"]), seed, tree["world"], tree["world_text"], tree["values"],
        _STEPS.validate_python(tree["protocol"]), tuple(tree["measures"]), tree["version"], tree["quick"],
    )  # fmt: skip
