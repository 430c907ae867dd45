"""The stage on a real viser server, without a browser: what it sends, what it keeps, what people's hands do."""

from __future__ import annotations

import asyncio
import re
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Future
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from viser import _messages

from tests.fake_snapshots import fake_reports, fake_snapshot, fake_walk
from web.latest import Latest
from web.messages import (
    Accepted,
    Command,
    InjectPacket,
    Inspect,
    Kidnap,
    MapLayer,
    OccupancyPicture,
    Refused,
    Resume,
    SetGoal,
    SetParameter,
    Snapshot,
    Step,
    StepStage,
    TimesLayer,
)
from web.stage import Stage
from web.stage.camera_views import Camera, camera_for
from web.stage.cameras import Cameras
from web.stage.hand import Click, Drag, ask
from web.stage.map_fit import MapFit
from web.stage.map_plate import ORIGIN as MAP_AT
from web.stage.map_plate import seconds_words
from web.stage.memory_panel import clock, number
from web.stage.office_plate import ORIGIN as OFFICE_AT
from web.stage.rates import Layer
from web.stage.switches import Overlay
from web.stage.tune_panel import _step, hint, label


@dataclass
class Engine:
    """Takes down commands; answers when told to."""

    commands: list[Command] = field(default_factory=list)
    answers: list[Future[Accepted | Refused]] = field(default_factory=list)

    def submit(self, command: Command) -> Future[Accepted | Refused]:
        self.commands.append(command)
        self.answers.append(Future())
        return self.answers[-1]


class Bench:
    """A stage whose rounds a test runs itself, and whose messages it counts."""

    def __init__(self) -> None:
        self.engine, self.latest = Engine(), Latest[Snapshot]()
        self.stage = Stage(self.latest, self.engine.submit)
        self.now_s = 100.0
        self.sent = 0
        self.complaints: list[tuple[int, str, str]] = []
        queue_message = self.stage.server._websock_server.queue_message

        def counted(message: Any) -> None:
            self.sent += 1
            queue_message(message)

        self.stage.server._websock_server.queue_message = counted  # type: ignore[method-assign]
        self.stage._hand._complain = lambda *words: self.complaints.append(words)
        self.stage.panels.tune._complain = lambda *words: self.complaints.append(words)

    def show(self, snapshot: Snapshot | None, later_s: float = 1.0) -> int:
        """One round, `later_s` after the last; how many messages it sent."""
        self.now_s += later_s
        before = self.sent
        self.stage.tick(snapshot, self.now_s)
        return self.sent - before

    @property
    def nodes(self) -> int:
        return len(self.stage.server.scene._handle_from_node_name)

    def draws(self) -> dict[str, int]:
        return {name: layer.draws for name, layer in self.stage._layers.items()}


@pytest.fixture(scope="module")
def shared() -> Iterator[Bench]:
    bench = Bench()
    yield bench
    bench.stage.stop()


@pytest.fixture
def bench(shared: Bench) -> Bench:
    """As if new: no hand on anything, a fresh engine, one snapshot drawn."""
    shared.engine.commands.clear()
    shared.engine.answers.clear()
    shared.complaints.clear()
    shared.show(fake_snapshot(430), 10.0)
    shared.engine.commands.clear()
    return shared


# ---------------------------------------------------------------- life


def test_it_starts_and_stops_without_leaving_threads() -> None:
    before = set(threading.enumerate())
    latest: Latest[Snapshot] = Latest()
    stage = Stage(latest, Engine().submit, theme="light")
    stage.start()
    latest.put(fake_snapshot(3))
    stage.stop()
    stage.stop()
    deadline = time.monotonic() + 5
    while set(threading.enumerate()) - before and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not set(threading.enumerate()) - before


def test_only_the_loopback_and_no_way_to_ask_for_a_tunnel(bench: Bench) -> None:
    server = bench.stage.server
    assert server.get_host() == "127.0.0.1"
    assert bench.stage.port == server.get_port() > 0
    handlers = server._websock_server._incoming_handlers
    assert _messages.ShareUrlRequest not in handlers
    assert _messages.ShareUrlDisconnect not in handlers


# ---------------------------------------------------------------- what is sent


def test_nothing_new_sends_nothing(bench: Bench) -> None:
    snapshot = fake_snapshot(430)
    bench.show(snapshot)
    assert bench.show(snapshot) == 0


def test_only_changed_layers_are_drawn(bench: Bench) -> None:
    snapshot = fake_snapshot(440)
    bench.show(snapshot)
    before = bench.draws()
    bench.show(replace(snapshot, estimate=replace(snapshot.estimate)))
    after = bench.draws()
    assert {name for name in after if after[name] != before[name]} == {"estimate"}


