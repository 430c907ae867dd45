"""The page of an experiment, and the index of all, filled in from their templates.

A figure becomes a part of the page: its ids are its own, its colours the page's, and its dots tell their trials.
"""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from app.code_version import code_version
from app.experiments.figures.canvas import THEMED, svg_of
from app.experiments.figures.material import Drawn, Material
from app.experiments.store import StoredTrial
from app.experiments.summary import ENGINE_WORDS, CellSummary, found, value_of, words, words_of
from app.protocol.experiment import Experiment, Score

_SVG, _XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
_HREF = f"{{{_XLINK}}}href"
_ADDRESS = re.compile(r"url\(#([^)]+)\)")
_COLOUR = re.compile("|".join(THEMED))
_LARGER = 1.2  # than on paper, since a screen is farther away
_LABELLED = re.compile(r"(trial|cell)-([0-9a-f]+)$")


@dataclass(frozen=True, slots=True)
class Entry:
    """An experiment in the index. file: its page, beside the index."""

    experiment: Experiment
    file: str
    says: list[str]
    picture: str  # SVG; empty if it has no figure
    trials: int


def page_of(material: Material, drawn: list[Drawn], command: str, failed: list[StoredTrial]) -> str:
    """The page as HTML. command: what made it; failed: trials that ended with an error."""
    experiment = material.experiment
    engines = [engine for engine in experiment.engines if any(cell.engine == engine for cell in material.cells)]
    titles = _titles(material)
    figures = [
        {
            "title": each.spec.title,
            "paper": each.spec.paper,
            "svg": Markup(inlined(svg_of(each.figure), f"f{n}", titles, each.spec.title or each.spec.kind)),
            "caption": each.caption,
        }
        for n, each in enumerate(drawn, start=1)
    ]
    return _template("page.html.j2").render(
        experiment=experiment,
        says=found(experiment, material.cells),
        figures=figures,
        engines=engines,
        engine_words=ENGINE_WORDS,
        rows=_rows(material, engines),
        scores=[(score, int(_is_compared(experiment, score))) for score in experiment.scores],
        trials=[_row_of(material, trial) for trial in material.trials],
        failed=failed,
        data=_json({"trials": _trials(material), "cells": _cells(material)}),
        command=command,
        seeds=sorted({trial.seed for trial in material.trials}),
        version=code_version(),
    )


def index_of(entries: list[Entry], command: str) -> str:
    """The page that leads to those of all experiments."""
    return _template("index.html.j2").render(
        entries=[(entry, Markup(entry.picture)) for entry in entries],
        command=command,
        version=code_version(),
    )


def picture_of(drawn: Drawn, prefix: str) -> str:
    """A figure for the index, where nothing in it is clicked."""
    return inlined(svg_of(drawn.figure), prefix, {}, drawn.spec.title or drawn.spec.kind)


def _template(name: str) -> Any:
    loader = FileSystemLoader(Path(__file__).with_name("templates"))
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template(name)


