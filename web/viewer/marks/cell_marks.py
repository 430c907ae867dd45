"""What happened among the pose cells, where it happened: a name at each place, and a dashed way from where it came."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import viser

from web.messages import LessonMark
from web.viewer.fits import HEIGHT, SIDE, CellFit, broken_where_it_wraps
from web.viewer.marks.names import last_named
from web.viewer.primitives import meshes
from web.viewer.primitives.labels import Pill
from web.viewer.primitives.palette import Palette

PILL, BELOW, LOWEST = 0.4, 0.75, 0.25  # over a packet stands its own name
APART = 0.7  # in the box; of marks that are nearer to one another only the last is named
STEPS, MOST = 30, 60  # of a way; of all ways
BOX = np.array([SIDE, SIDE, HEIGHT])
LEAST = BOX * (-0.5, -0.5, 0.0)  # the corner at which all coordinates are least


class CellMarks:
    """More names are made when there are more marks; those that are not needed are hidden."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str) -> None:
        self._scene, self._palette, self._name = scene, palette, name
        self._pills: list[Pill] = []
        self._ways = scene.add_line_segments(
            f"{name}_ways", meshes.NOWHERE, palette.drawn(palette.text), thickness=0.04
        )
        self._shown: tuple[object, ...] = ()

    def show(self, marks: Sequence[LessonMark], fit: CellFit) -> None:
        """Only what has changed is sent."""
        now = (*marks, fit.shape)
        if now == self._shown:
            return
        self._shown = now
        places = fit.path(np.array([(mark.x, mark.y, mark.heading_rad or 0.0) for mark in marks]).reshape(-1, 3))
        kept = last_named(places, APART)
        for number, k in enumerate(kept):
            if number == len(self._pills):
                self._pills.append(Pill(self._scene, f"{self._name}_{number}", PILL, self._palette.text, self._palette))
            x, y, z = places[k].tolist()
            self._pills[number].show(marks[k].words, self._palette.sheet, (x, y, max(LOWEST, z - BELOW)))
        for pill in self._pills[len(kept) :]:
            pill.hide()
        ways = [
            way_between(fit.path(np.array([mark.start]))[0], at)
            for mark, at in zip(marks, places, strict=True)
            if mark.start
        ]
        self._ways.points = meshes.some(np.concatenate(ways) if ways else meshes.NOWHERE, MOST)


def way_between(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Dashes along the shortest way round the torus, (n, 2, 3)."""
    along = (end - start + BOX / 2) % BOX - BOX / 2
    points = (start + np.linspace(0.0, 1.0, STEPS)[:, None] * along - LEAST) % BOX + LEAST
    return broken_where_it_wraps(points)[::2]