def test_the_newest_wins_and_rates_are_kept(bench: Bench) -> None:
    bench.show(fake_snapshot(500))
    before = bench.draws()
    for k in range(40):  # two seconds at twenty a second
        bench.show(fake_snapshot(501 + k), 0.05)
    drawn = {name: count - before[name] for name, count in bench.draws().items()}
    assert drawn["world"] == 0
    assert 18 <= drawn["cells"] <= 21
    assert 9 <= drawn["glow"] <= 11
    assert drawn["map"] <= 5
    assert drawn["goal"] <= 7
    bench.show(None, 2.0)  # what was not due is drawn later, without another snapshot
    assert bench.stage._layers["goal"]._drawn == (fake_snapshot(540).goal,)


def test_handles_and_backlog_stay_the_same_over_two_hundred_snapshots(bench: Bench) -> None:
    backlog = bench.stage.server._websock_server._broadcast_buffer.message_from_id
    sizes, waiting = set(), []
    for k in range(200):
        bench.show(fake_snapshot(800 + 7 * k, goal=k % 40 < 30), 0.2)
        sizes.add(bench.nodes)
        waiting.append(len(backlog))
    assert len(sizes) == 1
    assert max(waiting[100:]) <= max(waiting[:100]) + 5
    assert bench.nodes < 230


# ---------------------------------------------------------------- what is laid over the floors


def switch(bench: Bench, overlay: Overlay, on: bool) -> None:
    bench.stage.panels.switches.turn(overlay, on)
    bench.show(None, 3)
    settle(bench)


def settle(bench: Bench) -> None:
    """Until what is drawn in another thread is there."""
    deadline = time.monotonic() + 5
    while bench.stage._drawing and time.monotonic() < deadline:
        time.sleep(0.01)
        bench.show(None, 0.05)
    bench.show(None, 0.5)


def test_occupancy_lies_under_the_map_while_it_is_switched_on(bench: Bench) -> None:
    plate = bench.stage._scenery.map
    bench.show(fake_snapshot(2000))
    switch(bench, "occupancy", False)
    assert not plate._occupancy.visible
    switch(bench, "occupancy", True)
    assert plate._occupancy.visible
    assert len(np.unique(plate._occupancy.image.reshape(-1, 3), axis=0)) > 2
    assert plate._picture is fake_snapshot(2000).occupancy.draw_map()  # type: ignore[union-attr]


def test_a_picture_that_comes_after_its_switch_was_turned_off_is_dropped(bench: Bench) -> None:
    stage = bench.stage
    switch(bench, "occupancy", False)
    late: Future[OccupancyPicture] = Future()
    late.set_result(fake_snapshot(0).occupancy.draw_map())  # type: ignore[union-attr]
    stage._lay_occupancy(stage._scenery.map, late)
    assert not stage._scenery.map._occupancy.visible
    switch(bench, "occupancy", True)


def test_the_pose_cells_floor_shows_what_is_switched_on(bench: Bench) -> None:
    plate = bench.stage._scenery.cells
    bench.show(fake_snapshot(2100))
    switch(bench, "cell_occupancy", False)
    switch(bench, "goal_memory", False)
    assert plate.under is plate._ground
    assert not plate._way.visible
    assert not plate._goal.visible
    switch(bench, "goal_memory", True)
    timed = plate.under
    assert timed is not plate._ground
    assert plate._way.visible
    assert plate._goal.visible
    switch(bench, "cell_occupancy", True)
    assert not np.array_equal(plate.under, timed)
    switch(bench, "cell_occupancy", False)
    bench.show(fake_snapshot(2100, goal=False), 2)
    assert plate.under is plate._ground
    assert not plate._way.visible


def test_unwatched_it_draws_nothing(bench: Bench) -> None:
    before = bench.sent
    bench.stage.tick(fake_snapshot(460), bench.now_s + 10, watched=False)
    assert bench.sent == before


def test_a_map_that_outgrows_its_room_gets_more(bench: Bench) -> None:
    plate, nodes = bench.stage._scenery.map, bench.nodes
    bench.show(fake_snapshot(450, nodes=2500), 5)
    bench.show(None, 5)
    assert plate._nodes.points.shape[0] >= 2500
    assert plate._nodes.colors[2400].any()
    assert bench.nodes == nodes


def test_a_theme_is_changed_for_all_and_back(bench: Bench) -> None:
    nodes = bench.nodes
    bench.stage.set_theme("light")
    bench.show(fake_snapshot(431))
    assert not bench.stage._scenery.office.palette.dark
    settle(bench)
    bench.stage.set_theme("light")
    assert bench.show(None) == 0
    bench.stage.set_theme("dark")
    bench.show(fake_snapshot(431))
    assert bench.stage._scenery.office.palette.dark
    assert bench.nodes == nodes
    with pytest.raises(KeyError):
        bench.stage.set_theme("sepia")  # type: ignore[arg-type]


