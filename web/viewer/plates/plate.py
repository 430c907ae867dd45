"""A plate: a named frame with slab, sheet, rim, title and subtitle, on which one view of the session stands."""

from __future__ import annotations

import numpy as np
import viser

from web.viewer.camera_views import SHEET
from web.viewer.primitives import images, meshes
from web.viewer.primitives.labels import LabelRoom, Sign, add_mesh
from web.viewer.primitives.palette import Palette, Rgb

TITLE_M, SUBTITLE_M = 0.62, 0.36
CORNER = 0.45  # radius
MOST_LARGE = 1.2  # a larger subtitle has no room between title and edge; the title is large as it is
BEHIND = (
    0.0,
    30.0,
    0.0,
)  # opaque meshes are drawn by the distance of their origin: this after what covers most of it
SHEET_Z, RIM_Z, TEXT_Z, FLOOR_Z = -0.055, -0.05, -0.035, -0.03


class Plate:
    """What all three plates have in common. Children take names below `self.root`."""

    def __init__(
        self,
        scene: viser.SceneApi,
        palette: Palette,
        name: str,
        origin: tuple[float, float, float],
        beside_title: float = 0.0,  # room that the title leaves at its right
    ) -> None:
        self.scene, self.palette, self.root, self.origin = scene, palette, f"/{name}", origin
        self.frame = scene.add_frame(self.root, show_axes=False, position=origin)
        width, depth, centre_y = SHEET
        self.labels = LabelRoom((width / 2 - 0.5, depth / 2 - abs(centre_y)))
        self.left, self.front = -width / 2 + 0.5, centre_y - depth / 2
        outline = meshes.rounded_rectangle(width, depth, CORNER, centre=(0.0, centre_y))
        add_mesh(scene, f"{self.root}/slab", meshes.sides(outline, -0.32, -0.06), palette.lit(palette.slab))
        vertices, faces = meshes.flat_polygon(outline, SHEET_Z)
        far = (vertices - np.array(BEHIND, np.float32), faces)
        add_mesh(scene, f"{self.root}/sheet", far, palette.lit(palette.sheet), position=BEHIND)
        self._rim = scene.add_line_segments(
            f"{self.root}/rim", meshes.closed_line(outline, RIM_Z), palette.drawn(palette.rim), thickness=0.04
        )
        self._heading_words = ("", "")
        self._brain: tuple[str, Rgb] | None = None
        self._title = Sign(scene, f"{self.root}/title", TITLE_M, most=width - 1.0 - beside_title)
        height = SUBTITLE_M * min(palette.letters, MOST_LARGE)
        self._subtitle = Sign(scene, f"{self.root}/subtitle", height, most=width - 1.0 - beside_title)

    def stand_at(self, x: float, y: float) -> None:
        """Moves the plate over the floor, with all that stands on it."""
        self.origin = (x, y, self.origin[2])
        self.frame.position = self.origin

    def belong_to(self, brain: tuple[str, Rgb] | None) -> None:
        """Shows whose plate it is, while there are two brains: name and colour; None: no longer."""
        self._brain = brain
        colour = self.palette.rim if brain is None else brain[1]
        self._rim.colors = np.array(self.palette.drawn(colour), np.uint8)
        self._rim.thickness = 0.04 if brain is None else 0.1
        self.set_heading(*self._heading_words)

    def set_heading(self, title: str, subtitle: str) -> None:
        """Shows title and subtitle, flat in front of the content. Of two brains, the name takes the title's place."""
        self._heading_words, ink = (title, subtitle), self.palette.text
        if self._brain is not None:
            first, _, last = subtitle.rpartition(" - ")
            (words, ink), what = self._brain, title.lower().removeprefix("experience ")  # beside the scale
            title, subtitle = words, f"{what} - {last}" if first else what
        self._title.show(images.text(title, ink, 96, True), (self.left, self.front + 1.08, TEXT_Z))
        self._subtitle.show(images.text(subtitle, self.palette.text_2, 64), (self.left, self.front + 0.46, TEXT_Z))


def point_on_plane(
    origin: np.ndarray, direction: np.ndarray, plate: tuple[float, float, float], z: float = 0.0
) -> tuple[float, float] | None:
    """Where a ray (world frame) meets the plane `z` above a plate, in the plate's frame; None when it does not."""
    if abs(direction[2]) < 1e-9:
        return None
    along = (plate[2] + z - origin[2]) / direction[2]
    if along <= 0:
        return None
    return float(origin[0] + along * direction[0] - plate[0]), float(origin[1] + along * direction[1] - plate[1])