def _json(value: Any) -> Markup:
    """JSON that cannot end the script it stands in."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    for sign in "<>&\u2028\u2029":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return Markup(text)


def _rows(material: Material, engines: list[str]) -> list[dict[str, Any]]:
    """The table: a row for each cell; for each score the paper's value and each engine's."""
    experiment = material.experiment
    rows: list[dict[str, Any]] = []
    for levels in dict.fromkeys(cell.levels for cell in material.cells):
        cells = {cell.engine: cell for cell in material.cells if cell.levels == levels}
        scores: list[tuple[str | None, list[str]]] = []
        for score in experiment.scores:
            original = [o for o in experiment.original if o.score == score.label and set(o.levels) <= set(levels)]
            ours = [words(cells[e].values[score.label], score) if e in cells else "-" for e in engines]
            paper = words_of(score, original[0].value) if original else ""
            scores.append((paper if _is_compared(experiment, score) else None, ours))
        rows.append({"levels": levels, "n": max(cell.n for cell in cells.values()), "scores": scores})
    return rows


def _is_compared(experiment: Experiment, score: Score) -> bool:
    """Whether the paper has a value of this score at all."""
    return any(original.score == score.label for original in experiment.original)


def _row_of(material: Material, trial: StoredTrial) -> dict[str, Any]:
    return {
        "id": trial.id,
        "command": _open_command(trial),
        "engine": ENGINE_WORDS[trial.engine],
        "levels": trial.levels,
        "seed": trial.seed,
        "scores": [value for _, value in _scores(material, trial)],
        "moment": _moment(trial),
    }


def _trials(material: Material) -> dict[str, Any]:
    """What the box says of each trial."""
    return {
        trial.id: {
            "command": _open_command(trial),
            "heading": f"{ENGINE_WORDS[trial.engine].capitalize()}, seed {trial.seed}",
            "levels": _levels(material.experiment, trial),
            "scores": _scores(material, trial),
            "moment": _moment(trial),
        }
        for trial in material.trials
    }


def _cells(material: Material) -> list[dict[str, Any]]:
    """What the box says of each cell: its scores and its trials."""
    experiment = material.experiment
    return [
        {
            "heading": f"{ENGINE_WORDS[cell.engine].capitalize()}, {cell.n} trials",
            "levels": _levels(experiment, cell),
            "scores": [(score.label, words(cell.values[score.label], score)) for score in experiment.scores],
            "trials": [t.id for t in material.trials if t.engine == cell.engine and t.levels == cell.levels],
        }
        for cell in material.cells
    ]


def _titles(material: Material) -> dict[str, str]:
    """What is told when a dot is pointed at."""
    experiment = material.experiment
    titles = {
        f"trial-{t.id}": f"{_open_command(t)}\n{ENGINE_WORDS[t.engine]}, {_levels(experiment, t)}, seed {t.seed}: {_moment(t)}"
        for t in material.trials
    }
    for number, cell in enumerate(_cells(material)):
        titles[f"cell-{number}"] = f"{cell['heading']}, {cell['levels']}; press to list them"
    return titles


def _levels(experiment: Experiment, of: StoredTrial | CellSummary) -> str:
    return ", ".join(f"{axis.name} {label}" for axis, label in zip(experiment.axes, of.levels, strict=True))


def _scores(material: Material, trial: StoredTrial) -> list[tuple[str, str]]:
    values = [(score, value_of(score, trial)) for score in material.experiment.scores]
    return [(score.label, "-" if value is None else words_of(score, value)) for score, value in values]


def _moment(trial: StoredTrial) -> str:
    return f"{trial.moment_words}, at {trial.moment_s:.1f} s"


def _open_command(trial: StoredTrial) -> str:
    """What opens a trial in the dashboard at the moment that decided it."""
    return f"ratslam experiment open {trial.id}"


def inlined(svg: str, prefix: str, titles: dict[str, str], label: str) -> str:
    """The SVG as an element of a page.

    prefix: of its ids, since several figures stand on a page. titles: what is told of each trial or cell when it is
    pointed at, by `trial-ID` or `cell-NUMBER`. label: what the whole figure is, for those who do not see it.
    """
    ET.register_namespace("", _SVG)
    ET.register_namespace("xlink", _XLINK)
    root = ET.fromstring(svg)
    for metadata in root.findall(f"{{{_SVG}}}metadata"):
        root.remove(metadata)
    taken: set[str] = set()
    for element in root.iter():
        _own(element, prefix, titles, taken)
    width = root.attrib.pop("width", "100%")
    root.attrib.pop("height", None)
    root.set("style", f"width: calc({width} * {_LARGER})")
    root.set("role", "group")
    root.set("aria-label", label)
    return ET.tostring(root, encoding="unicode")


def _own(element: ET.Element, prefix: str, titles: dict[str, str], taken: set[str]) -> None:
    name = element.attrib.get("id")
    if name is not None:
        own = f"{prefix}-{name}"
        while own in taken:  # a trial that two cells share has two dots
            own += "-again"
        taken.add(own)
        element.set("id", own)
        labelled = _LABELLED.match(name)
        if labelled and name in titles:
            _label(element, labelled[1], labelled[2], titles[name])
    for key, value in element.attrib.items():
        if key == _HREF and value.startswith("#"):
            element.set(key, f"#{prefix}-{value[1:]}")
        elif key in ("clip-path", "style"):
            own = _ADDRESS.sub(rf"url(#{prefix}-\1)", value)
            element.set(key, _COLOUR.sub(lambda found: f"var(--{THEMED[found.group()]})", own))


def _label(element: ET.Element, kind: str, which: str, words: str) -> None:
    element.set(f"data-{kind}", which)
    element.set("tabindex", "0")
    element.set("role", "button")
    element.set("aria-label", words)
    title = ET.Element(f"{{{_SVG}}}title")
    title.text = words
    element.insert(0, title)