def test_packets_bear_their_ids_whatever_their_rank(bench: Bench) -> None:
    s = fake_snapshot(440)
    first, second = s.pose_cells.packets
    swapped = replace(second, mass=first.mass), replace(first, mass=second.mass)
    for packets in ((first, second), swapped):
        bench.show(replace(s, pose_cells=replace(s.pose_cells, packets=packets)), 10.0)
        pills = bench.stage._scenery.cells._pills
        assert [pill._words.split()[0] for pill in pills[:2]] == [str(p.id) for p in packets]
        page = bench.stage.panels.memory._page.content
        assert page.index(f"{packets[0].id}: ") < page.index(f"{packets[1].id}: ")


@pytest.mark.parametrize("front_end", ["template", "complex cells", "hue and saturation", "scene numbers"])
def test_the_senses_show_what_the_front_end_sees(bench: Bench, front_end: str) -> None:
    """Grey or coloured, of any size; and which view a false positive took the place of."""
    s = fake_snapshot(432)
    shape = (8, 12, 3) if front_end == "hue and saturation" else (18, 108)
    seen, best = (np.full(shape, grey, np.uint8) for grey in (60, 200))
    senses = replace(
        s.senses, front_end=front_end, seen=seen, best=best, seen_words="what is seen", best_words="what was seen"
    )
    senses = replace(senses, best_view=12, active_view=311, false_positive=True, false_positives=7)
    bench.show(replace(s, senses=senses))
    page = bench.stage.panels.senses._views.content
    for words in (
        f"{front_end} now",
        "what is seen",
        "stored view 12: what was seen",
        "false positive 7: rightly #12",
        "#311",
    ):
        assert words in page
    assert f"aspect-ratio:{shape[1] / shape[0]:.4g}" in page


def test_empty_panels_say_why(bench: Bench) -> None:
    s = fake_snapshot(432, goal=False)
    nothing = MapLayer(
        np.zeros(0, np.int32), np.zeros((0, 2), np.float32), np.zeros(0, np.float32), np.zeros((0, 2), np.int32)
    )
    cells = replace(
        s.pose_cells, cells=s.pose_cells.cells[:0], activity=s.pose_cells.activity[:0], packets=(), last_snap=None
    )
    cells = replace(cells, path=np.zeros((0, 3), np.float32))
    senses = replace(s.senses, best=None, best_view=-1, difference=float("inf"), active_view=-1)
    series = replace(s.series, time_s=s.series.time_s[:1])
    s = replace(s, run=9, map=nothing, times=TimesLayer(False, np.zeros(0, np.float32)), pose_cells=cells, goal=None)
    s = replace(s, senses=senses, trail=s.trail[:1], events=(), series=series, parameters=(), views=0)
    bench.show(replace(s, revisit_consistency=None))
    stage = bench.stage
    assert stage._scenery.map._empty.handle.visible
    assert stage._scenery.cells._empty.handle.visible
    assert "every view is new" in stage.panels.senses._views.content
    assert "nothing to see" in stage.panels.senses._views.content
    assert "none active of 0" in stage.panels.senses._cells.content
    for words in ("no activity yet", "click on the map", "none yet"):
        assert words in stage.panels.memory._page.content
    assert "no revisits yet" in stage.panels.truth._page.content
    bench.show(fake_snapshot(433))
    assert not stage._scenery.map._empty.handle.visible


def test_a_larger_world_is_scaled_and_low(bench: Bench) -> None:
    s = fake_snapshot(434)
    desk = [
        (30, 30, 30.5, 30),
        (30.5, 30, 30.5, 30.5),
        (30.5, 30.5, 30, 30.5),
        (30, 30.5, 30, 30),
    ]  # too small for a screen
    walls = np.vstack([s.world.walls * 4, [(20, 5, 20, 9)], desk]).astype(np.float32)
    on_front_wall, screen = (3, 0, 4, 0, 1, 2), (10, 22.6, 10.5, 22.6, 0.8, 1.2)
    world = replace(
        s.world,
        bounds=(0, 0, 40, 32),
        walls=walls,
        wall_kind=(*s.world.wall_kind, "pillar", *("desk",) * 4),
        wall_height_m=np.append(s.world.wall_height_m, np.ones(5)).astype(np.float32),
        panels=np.array([on_front_wall, screen], np.float32),
        panel_rgb=s.world.panel_rgb[:2],
        places=(),
    )
    nodes = bench.nodes
    bench.show(replace(s, world=world), 10)
    assert bench.stage._scenery.office.fit.scale == pytest.approx(0.25)
    bare = replace(world, walls=walls[:0], wall_kind=(), wall_height_m=world.wall_height_m[:0], panels=world.panels[:0])
    bench.show(replace(s, world=bare), 10)
    bench.show(s, 10)
    assert bench.nodes == nodes


def test_before_the_first_world_there_is_no_robot_to_place(bench: Bench) -> None:
    office, s = bench.stage._scenery.office, fake_snapshot(0)
    kept, office.world = office.world, None
    before = office.robot.frame.position.copy()
    office.set_robot(s.truth, s.senses)
    office.world = kept
    assert np.array_equal(office.robot.frame.position, before)


