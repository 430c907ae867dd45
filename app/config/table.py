"""Parameters as Markdown tables for the documentation."""

from __future__ import annotations

from dataclasses import Field
from typing import Any

from app.config.tree import Config, Value


def to_markdown(config: Config) -> str:
    """All parameters, one table for each section; this is docs/parameters.md."""
    lines = [
        "# Parameters",
        "",
        "Made by `ratslam config --table`. ↻: takes effect at the next reset. Sources: A = ACRA 2004, ",
    ]
    lines[-1] += "B = ACRA 2005, C = IROS 2005, D = ACRA 2006."
    section = ""
    for name, item, value in config.items():
        group, key = name.split(".")
        if group != section:
            section = group
            lines += ["", f"## {section}", "", "| name | symbol | default | range | unit | meaning | source |"]
            lines += ["|---|---|---|---|---|---|---|"]
        lines.append(_row(key, item, value))
    return "\n".join(lines) + "\n"


def _row(key: str, item: Field[Any], value: Value) -> str:
    about = item.metadata
    limits = " or ".join(about["choices"]) if about["low"] is None else f"{about['low']:g} to {about['high']:g}"
    shown = f"{value:.6g}" if isinstance(value, float) else str(value).lower() if isinstance(value, bool) else value
    name = f"`{key}`{'' if about['live'] else ' ↻'}"
    cells = (name, about["symbol"], shown, limits, about["unit"], about["meaning"], about["source"])
    return f"| {' | '.join(str(cell) for cell in cells)} |"
