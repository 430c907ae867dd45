"""Figures that cannot be drawn are refused where the experiment is read, in a sentence."""

from __future__ import annotations

import pytest

from app.protocol.experiment import catalogue
from app.protocol.figure_options import OPTIONS, check_figures, options_of
from tests.unit.app.made_trials import experiment, figure

WRONG = [
    ("pie", {}, r"unknown kind 'pie'; expected one of: curves, dots, maps, series, survival"),
    (
        "curves",
        {"score": "goals reached", "allong": "N_vis"},
        r"no option 'allong' \(did you mean 'along'\?\); it has: at,",
    ),
    ("curves", {"along": "N_vis"}, r"option score: Field required"),
    ("curves", {"score": "speed", "along": "N_vis"}, r"score = 'speed': expected one of: 'goals reached', 'map error'"),
    ("curves", {"score": "map error", "along": "colour"}, r"along = 'colour': expected one of: 'N_vis', 'size'"),
    (
        "curves",
        {"score": "map error", "along": "size", "lines": "size"},
        r"lines = 'size': expected one of: '', 'N_vis'",
    ),
    ("dots", {"score": "map error", "by": "engine"}, r"by = 'engine': expected one of: '', 'N_vis', 'size'"),
    ("dots", {"score": "map error", "at": ["3 %"]}, r"at = '3 %': expected one of: '0 %', '2 %', '10 %', '8', '16'"),
    ("maps", {"show": "the map"}, r"option show: Input should be 'experience map', .* got 'the map'"),
    ("maps", {"show": "path", "each": "robot"}, r"each = 'robot': expected one of: 'N_vis', 'size', 'engine', 'seed'"),
    ("maps", {"show": "path", "pick": "median"}, r"score = '': expected one of: 'goals reached'"),
    ("series", {"channels": []}, r"option channels: List should have at least 1 item"),
    ("series", {"channels": ["speed"]}, r"option channels.0: Input should be 'packets', .* got 'speed'"),
    ("survival", {"score": "after", "lines": "seed"}, r"lines = 'seed': expected one of: 'engine', 'N_vis', 'size'"),
    ("survival", {"score": "recovered"}, r"score = 'recovered': expected one of: 'map error', 'after'"),
    ("survival", {"score": "after", "most": -1}, r"option most: Input should be greater than or equal to 0, got -1"),
]


def test_a_wrong_figure_is_refused_with_what_is_allowed(subtests):
    for kind, options, words in WRONG:
        said = rf"^experiment made, figure 'A figure of {kind}': .*{words}"
        with subtests.test(msg=f"{kind} {options}"), pytest.raises(ValueError, match=said):
            options_of(experiment(), figure(kind, **options))
    with pytest.raises(ValueError, match="experiment made, figure 'A figure of pie'"):
        experiment(figures=[figure("pie")]).check()
    made = experiment()
    made = made.model_copy(update={"engines": {"ours": made.engines["ours"]}})
    with pytest.raises(ValueError, match="engines = 'paper': expected one of: 'ours'"):
        options_of(made, figure("survival", score="after", engines=["paper"]))


def test_every_option_has_a_value_that_is_taken_as_it_is():
    asked = figure("curves", score="map error", along="size", spacing="log", width=3)
    o = options_of(experiment(), asked)
    assert (o.score, o.along, o.lines, o.spacing, o.width) == ("map error", "size", "", "log", 3)
    assert all(kind.model_config.get("extra") == "forbid" for kind in OPTIONS.values())
    for each in catalogue():
        check_figures(each)