@pytest.mark.parametrize(
    ("state", "eta", "words"),
    [
        ("tracking", 7.4, "7 s"),
        ("tracking", 300.0, "5 min"),
        ("exploring", None, "? s"),
        ("arrived", 0.0, "arrived"),
        ("unreachable", None, "no way known"),
    ],
)
def test_the_flag_says_how_long(bench: Bench, state: str, eta: float | None, words: str) -> None:
    s = fake_snapshot(435)
    assert s.goal is not None
    short = replace(
        s.goal, state=state, eta_s=eta, route_xy=s.goal.route_xy[:1], route_arrival_s=s.goal.route_arrival_s[:1]
    )
    bench.show(replace(s, goal=short))
    assert bench.stage._scenery.map._flag._pill._words == words


# ---------------------------------------------------------------- clicks


def click_at(x: float, y: float) -> Click:
    """From above, a little aslant, onto a place of the map plate (plate units)."""
    aim, eye = np.array([MAP_AT[0] + x, MAP_AT[1] + y, 0.05]), np.array([2.0, -20.0, 25.0])
    return Click(7, tuple(eye), tuple(aim - eye))


def press(bench: Bench, x: float, y: float, modifier: str | None = None) -> None:
    send_click(bench, click_at(x, y), modifier)


def send_click(bench: Bench, click: Click, modifier: str | None = None) -> None:
    event = SimpleNamespace(client_id=7, ray_origin=click.origin, ray_direction=click.direction, modifier=modifier)
    bench.stage._clicked(event)  # type: ignore[arg-type]


def test_a_click_on_the_map_sets_the_goal_there(bench: Bench) -> None:
    plate = bench.stage._scenery.map
    bench.show(fake_snapshot(430, goal=False))
    wanted = plate.fit.to_map(np.array([[1.5, -0.5]]))[0]
    press(bench, 1.5, -0.5)
    assert bench.engine.commands == []  # the callback only posts
    bench.show(None, 0.05)
    (command,) = bench.engine.commands
    assert isinstance(command, SetGoal)
    assert (command.x, command.y) == pytest.approx(tuple(wanted), abs=1e-6)
    assert plate._clicked.visible  # at once, before any answer
    bench.engine.answers[0].set_result(Accepted(431))
    bench.show(fake_snapshot(430, goal=False), 0.5)
    assert plate._clicked.visible
    before = plate._clicked.position.copy()
    plate.fit = MapFit(0.1)
    bench.stage._draw_map(fake_snapshot(450, nodes=60).map)  # the map moves on the plate: the marker follows
    assert not np.allclose(before, plate._clicked.position)
    bench.show(fake_snapshot(432), 0.5)
    assert not plate._clicked.visible


def test_a_refused_goal_takes_its_marker_away_and_says_why(bench: Bench) -> None:
    press(bench, 0.0, 0.0)
    bench.show(None, 0.05)
    bench.engine.answers[0].set_result(Refused("x", 0.0, "no experience is near"))
    bench.show(None, 0.05)
    assert not bench.stage._scenery.map._clicked.visible
    assert bench.complaints == [(7, "No goal set", "no experience is near")]


def test_a_marker_does_not_wait_for_ever(bench: Bench) -> None:
    bench.stage._hand.click(click_at(0, 0), bench.stage._scenery.map, bench.now_s)
    bench.show(None, 10)
    assert not bench.stage._scenery.map._clicked.visible
    bench.engine.answers[0].set_result(Accepted(1))  # too late to matter
    bench.show(None)


@pytest.mark.parametrize("at", [(5.5, 0.0), (0.0, -4.6), (-12.0, 0.0)])
def test_a_click_elsewhere_does_nothing(bench: Bench, at: tuple[float, float]) -> None:
    press(bench, *at)
    bench.show(None, 0.05)
    assert bench.engine.commands == []


def test_a_click_at_the_sky_does_nothing(bench: Bench) -> None:
    bench.stage._hand.click(Click(7, (0, 0, 9), (0, 1, 0.1)), bench.stage._scenery.map, 0)
    assert bench.engine.commands == []


# ---------------------------------------------------------------- drags


def drag_to(bench: Bench, x: float, y: float, phase: str, turning: bool = False) -> None:
    """The pointer over a place of the office (metres)."""
    on_plate = bench.stage._scenery.office.fit.to_plate(np.array([[x, y]]))[0]
    aim, eye = np.array([OFFICE_AT[0] + on_plate[0], OFFICE_AT[1] + on_plate[1], 0.15]), np.array([0.0, -25.0, 30.0])
    camera = SimpleNamespace(position=eye)
    event = SimpleNamespace(
        client_id=7, phase=phase, client=SimpleNamespace(camera=camera), end_position=tuple(eye + 0.9 * (aim - eye))
    )
    asyncio.run(bench.stage._dragged(turning)(event))  # type: ignore[arg-type]
    bench.show(None, 0.05)


