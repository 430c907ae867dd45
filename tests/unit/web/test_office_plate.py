"""What moves in the office and what the robot tries there: on its plate, as a browser receives it, and in the panel's tab."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from tests.unit.web.office_moments import living, tried
from web.messages import LivingLayer, Movements, Parameter, Refused, SetDoor, TaggedPlace
from web.panel.truth import MOST, tags
from web.panel.truth import office as office_tab
from web.viewer.fits import OfficeFit
from web.viewer.marks.movements import ENLARGED, arc_on_plate
from web.viewer.plates.office_plate import ORIGIN
from web.viewer.pointer import DOOR_Z

PLAIN: Any = fake_snapshot(430)
FIT = OfficeFit(PLAIN.world.bounds)


class Office(Bench):
    """A bench whose office has people and things in it."""

    def live(self, layer: LivingLayer | None) -> int:
        """Show a layer; returns how many messages the round sends."""
        return sum(self.show(replace(PLAIN, living=layer)).values())

    def shown(self) -> tuple[int, ...]:
        """How many doors, boxes, people and lamps are visible."""
        nodes = self.nodes()

        def count(kind: str) -> int:
            return sum(node["visible"] for name, node in nodes.items() if name.startswith(f"/office/{kind}_"))

        return count("door"), count("box"), len(self.standing()), count("lamp")

    def standing(self) -> np.ndarray:
        """(n, 3): where people are on the plate."""
        people = "/office/people"
        return self.drawn(people, "batched_positions") if self.visible(people) else np.zeros((0, 3))

    def shows(self, *names: str) -> list[bool]:
        return [self.visible(f"/office/{name}") for name in names]


@pytest.fixture(scope="module")
def shared() -> Iterator[Office]:
    made = Office()
    yield made
    made.viewer.stop()


@pytest.fixture
def office(shared: Office) -> Office:
    shared.switches.turn("movements", False)
    shared.show(PLAIN, 20.0)
    shared.live(living())
    shared.settle()
    return shared


# ---------------------------------------------------------------- on the plate


def test_every_living_thing_stands_on_the_plate(office: Office) -> None:
    assert office.shown() == (2, 1, 2, 1)
    assert office.standing()[:, :2] == pytest.approx(FIT.to_plate(np.array([[1.0, 1.0], [6.0, 1.0]])))
    assert office.shows("pools", "dark") == [True, False]
    office.live(living(people=living().people[:1], people_rgb=living().people_rgb[1:], boxes=np.zeros((0, 6))))
    assert office.shown() == (2, 0, 1, 1)
    office.live(None)
    assert (office.shown(), office.shows("pools")) == ((0, 0, 0, 0), [False])


def test_who_walks_is_moved_and_who_stands_sends_nothing(office: Office) -> None:
    layer, before = living(), office.standing().copy()
    assert office.live(replace(layer, people=layer.people.copy())) == 0
    walked = layer.people.copy()
    walked[0, 0] += 0.5
    assert office.live(replace(layer, people=walked)) == 1  # their places, and nothing else
    after = office.standing()
    assert after[0, 0] > before[0, 0]
    assert np.array_equal(after[1], before[1])
    more = np.vstack([walked, walked + np.array([1, 1, 0, 0, 0], np.float32)])
    office.live(replace(layer, people=more, people_rgb=np.tile(layer.people_rgb, (2, 1))))
    assert len(office.standing()) == 4
    office.live(layer)
    assert np.array_equal(office.standing(), before)


def test_lamps_and_daylight_change_the_floor(office: Office) -> None:
    lit = tuple(office.node("/office/lamp_0")["color"])
    dark = np.array([(5.0, 4.0, 3.0, 0.0)], np.float32)
    office.live(living(lamps=dark, lamp_on=np.array([False]), daylight=0.4))
    assert tuple(office.node("/office/lamp_0")["color"]) != lit
    assert office.shows("pools", "dark") == [False, True]
    assert office.node("/office/dark")["opacity"] == pytest.approx(0.45)


def test_a_click_on_a_leaf_opens_or_shuts_it(office: Office) -> None:
    for place in ((2.5, 4.0), (8.0, 4.5), (5.0, 6.0)):  # the last one is far from any
        x, y = FIT.to_plate(np.array([place]))[0].tolist()
        office.click((ORIGIN[0] + x, ORIGIN[1] + y, DOOR_Z))
        office.live(living())
    assert office.engine.commands == [
        SetDoor(type="set_door", name="lab", open=True),
        SetDoor(type="set_door", name="hall", open=False),
    ]
    office.answer(Refused("name", "hall", "no door named 'hall'"))
    assert "The door stays as it is: no door named 'hall'" in office.told


def test_glass_and_slow_floors_are_drawn(office: Office) -> None:
    kinds = list(PLAIN.world.wall_kind)
    kinds[4] = "glass"
    zone = np.array([(1.0, 1.0), (3.0, 1.0), (3.0, 3.0), (1.0, 3.0)], np.float32)
    plain = office.node("/office/floor")["_data"]
    office.show(replace(PLAIN, world=replace(PLAIN.world, wall_kind=tuple(kinds), slow_zones=(zone,))), 20)
    glass = office.node("/office/furniture_glass")
    assert glass["vertices"][:, 2].max() > 0
    assert glass["opacity"] < 1
    assert office.node("/office/floor")["_data"] != plain


def test_the_robot_stands_where_it_is_and_the_echoes_lie_where_its_sonars_hear_them(office: Office) -> None:
    truth, reach = PLAIN.truth, PLAIN.senses.ranges_m
    (here,) = FIT.to_plate(np.array([[truth.x, truth.y]]))
    assert office.node("/office/robot")["position"][:2] == pytest.approx(here, abs=1e-4)
    angles = truth.heading_rad + PLAIN.world.sonar_angles_rad
    heard = np.column_stack([truth.x + reach * np.cos(angles), truth.y + reach * np.sin(angles)])
    for drawn in (office.drawn("/office/echoes"), office.drawn("/office/sonar")[:, 1]):
        assert np.allclose(drawn[:, :2], FIT.to_plate(heard), atol=1 / 256)


def test_the_view_ends_at_a_leaf_and_goes_on_behind_glass(office: Office) -> None:
    world, pane = PLAIN.world, (6.0, 3.0, 6.0, 5.0)
    walls = np.vstack([world.walls, [pane]]).astype(np.float32)
    heights = np.append(world.wall_height_m, 2.5).astype(np.float32)

    def reach(kind: str, layer: LivingLayer | None) -> float:
        drawing = replace(world, walls=walls, wall_height_m=heights, wall_kind=(*world.wall_kind, kind))
        here = replace(PLAIN.truth, x=5.0, y=4.0, heading_rad=0.0)
        office.show(replace(PLAIN, world=drawing, truth=here, living=layer, speed=8.0), 20.0)  # nobody carried it
        tips = office.drawn("/office/view_edges")[:, 1, :2]  # of the two outermost rays
        return float(FIT.to_office(tips)[:, 0].max())

    assert reach("wall", None) == pytest.approx(6.0, abs=1e-5)
    assert reach("glass", living()) > 6.3  # a desk
    leaf = np.array([pane, (8.0, 4.0, 8.0, 5.0)], np.float32)
    assert reach("glass", living(doors=leaf)) == pytest.approx(6.0, abs=1e-5)


# ---------------------------------------------------------------- what the robot tries there

NOTHING = {"free": 0, "blocked": 0, "ends": 0, "chosen": 0}


def arrow(office: Office) -> np.ndarray:
    return office.drawn("/office/movements/chosen", "vertices")


def there(office: Office) -> dict[str, int]:
    lines = {kind: len(office.drawn(f"/office/movements/{kind}")) for kind in ("free", "blocked", "ends")}
    return lines | {"chosen": len(arrow(office))}


def test_movements_are_computed_only_while_somebody_wants_them_and_the_robot_tries_some(office: Office) -> None:
    asked = []

    def movements() -> Movements:
        asked.append("once")
        return tried()

    office.show(replace(PLAIN, movements=movements))
    assert (asked, there(office)) == ([], NOTHING)
    office.switch("movements", True)
    assert asked == ["once"]
    shown = there(office)
    assert shown == {"free": 8, "blocked": 4, "ends": 4, "chosen": shown["chosen"]}
    assert shown["chosen"] > 0
    office.show(fake_snapshot(431))  # it chooses no arc
    assert there(office) == NOTHING
    office.show(replace(PLAIN, movements=tried))
    assert there(office) == shown
    office.switch("movements", False)
    office.show(replace(PLAIN, movements=lambda: tried()))
    assert there(office) == NOTHING


def test_the_arrow_ends_where_the_chosen_arc_ends_enlarged(office: Office) -> None:
    office.switch("movements", True)
    for chosen, reach in ((1, 0.4), (2, 0.1)):
        office.show(replace(PLAIN, movements=lambda chosen=chosen: tried(chosen)))
        (tip,) = FIT.to_plate(np.array([(5.0 + ENLARGED * reach, 4.0)]))
        assert arrow(office)[:, 0].max() == pytest.approx(tip[0], abs=0.25)
        assert arrow(office)[:, 1].mean() == pytest.approx(tip[1], abs=0.05)


def test_an_arc_begins_at_the_robot_and_a_turn_on_the_spot_is_one_around_it() -> None:
    moved = replace(tried(), paths=tried().paths + np.array((1.0, 0.5), np.float32))
    (end,) = FIT.to_plate(np.array([(6.0 + ENLARGED * 0.4, 4.5)]))
    assert arc_on_plate(moved, 1, FIT, 0.25)[-1] == pytest.approx(end, abs=1e-6)
    away = arc_on_plate(moved, 3, FIT, 0.25) - FIT.to_plate(np.array([(6.0, 4.5)]))
    assert np.hypot(*away.T) == pytest.approx(1.7 * 0.25)
    turned = np.arctan2(away[:, 1], away[:, 0])
    assert (turned[0], turned[-1]) == (pytest.approx(0.0, abs=1e-6), pytest.approx(0.6))


# ---------------------------------------------------------------- in the panel's tab

PEOPLE = Parameter("office.people", True, True, "", "", None, None, "people walk", "ours", True)
SEED = Parameter("office.seed", 0, 0, "", "", 0, 99, "of people", "ours", False)
PRESETS = ("Pioneer 2DXE 2004", "ideal")


def told(layer: LivingLayer | None, *switches: str) -> dict[str, Any]:
    return dict(office_tab(layer, (PEOPLE, SEED), PRESETS, "ideal", switches).data)


def test_the_tab_has_a_switch_for_what_the_world_has() -> None:
    data = told(living(), "people", "seed")
    assert (data["doors"], data["lamps"]) == ([("lab", False), ("hall", True)], [("sun", True)])
    assert [(knob["name"], knob["value"]) for knob in data["knobs"]] == [("office.people", True), ("office.seed", 0)]
    assert (data["presets"], data["preset"]) == (PRESETS, "ideal")
    bare = told(None)
    assert (bare["doors"], bare["lamps"], bare["knobs"]) == ([], [], [])
    many = living(
        door_names=tuple(f"door {k}" for k in range(1000)), doors=np.tile(living().doors[:1], (1000, 1)),
        door_wanted=np.zeros(1000, bool), door_opening=np.zeros(1000, np.float32),
    )  # fmt: skip
    assert len(told(many)["doors"]) == MOST


def test_the_tab_says_what_is_there() -> None:
    no = np.zeros((0, 5), np.float32)
    bare = living(door_names=(), doors=no[:, :4], door_wanted=np.zeros(0, bool), door_opening=no[:, 0], people=no)
    dark = replace(bare, lamps=no[:, :4], lamp_names=(), lamp_on=np.zeros(0, bool))
    everything = "2 people, 1 box, 1 of 2 doors not open, 1 of 1 lamps lit, daylight 1.00."
    for layer, switches, words in (
        (living(), ("people", "seed", "boxes", "daylight"), f"Here now: {everything}"),
        (None, ("reflections",), "Nothing moves here."),
        (bare, ("lamps",), "Here now: 1 of 1 lamps lit."),
        (bare, ("lamps", "people"), "Here now: 0 people, 1 of 1 lamps lit."),
        (dark, ("script",), "A script is carried out here."),
    ):
        assert told(layer, *switches)["words"] == words
    assert told(None)["words"].startswith("No people, doors, lamps")


def test_the_tab_lists_the_names_of_places_and_not_where_they_are() -> None:
    """The map bends all the time; the list is told anew only when a name comes or goes."""
    places = (TaggedPlace("kitchen", 3, 1.0, 2.0), TaggedPlace("desk", 9, -1.0, 0.0))
    assert [tags(some).data for some in (places, ())] == [{"tags": ["kitchen", "desk"]}, {"tags": []}]
