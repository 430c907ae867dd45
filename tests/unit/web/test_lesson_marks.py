"""A lesson on the plates: what happened is marked where it happened, and a click is a prediction only while one is asked for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from web.messages import (
    LessonMark,
    LessonOutcome,
    LessonPrediction,
    LessonView,
    LessonVotes,
    Predict,
    SetGoal,
    Snapshot,
)
from web.viewer.fits.cell_fit import SIDE, CellFit
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


@pytest.fixture(scope="module")
def bench() -> Iterator[Bench]:
    made = Bench()
    yield made
    made.viewer.stop()


def taught(lesson: LessonView | None) -> Snapshot:
    return replace(fake_snapshot(430), lesson=lesson)


def press(bench: Bench, x: float, y: float) -> None:
    """A click on a place of the office's plate."""
    bench.engine.commands.clear()
    bench.click((ORIGIN[0] + x, ORIGIN[1] + y, ORIGIN[2] + 0.05), False)
    bench.show(None, 0.05)


def marked(bench: Bench) -> dict[str, tuple[float, ...]]:
    """The rings of the lesson that are shown, and where they are on their plates."""
    scene = bench.viewer._scenery.lesson
    marks = {"office": scene._on_office, "map": scene._on_map}
    return {
        f"{plate} {k}": tuple(ring.position)
        for plate, tags in marks.items()
        for k, ring in enumerate(tags._rings)
        if ring.visible
    }


def test_a_click_predicts_while_a_point_on_this_plate_is_asked_for(bench: Bench) -> None:
    bench.show(taught(ASKED), 10.0)
    bench.settle()
    press(bench, 1.0, -1.5)
    (predicted,) = bench.engine.commands
    assert isinstance(predicted, Predict)
    assert predicted.x is not None
    assert predicted.y is not None
    x, y = bench.viewer._scenery.office.fit.to_plate(np.array([[predicted.x, predicted.y]]))[0]
    assert (x, y) == pytest.approx((1.0, -1.5), abs=1e-6)
    press(bench, 5.4, -1.5)  # beside the floor
    assert not bench.engine.commands


@pytest.mark.parametrize("lesson", [None, OVER, replace(ASKED, draws=None), replace(ASKED, rounds=2, marks=MARKS)])
def test_otherwise_a_click_is_what_it_always_is(bench: Bench, lesson: LessonView | None) -> None:
    bench.show(taught(lesson), 10.0)
    bench.settle()
    press(bench, 1.0, -1.5)
    assert not any(isinstance(command, Predict | SetGoal) for command in bench.engine.commands)


def test_what_happened_is_marked_beside_what_was_predicted_and_goes_with_the_lesson(bench: Bench) -> None:
    bench.show(taught(OVER), 10.0)
    bench.settle()
    shown = marked(bench)
    fit = bench.viewer._scenery.office.fit
    expected = fit.to_plate(np.array([[2.0, 2.0], [6.0, 5.0], [4.0, 5.0]]))
    assert [shown[f"office {k}"][:2] for k in range(3)] == [pytest.approx(tuple(at)) for at in expected]
    assert "map 0" in shown
    assert "map 1" not in shown
    bench.show(taught(None), 10.0)
    bench.settle()
    assert marked(bench) == {}


AMONG_CELLS = (
    LessonMark("cells", 58.0, 10.0, 0.5, "a packet put in", 40),
    LessonMark("cells", 2.0, 10.0, 0.5, "a snap", 50, (60.0, 10.0, 0.5)),
    LessonMark("cells", 30.0, 30.0, 3.0, "it ended here", 60, (20.0, 30.0, 3.0)),
)


def test_among_the_pose_cells_it_is_named_where_it_happened_with_the_way_there(bench: Bench) -> None:
    bench.show(taught(replace(OVER, marks=AMONG_CELLS)), 10.0)
    bench.settle()
    cells, marks = bench.viewer._scenery.cells, bench.viewer._scenery.lesson._among_cells
    assert [pill._words for pill in marks._pills if pill.frame.visible] == [mark.words for mark in AMONG_CELLS]
    places = cells.fit.path(np.array([(mark.x, mark.y, mark.heading_rad) for mark in AMONG_CELLS]))
    for pill, (x, y, z) in zip(marks._pills, places, strict=True):
        assert tuple(pill.frame.position) == pytest.approx((x, y, max(LOWEST, z - BELOW)))
    assert len(np.asarray(marks._ways.points)) > 20
    bench.show(taught(None), 10.0)
    bench.settle()
    assert not any(pill.frame.visible for pill in marks._pills)


def test_the_way_of_a_packet_goes_round_the_torus_where_that_is_shorter() -> None:
    fit = CellFit((36, 64, 64))
    start, end = fit.path(np.array([[60.0, 10.0, 0.1], [4.0, 10.0, 6.2]]))
    dashes = way_between(start, end)
    assert np.abs(dashes[:, 1] - dashes[:, 0]).max() < 0.1  # none goes through the box
    assert np.abs(dashes[..., 0]).max() <= SIDE / 2
    assert np.abs(dashes[..., 0]).min() > SIDE / 2 - 1.0
    ends = fit.path(np.array([[10.0, 10.0, 1.0], [20.0, 10.0, 1.0]]))
    plain = way_between(*ends)
    assert (plain[0, 0, 0], plain[-1, -1, 0]) == pytest.approx((ends[0, 0], ends[1, 0]), abs=0.1)


def test_of_marks_in_one_place_the_last_is_named(bench: Bench) -> None:
    near = replace(MARKS[0], words="feels lost", x=2.05, tick=60)
    bench.show(taught(replace(OVER, outcome=None, prediction=None, marks=(MARKS[0], near))), 10.0)
    bench.settle()
    assert len(marked(bench)) == 1
    assert bench.viewer._scenery.lesson._on_office._pills[0]._words == "feels lost"