def test_a_dragged_robot_is_kidnapped_where_it_is_dropped(bench: Bench) -> None:
    office, truth = bench.stage._scenery.office, fake_snapshot(430).truth
    drag_to(bench, 5.0, 4.0, "start")
    drag_to(bench, 5.0, 0.8, "update")
    assert office._room_for.visible
    teal = office._room_for.colors.copy()
    drag_to(bench, 2.8, 5.7, "update")  # a desk: another colour
    assert not np.array_equal(teal, office._room_for.colors)
    bench.show(fake_snapshot(436), 0.2)
    assert office.robot.frame.position[:2] == pytest.approx(office.fit.to_plate(np.array([[2.8, 5.7]]))[0], abs=1e-5)
    drag_to(bench, 5.0, 0.8, "end")
    (command,) = bench.engine.commands
    assert isinstance(command, Kidnap)
    assert (command.x, command.y) == pytest.approx((5.0, 0.8), abs=1e-6)
    assert command.heading_rad == pytest.approx(fake_snapshot(436).truth.heading_rad)
    bench.engine.answers[0].set_result(Accepted(437))
    bench.show(None, 0.2)
    assert not office._room_for.visible
    assert not bench.complaints
    here = office.fit.to_plate(np.array([[fake_snapshot(436).truth.x, fake_snapshot(436).truth.y]]))[0]
    assert office.robot.frame.position[:2] == pytest.approx(here, abs=1e-5)  # back at the truth
    assert truth is not None


def test_with_shift_it_turns_on_the_spot(bench: Bench) -> None:
    truth = fake_snapshot(430).truth
    drag_to(bench, truth.x, truth.y + 2, "start", turning=True)
    drag_to(bench, truth.x, truth.y + 2, "end", turning=True)
    (command,) = bench.engine.commands
    assert isinstance(command, Kidnap)
    assert (command.x, command.y) == (truth.x, truth.y)
    assert command.heading_rad == pytest.approx(np.pi / 2, abs=1e-5)
    bench.engine.answers[0].set_result(Refused("x", 0.0, "no room"))
    bench.show(None, 0.1)
    assert bench.complaints[0][2] == "no room"


def test_dropped_beside_the_office_it_stays(bench: Bench) -> None:
    drag_to(bench, 30.0, 4.0, "start")
    drag_to(bench, 30.0, 4.0, "end")
    assert bench.engine.commands == []
    assert not bench.stage._scenery.office._room_for.visible


def test_a_drag_into_the_sky_is_let_go(bench: Bench) -> None:
    snapshot, office = fake_snapshot(430), bench.stage._scenery.office
    for phase in ("update", "end"):
        bench.stage._hand.drag(Drag(7, phase, False, (0, 0, 9), (0, 1, 9.5)), office, snapshot)  # type: ignore[arg-type]
    assert not bench.stage._hand.dragging
    stage = bench.stage
    kept, stage._snapshot = stage._snapshot, None
    stage._drag(Drag(7, "end", False, (0, 0, 9), (0, 1, 8)))  # before the first snapshot
    stage._snapshot = kept
    assert bench.engine.commands == []


def test_a_broken_answer_is_a_refusal() -> None:
    got: list[Accepted | Refused] = []
    for spoil in (lambda f: f.set_exception(RuntimeError("engine gone")), lambda f: f.cancel()):
        future: Future[Accepted | Refused] = Future()
        ask(lambda _command, future=future: future, SetGoal(type="set_goal", x=0, y=0), got.append)
        spoil(future)
    assert [answer.reason for answer in got if isinstance(answer, Refused)] == ["engine gone", "the session has ended"]


# ---------------------------------------------------------------- parameters


def turn(bench: Bench, name: str, value: object, client_id: int | None = 7) -> None:
    handle = bench.stage.panels.tune._knobs[name].handle
    handle._impl.value = value  # as viser does before it calls back
    for callback in handle._impl.update_cb:
        callback(SimpleNamespace(client_id=client_id, target=handle))


def test_a_turned_knob_is_a_command_and_the_newest_value_wins(bench: Bench) -> None:
    turn(bench, "pilot.speed", 0.35)
    turn(bench, "pilot.speed", 0.4)
    bench.show(None, 0.3)
    assert bench.engine.commands == [SetParameter(type="set_parameter", name="pilot.speed", value=0.4)]
    bench.engine.answers[0].set_result(Accepted(431))
    bench.show(None, 0.3)
    assert not bench.complaints


def test_a_refused_value_goes_back(bench: Bench) -> None:
    turn(bench, "pose_cells.injection", 0.9)
    bench.show(None, 0.3)
    bench.engine.answers[0].set_result(Refused("value", 0.9, "at most 0.5"))
    bench.show(None, 0.3)
    assert bench.stage.panels.tune._knobs["pose_cells.injection"].handle.value == 0.1
    assert bench.complaints == [(7, "pose_cells.injection", "at most 0.5")]


