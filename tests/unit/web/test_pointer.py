"""What people do with the pointer on the plates: clicks set goals, inspect and open doors; a drag kidnaps."""

from __future__ import annotations

from concurrent.futures import Future
from dataclasses import replace

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from web.messages import Accepted, Inspect, Kidnap, Refused, SetGoal
from web.viewer.fits.cell_fit import CellFit
from web.viewer.fits.map_fit import MapFit, refit
from web.viewer.fits.office_fit import OfficeFit
from web.viewer.plates.map_plate import NODE_Z
from web.viewer.plates.map_plate import ORIGIN as MAP_AT
from web.viewer.plates.office_plate import ORIGIN as OFFICE_AT
from web.viewer.plates.pose_cell_plate import ORIGIN as CELLS_AT
from web.viewer.pointer import BESIDE_MAP, NOT_THERE, NOTHING_THERE, Click, Drag, ask

SKY = (0.0, 0.0, 9.0)


@pytest.fixture
def bench(shared: Bench) -> Bench:
    """The shared bench as if new: nobody drags anything, a fresh engine, one snapshot drawn."""
    shared.show(fake_snapshot(430), 10.0)
    shared.settle()
    shared.engine.commands.clear()
    shared.engine.answers.clear()
    shared.complaints.clear()
    shared.told.clear()
    return shared


def on_map(x: float, y: float) -> tuple[float, float, float]:
    return MAP_AT[0] + x, MAP_AT[1] + y, MAP_AT[2] + NODE_Z


def press(bench: Bench, x: float, y: float, shift: bool = False) -> None:
    """A click on a place of the map's plate."""
    bench.click(on_map(x, y), shift)
    bench.show(None, 0.05)


def in_office(x: float, y: float) -> tuple[float, float, float]:
    at = OfficeFit(fake_snapshot(430).world.bounds).to_plate(np.array([[x, y]]))[0]
    return OFFICE_AT[0] + float(at[0]), OFFICE_AT[1] + float(at[1]), OFFICE_AT[2] + 0.15


def robot_at(bench: Bench) -> tuple[float, float]:
    """Where the robot stands in the office, metres."""
    fit = OfficeFit(fake_snapshot(430).world.bounds)
    x, y = fit.to_office(np.array([bench.node("/office/robot")["position"][:2]]))[0]
    return float(x), float(y)


# ---------------------------------------------------------------- clicks on the map


def test_a_click_on_the_map_sets_the_goal_there(bench: Bench) -> None:
    snapshot = fake_snapshot(430, goal=False)
    bench.show(snapshot)
    bench.click(on_map(1.5, -0.5))
    assert bench.engine.commands == []  # nothing happens in viser's thread
    bench.show(None, 0.05)
    (command,) = bench.engine.commands
    assert isinstance(command, SetGoal)
    fit = refit(MapFit(), snapshot.map.xy, snapshot.map_turn_rad)
    assert (command.x, command.y) == pytest.approx(tuple(fit.to_map(np.array([[1.5, -0.5]]))[0]), abs=1e-3)
    assert bench.visible("/map/clicked/ring_0")  # at once, before any answer
    bench.engine.answers[0].set_result(Accepted(431))
    bench.show(fake_snapshot(430, goal=False), 0.5)
    assert bench.visible("/map/clicked/ring_0")
    before = bench.node("/map/clicked")["position"]
    outgrown = replace(snapshot.map, xy=snapshot.map.xy * 3)
    bench.show(replace(snapshot, map=outgrown), 1.0)  # the map moves on the plate: the marker follows
    assert bench.node("/map/clicked")["position"] != pytest.approx(before, abs=1e-3)
    bench.show(fake_snapshot(432), 0.5)
    assert not bench.visible("/map/clicked/ring_0")


def test_a_refused_goal_takes_its_marker_away_and_says_why(bench: Bench) -> None:
    press(bench, 0.0, 0.0)
    bench.answer(Refused("x", 0.0, "no experience is near"))
    assert not bench.visible("/map/clicked/ring_0")
    assert bench.told == ["No goal set: no experience is near"]


