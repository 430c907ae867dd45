"""What people do with the pointer on the plates: clicks set goals, inspect and open doors; a drag kidnaps."""

from __future__ import annotations

from concurrent.futures import Future
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from web.messages import Accepted, Command, Inspect, Kidnap, Refused, SetGoal
from web.viewer.fits import CellFit, MapFit, OfficeFit, refit
from web.viewer.plates.map_plate import NODE_Z
from web.viewer.plates.map_plate import ORIGIN as MAP_AT
from web.viewer.plates.office_plate import ORIGIN as OFFICE_AT
from web.viewer.plates.pose_cell_plate import ORIGIN as CELLS_AT
from web.viewer.pointer import BESIDE_MAP, NOT_THERE, NOTHING_THERE, Click, Drag, ask

SKY = (0.0, 0.0, 9.0)
PLAIN, NO_GOAL = fake_snapshot(430), fake_snapshot(430, goal=False)
OFFICE = OfficeFit(PLAIN.world.bounds)
MAP = refit(MapFit(), PLAIN.map.xy, PLAIN.map_turn_rad)
RING = "/map/clicked/ring_0"


def press(stage: Bench, x: float, y: float, shift: bool = False) -> None:
    """A click on a place of the map's plate."""
    stage.click((MAP_AT[0] + x, MAP_AT[1] + y, MAP_AT[2] + NODE_Z), shift)
    stage.show(None, 0.05)


def in_office(x: float, y: float) -> tuple[float, float, float]:
    at = OFFICE.to_plate(np.array([[x, y]]))[0]
    return OFFICE_AT[0] + float(at[0]), OFFICE_AT[1] + float(at[1]), OFFICE_AT[2] + 0.15


def robot_at(stage: Bench) -> tuple[float, float]:
    """Where the robot stands in the office, metres."""
    x, y = OFFICE.to_office(np.array([stage.node("/office/robot")["position"][:2]]))[0]
    return float(x), float(y)


def the_command(stage: Bench, kind: type[Command]) -> Any:
    """The only one that there was, of this kind."""
    (command,) = stage.engine.commands
    assert isinstance(command, kind)
    return command


# ---------------------------------------------------------------- clicks on the map


def test_a_click_on_the_map_sets_the_goal_there_and_is_marked_until_it_is_set(stage: Bench) -> None:
    stage.show(NO_GOAL)
    stage.click((MAP_AT[0] + 1.5, MAP_AT[1] - 0.5, MAP_AT[2] + NODE_Z))
    assert stage.engine.commands == []  # nothing happens in viser's thread
    stage.show(None, 0.05)
    command = the_command(stage, SetGoal)
    assert (command.x, command.y) == pytest.approx(tuple(MAP.to_map(np.array([[1.5, -0.5]]))[0]), abs=1e-3)
    assert stage.visible(RING)  # at once, before any answer
    stage.engine.answers[0].set_result(Accepted(431))
    stage.show(NO_GOAL, 0.5)
    assert stage.visible(RING)
    before = stage.node("/map/clicked")["position"]
    stage.show(replace(NO_GOAL, map=replace(NO_GOAL.map, xy=NO_GOAL.map.xy * 3)), 1.0)  # the marker follows the map
    assert stage.node("/map/clicked")["position"] != pytest.approx(before, abs=1e-3)
    stage.show(fake_snapshot(432), 0.5)
    assert not stage.visible(RING)


def test_a_marker_goes_when_its_goal_is_refused_or_not_set_in_time(stage: Bench) -> None:
    stage.show(NO_GOAL)
    press(stage, 0.0, 0.0)
    stage.answer(Refused("x", 0.0, "no experience is near"))
    assert not stage.visible(RING)
    press(stage, 0.0, 0.0)
    assert stage.visible(RING)
    stage.show(None, 10)
    assert not stage.visible(RING)
    stage.answer(Accepted(1))  # too late for the marker, but it was carried out
    assert stage.told == ["No goal set: no experience is near", None]


def test_a_click_that_hits_nothing_says_so(stage: Bench) -> None:
    for x, y, why in (
        (0.0, -6.6, NOTHING_THERE), (-5.85, 0.0, NOTHING_THERE), (5.2, 0.0, BESIDE_MAP), (0.0, -4.6, BESIDE_MAP),
    ):  # fmt: skip
        press(stage, x, y)
        assert (x, y, stage.told.pop()) == (x, y, why)
    stage.viewer.click(Click(SKY, (0.0, 1.0, 0.1), stage.told.append))
    stage.viewer.press(99, (0.0, 0.0), False, stage.told.append)  # a browser that is not there
    stage.show(None, 0.05)
    assert (stage.engine.commands, stage.told) == ([], [NOTHING_THERE, NOT_THERE])


# ---------------------------------------------------------------- clicks that inspect


def test_a_click_with_shift_inspects_the_experience_there(stage: Bench) -> None:
    x, y = MAP.to_plate(PLAIN.map.xy[20:21])[0]
    press(stage, x, y, shift=True)
    found = the_command(stage, Inspect).experience
    assert np.hypot(*(PLAIN.map.xy[found] - PLAIN.map.xy[20])) < 0.05
    assert not stage.visible(RING)


