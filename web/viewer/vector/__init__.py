"""The plates as vector pictures, drawn from the data of a snapshot in the colours of a theme."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, get_args

from web.messages import Snapshot
from web.themes import Theme
from web.viewer.primitives.palette import Palette, palette_of
from web.viewer.vector.experience_map import draw_map
from web.viewer.vector.office import draw_office
from web.viewer.vector.pose_cells import draw_pose_cells

PlateName = Literal["office", "pose", "map"]
PLATES: tuple[PlateName, ...] = get_args(PlateName)
_DRAW: dict[PlateName, Callable[[Snapshot, Palette], str]] = {
    "office": draw_office,
    "pose": draw_pose_cells,
    "map": draw_map,
}


def vector_picture(plate: PlateName, snapshot: Snapshot, theme: Theme) -> str:
    """An SVG document. ValueError: this plate has nothing to show, as the office of a recording."""
    return _DRAW[plate](snapshot, palette_of(theme))