def test_a_marker_does_not_wait_for_ever(bench: Bench) -> None:
    bench.show(fake_snapshot(430, goal=False))
    press(bench, 0.0, 0.0)
    bench.show(None, 10)
    assert not bench.visible("/map/clicked/ring_0")
    bench.answer(Accepted(1))  # too late for the marker, but it was carried out
    assert bench.told == [None]


@pytest.mark.parametrize(
    ("at", "why"),
    [((0.0, -6.6), NOTHING_THERE), ((-12.0, 0.0), NOTHING_THERE), ((5.2, 0.0), BESIDE_MAP), ((0.0, -4.6), BESIDE_MAP)],
)
def test_a_click_that_hits_nothing_says_so(bench: Bench, at: tuple[float, float], why: str) -> None:
    press(bench, *at)
    assert (bench.engine.commands, bench.told) == ([], [why])


def test_a_click_at_the_sky_says_so(bench: Bench) -> None:
    bench.viewer.click(Click(SKY, (0.0, 1.0, 0.1), bench.told.append))
    bench.show(None, 0.05)
    assert (bench.engine.commands, bench.told) == ([], [NOTHING_THERE])


def test_a_click_on_a_browser_that_is_not_there_says_so(bench: Bench) -> None:
    bench.viewer.press(99, (0.0, 0.0), False, bench.told.append)
    bench.show(None, 0.05)
    assert (bench.engine.commands, bench.told) == ([], [NOT_THERE])


def test_complaints_before_anybody_listens_are_nobody_s(bench: Bench) -> None:
    listener, bench.viewer.on_complaint = bench.viewer.on_complaint, None
    bench.viewer.drag(Drag(7, "end", False, SKY, (0.0, 1.0, 9.5)))
    bench.show(None, 0.05)
    bench.viewer.on_complaint = listener
    assert bench.complaints == []


# ---------------------------------------------------------------- clicks that inspect


def test_a_click_with_shift_inspects_the_experience_there(bench: Bench) -> None:
    snapshot = fake_snapshot(430)
    x, y = refit(MapFit(), snapshot.map.xy, snapshot.map_turn_rad).to_plate(snapshot.map.xy[20:21])[0]
    press(bench, x, y, shift=True)
    (command,) = bench.engine.commands
    assert isinstance(command, Inspect)
    assert command.experience is not None
    assert np.hypot(*(snapshot.map.xy[command.experience] - snapshot.map.xy[20])) < 0.05
    assert not bench.visible("/map/clicked/ring_0")


def test_with_the_switch_a_plain_click_inspects_and_beside_all_experiences_it_chooses_nothing(bench: Bench) -> None:
    bench.switch("click_inspects", True)
    press(bench, 0.0, 4.3)
    bench.switch("click_inspects", False)
    assert bench.engine.commands == [Inspect(type="inspect")]


def test_a_click_into_the_pose_cells_inspects_the_strongest_voxel_it_hits_or_the_floor(bench: Bench) -> None:
    layer = fake_snapshot(430).pose_cells
    _, y, x = layer.cells[0].tolist()
    voxel = CellFit(layer.shape).cells(layer.cells[:1])[0]
    for aim, wanted in ((voxel, (x, y)), (np.array([-3.4, -3.4, 0.0]), (0, 0))):
        bench.engine.commands.clear()
        bench.click(tuple(np.array(CELLS_AT) + aim))
        bench.show(None, 0.05)
        (command,) = bench.engine.commands
        assert isinstance(command, Inspect)
        assert (command.x, command.y) == wanted


def test_what_cannot_be_inspected_is_a_complaint(bench: Bench) -> None:
    bench.click((CELLS_AT[0] - 3.4, CELLS_AT[1] - 3.4, CELLS_AT[2]))
    bench.show(None, 0.05)
    bench.answer(Refused("x", 0, "there is no such cell"))
    assert bench.told == ["Nothing to inspect: there is no such cell"]


