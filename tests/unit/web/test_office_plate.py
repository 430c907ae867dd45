"""What moves in the office: on its plate, as a browser receives it, and in the panel's tab."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from tests.unit.web.office_moments import living
from web.messages import LivingLayer, Parameter, Refused, SetDoor, TaggedPlace
from web.panel.office import MOST, tags
from web.panel.office import office as office_tab
from web.viewer.fits.office_fit import OfficeFit
from web.viewer.plates.office_plate import ORIGIN
from web.viewer.pointer import DOOR_Z

PEOPLE = Parameter("office.people", True, True, "", "", None, None, "people walk", "ours", True)
SEED = Parameter("office.seed", 0, 0, "", "", 0, 99, "of people", "ours", False)


class Office(Bench):
    """A bench whose office has people and things in it."""

    def live(self, layer: LivingLayer | None) -> int:
        """Show a layer; returns how many messages the round sends."""
        return sum(self.show(replace(fake_snapshot(430), living=layer)).values())

    def shown(self) -> dict[str, int]:
        """How many things of each kind are visible."""
        counts = dict.fromkeys(("door", "box", "lamp"), 0)
        for name, node in self.nodes().items():
            kind = name.rpartition("/")[2].partition("_")[0]
            if name.startswith("/office/") and kind in counts and name[-1].isdigit():
                counts[kind] += node["visible"]
        return counts | {"person": len(self.standing())}

    def standing(self) -> np.ndarray:
        """(n, 3): where people are on the plate."""
        people = "/office/people"
        return self.drawn(people, "batched_positions") if self.visible(people) else np.zeros((0, 3))


FIT = OfficeFit(fake_snapshot(430).world.bounds)


@pytest.fixture(scope="module")
def shared() -> Iterator[Office]:
    made = Office()
    yield made
    made.viewer.stop()


@pytest.fixture
def office(shared: Office) -> Office:
    shared.live(living())
    shared.settle()
    shared.engine.commands.clear()
    shared.engine.answers.clear()
    shared.told.clear()
    return shared


# ---------------------------------------------------------------- on the plate


def test_every_living_thing_stands_on_the_plate(office: Office) -> None:
    assert office.shown() == {"door": 2, "box": 1, "person": 2, "lamp": 1}
    assert office.standing()[:, :2] == pytest.approx(FIT.to_plate(np.array([[1.0, 1.0], [6.0, 1.0]])))
    assert office.visible("/office/pools")
    assert not office.visible("/office/dark")
    office.live(living(people=living().people[:1], people_rgb=living().people_rgb[1:], boxes=np.zeros((0, 6))))
    assert office.shown() == {"door": 2, "box": 0, "person": 1, "lamp": 1}
    office.live(None)
    assert office.shown() == {"door": 0, "box": 0, "person": 0, "lamp": 0}
    assert not office.visible("/office/pools")


def test_who_walks_is_moved_and_who_stands_sends_nothing(office: Office) -> None:
    snapshot = living()
    before = office.standing().copy()
    assert office.live(replace(snapshot, people=snapshot.people.copy())) == 0
    walked = snapshot.people.copy()
    walked[0, 0] += 0.5
    assert office.live(replace(snapshot, people=walked)) == 1  # their places, and nothing else
    after = office.standing()
    assert after[0, 0] > before[0, 0]
    assert np.array_equal(after[1], before[1])
    more = np.vstack([walked, walked + np.float32([1, 1, 0, 0, 0])])
    office.live(replace(snapshot, people=more, people_rgb=np.tile(snapshot.people_rgb, (2, 1))))
    assert office.shown()["person"] == 4
    office.live(snapshot)
    assert np.array_equal(office.standing(), before)


def test_lamps_and_daylight_change_the_floor(office: Office) -> None:
    lit = tuple(office.node("/office/lamp_0")["color"])
    dark = np.array([(5.0, 4.0, 3.0, 0.0)], np.float32)
    office.live(living(lamps=dark, lamp_on=np.array([False]), daylight=0.4))
    assert tuple(office.node("/office/lamp_0")["color"]) != lit
    assert not office.visible("/office/pools")
    assert office.visible("/office/dark")
    assert office.node("/office/dark")["opacity"] == pytest.approx(0.45)


def click(office: Office, x: float, y: float) -> None:
    at = FIT.to_plate(np.array([[x, y]]))[0]
    office.click((ORIGIN[0] + float(at[0]), ORIGIN[1] + float(at[1]), DOOR_Z))
    office.live(living())


def test_a_click_on_a_leaf_opens_or_shuts_it(office: Office) -> None:
    click(office, 2.5, 4.0)
    click(office, 8.0, 4.5)
    assert office.engine.commands == [
        SetDoor(type="set_door", name="lab", open=True),
        SetDoor(type="set_door", name="hall", open=False),
    ]
    office.answer(Refused("name", "hall", "no door named 'hall'"))
    assert office.told == ["The door stays as it is: no door named 'hall'"]
    click(office, 5.0, 6.0)  # far from any
    assert len(office.engine.commands) == 2


def test_glass_and_slow_floors_are_drawn(office: Office) -> None:
    s = fake_snapshot(430)
    kinds = list(s.world.wall_kind)
    kinds[4] = "glass"
    zone = np.array([(1.0, 1.0), (3.0, 1.0), (3.0, 3.0), (1.0, 3.0)], np.float32)
    plain = office.node("/office/floor")["_data"]
    office.show(replace(s, world=replace(s.world, wall_kind=tuple(kinds), slow_zones=(zone,))), 20)
    glass = office.node("/office/furniture_glass")
    assert glass["vertices"][:, 2].max() > 0
    assert glass["opacity"] < 1
    assert office.node("/office/floor")["_data"] != plain
    office.show(s, 20)


def test_the_view_ends_at_a_leaf_and_goes_on_behind_glass(office: Office) -> None:
    s = fake_snapshot(430)
    truth = replace(s.truth, x=5.0, y=4.0, heading_rad=0.0)
    pane = (6.0, 3.0, 6.0, 5.0)
    walls = np.vstack([s.world.walls, [pane]]).astype(np.float32)
    heights = np.append(s.world.wall_height_m, 2.5).astype(np.float32)

    def reach(kind: str, layer: LivingLayer | None) -> float:
        world = replace(s.world, walls=walls, wall_height_m=heights, wall_kind=(*s.world.wall_kind, kind))
        office.show(replace(s, world=world, truth=truth, living=layer), 20.0)
        tips = office.drawn("/office/view_edges")[:, 1, :2]  # of the two outermost rays
        return float(FIT.to_office(tips)[:, 0].max())

    leaf = np.array([(6.0, 3.0, 6.0, 5.0), (8.0, 4.0, 8.0, 5.0)], np.float32)
    assert reach("wall", None) == pytest.approx(6.0, abs=1e-5)
    assert reach("glass", living()) > 6.3  # a desk
    assert reach("glass", living(doors=leaf)) == pytest.approx(6.0, abs=1e-5)
    office.show(s, 20)


# ---------------------------------------------------------------- in the panel's tab


def told(layer: LivingLayer | None, switches: tuple[str, ...]) -> dict[str, Any]:
    return dict(office_tab(layer, (PEOPLE, SEED), PRESETS, "ideal", switches).data)


PRESETS = ("Pioneer 2DXE 2004", "ideal")


def test_the_tab_has_a_switch_for_what_the_world_has() -> None:
    data = told(living(), ("people", "seed"))
    assert data["doors"] == [("lab", False), ("hall", True)]
    assert data["lamps"] == [("sun", True)]
    assert [(knob["name"], knob["value"]) for knob in data["knobs"]] == [("office.people", True), ("office.seed", 0)]
    assert (data["presets"], data["preset"]) == (PRESETS, "ideal")
    bare = told(None, ())
    assert (bare["doors"], bare["lamps"], bare["knobs"]) == ([], [], [])


def test_the_tab_says_what_is_there() -> None:
    switches = ("people", "seed", "boxes", "daylight")
    words = told(living(), switches)["words"]
    assert words == "Here now: 2 people, 1 box, 1 of 2 doors not open, 1 of 1 lamps lit, daylight 1.00."
    assert told(None, ())["words"].startswith("Nothing lives in this world")
    assert told(None, ("reflections",))["words"] == "Nothing moves in this world."
    empty = np.zeros((0, 5), np.float32)
    bare = living(
        door_names=(), doors=empty[:, :4], door_wanted=np.zeros(0, bool), door_opening=empty[:, 0], people=empty
    )
    assert told(bare, ("lamps",))["words"] == "Here now: 1 of 1 lamps lit."
    assert told(bare, ("lamps", "people"))["words"] == "Here now: 0 people, 1 of 1 lamps lit."
    dark = replace(bare, lamps=empty[:, :4], lamp_names=(), lamp_on=np.zeros(0, bool))
    assert told(dark, ("script",))["words"] == "A script is carried out here."


def test_a_thousand_doors_are_no_thousand_switches() -> None:
    names = tuple(f"door {k}" for k in range(1000))
    doors = np.tile(living().doors[:1], (1000, 1))
    many = living(
        door_names=names, doors=doors, door_wanted=np.zeros(1000, bool), door_opening=np.zeros(1000, np.float32)
    )
    assert len(told(many, ())["doors"]) == MOST


def test_the_tab_lists_the_names_of_places_and_not_where_they_are() -> None:
    """The map bends all the time; the list is told anew only when a name comes or goes."""
    places = (TaggedPlace("kitchen", 3, 1.0, 2.0), TaggedPlace("desk", 9, -1.0, 0.0))
    assert tags(places).data == {"tags": ["kitchen", "desk"]}
    assert tags(()).data == {"tags": []}
