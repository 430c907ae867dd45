"""Marks of lessons: where it happened in the office and on the map, and among the pose cells a packet put in, where two merged,
a snap, how far a packet got."""

from __future__ import annotations

import pytest

from app.protocol.lesson import find_lesson
from app.protocol.lesson_round import LessonRound, run_round
from web.messages import LessonMark

pytestmark = pytest.mark.slow


def marks_on(plate: str, round_: LessonRound) -> dict[str, LessonMark]:
    assert round_.marks is not None
    return {mark.words: mark for mark in round_.marks.view() if mark.plate == plate}


def test_they_lie_where_it_happened_and_go_with_the_map() -> None:
    round_ = run_round(find_lesson("loop"), 0)
    session, office = round_.session, marks_on("office", round_)
    closure, end, on_map = (
        office["loop closed"],
        office["it ended here"],
        marks_on("map", round_)["it ended here"],
    )
    truth, robot = session.simulator.truth, session.brain.experience_map.robot
    for mark, (x, y) in [
        (closure, session.evaluation.path[closure.tick].tolist()), (end, (truth.x, truth.y)), (on_map, (robot.x, robot.y)),
    ]:  # fmt: skip
        assert (mark.x, mark.y) == pytest.approx((x, y), abs=1e-3)
    assert marks_on("cells", round_) == {}, "a lesson about something else"


def test_a_packet_is_marked_where_it_is_put_and_the_winner_from_where_it_was_to_where_it_ends() -> None:
    near, far = (marks_on("cells", run_round(find_lesson("merge"), number)) for number in (0, 1))
    assert set(far) == {"packet put in", "it ended here"}
    put, end = far["packet put in"], far["it ended here"]
    assert end.start is not None
    assert put.start is None
    assert put.x - end.start[0] == pytest.approx(20, abs=1)
    assert set(near) == {"it ended here"}  # at once one packet with the other
    merged = near["it ended here"]
    assert merged.start is not None
    assert 0.3 < merged.x - merged.start[0] < 2


@pytest.mark.parametrize("name", ["packet"])
def test_the_way_of_a_packet_is_as_long_as_what_is_measured(name: str) -> None:
    round_ = run_round(find_lesson(name), 0)
    end = marks_on("cells", round_)["it ended here"]
    assert round_.values is not None
    assert end.start is not None
    way = round_.session.brain.pose_cells.cells_apart(*end.start[:2], end.x, end.y)
    assert way == pytest.approx(round_.values["cells_moved"], abs=0.01)
    assert way > 1
