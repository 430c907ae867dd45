"""What a lesson has on the plates: what happened, where it happened, what was predicted; and a click that predicts."""

from __future__ import annotations

from typing import Literal

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import LessonView, Predict
from web.viewer.fits import DEPTH, WIDTH
from web.viewer.marks.cell_marks import CellMarks
from web.viewer.marks.names import TagMarks, last_named
from web.viewer.plates.map_plate import NODE_Z, MapPlate
from web.viewer.plates.office_plate import OfficePlate
from web.viewer.plates.plate import point_on_plane
from web.viewer.plates.pose_cell_plate import PoseCellPlate
from web.viewer.primitives.palette import Palette

Place3 = tuple[float, float, float]
Points = NDArray[np.float64]
ABOVE_WALLS = 0.8  # on the plate
APART = 0.5  # on the plate


class LessonMarks:
    """On office and map, and among the pose cells."""

    def __init__(
        self, scene: viser.SceneApi, palette: Palette, office: OfficePlate, map_plate: MapPlate, cells: PoseCellPlate
    ) -> None:
        self._office, self._map, self._cells = office, map_plate, cells
        self._among_cells = CellMarks(scene, palette, f"{cells.root}/lesson")
        self._on_office = TagMarks(scene, palette, f"{office.root}/lesson", office.labels, ABOVE_WALLS)
        self._on_map = TagMarks(scene, palette, f"{map_plate.root}/lesson", map_plate.labels)

    def show(self, lesson: LessonView | None) -> None:
        self._show(self._on_office, "office", lesson)
        self._show(self._on_map, "map", lesson)
        marks = () if lesson is None else lesson.marks
        self._among_cells.show([mark for mark in marks if mark.plate == "cells"], self._cells.fit)

    def _show(self, marks: TagMarks, plate: Literal["office", "map"], lesson: LessonView | None) -> None:
        words, places = ([], np.zeros((0, 2))) if lesson is None else pins(lesson, plate)
        on_plate = (self._office.fit if plate == "office" else self._map.fit).to_plate(places)
        kept = last_named(on_plate, APART)
        marks.show([words[k] for k in kept], on_plate[kept])

    def predicted(self, lesson: LessonView | None, origin: Place3, direction: Place3) -> Predict | None:
        """The prediction that a click on the plates is, while the lesson asks for a place there; None: it is not one."""
        if (
            lesson is None
            or lesson.draws is None
            or lesson.state not in ("scene", "predict")
            or lesson.round > 1
            or lesson.marks
        ):
            return None
        plate = self._office if lesson.draws == "office" else self._map
        at = point_on_plane(np.array(origin), np.array(direction), plate.origin, NODE_Z)
        if at is None or abs(at[0]) > WIDTH / 2 or abs(at[1]) > DEPTH / 2:
            return None
        to_metres = self._map.fit.to_map if lesson.draws == "map" else self._office.fit.to_office
        x, y = to_metres(np.array([at]))[0].tolist()
        return Predict(type="predict", x=x, y=y)


def pins(lesson: LessonView, plate: Literal["office", "map"]) -> tuple[list[str], Points]:
    """The words of each mark, in their order, and (n, 2) where they are: m, in the frame of the plate."""
    found = [(mark.words, mark.x, mark.y) for mark in lesson.marks if mark.plate == plate]
    said, was = lesson.prediction, lesson.outcome
    if lesson.draws == plate:
        if was is not None and was.x is not None and was.y is not None:
            found.append(("the answer", was.x, was.y))
        if said is not None and said.x is not None and said.y is not None:
            found.append(("predicted", said.x, said.y))
    return [words for words, _, _ in found], np.array([(x, y) for _, x, y in found]).reshape(-1, 2)
