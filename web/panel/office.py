"""Office: what moves in this world, one switch each, the robot's presets, and the places that people have named."""

from __future__ import annotations

from web.messages import LivingLayer, Parameter, TaggedPlace
from web.panel.part import Content
from web.panel.tune import knob
from web.panel.words import counted

NOTHING = "Nothing lives in this world: no people, doors, lamps, boxes, daylight or script. The pencil above lets you draw some."
MOST = 40  # switches of one kind; beyond that, click on the door itself


def office(
    layer: LivingLayer | None,
    parameters: tuple[Parameter, ...],
    presets: tuple[str, ...],
    preset: str,
    shown: tuple[str, ...],
) -> Content:
    """shown: those parameters of the office that have an effect in this world."""
    doors, lamps = [], []
    if layer is not None:
        doors = list(zip(layer.door_names, map(bool, layer.door_wanted), strict=True))[:MOST]
        lamps = list(zip(layer.lamp_names, map(bool, layer.lamp_on), strict=True))[:MOST]
    wanted = {f"office.{name}" for name in shown}
    return Content(
        {
            "presets": presets,
            "preset": preset,
            "knobs": [knob(parameter) for parameter in parameters if parameter.name in wanted],
            "doors": doors,
            "lamps": lamps,
            "words": words(layer, shown),
        }
    )


def tags(places: tuple[TaggedPlace, ...]) -> Content:
    """The places that people have named, in the order in which they did."""
    return Content({"tags": [place.name for place in places]})


def words(layer: LivingLayer | None, shown: tuple[str, ...]) -> str:
    """What is there now, in a sentence."""
    if layer is None:
        return "Nothing moves in this world." if shown else NOTHING
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
