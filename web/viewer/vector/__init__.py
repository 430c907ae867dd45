"""The plates as vector pictures, drawn from the data of a snapshot in the colours of a theme, under the switches of the stage."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Literal, get_args

from web.messages import Snapshot
from web.switches import Name
from web.themes import Theme
from web.viewer.primitives.palette import palette_of
from web.viewer.vector.experience_map import draw_map
from web.viewer.vector.office import draw_office
from web.viewer.vector.pose_cells import draw_pose_cells
from web.viewer.vector.subject import Subject, first_of, second_of

PlateName = Literal["office", "pose", "map", "pose_2", "map_2"]  # those of a second brain have a 2
PLATES: tuple[PlateName, ...] = get_args(PlateName)
_DRAW: dict[str, Callable[[Subject], str]] = {"office": draw_office, "pose": draw_pose_cells, "map": draw_map}


def vector_picture(plate: PlateName, snapshot: Snapshot, theme: Theme, on: Collection[Name]) -> str:
    """An SVG document. on: the switches that are on. ValueError: this plate has nothing to show, as the office of a recording."""
    palette, name = palette_of(theme), plate.removesuffix("_2")
    subject = first_of(snapshot, palette, on) if name == plate else second_of(snapshot, palette)
    return _DRAW[name](subject)