def test_values_changed_elsewhere_follow_without_an_echo(bench: Bench) -> None:
    s = fake_snapshot(430)
    faster = tuple(replace(p, value=0.2) if p.name == "pilot.speed" else p for p in s.parameters)
    bench.show(replace(s, parameters=faster))
    assert bench.stage.panels.tune._knobs["pilot.speed"].handle.value == 0.2
    bench.show(s)
    assert bench.stage.panels.tune._knobs["pilot.speed"].handle.value == 0.3
    assert bench.engine.commands == []


def test_other_names_build_other_knobs(bench: Bench) -> None:
    s = fake_snapshot(430)
    turn(bench, "pilot.wander", False)
    bench.show(replace(s, parameters=s.parameters[:3]), 0.01)
    assert list(bench.stage.panels.tune._knobs) == [p.name for p in s.parameters[:3]]
    bench.show(s, 1)  # the turned knob was gone: nothing to send
    assert all(not isinstance(c, SetParameter) or c.name != "x" for c in bench.engine.commands)
    bench.stage.panels.tune._submit("unknown", 7, 1.0)


def test_every_parameter_explains_itself() -> None:
    by_name = {p.name: p for p in fake_snapshot(0).parameters}
    fixed, live = by_name["pose_cells.cells"], by_name["pilot.speed"]
    assert label(live) == "speed v [m/s]"
    assert "↻" in label(fixed)
    assert "Takes effect at reset." in hint(fixed)
    assert "Range: 0.05 to 0.5 m/s." in hint(live)
    assert "Range" not in hint(by_name["views.kind"])
    assert _step(fixed) == 1
    assert _step(live) == pytest.approx(0.002)
    assert _step(replace(live, low=None)) == pytest.approx(0.001)
    assert "Range:  to 0.5" in hint(replace(live, low=None))


# ---------------------------------------------------------------- cameras


class FakeCamera(SimpleNamespace):
    def on_update(self, callback: Any) -> None:
        self.moved = callback


def browser(client_id: int, aspect: float) -> Any:
    camera = FakeCamera(aspect=aspect, position=np.zeros(3), look_at=np.ones(3), fov=0.5, up_direction=None)
    return SimpleNamespace(client_id=client_id, camera=camera, atomic=threading.Lock)


class FakeServer(SimpleNamespace):
    def get_clients(self) -> dict[int, Any]:
        return self.clients


def test_cameras_are_framed_flown_and_framed_anew() -> None:
    screen, phone = browser(1, 1.5), browser(2, 0.46)
    server = FakeServer(clients={1: screen, 2: phone}, initial_camera=SimpleNamespace())
    posted: list[Any] = []
    cameras = Cameras(server, posted.append)  # type: ignore[arg-type]
    assert server.initial_camera.far > server.initial_camera.near
    cameras.fly_on(0.0)
    cameras.welcome(screen)
    cameras.welcome(phone)
    assert cameras.flying
    cameras.fly_on(0.0)
    assert not cameras.flying
    assert np.allclose(screen.camera.position, camera_for("all", 1.5).position)
    assert np.allclose(phone.camera.position, camera_for("map", 0.46).position)

    cameras.take_off(1, "pose", 10.0)
    cameras.fly_on(10.35)
    assert cameras.flying
    cameras.fly_on(11.0)
    assert np.allclose(screen.camera.position, camera_for("pose", 1.5).position)
    assert np.allclose(phone.camera.position, camera_for("map", 0.46).position)

    asyncio.run(screen.camera.moved(screen.camera))  # orbiting alone changes nothing
    screen.camera.aspect = 1.0
    asyncio.run(screen.camera.moved(screen.camera))
    assert len(posted) == 1
    posted[0]()
    cameras.fly_on(12.0)
    assert np.allclose(screen.camera.position, camera_for("pose", 1.0).position)

    cameras.take_off(None, "map", 20.0)
    del server.clients[2]
    cameras.farewell(1)
    cameras.fly_on(20.1)
    assert not cameras.flying
    cameras.reframe(9)
    assert isinstance(camera_for("all", 1.0), Camera)


def test_views_have_names(bench: Bench) -> None:
    with pytest.raises(ValueError, match=re.escape("unknown view 'moon'; expected one of: all, office, pose, map")):
        bench.stage.fly(None, "moon")
    bench.stage.fly(3, "map")
    bench.show(None)


def test_browsers_that_come_are_announced(bench: Bench) -> None:
    arrived: list[int] = []
    bench.stage.on_connect = arrived.append
    bench.stage._connected(browser(5, 1.2))
    bench.show(None)
    bench.stage.on_connect = None
    bench.stage._connected(browser(6, 1.2))
    bench.stage._disconnected(browser(5, 1.2))
    bench.show(None)
    assert arrived == [5]


