"""The experience map as GraphML, which networkx, Gephi and yEd read: experiences, ways between them, and how long they take."""

from __future__ import annotations

import io
from xml.etree import ElementTree as Tree

from app.export.played import name_of
from app.session import Session

_NODE = {"x": "double", "y": "double", "heading_rad": "double", "view": "long", "island": "long"}
_EDGE = {"time_s": "double", "distance_m": "double", "behaviour": "long", "passages": "long", "confidence": "double"}


def graphml_text(session: Session) -> bytes:
    """A directed graph. Lengths in m; numbers are exact."""
    map_ = session.brain.experience_map
    root = Tree.Element("graphml", xmlns="http://graphml.graphdrawing.org/xmlns")
    for kind, columns in (("node", _NODE), ("edge", _EDGE)):
        for name, value in columns.items():
            key = {"id": f"{kind}-{name}", "for": kind, "attr.name": name, "attr.type": value}
            Tree.SubElement(root, "key", key)
    graph = Tree.SubElement(root, "graph", id=name_of(session), edgedefault="directed")
    columns = zip(map_.poses.tolist(), map_.views.tolist(), map_.island_of.tolist(), strict=True)
    for i, (pose, view, island) in enumerate(columns):
        _add(Tree.SubElement(graph, "node", id=str(i)), "node", dict(zip(_NODE, (*pose, view, island), strict=True)))
    for (i, j), time_s in zip(map_.links.tolist(), map_.link_times.tolist(), strict=True):
        link = map_.link(i, j)
        values = (time_s, link.distance_m, link.behaviour, link.passages, link.confidence)
        edge = Tree.SubElement(graph, "edge", source=str(i), target=str(j))
        _add(edge, "edge", dict(zip(_EDGE, values, strict=True)))
    Tree.indent(root, " ")
    out = io.BytesIO()
    Tree.ElementTree(root).write(out, encoding="utf-8", xml_declaration=True)
    return out.getvalue()


def _add(element: Tree.Element, kind: str, values: dict[str, float]) -> None:
    for name, value in values.items():
        Tree.SubElement(element, "data", key=f"{kind}-{name}").text = repr(value)
