"""An SVG file made a part of a page: ids of its own, colours of the page, and dots that tell their trial."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

from app.experiments.figures.palette import THEMED

_SVG, _XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
_HREF = f"{{{_XLINK}}}href"
_ADDRESS = re.compile(r"url\(#([^)]+)\)")
_COLOUR = re.compile("|".join(THEMED))
_LARGER = 1.2  # than on paper, since a screen is farther away
_TOLD = re.compile(r"(trial|cell)-([0-9a-f]+)$")


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
        told = _TOLD.match(name)
        if told and name in titles:
            _tell(element, told[1], told[2], titles[name])
    for key, value in element.attrib.items():
        if key == _HREF and value.startswith("#"):
            element.set(key, f"#{prefix}-{value[1:]}")
        elif key == "clip-path" or key == "style":
            own = _ADDRESS.sub(rf"url(#{prefix}-\1)", value)
            element.set(key, _COLOUR.sub(lambda found: f"var(--{THEMED[found.group()]})", own))


def _tell(element: ET.Element, kind: str, which: str, words: str) -> None:
    element.set(f"data-{kind}", which)
    element.set("tabindex", "0")
    element.set("role", "button")
    element.set("aria-label", words)
    title = ET.Element(f"{{{_SVG}}}title")
    title.text = words
    element.insert(0, title)