def test_with_the_switch_a_plain_click_inspects_and_beside_all_experiences_it_chooses_nothing(stage: Bench) -> None:
    stage.switch("click_inspects", True)
    press(stage, 0.0, 4.3)
    stage.switch("click_inspects", False)
    assert stage.engine.commands == [Inspect(type="inspect")]


def test_a_click_into_the_pose_cells_inspects_the_strongest_voxel_it_hits_or_the_floor(stage: Bench) -> None:
    layer = PLAIN.pose_cells
    _, y, x = layer.cells[0].tolist()
    voxel = CellFit(layer.shape).cells(layer.cells[:1])[0]
    for aim, wanted in ((voxel, (x, y)), (np.array([-3.55, -3.55, 0.0]), (0, 0))):
        stage.engine.commands.clear()
        stage.click(tuple(np.array(CELLS_AT) + aim))
        stage.show(None, 0.05)
        command = the_command(stage, Inspect)
        assert (command.x, command.y) == wanted
    stage.answer(Refused("x", 0, "there is no such cell"))
    assert stage.told == ["Nothing to inspect: there is no such cell"]


# ---------------------------------------------------------------- drags


def test_a_dragged_robot_is_kidnapped_where_it_is_dropped(stage: Bench) -> None:
    stage.drag(in_office(5.0, 4.0), "start")
    stage.drag(in_office(5.0, 0.8), "update")
    assert stage.visible("/office/room")
    fits = np.array(stage.node("/office/room")["colors"])
    stage.drag(in_office(2.8, 5.7), "update")  # a desk: another colour
    assert not np.array_equal(fits, stage.node("/office/room")["colors"])
    stage.show(fake_snapshot(436), 0.2)
    assert robot_at(stage) == pytest.approx((2.8, 5.7), abs=1e-4)
    stage.drag(in_office(5.0, 0.8), "end")
    command, truth = the_command(stage, Kidnap), fake_snapshot(436).truth
    assert (command.x, command.y) == pytest.approx((5.0, 0.8), abs=1e-6)
    assert command.heading_rad == pytest.approx(truth.heading_rad)
    stage.answer(Accepted(437), 0.2)
    assert not stage.visible("/office/room")
    assert not stage.complaints
    assert robot_at(stage) == pytest.approx((truth.x, truth.y), abs=1e-4)  # back at the truth


def test_with_shift_it_turns_on_the_spot(stage: Bench) -> None:
    truth = PLAIN.truth
    for phase in ("start", "end"):
        stage.drag(in_office(truth.x, truth.y + 2), phase, turning=True)
    command = the_command(stage, Kidnap)
    assert (command.x, command.y) == (truth.x, truth.y)
    assert command.heading_rad == pytest.approx(np.pi / 2, abs=1e-5)
    stage.answer(Refused("x", 0.0, "no room"))
    assert stage.complaints == [(7, "The robot stays where it is: no room")]


def test_dropped_beside_the_office_it_stays(stage: Bench) -> None:
    """The engine says whether there is room: for the ring through the snapshot, for the drop by its answer."""
    stage.drag(in_office(30.0, 4.0), "start")
    no_room = np.array(stage.node("/office/room")["colors"])
    stage.drag(in_office(5.0, 0.8), "update")
    assert not np.array_equal(no_room, stage.node("/office/room")["colors"])
    stage.drag(in_office(30.0, 4.0), "end")
    assert the_command(stage, Kidnap).x == pytest.approx(30.0, abs=1e-6)
    stage.answer(Refused("x, y", (30.0, 4.0), "(30, 4) is outside of office"))
    assert not stage.visible("/office/room")
    assert stage.complaints == [(7, "The robot stays where it is: (30, 4) is outside of office")]


def test_a_drag_into_the_sky_is_let_go_whether_anybody_listens_or_not(stage: Bench) -> None:
    before, listener = robot_at(stage), stage.viewer.on_complaint
    for hears, phases in ((listener, ("update", "end")), (None, ("end",))):
        stage.viewer.on_complaint = hears
        for phase in phases:
            stage.viewer.drag(Drag(7, phase, False, SKY, (0.0, 1.0, 9.5)))  # type: ignore[arg-type]
            stage.show(None, 0.05)
    stage.viewer.on_complaint = listener
    assert (stage.engine.commands, robot_at(stage)) == ([], before)
    why = "The robot stays where it is: that is beside the office; drop it on free floor"
    assert stage.complaints == [(7, why)]


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


def test_who_points_is_told_what_a_click_does_and_a_click_does_that(stage: Bench) -> None:
    x, y = PLAIN.map.xy[0].tolist()
    node = stage.on_map(np.array([[x, y]]))[0]
    places = {
        "Click: the robot goes there": (MAP_AT[0] + float(node[0]), MAP_AT[1] + float(node[1]), NODE_Z),
        "Click: inspect these pose cells": (CELLS_AT[0] - 3.5, CELLS_AT[1] - 3.5, 0.0),
        "": (MAP_AT[0] - 5.85, MAP_AT[1], 0.0),
    }
    for words, place in places.items():
        stage.engine.commands.clear()
        assert stage.meaning(place) == words
        assert not stage.engine.commands  # pointing changes nothing
        stage.click(place)
        stage.show(None, 0.05)
        assert bool(stage.engine.commands) == bool(words)
