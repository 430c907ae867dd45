"""The rules of each paper, as values of parameters: `preset("paper-2006")`. The default is "ours".

A value that no paper names, such as a threshold, is the same in all presets. Where a text can be read in several ways or
does not say, the reading is the one with which its results come out: `_READ`. additions.py and docs/additions.md list
our additions with their switches; test_papers.py compares whole runs without them with a literal twin.
"""

from __future__ import annotations

from dataclasses import replace

from ratslam_core.params import RatSlamParams
from ratslam_core.params.additions import ADDITIONS, Value

# Also off in the papers, and off by default: the adaptive learning rate, shortcuts.
_ALSO_OFF: dict[str, Value] = {
    "local_view.adaptive": False,
    "experience_map.shortcut_m": 0.0,
}
_PLAIN: dict[str, Value] = {name: value for addition in ADDITIONS for name, value in addition.off.items()} | _ALSO_OFF
# B to D. Equations B12-14 and D7 diverge unless their sums are divided by the number of links. Nobody tells how large the zone
# of an experience is: of one cell and layer, an eighth of two, come an eighth of the false closures. Three readings are the
# defaults: in D5, experience j lies where it is relative to experience i itself, not to where the robot entered its zone;
# nobody tells the activity of an active local view cell, which is a tenth, at the learning rate of 0.15; and a link saturates
# so that a single observation moves no packet, as D's table demands. docs/findings.md has each with and without it.
_READ: dict[str, Value] = {
    "local_view.front_end": "template",
    "experience_map.sweep": "by experience",
    "experience_map.zone_xy": 1.0,
    "experience_map.zone_theta": 1.0,
}
_PAPERS: dict[str, dict[str, Value]] = {
    # A: pose cells and local view; the map is the cells' own plane.
    "paper-2004": {
        **_PLAIN,
        "local_view.front_end": "complex cells",
        "local_view.learning_rate": 0.2,
        "local_view.saturation": 0.02,
        "experience_map.enabled": False,
        "experience_map.link_confidence": 0.0,
    },
    # B and C: experiences, map correction, goal memory.
    "paper-2005": {**_PLAIN, **_READ, "experience_map.link_confidence": 0.0},
    # D: the same, and links that fail are deleted.
    "paper-2006": {**_PLAIN, **_READ, "experience_map.link_confidence": 0.2},
}


def _all_of_ours() -> dict[str, Value]:
    names = sorted({name for values in _PAPERS.values() for name in values})
    return {name: _value(RatSlamParams(), name) for name in names}


def _value(params: RatSlamParams, name: str) -> Value:
    section, key = name.split(".")
    value: Value = getattr(getattr(params, section), key)
    return value


PRESETS: dict[str, dict[str, Value]] = {"ours": _all_of_ours()}
PRESETS.update({name: {**PRESETS["ours"], **values} for name, values in _PAPERS.items()})


def preset(name: str, base: RatSlamParams | None = None) -> RatSlamParams:
    """Parameters with a preset over them. ValueError lists the presets when there is none of this name."""
    if name not in PRESETS:
        raise ValueError(f"unknown preset {name!r}; expected one of: {', '.join(PRESETS)}")
    return with_values(base or RatSlamParams(), PRESETS[name])


def with_values(params: RatSlamParams, values: dict[str, Value]) -> RatSlamParams:
    """Parameters with some of them changed, by dotted names."""
    sections: dict[str, dict[str, Value]] = {}
    for name, value in values.items():
        section, key = name.split(".")
        sections.setdefault(section, {})[key] = value
    changed = {section: replace(getattr(params, section), **change) for section, change in sections.items()}
    return replace(params, **changed)
