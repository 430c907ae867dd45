"""The robot's candidate movements on the floor: free arcs bright, blocked ones grey and dashed, the chosen one a bold arrow."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import Movements
from web.viewer.fits import MapFit, OfficeFit
from web.viewer.primitives import meshes
from web.viewer.primitives.labels import add_mesh
from web.viewer.primitives.palette import Palette, Rgb, mix

ENLARGED = 2.5  # arcs of a second at the robot's pace would end beneath its drawn body
SPOT_STEPS = 12  # points on the arc of a turn on the spot
MOST = 400  # segments of one kind
FAR = -50.0


class MovementArcs:
    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str) -> None:
        self._bright, self._grey = shades(palette)
        self._free = scene.add_line_segments(
            f"{name}/free", meshes.NOWHERE, palette.drawn(self._bright), thickness=0.014
        )
        self._blocked = scene.add_line_segments(
            f"{name}/blocked", meshes.NOWHERE, palette.drawn(self._grey), thickness=0.014
        )
        self._ends = scene.add_point_cloud(
            f"{name}/ends",
            np.full((1, 3), FAR),
            self._bright,
            point_size=0.03,
            point_shape="circle",
            point_shading="flat",
        )
        self._casing = add_mesh(scene, f"{name}/casing", meshes.NOTHING, palette.lit(palette.casing))
        self._chosen = add_mesh(scene, f"{name}/chosen", meshes.NOTHING, palette.lit(palette.robot))

    def show(self, tried: Movements, fit: OfficeFit, radius: float) -> None:
        """Every arc has its end as a dot, and those at full speed, which do not hide each other, are drawn along their way.

        radius: of the robot as it is drawn, plate units; a turn on the spot is an arc around it.
        """
        ways = [arc_on_plate(tried, k, fit, radius) for k in range(len(tried.free))]
        lines: dict[bool, list[NDArray[np.float32]]] = {True: [meshes.NOWHERE[:0]], False: [meshes.NOWHERE[:0]]}
        for k in drawn_along(tried):
            free = bool(tried.free[k])
            line = meshes.open_line(meshes.lifted(ways[k], 0.05))
            lines[free].append(line if free else line[1::2])
        self._free.points = meshes.some(np.concatenate(lines[True]), MOST)
        self._blocked.points = meshes.some(np.concatenate(lines[False]), MOST)
        self._ends.points = meshes.lifted(np.array([way[-1] for way in ways]), 0.055).astype(np.float32)
        self._ends.colors = np.where(tried.free[:, None], self._bright, self._grey).astype(np.uint8)
        width = 0.38 * radius
        self._casing.vertices, self._casing.faces = arrow(ways[tried.chosen], width, 0.075, 0.12 * radius)
        self._chosen.vertices, self._chosen.faces = arrow(ways[tried.chosen], width, 0.085)

    def hide(self) -> None:
        self._free.points = self._blocked.points = meshes.NOWHERE
        self._ends.points, self._ends.colors = np.full((1, 3), FAR, np.float32), np.array([self._bright], np.uint8)
        for mesh in (self._casing, self._chosen):
            mesh.vertices, mesh.faces = meshes.NOTHING


def shades(palette: Palette) -> tuple[Rgb, Rgb]:
    """The colours of those that are free, and of those that are blocked."""
    return mix(palette.text, palette.floor, 0.1), mix(palette.text_2, palette.floor, 0.1)


def drawn_along(tried: Movements) -> list[int]:
    """Those that are drawn along their way: at full speed."""
    return np.flatnonzero((tried.length_m > 0.99 * tried.length_m.max()) & tried.drives).tolist()


def arc_on_plate(tried: Movements, k: int, fit: OfficeFit | MapFit, radius: float) -> NDArray[np.float64]:
    """(n, 2): the k-th arc; that of a turn on the spot lies around the robot, from ahead to where it would then face."""
    path = fit.to_plate(tried.paths[k])
    if tried.drives[k]:
        return path[0] + ENLARGED * (path - path[0])
    angles = tried.heading_rad + np.linspace(0.0, float(tried.turned_rad[k]), SPOT_STEPS)
    return path[0] + 1.7 * radius * np.column_stack([np.cos(angles), np.sin(angles)])


def arrow(way: NDArray[np.float64], width: float, z: float, rim: float = 0.0) -> meshes.Mesh:
    """A ribbon along `way` (n, 2) with a head at its end. rim: so much larger on all sides."""
    ahead = way[-1] - way[-2]
    ahead /= max(float(np.hypot(*ahead)), 1e-9)
    aside = np.array([-ahead[1], ahead[0]])
    long, wide, back = 1.6 * width + 2.0 * rim, 1.2 * width + 1.8 * rim, rim
    head = np.array(
        [way[-1] + long * ahead, way[-1] + wide * aside - back * ahead, way[-1] - wide * aside - back * ahead]
    )
    return meshes.joined(meshes.ribbon(way, width + 2 * rim, z), meshes.flat_polygon(head, z))
