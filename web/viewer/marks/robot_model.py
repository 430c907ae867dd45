"""The robot: an orange cylinder with a white turret, a dark camera and two wheels, drawn a quarter larger than it is."""

from __future__ import annotations

import math

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.primitives import meshes
from web.viewer.primitives.labels import add_mesh
from web.viewer.primitives.palette import Palette, Rgb

ENLARGED = 1.25
SMALLEST = 0.19  # plate units: stays visible in large worlds, however small they are drawn


class RobotModel:
    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str, plain: Rgb | None = None) -> None:
        """plain: one colour for all of it, and then it is hidden at first."""
        self.radius = 0.25
        self.frame = scene.add_frame(name, show_axes=False, visible=plain is None)
        circle = meshes.circle(1.0)
        wheels = [meshes.rounded_rectangle(0.62, 0.2, 0.09, 4, centre=(0.0, side)) for side in (1.0, -1.0)]
        lens = meshes.rounded_rectangle(0.36, 0.5, 0.1, 4, centre=(0.72, 0.0))
        parts = {
            "body": (meshes.extruded(circle, 0.12, 0.95), palette.robot),
            "turret": (meshes.extruded(circle * 0.5, 0.95, 1.3), palette.turret),
            "camera": (meshes.extruded(lens, 0.9, 1.3), palette.tyre),
            "left": (meshes.extruded(wheels[0], 0.0, 0.5), palette.tyre),
            "right": (meshes.extruded(wheels[1], 0.0, 0.5), palette.tyre),
        }
        if plain is not None:
            parts = {"body": (meshes.joined(*(mesh for mesh, _ in parts.values())), plain)}
        self.parts = [
            add_mesh(scene, f"{name}/{part}", mesh, palette.lit(colour), scale=self.radius)
            for part, (mesh, colour) in parts.items()
        ]
        halo = meshes.ring(1.42, 0.2, 0.06)
        self.parts.append(
            add_mesh(scene, f"{name}/halo", halo, palette.lit(palette.robot), opacity=0.35, scale=self.radius)
        )

    def resize(self, drawn_radius: float) -> None:
        """drawn_radius: the robot's radius in plate units, before it is enlarged."""
        self.radius = max(drawn_radius * ENLARGED, SMALLEST)
        for part in self.parts:
            part.scale = self.radius

    def place(self, xy: NDArray[np.float64], heading_rad: float) -> None:
        """xy: in plate units."""
        self.frame.position = (float(xy[0]), float(xy[1]), 0.0)
        self.frame.wxyz = (math.cos(heading_rad / 2), 0.0, 0.0, math.sin(heading_rad / 2))
