"""The names of places as signs that can be clicked; those that the map knows are bright. Each is one node, whatever the world."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.marks.pill_layout import spread
from web.viewer.primitives import images
from web.viewer.primitives.label_room import LabelRoom
from web.viewer.primitives.labels import Sign
from web.viewer.primitives.palette import Palette, mix

HEIGHT, Z = 0.4, 0.72  # plate units, in worlds of any size, of usual letters; above the walls
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
