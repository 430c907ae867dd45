"""Short trials of an experiment that is in no catalogue, and the catalogue's own made short."""

from __future__ import annotations

from app.protocol.experiment import Experiment, chosen_trial, find_experiment
from app.protocol.trial import Trial

SHORT = {
    "name": "short",
    "title": "A short walk",
    "paper": "none",
    "asks": "Does it come to the places again?",
    "found": "It does.",
    "world": "office",
    "engines": {"ours": {}, "paper": {"preset": "paper-2006"}},
    "protocol": [
        {"do": "tag", "places": ["home"], "within_m": 2.0},
        {"do": "move", "moves": [[0.3, 0.0, 4.0]]},
        {"do": "kidnap", "turn_deg": 90.0},
        {"do": "explore", "minutes": 0.1},
        {"do": "visit", "places": ["home"], "timeout_s": 4.0, "near_m": 5.0},
    ],
    "scores": [{"label": "goals reached", "rate": ["reached", "goals"]}],
}


def short_trial(**changes: object) -> Trial:
    return chosen_trial(Experiment.model_validate({**SHORT, **changes}))


def table_trial(quick: bool = True) -> Trial:
    return chosen_trial(find_experiment("table"), quick=quick)