def test_complaints_reach_the_browser_that_asked(bench: Bench) -> None:
    shown: list[tuple[str, str]] = []
    client = SimpleNamespace(add_notification=lambda title, body, **_: shown.append((title, body)))
    get_clients = bench.stage.server.get_clients
    bench.stage.server.get_clients = lambda: {7: client}  # type: ignore[method-assign,assignment,return-value]
    bench.stage._complain(7, "No goal set", "why")
    bench.stage._complain(8, "No goal set", "gone")
    bench.stage.server.get_clients = get_clients  # type: ignore[method-assign]
    assert shown == [("No goal set", "why")]


# ---------------------------------------------------------------- small things


def test_a_layer_waits_its_turn_and_forgets_on_request() -> None:
    drawn: list[object] = []
    layer = Layer(10, drawn.append)
    first, second = object(), object()
    assert layer.offer(0.0, first)
    assert not layer.offer(1.0, first)
    assert layer.offer(1.0, second)
    assert not layer.offer(1.05, first)
    layer.forget()
    assert layer.offer(1.05, second)
    assert drawn == [first, second, second]


def test_words_for_numbers() -> None:
    assert clock(128.9) == "2:08"
    assert number(None, "m") == number(float("nan"), "m") == "-"
    assert number(1.234, "m", 2) == "1.23 m"
    assert seconds_words(119.0) == "119 s"


# ---------------------------------------------------------------- inspectors


def test_a_click_with_shift_inspects_the_experience_there(bench: Bench) -> None:
    snapshot = fake_snapshot(430)
    plate = bench.stage._scenery.map
    x, y = plate.fit.to_plate(snapshot.map.xy[20:21])[0]
    press(bench, x, y, "shift")
    bench.show(None, 0.05)
    (command,) = bench.engine.commands
    assert isinstance(command, Inspect)
    assert command.experience is not None
    assert np.hypot(*(snapshot.map.xy[command.experience] - snapshot.map.xy[20])) < 0.05
    assert not plate._clicked.visible


def test_with_the_switch_a_plain_click_inspects_and_beside_all_experiences_it_chooses_nothing(bench: Bench) -> None:
    panel = bench.stage.panels.inspect
    panel._switch.value = True
    press(bench, 0.0, 4.3)
    bench.show(None, 0.05)
    panel._switch.value = False
    (command,) = bench.engine.commands
    assert command == Inspect(type="inspect")


def test_a_click_into_the_pose_cells_inspects_the_strongest_voxel_it_hits_or_the_floor(bench: Bench) -> None:
    snapshot = fake_snapshot(430)
    plate = bench.stage._scenery.cells
    _, y, x = snapshot.pose_cells.cells[0].tolist()
    eye = np.array([2.0, -20.0, 25.0])
    for aim, wanted in (
        (plate._fit.cells(snapshot.pose_cells.cells[:1])[0], (x, y)),
        (np.array([-3.4, -3.4, 0.0]), (0, 0)),
    ):
        bench.engine.commands.clear()
        send_click(bench, Click(7, tuple(eye), tuple(aim + plate.origin - eye)))
        bench.show(None, 0.05)
        (command,) = bench.engine.commands
        assert isinstance(command, Inspect)
        assert (command.x, command.y) == wanted


def test_what_cannot_be_inspected_is_a_complaint(bench: Bench) -> None:
    bench.stage.panels.inspect._complain = lambda *words: bench.complaints.append(words)
    bench.stage.panels.inspect.choose(7, experience=99)
    bench.engine.answers[0].set_result(Refused("experience", 99, "experience must be from 0 to 5, got 99"))
    bench.show(None, 0.05)
    assert bench.complaints == [(7, "Nothing to inspect", "experience must be from 0 to 5, got 99")]


@pytest.mark.parametrize("kind", ["experience", "view", "cell"])
def test_what_is_inspected_is_told_and_marked(bench: Bench, kind: str) -> None:
    reports = fake_reports()
    stage, plates = bench.stage, bench.stage._scenery
    bench.show(replace(fake_snapshot(430), inspected=reports[kind]), 5)
    words = {
        "experience": ("#12", "its view #7", "Links to other experiences: 2", "1.50 m at 45°", "following the wall",
                       "confidence 80 %", "first", "1:05", "gone 3 times"),
        "view": ("#7", "12.5", "another view", "#12<", "#40<", "pose cells linked"),
        "cell": ("31, 22", "40 % of all activity", "3, with 62 %", "#7<", "0.050", "Experiences whose zone"),
    }[kind]  # fmt: skip
    page = stage.panels.inspect._page.content
    for word in words:
        assert word in page, word
    assert plates.map.mark.frame.visible == (kind == "experience")
    assert plates.map.mark.pill.frame.visible == (kind == "experience")
    assert (plates.map.mark.links.points > -40).any()
    assert (plates.cells.mark.zone.points > -40).any() == (kind != "view")
    cells = plates.cells.mark.cells
    assert cells is not None
    assert (cells.batched_positions > -40).any() == (kind != "cell")
    assert (plates.cells.under is plates.cells._ground) == (kind != "experience") or stage.panels.switches.is_on(
        "goal_memory"
    )
    bench.show(replace(fake_snapshot(430), inspected=None), 5)
    assert "Nothing is chosen" in stage.panels.inspect._page.content
    assert not plates.map.mark.frame.visible
    assert not (plates.map.mark.links.points > -40).any()


