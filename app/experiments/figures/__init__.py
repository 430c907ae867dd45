"""The figures of an experiment, one file for each kind. KINDS finds them by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from app.experiments.figures import curves, dots, maps, series, survival
from app.experiments.figures.canvas import style
from app.experiments.figures.material import Drawn, Material, Pick
from app.protocol.experiment import FigureSpec
from app.protocol.figure_options import options_of

KINDS: dict[str, Callable[[FigureSpec, Any, Material], Drawn]] = {
    "curves": curves.draw,
    "dots": dots.draw,
    "maps": maps.draw,
    "series": series.draw,
    "survival": survival.draw,
}
NEED_TRACES: dict[str, Callable[[Any, Material], list[Pick]]] = {"maps": maps.wanted, "series": series.wanted}


def wanted(spec: FigureSpec, material: Material) -> list[str]:
    """The ids of the trials that have to be run again for a figure."""
    options = options_of(material.experiment, spec)
    picks = NEED_TRACES[spec.kind](options, material) if spec.kind in NEED_TRACES else []
    return list(dict.fromkeys(pick.trial.id for pick in picks))


def draw(spec: FigureSpec, material: Material) -> Drawn:
    """Draw a figure in the one style. ValueError names the experiment, the figure and what is allowed."""
    options = options_of(material.experiment, spec)
    with style():
        return KINDS[spec.kind](spec, options, material)
