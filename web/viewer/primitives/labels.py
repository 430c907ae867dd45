"""Words in the scene that change in place: a sign lies flat or leans towards the eye; a pill is a sign on a bar.

A pill's bar is an opaque mesh, because transparent images hide what is drawn after them.
"""

from __future__ import annotations

import math
from typing import Any

import viser

from web.viewer.primitives import images, meshes
from web.viewer.primitives.label_room import LEAN_RAD, LabelRoom, Place
from web.viewer.primitives.palette import Palette, Rgb

FLAT = (1.0, 0.0, 0.0, 0.0)
LEANING = (math.cos(LEAN_RAD / 2), math.sin(LEAN_RAD / 2), 0.0, 0.0)
LEANING_NORMAL = (0.0, -math.sin(LEAN_RAD), math.cos(LEAN_RAD))


def add_mesh(scene: viser.SceneApi, name: str, mesh: meshes.Mesh, colour: Rgb, **options: Any) -> viser.MeshHandle:
    return scene.add_mesh_simple(name, *mesh, color=colour, cast_shadow=False, receive_shadow=False, **options)


def add_picture(
    scene: viser.SceneApi, name: str, image: images.Pixels, width: float, height: float, **options: Any
) -> viser.ImageHandle:
    options.setdefault("format", "png")
    return scene.add_image(
        name, images.upright(image), width, height, cast_shadow=False, receive_shadow=False, **options
    )


class Sign:
    """Words in a line `height` high, smaller if they were longer than `most`; `anchor` says which end of them is at the
    place."""

    def __init__(
        self,
        scene: viser.SceneApi,
        name: str,
        height: float,
        *,
        anchor: str = "left",
        leaning: bool = False,
        most: float = math.inf,
    ) -> None:
        self._height, self._most = height * 1.3, most
        self._anchor = {"left": 0.5, "centre": 0.0, "right": -0.5}[anchor]
        self._image = images.text(" ", (0, 0, 0), 16)
        self.handle = add_picture(
            scene, name, self._image, 0.1, self._height, visible=False, wxyz=LEANING if leaning else FLAT
        )

    def show(self, image: images.Pixels, at: Place) -> None:
        """`image` comes from `images.text`, which hands out the same object for the same words."""
        ratio = image.shape[1] / image.shape[0]
        height = min(self._height, self._most / ratio)
        width = height * ratio
        if image is not self._image:
            self._image = image
            self.handle.image = images.upright(image)
            self.handle.render_width, self.handle.render_height = width, height
        self.handle.position = (at[0] + width * self._anchor, at[1], at[2])
        self.handle.visible = True

    def hide(self) -> None:
        self.handle.visible = False


class Pill:
    """Words on a rounded bar that leans towards the eye, centred at a place; in a room, where it covers nothing."""

    def __init__(
        self, scene: viser.SceneApi, name: str, height: float, fill: Rgb, palette: Palette, rim: Rgb | None = None,
        room: LabelRoom | None = None, rank: int = 0,
    ) -> None:  # fmt: skip
        """height: with usual letters; rank: which label of the room gives way to which."""
        height *= palette.letters
        self._height, self._room, self._rank = height, room, rank
        self._words: str = ""
        self.width = 0.0
        self.frame = scene.add_frame(name, show_axes=False, visible=False, wxyz=LEANING)
        self._bar = add_mesh(scene, f"{name}/bar", meshes.NOTHING, palette.lit(fill, LEANING_NORMAL), side="double")
        self._rim = None
        if rim is not None:
            self._rim = add_mesh(scene, f"{name}/rim", meshes.NOTHING, palette.lit(rim, LEANING_NORMAL), side="double")
        self._ink = Sign(scene, f"{name}/words", height * 0.62, anchor="centre")

    def show(self, words: str, ink: Rgb, at: Place) -> None:
        if words != self._words:
            self._words = words
            image = images.text(words, ink, 72, True)
            self.width = pill_width(words, self._height)
            self._ink.show(image, (0.0, 0.0, 0.012))
            self._bar.vertices, self._bar.faces = _bar(self.width, self._height, 0.0)
            if self._rim is not None:
                self._rim.vertices, self._rim.faces = _bar(self.width + 0.09, self._height + 0.09, -0.012)
        if self._room is None:
            self._move(at)
        else:
            self._room.put(self, self._rank, at, (self.width, self._height), self._move)
        self.frame.visible = True

    def hide(self) -> None:
        self.frame.visible = False
        if self._room is not None:
            self._room.leave(self)

    def _move(self, at: Place) -> None:
        self.frame.position = at


def pill_width(words: str, height: float) -> float:
    """How wide the bar under `words` will be."""
    image = images.text(words, (0, 0, 0), 72, True)
    return max(height, height * 0.62 * 1.3 * image.shape[1] / image.shape[0] + height * 0.6)


def _bar(width: float, height: float, z: float) -> meshes.Mesh:
    return meshes.flat_polygon(meshes.rounded_rectangle(width, height, height / 2 - 1e-4), z)
