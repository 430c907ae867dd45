"""Truth: how far map and odometry are from the robot's true place, and how far the map is from its own links. Office: what moves
in this world, one switch each, the robot's presets, and the places that people have named.
"""

from __future__ import annotations

import math
from dataclasses import fields

import numpy as np

from web.messages import LivingLayer, Parameter, Series, Snapshot, TaggedPlace
from web.panel.part import Content, counted, number, table
from web.panel.tune import knob

COLUMNS = tuple(field.name for field in fields(Series))
NOTHING = "No people, doors, lamps, boxes or script here. The pencil above draws some."
MOST = 40  # switches of one kind; beyond that, click on the door itself


def numbers(snapshot: Snapshot) -> Content:
    again = snapshot.revisit_consistency
    rows = [
        ("map error, after alignment", number(snapshot.error_map_m, "m", 2)),
        ("odometry alone, after alignment", number(snapshot.error_odometry_m, "m", 2)),
    ]
    if snapshot.coverage is not None:
        rows.append(("floor explored, to 1 m", f"{100 * snapshot.coverage:.0f} %"))
    rows.append(("revisits within 0.5 m", "none yet" if again is None else f"{100 * again:.0f} %"))
    return Content({"table": table("Error against the true world", rows)})


def series(series: Series) -> Content:
    """The columns of the plots, and by how much map and links disagree now."""
    if len(series.time_s) < 2:
        return Content({"residual": None})
    now = f"{series.residual_mm[-1]:.1f} mm and {math.degrees(series.residual_mrad[-1] / 1000):.2f}°"
    return Content({"residual": now}, {name: getattr(series, name).astype(np.float32) for name in COLUMNS})


def office(
    layer: LivingLayer | None, parameters: tuple[Parameter, ...], presets: tuple[str, ...], preset: str,
    shown: tuple[str, ...],
) -> Content:  # fmt: skip
    """shown: those parameters of the office that have an effect in this world."""
    doors, lamps = [], []
    if layer is not None:
        doors = list(zip(layer.door_names, map(bool, layer.door_wanted), strict=True))[:MOST]
        lamps = list(zip(layer.lamp_names, map(bool, layer.lamp_on), strict=True))[:MOST]
    wanted = {f"office.{name}" for name in shown}
    knobs = [knob(parameter) for parameter in parameters if parameter.name in wanted]
    data = {"presets": presets, "preset": preset, "knobs": knobs, "doors": doors, "lamps": lamps}
    return Content({**data, "words": words(layer, shown)})


def words(layer: LivingLayer | None, shown: tuple[str, ...]) -> str:
    """What is there now, in a sentence."""
    if layer is None:
        return "Nothing moves here." if shown else NOTHING
    parts: list[str] = []
    if "people" in shown:
        parts.append(counted(len(layer.people), "person", "people"))
    if "boxes" in shown:
        parts.append(counted(len(layer.boxes), "box", "boxes"))
    if len(layer.doors):
        parts.append(f"{int((layer.door_opening < 1.0).sum())} of {len(layer.doors)} doors not open")
    if len(layer.lamps):
        parts.append(f"{int((layer.lamps[:, 3] > 0).sum())} of {len(layer.lamps)} lamps lit")
    if "daylight" in shown or layer.daylight != 1.0:
        parts.append(f"daylight {layer.daylight:.2f}")
    return f"Here now: {', '.join(parts)}." if parts else "A script is carried out here."


def tags(places: tuple[TaggedPlace, ...]) -> Content:
    """The places that people have named, in the order in which they did."""
    return Content({"tags": [place.name for place in places]})
