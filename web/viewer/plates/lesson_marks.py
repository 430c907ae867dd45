"""What a lesson has on the plates: what happened, where it happened, what was predicted; and a click that predicts."""

from __future__ import annotations

from typing import Literal

import numpy as np
import viser

from web.messages import LessonView, Predict
from web.viewer.fits.office_fit import DEPTH, WIDTH
from web.viewer.marks.cell_marks import CellMarks
from web.viewer.marks.tags import TagMarks
from web.viewer.plates.map_plate import NODE_Z, MapPlate
from web.viewer.plates.office_plate import OfficePlate
from web.viewer.plates.plate import point_on_plane
from web.viewer.plates.pose_cell_plate import PoseCellPlate
from web.viewer.primitives.palette import Palette

Place3 = tuple[float, float, float]
ABOVE_WALLS = 0.8  # on the plate
APART = 0.5  # on the plate; of marks that are nearer to one another only the last is named


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
        pins = [] if lesson is None else _pins(lesson, plate)
        places = np.array([(x, y) for _, x, y in pins]).reshape(-1, 2)
        fit = self._office.fit if plate == "office" else self._map.fit
        on_plate = fit.to_plate(places)
        kept = [
            k
            for k, here in enumerate(on_plate)
            if not len(later := on_plate[k + 1 :]) or float(np.hypot(*(later - here).T).min()) > APART
        ]
        marks.show([pins[k][0] for k in kept], on_plate[kept])

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


def _pins(lesson: LessonView, plate: str) -> list[tuple[str, float, float]]:
    """Words and place of each, in their order: m, in the frame of the plate."""
    pins = [(mark.words, mark.x, mark.y) for mark in lesson.marks if mark.plate == plate]
    said, was = lesson.prediction, lesson.outcome
    if lesson.draws != plate:
        return pins
    if was is not None and was.x is not None and was.y is not None:
        pins.append(("the answer", was.x, was.y))
    if said is not None and said.x is not None and said.y is not None:
        pins.append(("predicted", said.x, said.y))
    return pins