def test_buttons_choose_what_is_active_now(bench: Bench) -> None:
    panel, snapshot = bench.stage.panels.inspect, fake_snapshot(430)
    bench.show(replace(snapshot, active_experience=17), 5)

    def pressed(value: str) -> Command:
        bench.engine.commands.clear()
        panel._pressed(SimpleNamespace(client_id=7, target=SimpleNamespace(value=value)))  # type: ignore[arg-type]
        (command,) = bench.engine.commands
        return command

    assert pressed("experience") == Inspect(type="inspect", experience=17)
    assert pressed("view") == Inspect(type="inspect", view=snapshot.senses.active_view)
    assert pressed("nothing") == Inspect(type="inspect")
    bench.engine.commands.clear()
    panel._typed(SimpleNamespace(client_id=7, target=SimpleNamespace(value=4)), "view")  # type: ignore[arg-type]
    assert bench.engine.commands == [Inspect(type="inspect", view=4)]
    panel._typed(SimpleNamespace(client_id=None, target=SimpleNamespace(value=5)), "view")  # type: ignore[arg-type]
    assert len(bench.engine.commands) == 1  # not a person


# ---------------------------------------------------------------- one tick


def test_a_walk_is_told_stage_by_stage(bench: Bench) -> None:
    panel = bench.stage.panels.tick
    bench.show(fake_snapshot(430), 5)
    assert "Press next stage" in panel._walk.content
    bench.show(replace(fake_snapshot(430), walk=fake_walk(1)), 5)
    page = panel._walk.content
    assert "Stage 2 of 3" in page
    assert "This is what the image did." in page
    assert "This is what the injection did." in page
    assert "This is what the correction did." not in page  # it comes later
    assert "Correction" in page


def test_timings_are_bars_and_milliseconds(bench: Bench) -> None:
    bench.show(fake_snapshot(430), 5)
    page = bench.stage.panels.tick._timings.content
    assert "A tick takes 1.80 of its 100 ms" in page
    assert "view match" in page
    assert "0.25, worst 0.7 ms" in page


@pytest.mark.parametrize(
    ("button", "command"),
    [
        ("back", StepStage(type="step_stage", back=True)),
        ("next stage", StepStage(type="step_stage")),
        ("tick", Step(type="step")),
        ("play", Resume(type="resume")),
    ],
)
def test_the_tick_s_buttons(bench: Bench, button: str, command: Command) -> None:
    panel = bench.stage.panels.tick
    panel._complain = lambda *words: bench.complaints.append(words)
    panel._pressed(SimpleNamespace(client_id=7, target=SimpleNamespace(value=button)))  # type: ignore[arg-type]
    assert bench.engine.commands == [command]
    bench.engine.answers[0].set_result(Refused("back", True, "there is no stage before this one"))
    bench.show(None, 0.05)
    assert bench.complaints == [(7, "Not done", "there is no stage before this one")]


def test_the_residual_of_map_correction_is_told_and_drawn(bench: Bench) -> None:
    snapshot = fake_snapshot(930)
    bench.show(snapshot, 5)
    truth = bench.stage.panels.truth
    assert f"a residual of {snapshot.series.residual_mm[-1]:.1f} mm" in truth._residual_words.content
    assert np.array_equal(truth._residual.data[1], snapshot.series.residual_mm)


def test_a_packet_is_injected_where_the_cell_is(bench: Bench) -> None:
    panel = bench.stage.panels.inspect
    panel._complain = lambda *words: bench.complaints.append(words)
    person = SimpleNamespace(client_id=7)
    bench.show(replace(fake_snapshot(430), inspected=None), 5)
    assert not panel._packet.visible
    panel._inject(person)  # type: ignore[arg-type]
    assert bench.engine.commands == []
    bench.show(replace(fake_snapshot(430), inspected=fake_reports()["cell"]), 5)
    assert panel._packet.visible
    panel._inject(person)  # type: ignore[arg-type]
    (command,) = bench.engine.commands
    assert command == InjectPacket(type="inject_packet", x=31, y=22, heading_rad=0.0, share=0.45)
    bench.engine.answers[0].set_result(Refused("x, y", (31, 22), "a pose cell has x from 0 to 20"))
    bench.show(None, 0.05)
    assert bench.complaints == [(7, "No packet injected", "a pose cell has x from 0 to 20")]