# ---------------------------------------------------------------- drags


def test_a_dragged_robot_is_kidnapped_where_it_is_dropped(bench: Bench) -> None:
    bench.drag(in_office(5.0, 4.0), "start")
    bench.drag(in_office(5.0, 0.8), "update")
    assert bench.visible("/office/room")
    fits = np.array(bench.node("/office/room")["colors"])
    bench.drag(in_office(2.8, 5.7), "update")  # a desk: another colour
    assert not np.array_equal(fits, bench.node("/office/room")["colors"])
    bench.show(fake_snapshot(436), 0.2)
    assert robot_at(bench) == pytest.approx((2.8, 5.7), abs=1e-4)
    bench.drag(in_office(5.0, 0.8), "end")
    (command,) = bench.engine.commands
    assert isinstance(command, Kidnap)
    assert (command.x, command.y) == pytest.approx((5.0, 0.8), abs=1e-6)
    assert command.heading_rad == pytest.approx(fake_snapshot(436).truth.heading_rad)
    bench.answer(Accepted(437), 0.2)
    assert not bench.visible("/office/room")
    assert not bench.complaints
    truth = fake_snapshot(436).truth
    assert robot_at(bench) == pytest.approx((truth.x, truth.y), abs=1e-4)  # back at the truth


def test_with_shift_it_turns_on_the_spot(bench: Bench) -> None:
    truth = fake_snapshot(430).truth
    bench.drag(in_office(truth.x, truth.y + 2), "start", turning=True)
    bench.drag(in_office(truth.x, truth.y + 2), "end", turning=True)
    (command,) = bench.engine.commands
    assert isinstance(command, Kidnap)
    assert (command.x, command.y) == (truth.x, truth.y)
    assert command.heading_rad == pytest.approx(np.pi / 2, abs=1e-5)
    bench.answer(Refused("x", 0.0, "no room"))
    assert bench.complaints == [(7, "The robot stays where it is: no room")]


def test_dropped_beside_the_office_it_stays(bench: Bench) -> None:
    """The engine says whether there is room: for the ring through the snapshot, for the drop by its answer."""
    bench.drag(in_office(30.0, 4.0), "start")
    no_room = np.array(bench.node("/office/room")["colors"])
    bench.drag(in_office(5.0, 0.8), "update")
    assert not np.array_equal(no_room, bench.node("/office/room")["colors"])
    bench.drag(in_office(30.0, 4.0), "end")
    (command,) = bench.engine.commands
    assert isinstance(command, Kidnap)
    assert command.x == pytest.approx(30.0, abs=1e-6)
    bench.answer(Refused("x, y", (30.0, 4.0), "(30, 4) is outside of office"))
    assert not bench.visible("/office/room")
    assert bench.complaints == [(7, "The robot stays where it is: (30, 4) is outside of office")]


def test_a_drag_into_the_sky_is_let_go(bench: Bench) -> None:
    before = robot_at(bench)
    for phase in ("update", "end"):
        bench.viewer.drag(Drag(7, phase, False, SKY, (0.0, 1.0, 9.5)))  # type: ignore[arg-type]
        bench.show(None, 0.05)
    assert bench.engine.commands == []
    assert robot_at(bench) == before


def test_before_the_first_snapshot_there_is_no_robot_to_drag() -> None:
    fresh = Bench()
    fresh.drag(in_office(5.0, 0.8), "end")
    assert fresh.engine.commands == []
    fresh.viewer.stop()


def test_a_broken_answer_is_a_refusal() -> None:
    got: list[Accepted | Refused] = []
    for spoil in (lambda f: f.set_exception(RuntimeError("engine gone")), lambda f: f.cancel()):
        future: Future[Accepted | Refused] = Future()
        ask(lambda _command, future=future: future, SetGoal(type="set_goal", x=0, y=0), got.append)
        spoil(future)
    assert [answer.reason for answer in got if isinstance(answer, Refused)] == ["engine gone", "the session has ended"]
