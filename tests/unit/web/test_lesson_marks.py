"""A lesson on the plates: what happened is marked where it happened, and a click is a prediction only while one is asked for."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from web.messages import LessonMark, LessonOutcome, LessonPrediction, LessonView, LessonVotes, Predict, SetGoal
from web.viewer.fits import SIDE, CellFit, OfficeFit
from web.viewer.marks.cell_marks import BELOW, LOWEST, way_between
from web.viewer.plates.office_plate import ORIGIN

NOBODY = LessonVotes((), ())
ASKED = LessonView("dark", "Eyes shut", "predict", "", None, 1, 1, "", 2, None, NOBODY, None, (), False, "office")
MARKS = (
    LessonMark("office", 2.0, 2.0, None, "put down here", 50),
    LessonMark("map", 2.0, 2.0, 0.0, "put down here", 50),
)
ENDED = LessonOutcome("it drifted", "", False, x=6.0, y=5.0, distance_m=2.0)
OVER = replace(ASKED, state="compared", prediction=LessonPrediction(x=4.0, y=5.0), outcome=ENDED, marks=MARKS)
AMONG_CELLS = (
    LessonMark("cells", 58.0, 10.0, 0.5, "a packet put in", 40),
    LessonMark("cells", 2.0, 10.0, 0.5, "a snap", 50, (60.0, 10.0, 0.5)),
    LessonMark("cells", 30.0, 30.0, 3.0, "it ended here", 60, (20.0, 30.0, 3.0)),
)
PLAIN: Any = fake_snapshot(430)
OFFICE = OfficeFit(PLAIN.world.bounds)


def teach(bench: Bench, lesson: LessonView | None) -> None:
    bench.show(replace(PLAIN, lesson=lesson), 10.0)
    bench.settle()


def press(bench: Bench, x: float, y: float) -> list[object]:
    """A click on a place of the office's plate; what that has the engine do."""
    bench.engine.commands.clear()
    bench.click((ORIGIN[0] + x, ORIGIN[1] + y, ORIGIN[2] + 0.05), False)
    bench.show(None, 0.05)
    return list(bench.engine.commands)


def marked(bench: Bench, plate: str) -> list[tuple[float, ...]]:
    """Where the rings of the lesson that are shown are on a plate."""
    rings = [name for name in bench.nodes() if name.startswith(f"/{plate}/lesson_") and name.endswith("/ring")]
    return [bench.node(ring[:-5])["position"][:2] for ring in rings if bench.visible(ring)]


def test_a_click_predicts_only_while_a_point_on_this_plate_is_asked_for(shared: Bench, subtests) -> None:
    teach(shared, ASKED)
    (predicted,) = press(shared, 1.0, -1.5)
    assert isinstance(predicted, Predict)
    assert OFFICE.to_plate(np.array([[predicted.x, predicted.y]]))[0] == pytest.approx((1.0, -1.5), abs=1e-6)
    assert not press(shared, 5.4, -1.5) + press(shared, 1.0, -4.2)  # beside the floor, and before it
    for lesson in (None, OVER, replace(ASKED, draws=None), replace(ASKED, rounds=2, marks=MARKS)):
        with subtests.test(lesson=lesson):
            teach(shared, lesson)
            assert not [command for command in press(shared, 1.0, -1.5) if isinstance(command, Predict | SetGoal)]


def test_what_happened_is_marked_beside_what_was_predicted_and_goes_with_the_lesson(shared: Bench) -> None:
    teach(shared, OVER)
    expected = OFFICE.to_plate(np.array([[2.0, 2.0], [6.0, 5.0], [4.0, 5.0]]))
    assert np.array(marked(shared, "office")) == pytest.approx(expected)
    assert len(marked(shared, "map")) == 1
    teach(shared, None)
    assert (marked(shared, "office"), marked(shared, "map")) == ([], [])


def test_of_marks_in_one_place_the_last_is_named(shared: Bench) -> None:
    near = replace(MARKS[0], words="feels lost", x=2.05, tick=60)
    teach(shared, replace(OVER, outcome=None, prediction=None, marks=(MARKS[0], near)))
    assert len(marked(shared, "office")) == 1
    assert shared.says("/office/lesson_0_pill", "feels lost")


def test_among_the_pose_cells_it_is_named_where_it_happened_with_the_way_there(shared: Bench) -> None:
    teach(shared, replace(OVER, marks=AMONG_CELLS))
    fit = CellFit(PLAIN.pose_cells.shape)
    places = fit.path(np.array([(mark.x, mark.y, mark.heading_rad) for mark in AMONG_CELLS]))
    for k, (mark, (x, y, z)) in enumerate(zip(AMONG_CELLS, places.tolist(), strict=True)):
        pill = f"/pose_cells/lesson_{k}"
        assert (shared.visible(pill), shared.says(pill, mark.words)) == (True, True)
        assert shared.node(pill)["position"] == pytest.approx((x, y, max(LOWEST, z - BELOW)))
    assert len(shared.drawn("/pose_cells/lesson_ways")) > 20
    teach(shared, None)
    assert not any(shared.visible(f"/pose_cells/lesson_{k}") for k in range(3))


def test_the_way_of_a_packet_goes_round_the_torus_where_that_is_shorter() -> None:
    fit = CellFit((36, 64, 64))
    dashes = way_between(*fit.path(np.array([[60.0, 10.0, 0.1], [4.0, 10.0, 6.2]])))
    assert np.abs(dashes[:, 1] - dashes[:, 0]).max() < 0.1  # none goes through the box
    assert SIDE / 2 - 1.0 < np.abs(dashes[..., 0]).min() < np.abs(dashes[..., 0]).max() <= SIDE / 2
    ends = fit.path(np.array([[10.0, 10.0, 1.0], [20.0, 10.0, 1.0]]))
    plain = way_between(*ends)
    assert (plain[0, 0, 0], plain[-1, -1, 0]) == pytest.approx((ends[0, 0], ends[1, 0]), abs=0.1)
