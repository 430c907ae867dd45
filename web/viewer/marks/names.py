"""The names of places as signs that can be clicked; those that the map knows are bright. Each is one node, whatever the world.

The names of tagged places on the map: a ring at each, and its name beside it.
"""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.marks.route import spread
from web.viewer.primitives import images, meshes
from web.viewer.primitives.labels import TAG, LabelRoom, Pill, Sign, add_mesh
from web.viewer.primitives.palette import Palette, mix

HEIGHT, Z = 0.4, 0.72  # plate units, in worlds of any size, where letters are 1; above the walls
MOST = 40
REACH = 5.4  # plate units to each side: no name leaves the plate


class PlaceNames:
    """More signs are made when there are more names; those that are not needed are hidden."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str, room: LabelRoom) -> None:
        self._room = room
        self._scene, self._palette, self._name = scene, palette, name
        self._height = HEIGHT * palette.letters
        self._signs: list[Sign] = []
        self._boxes: list[tuple[str, float, float, float]] = []  # name, x, y, width
        self._shown: tuple[object, ...] = ()

    def show(self, names: list[str], known: list[bool], places: NDArray[np.float64]) -> None:
        """places: (n, 2) on the plate. Names that would cover one another are pushed apart. Only what has changed is sent."""
        names, known, places = names[:MOST], known[:MOST], places[:MOST]
        now = (*names, *known, places.tobytes())
        if now == self._shown:
            return
        self._shown = now
        pictures = [self._picture(name, bright) for name, bright in zip(names, known, strict=True)]
        widths = np.array([self._height * p.shape[1] / p.shape[0] for p in pictures])
        middles = spread(places, widths, self._height) if len(names) else places
        room = np.maximum(REACH - widths / 2, 0.0)
        middles[:, 0] = np.clip(middles[:, 0], -room, room)
        self._boxes = []
        for k, picture in enumerate(pictures):
            if k == len(self._signs):
                self._signs.append(
                    Sign(self._scene, f"{self._name}_{k}", self._height / 1.3, anchor="centre", leaning=True)
                )
            x, y = middles[k].tolist()
            self._signs[k].show(picture, (x, y, Z))
            self._boxes.append((names[k], x, y, float(widths[k])))
        for sign in self._signs[len(pictures) :]:
            sign.hide()
        self._room.fix(self, [((x, y, Z), width, self._height) for _, x, y, width in self._boxes])

    def at(self, place: tuple[float, float]) -> str | None:
        """The name under a point in the plane of the signs (plate units); they lean towards the eye."""
        for name, x, y, width in self._boxes:
            if abs(place[0] - x) <= width / 2 and abs(place[1] - y) <= 0.7 * self._height:
                return name
        return None

    def _picture(self, name: str, bright: bool) -> images.Pixels:
        palette = self._palette
        ink = palette.text if bright else palette.text_2
        return images.plaque(name, ink, mix(palette.slab, palette.sheet, 0.0 if bright else 0.6))


RING, RING_WIDTH, RING_Z = 0.14, 0.05, 0.1
PILL, BELOW, PILL_Z = 0.4, 0.5, 0.2


class TagMarks:
    """More marks are made when there are more tags; those that are not needed are hidden."""

    def __init__(
        self, scene: viser.SceneApi, palette: Palette, name: str, room: LabelRoom, pill_z: float = PILL_Z
    ) -> None:
        self._pill_z, self._room = pill_z, room
        self._scene, self._palette, self._name = scene, palette, name
        self._rings: list[viser.FrameHandle] = []
        self._pills: list[Pill] = []
        self._shown: tuple[object, ...] = ()

    def show(self, names: list[str], places: NDArray[np.float64]) -> None:
        """places: (k, 2) on the plate. Only what has changed is sent."""
        now = (*names, places.tobytes())
        if now == self._shown:
            return
        self._shown = now
        for k, (name, (x, y)) in enumerate(zip(names, places.tolist(), strict=True)):
            if k == len(self._rings):
                self._add(k)
            self._rings[k].position = (x, y, 0.0)
            self._rings[k].visible = True
            self._pills[k].show(name, self._palette.sheet, (x, y - BELOW, self._pill_z))
        for k in range(len(names), len(self._rings)):
            self._rings[k].visible = False
            self._pills[k].hide()

    def _add(self, k: int) -> None:
        name, palette = f"{self._name}_{k}", self._palette
        self._rings.append(self._scene.add_frame(name, show_axes=False, visible=False))
        add_mesh(self._scene, f"{name}/ring", meshes.ring(RING, RING_WIDTH, RING_Z), palette.lit(palette.text))
        pill = Pill(self._scene, f"{name}_pill", PILL, palette.text, palette, room=self._room, rank=TAG)
        self._pills.append(pill)


def last_named(places: NDArray[np.float64], apart: float) -> list[int]:
    """Those of (n, k) places that are named: of such as are nearer to one another than `apart` only the last."""
    return [k for k, here in enumerate(places) if not (np.linalg.norm(places[k + 1 :] - here, axis=1) <= apart).any()]
