"""Parameters as Markdown tables for the documentation.

Our additions as a Markdown page for the documentation.
"""

from __future__ import annotations

import json
from dataclasses import Field
from itertools import groupby
from typing import Any

from app.config.tree import Config, Value
from ratslam_core.params.additions import ADDITIONS

_HEAD = ["", "| name | symbol | default | range | unit | meaning | source |", "|---|---|---|---|---|---|---|"]


def to_markdown(config: Config) -> str:
    """The dozen that a lecture turns, then all parameters, one table for each section; this is docs/parameters.md."""
    items = list(config.items())
    dozen = [_row(name, item, value) for name, item, value in items if item.metadata["lecture"]]
    text = [
        "# Parameters",
        "",
        f"Made by `ratslam config --table`: {len(items)}. What nobody tunes is a constant beside its use, with its reason.",
        "↻: takes effect at the next reset. Sources: A = ACRA 2004, B = ACRA 2005, C = IROS 2005, D = ACRA 2006.",
        "",
        "## For a lecture",
        *_HEAD,
        *dozen,
    ]
    for section, rows in groupby(items, lambda row: row[0].split(".")[0]):
        text += ["", f"## {section}", *_HEAD, *(_row(name.split(".")[1], item, value) for name, item, value in rows)]
    return "\n".join(text) + "\n"


def _row(key: str, item: Field[Any], value: Value) -> str:
    about = item.metadata
    limits = " or ".join(about["choices"]) if about["low"] is None else f"{about['low']:g} to {about['high']:g}"
    shown = f"{value:.6g}" if isinstance(value, float) else str(value).lower() if isinstance(value, bool) else value
    name = f"`{key}`{'' if about['live'] else ' ↻'}"
    cells = (name, about["symbol"], shown, limits, about["unit"], about["meaning"], about["source"])
    return f"| {' | '.join(str(cell) for cell in cells)} |"


def additions_markdown() -> str:
    """What is ours, and how each of it is switched off; this is docs/additions.md."""
    rows = "\n".join(f"| {a.name} | {a.adds} | {a.why} | {_names(a.off)} |" for a in ADDITIONS)
    return f"""# What is ours

Made by `ratslam config --additions`. The papers' engine runs by itself: `--preset paper-2004`, `paper-2005`, `paper-2006`, or
*preset* in the *Office* tab. What is ours is on by default (`ours`); each addition has a switch and a plain twin. With all of
them off whole runs are, tick by tick, those of a literal twin written from the equations (`test_papers.py`). What each is worth
is measured by `ratslam experiment additions`: [results](results.md#what-each-of-our-additions-is-worth), read in
[findings](findings.md#what-each-addition-is-worth). On the page, *Compare* puts a brain without one beside a brain
with it ([two brains](time.md#two-brains-on-the-same-senses)).

| addition | what it adds | why | off with |
|---|---|---|---|
{rows}
"""


def _names(off: dict[str, Value]) -> str:
    return ", ".join(f"`{name} = {json.dumps(value)}`" for name, value in off.items())
