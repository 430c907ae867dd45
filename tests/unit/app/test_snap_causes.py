"""A snap says which links made it: views, how often they injected around the packet that won, and how much."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from app.views.snap_causes import SnapCauses, words_of
from ratslam_core import LocalViewParams, PoseCells, Recognition
from ratslam_core.visual_association import VisualAssociation
from web.messages import SnapCause

pytestmark = pytest.mark.slow

HERE, THERE = (8, 8, 0), (40, 50, 9)


class Bench:
    """Pose cells and views that a test links and looks at by hand."""

    def __init__(self) -> None:
        self.pose_cells, self.association = PoseCells(), VisualAssociation(LocalViewParams(rest=0.0, injection=0.3))
        self.causes = SnapCauses(SimpleNamespace(brain=self, time_s=0.0))  # type: ignore[arg-type]

    def learn(self, view: int, place: tuple[int, int, int]) -> None:
        """Link a new view to a place, as strongly as by a long look."""
        self.pose_cells.place(*place)
        self.pose_cells.attract()
        for k in range(30):
            links = self.association.links
            if k == 0:
                self.association.step(Recognition(view, True, -1, 99.0), 1.0, 0.1, self.pose_cells, False)
            links.learn(view, *self.pose_cells.active, self.pose_cells.slot)

    def look(self, view: int) -> None:
        self.association.step(Recognition(view, False, view, 1.0), 1.0, 0.1, self.pose_cells, False)
        self.pose_cells.attract()
        self.causes.watch()

    def at(self, place: tuple[int, int, int]) -> bool:
        return self.pose_cells.cells_apart(*place[:2], self.pose_cells.winner.x, self.pose_cells.winner.y) < 3


def test_the_views_that_fed_the_winner_are_told_the_strongest_first() -> None:
    bench = Bench()
    for view, place in ((0, HERE), (1, THERE), (2, THERE)):
        bench.learn(view, place)
    bench.pose_cells.place(*HERE)
    looks: list[int] = []
    for view in (0, 0, -1, *(1, 1, -1, 2) * 60):
        looks.append(view)
        bench.look(view)
        if bench.at(THERE):
            break
    assert bench.at(THERE)
    causes = bench.causes.of(bench.pose_cells.winner)
    assert [cause.view for cause in causes] == [1, 2]  # not 0, which fed the other packet
    assert [cause.looks for cause in causes] == [looks.count(1), looks.count(2)]
    assert sum(cause.share for cause in causes) == pytest.approx(1.0)
    for cause in causes:
        cells, strength = bench.association.links.of(cause.view)
        assert 0 < cause.links <= len(cells)
        assert cause.strongest == pytest.approx(strength.max())
        assert cause.age_s == pytest.approx(bench.association.age_s(cause.view))
    assert causes[0].amount > causes[1].amount > 0


def test_what_fed_the_place_before_the_packet_came_into_being_does_not_count() -> None:
    bench = Bench()
    for view, place in ((0, HERE), (1, THERE)):
        bench.learn(view, place)
    bench.pose_cells.place(*THERE)
    for view in (1, 1, 1):
        bench.look(view)
    bench.pose_cells.place(*HERE)  # that packet is gone
    for _ in range(5):
        bench.look(0)
    (cause,) = bench.causes.of(bench.pose_cells.winner)
    assert (cause.view, cause.looks) == (0, 5)
    bench = Bench()
    bench.look(-1)
    assert bench.causes.of(bench.pose_cells.winner) == ()  # a packet that no view made


def test_the_words_of_causes() -> None:
    cause = SnapCause(312, 7, 1.2, 0.41, 90, 0.02, 61.3)
    assert words_of((cause,)) == "by view 312 (7 looks, 0.41 of the injected activity, learnt 61 s before)"
    assert words_of((cause, cause, cause)).endswith("before) and 2 more")
    assert words_of((SnapCause(1, 1, 1.0, 1.0, 1, 0.1, 0.0),)).startswith("by view 1 (1 look, 1.00 of")
    assert words_of(()) == "no view put activity there"
