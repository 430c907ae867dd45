"""The glass box of the pose cells: tinted far walls, edges, grid, and axes x', y' in metres and theta' in degrees."""

from __future__ import annotations

import numpy as np
import viser

from web.viewer.fits.cell_fit import HEIGHT, SIDE
from web.viewer.primitives import images, meshes
from web.viewer.primitives.labels import Place, Sign, add_mesh
from web.viewer.primitives.palette import Palette, mix

HALF = SIDE / 2


class GlassBox:
    def __init__(self, scene: viser.SceneApi, palette: Palette, root: str) -> None:
        self._palette = palette
        self._labels: dict[str, Sign] = {}
        self._scene, self._root = scene, root
        corners = np.array([[-HALF, -HALF], [HALF, -HALF], [HALF, HALF], [-HALF, HALF]])
        add_mesh(
            scene,
            f"{root}/glass",
            _walls(corners),
            palette.lit(palette.glass, (0.0, -1.0, 0.0)),
            opacity=palette.glass_opacity,
            side="back",
        )
        edges = [meshes.closed_line(corners, z) for z in (0.0, HEIGHT)]
        posts = np.array([[[x, y, 0.0], [x, y, HEIGHT]] for x, y in corners], np.float32)
        scene.add_line_segments(
            f"{root}/edges", np.vstack([*edges, posts]), palette.drawn(palette.glass_edge), thickness=0.035
        )
        faint = palette.drawn(mix(palette.glass_edge, palette.sheet, 0.62))
        scene.add_line_segments(f"{root}/lattice", _lattice(), faint, thickness=0.018)
        for name, height, anchor in (
            *((f"x{k}", 0.40, "centre") for k in range(3)),
            *((f"y{k}", 0.40, "left") for k in range(3)),
            *((f"t{k}", 0.40, "right") for k in range(3)),
        ):
            self._labels[name] = Sign(
                scene, f"{root}/tick_{name}", height * palette.letters, anchor=anchor, leaning=True
            )
        for name, anchor in (("x", "centre"), ("y", "left"), ("t", "right")):
            self._labels[name] = Sign(scene, f"{root}/axis_{name}", 0.46 * palette.letters, anchor=anchor, leaning=True)

    def set_extent(self, width_m: float, depth_m: float) -> None:
        """Writes the numbers on the axes."""
        ink, faint = self._palette.text, self._palette.text_2
        for k, share in enumerate((0.0, 0.5, 1.0)):
            along = -HALF + share * SIDE
            self._write(f"x{k}", metres_words(share * width_m, k == 2), faint, (along, -HALF - 0.42, 0.1))
            self._write(f"y{k}", metres_words(share * depth_m, k == 2), faint, (HALF + 0.22, along + 0.1, 0.12))
            self._write(f"t{k}", f"{round(share * 360)}°", faint, (-HALF - 0.2, -HALF, 0.16 + share * (HEIGHT - 0.16)))
        self._write("x", "x′", ink, (HALF * 0.5, -HALF - 0.42, 0.14))
        self._write("y", "y′", ink, (HALF + 0.22, HALF * 0.5, 0.16))
        self._write("t", "θ′", ink, (-HALF - 0.2, -HALF, HEIGHT * 0.75))

    def _write(self, name: str, words: str, colour: tuple[int, int, int], at: Place) -> None:
        bold = name in ("x", "y", "t")
        self._labels[name].show(images.text(words, colour, 64, bold), at)


def metres_words(value: float, unit: bool) -> str:
    return f"{value:.3g} m" if unit else f"{value:.3g}"


def _walls(corners: np.ndarray) -> meshes.Mesh:
    """Four sides and a top, no bottom. They are seen from inside only (`side="back"`), so only the far ones tint."""
    vertices, faces = meshes.extruded(corners, 0.0, HEIGHT)
    return vertices, faces


def _lattice() -> np.ndarray:
    """Lines on the far and the left wall, a quarter turn and a quarter of the width apart."""
    lines: list[list[list[float]]] = []
    for share in (0.25, 0.5, 0.75):
        at, z = -HALF + share * SIDE, share * HEIGHT
        lines += [[[at, HALF, 0], [at, HALF, HEIGHT]], [[-HALF, HALF, z], [HALF, HALF, z]]]
        lines += [[[-HALF, at, 0], [-HALF, at, HEIGHT]], [[-HALF, -HALF, z], [-HALF, HALF, z]]]
    return np.array(lines, np.float32)
