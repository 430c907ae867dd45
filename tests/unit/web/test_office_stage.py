"""What lives in the office, on the stage and in its tab, without a browser."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from viser._messages import GuiUpdateMessage

from tests.fake_snapshots import fake_snapshot
from web.latest import Latest
from web.messages import (
    Accepted,
    Command,
    LivingLayer,
    Parameter,
    Refused,
    SetDoor,
    SetLamp,
    SetParameter,
    Snapshot,
    UsePreset,
)
from web.stage import Stage
from web.stage.office_panel import OWN
from web.stage.office_plate import ORIGIN

PEOPLE = Parameter("office.people", True, True, "", "", None, None, "people walk", "ours", True)
SEED = Parameter("office.seed", 0, 0, "", "", 0, 99, "of people", "ours", False)


def living(**changes: Any) -> LivingLayer:
    layer = LivingLayer(
        door_names=("lab", "hall"),
        doors=np.array([(2.0, 4.0, 3.0, 4.0), (8.0, 4.0, 8.0, 5.0)], np.float32),
        door_wanted=np.array([False, True]),
        door_opening=np.array([0.0, 1.0], np.float32),
        box_names=("crate",),
        boxes=np.array([(5.0, 7.0, 0.5, 0.4, 0.6, 0.3)], np.float32),
        box_rgb=np.array([(176, 137, 86)], np.uint8),
        person_names=("ann", "bob"),
        people=np.array([(1.0, 1.0, 0.0, 0.22, 1.7), (6.0, 1.0, 1.0, 0.22, 1.8)], np.float32),
        people_rgb=np.array([(86, 110, 150), (150, 60, 50)], np.uint8),
        lamp_names=("sun",),
        lamps=np.array([(5.0, 4.0, 3.0, 1.0)], np.float32),
        lamp_on=np.array([True]),
        daylight=1.0,
    )
    return replace(layer, **changes)


class Office:
    """A stage, the commands that come out of it and what it complains of."""

    def __init__(self) -> None:
        self.commands: list[Command] = []
        self.answers: list[Future[Accepted | Refused]] = []
        self.complaints: list[tuple[int, str, str]] = []
        self.stage = Stage(Latest[Snapshot](), self._submit)
        self.stage.panels.office._complain = lambda *words: self.complaints.append(words)
        self.stage._hand._complain = lambda *words: self.complaints.append(words)
        self.now_s, self.sent = 100.0, 0
        self.updated: set[str] = set()  # of the things on the panels
        queue_message = self.stage.server._websock_server.queue_message

        def counted(message: Any) -> None:
            self.sent += 1
            if isinstance(message, GuiUpdateMessage):
                self.updated.add(message.uuid)
            queue_message(message)

        self.stage.server._websock_server.queue_message = counted  # type: ignore[method-assign]

    def _submit(self, command: Command) -> Future[Accepted | Refused]:
        self.commands.append(command)
        self.answers.append(Future())
        return self.answers[-1]

    def show(self, layer: LivingLayer | None, preset: str = "", people: bool = True) -> int:
        before, self.now_s = self.sent, self.now_s + 1.0
        snapshot = replace(fake_snapshot(430), parameters=(replace(PEOPLE, value=people), SEED), living=layer)
        self.stage.tick(replace(snapshot, presets=PRESETS, preset=preset), self.now_s)
        return self.sent - before

    @property
    def things(self) -> Any:
        return self.stage._scenery.office.things

    def turn(self, key: tuple[str, str], value: object) -> None:
        """As viser tells of what a person in browser 7 did."""
        panel = self.stage.panels.office
        handle = panel._preset if key[0] == "preset" else panel._switches[key].handle
        handle.value = value
        for callback in handle._impl.update_cb:
            callback(SimpleNamespace(client_id=7, target=handle))


PRESETS = ("Pioneer 2DXE 2004", "ideal")


@pytest.fixture
def office() -> Iterator[Office]:
    made = Office()
    made.show(living())
    made.commands.clear()
    yield made
    made.stage.stop()


def shown(office: Office) -> dict[str, int]:
    counts = {kind: sum(t.handle.visible for t in things) for kind, things in office.things._handles.items()}
    return counts | {"person": len(standing(office))}


def standing(office: Office) -> Any:
    """(n, 3): where people are on the plate."""
    crowd = office.things._crowd._handle
    return crowd.batched_positions[crowd.batched_positions[:, 2] > -1.0] if crowd.visible else []


def test_every_living_thing_stands_on_the_plate(office: Office) -> None:
    assert shown(office) == {"door": 2, "box": 1, "person": 2, "lamp": 1}
    fit = office.stage._scenery.office.fit
    assert standing(office)[:, :2] == pytest.approx(fit.to_plate(np.array([[1.0, 1.0], [6.0, 1.0]])))
    assert office.things._pools.visible
    assert not office.things._dark.visible
    office.show(living(people=living().people[:1], people_rgb=living().people_rgb[1:], boxes=np.zeros((0, 6))))
    assert shown(office) == {"door": 2, "box": 0, "person": 1, "lamp": 1}
    office.show(None)
    assert shown(office) == {"door": 0, "box": 0, "person": 0, "lamp": 0}
    assert not office.things._pools.visible


def test_who_walks_is_moved_and_who_stands_sends_nothing(office: Office) -> None:
    snapshot = living()
    office.show(snapshot)
    crowd, before = office.things._crowd._handle, standing(office).copy()
    still = office.show(replace(snapshot, people=snapshot.people.copy()))
    walked = snapshot.people.copy()
    walked[0, 0] += 0.5
    assert office.show(replace(snapshot, people=walked)) == still + 1  # their places, and nothing else
    after = standing(office)
    assert after[0, 0] > before[0, 0]
    assert np.array_equal(after[1], before[1])
    more = np.vstack([walked, walked + np.float32([1, 1, 0, 0, 0])])
    office.show(replace(snapshot, people=more, people_rgb=np.tile(snapshot.people_rgb, (2, 1))))
    assert shown(office)["person"] == 4
    assert crowd is not office.things._crowd._handle  # there was no place for them
    office.show(snapshot)
    assert np.array_equal(standing(office), before)


def test_lamps_and_daylight_change_the_floor(office: Office) -> None:
    lit = tuple(office.things._handles["lamp"][0].handle.color)
    dark = np.array([(5.0, 4.0, 3.0, 0.0)], np.float32)
    office.show(living(lamps=dark, lamp_on=np.array([False]), daylight=0.4))
    assert tuple(office.things._handles["lamp"][0].handle.color) != lit
    assert not office.things._pools.visible
    assert office.things._dark.visible
    assert office.things._dark.opacity == pytest.approx(0.45)


def click(office: Office, x: float, y: float) -> None:
    plate = office.stage._scenery.office
    at = plate.fit.to_plate(np.array([[x, y]]))[0]
    aim, eye = np.array([ORIGIN[0] + at[0], ORIGIN[1] + at[1], 0.25]), np.array([0.0, -25.0, 30.0])
    ray = {"ray_origin": tuple(eye), "ray_direction": tuple(aim - eye)}
    office.stage._clicked(SimpleNamespace(client_id=7, modifier=None, **ray))  # type: ignore[arg-type]
    office.show(office.things.layer)


def test_a_click_on_a_leaf_opens_or_shuts_it(office: Office) -> None:
    click(office, 2.5, 4.0)
    click(office, 8.0, 4.5)
    assert office.commands == [
        SetDoor(type="set_door", name="lab", open=True),
        SetDoor(type="set_door", name="hall", open=False),
    ]
    office.answers[-1].set_result(Refused("name", "hall", "no door named 'hall'"))
    office.show(living())
    assert office.complaints == [(7, "The door stays as it is", "no door named 'hall'")]
    click(office, 5.0, 6.0)  # far from any
    assert len(office.commands) == 2


def test_a_switch_is_a_command_and_follows_what_the_session_says(office: Office) -> None:
    office.turn(("parameter", "office.people"), False)
    office.turn(("parameter", "office.seed"), 7)
    office.turn(("door", "lab"), True)
    office.turn(("lamp", "sun"), False)
    office.show(living())
    assert office.commands == [
        SetParameter(type="set_parameter", name="office.people", value=False),
        SetParameter(type="set_parameter", name="office.seed", value=7),
        SetDoor(type="set_door", name="lab", open=True),
        SetLamp(type="set_lamp", name="sun", on=False),
    ]
    switches = office.stage.panels.office._switches
    office.show(living(door_wanted=np.array([True, True]), lamp_on=np.array([False])), people=False)
    assert switches[("door", "lab")].handle.value
    assert not switches[("parameter", "office.people")].handle.value
    office.show(living(door_wanted=np.array([False, True])), people=True)  # somebody else
    assert not switches[("door", "lab")].handle.value
    assert switches[("parameter", "office.people")].handle.value


def test_a_refused_switch_goes_back_and_says_why(office: Office) -> None:
    office.turn(("door", "lab"), True)
    office.show(living())
    office.answers[-1].set_result(Refused("name", "lab", "it is locked"))
    office.show(living())
    assert not office.stage.panels.office._switches[("door", "lab")].handle.value
    assert office.complaints == [(7, "The office stays as it is", "it is locked")]


def test_an_answer_that_comes_after_the_world_is_gone_touches_nothing(office: Office) -> None:
    office.turn(("door", "lab"), True)
    office.show(living())
    gone = office.stage.panels.office._switches[("door", "lab")].handle._impl.uuid
    office.show(None)
    office.updated.clear()
    office.answers[-1].set_result(Refused("name", "lab", "it is locked"))
    office.show(None)
    assert gone not in office.updated
    assert office.complaints == [(7, "The office stays as it is", "it is locked")]


def test_switches_are_made_with_their_values(office: Office) -> None:
    """One that is made, set and removed within one frame of a slow browser is an error there."""
    office.updated.clear()
    office.show(None)
    office.show(living(), preset="ideal", people=False)
    panel = office.stage.panels.office
    made = {key: switch.handle for key, switch in panel._switches.items()} | {("preset", ""): panel._preset}
    assert {key: handle.value for key, handle in made.items()} == {
        ("parameter", "office.people"): False,
        ("parameter", "office.seed"): 0,
        ("door", "lab"): False,
        ("door", "hall"): True,
        ("lamp", "sun"): True,
        ("preset", ""): "ideal",
    }
    assert not {handle._impl.uuid for handle in made.values()} & office.updated


def test_presets_are_chosen_and_shown(office: Office) -> None:
    panel = office.stage.panels.office
    assert panel._preset.value == OWN
    office.turn(("preset", ""), "ideal")
    office.show(living())
    assert office.commands == [UsePreset(type="use_preset", name="ideal")]
    office.show(living(), preset="ideal")
    assert panel._preset.value == "ideal"
    office.turn(("preset", ""), OWN)  # that is nothing to choose
    office.show(living(), preset="ideal")
    assert len(office.commands) == 1
    assert panel._preset.value == "ideal"
    office.show(living())
    assert panel._preset.value == OWN


def test_the_tab_says_what_is_there(office: Office) -> None:
    office.show(living())
    words = office.stage.panels.office._page.content
    assert "2 people, 1 box; 1 of 2 doors not open; 1 of 1 lamps lit; daylight 1.00" in words
    office.show(None)
    assert "Nothing lives in this world" in office.stage.panels.office._page.content
    assert not [key for key in office.stage.panels.office._switches if key[0] in ("door", "lamp")]


def test_nothing_new_sends_nothing(office: Office) -> None:
    layer = living()
    office.show(layer)
    office.stage.tick(None, office.now_s + 5)
    before = office.sent
    office.stage.tick(None, office.now_s + 10)
    assert office.sent == before


def test_glass_and_slow_floors_are_drawn(office: Office) -> None:
    s = fake_snapshot(430)
    kinds = list(s.world.wall_kind)
    kinds[4] = "glass"
    zone = np.array([(1.0, 1.0), (3.0, 1.0), (3.0, 3.0), (1.0, 3.0)], np.float32)
    scene = office.stage.server.scene
    plain = scene._handle_from_node_name["/office/floor"].image.copy()
    world = replace(s.world, wall_kind=tuple(kinds), slow_zones=(zone,))
    office.stage.tick(replace(s, world=world), office.now_s + 20)
    glass = scene._handle_from_node_name["/office/furniture_glass"]
    assert glass.vertices[:, 2].max() > 0
    assert glass.opacity < 1
    assert not np.array_equal(scene._handle_from_node_name["/office/floor"].image, plain)


def test_the_view_ends_at_a_leaf_and_goes_on_behind_glass(office: Office) -> None:
    s = fake_snapshot(430)
    truth = replace(s.truth, x=5.0, y=4.0, heading_rad=0.0)
    pane = (6.0, 3.0, 6.0, 5.0)
    walls = np.vstack([s.world.walls, [pane]]).astype(np.float32)
    heights = np.append(s.world.wall_height_m, 2.5).astype(np.float32)

    def reach(kind: str, layer: LivingLayer | None) -> float:
        office.now_s += 20.0
        world = replace(s.world, walls=walls, wall_height_m=heights, wall_kind=(*s.world.wall_kind, kind))
        office.stage.tick(replace(s, world=world, truth=truth, living=layer), office.now_s)
        plate = office.stage._scenery.office
        tips = plate._fan_edges.points[:, 1, :2]  # of the two outermost rays
        return float(plate.fit.to_office(tips)[:, 0].max())

    leaf = np.array([(6.0, 3.0, 6.0, 5.0), (8.0, 4.0, 8.0, 5.0)], np.float32)
    assert reach("wall", None) == pytest.approx(6.0, abs=1e-5)
    assert reach("glass", living()) > 6.3  # a desk
    assert reach("glass", living(doors=leaf)) == pytest.approx(6.0, abs=1e-5)
