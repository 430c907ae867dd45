"""A situation goes through a link and through a file without losing a bit, and what is damaged or made up is refused."""

from __future__ import annotations

import base64
import json
import zlib
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.orders import METHODS, Order, check_order
from app.run_record.link import LONGEST_LINK, file_of, link_of, read_situation
from app.run_record.situation import Situation
from sim2d import load_world

from .made import LOOK, a_situation

pytestmark = pytest.mark.slow

PLAIN = a_situation()
FILE = file_of(PLAIN)
LINK = link_of(PLAIN)[0] or ""
BOX = {
    "name": "b", "x": 9.0, "y": 1.3, "width": 0.4, "depth": 0.4, "height": 0.6, "angle_rad": 0.0, "colour": [1, 2, 3],
    "present": True,
}  # fmt: skip


def same(a: Situation, b: Situation) -> bool:
    parts = ("header", "tick", "state_hash", "look", "brain")
    return all(getattr(a, part) == getattr(b, part) for part in parts) and orders_of(a) == orders_of(b)


def orders_of(situation: Situation) -> list[tuple[int, str, str]]:
    return [(order.tick, order.name, json.dumps(order.values)) for order in situation.orders]


def packed(document: object) -> str:
    raw = zlib.compress(json.dumps(document).encode())
    return "run=" + base64.urlsafe_b64encode(raw).decode().rstrip("=")


def both_ways(situation: Situation) -> list[Situation]:
    return [read_situation(text or "") for text in (file_of(situation), link_of(situation)[0])]


def test_nothing_is_lost_and_it_plays_to_the_same_bits_and_says_so() -> None:
    for text in (LINK, f"#{LINK}", f"http://127.0.0.1:8000/#{LINK}\n", f"{LINK}&more", FILE):
        assert same(read_situation(text), PLAIN), text
    words = f"The same, bit for bit: state hash {PLAIN.state_hash[:12]} at tick 120."
    assert PLAIN.verdict(read_situation(LINK).play()) == (True, words)


def test_boxes_edits_and_a_world_that_is_none_of_ours_are_in_it() -> None:
    world = replace(load_world("office"), name="my-office")
    situation = a_situation(60, boxes=True, edits=True, world=world)
    assert {order.name for order in situation.orders} >= {"put_box", "edit_world"}
    for again in both_ways(situation):
        assert same(again, situation)
        assert again.verdict(again.play())[0]
    assert len(link_of(situation)[0] or "") > 3 * len(LINK)


@settings(max_examples=40)
@given(st.lists(st.tuples(st.floats(-0.5, 0.5), st.floats(-1.6, 1.6)), max_size=20))
def test_numbers_are_exact(speeds: list[tuple[float, float]]) -> None:
    orders = tuple(Order(k, "drive", {"speed": speed, "yaw_rate": rate}) for k, (speed, rate) in enumerate(speeds))
    for again in both_ways(Situation(PLAIN.header, orders, 20, PLAIN.state_hash, LOOK)):
        assert [order.values for order in again.orders] == [order.values for order in orders]


def test_what_fits_into_no_link_says_why() -> None:
    brainy = Situation(PLAIN.header, (), 1, PLAIN.state_hash, brain=bytes(2_000_000))
    words = "The run began with a brain of its own, 2.0 MB, which fits into no link; the file has it."
    assert link_of(brainy) == (None, words)
    orders = tuple(Order(k, "drive", {"speed": (k * 7919 % 1000) / 2000, "yaw_rate": 0.1}) for k in range(9000))
    link, why = link_of(Situation(PLAIN.header, orders, 9000, PLAIN.state_hash))
    assert link is None
    assert "characters (9,000 orders), and more than 8,000" in why
    assert len(LINK) < LONGEST_LINK / 4


def test_the_cameras_field_of_view_is_as_it_was() -> None:
    """`Config.with_values` would set the brain's with it."""
    header = replace(PLAIN.header, values={**PLAIN.header.values, "robot.camera_fov_rad": 1.5})
    for again in both_ways(Situation(header, (), 0, PLAIN.state_hash)):
        assert again.header.config == header.config


def _order(name: str, **values: Any) -> dict[str, Any]:
    return {"orders": [[0, name, values]]}


def test_what_is_wrong_in_it_is_said(subtests: pytest.Subtests) -> None:
    for change, words in [
        ({"format": "ratslam situation/9"}, "its format is 'ratslam situation/9'; this program reads"),
        ({"tick": -1}, "tick: input should be greater than or equal to 0"),
        ({"tick": 10**12}, "tick: input should be less than"),
        ({"seed": 1.5}, "seed: input should be a valid integer"),
        ({"state_hash": "abc"}, "state_hash: string should match"),
        ({"extra": 1}, "extra: extra inputs are not permitted"),
        ({"values": {"pilot.cruise_speed": 99.0}}, r"pilot.cruise_speed must be between .* got 99"),
        ({"values": {"pilot.wings": 1}}, "unknown parameter 'pilot.wings'"),
        ({"world": None, "world_name": "castle"}, "this program has no world 'castle'; ask for the file"),
        ({"world": None, "world_name": "/etc/passwd"}, "this program has no world '/etc/passwd'"),
        ({"check": 1}, "the world in it is another than the one that the run began in"),
        ({"world": "{}"}, "the world in it is another"),
        ({"brain": "%"}, "the brain in it is damaged"),
        ({"orders": [[500, "kidnap", {}]]}, "order 1 is of tick 500; it must be from 0 to 120"),
        ({"orders": [[9, "kidnap", {}], [8, "kidnap", {}]]}, "order 2 is of tick 8; it must be from 9 to 120"),
        (_order("state_hash"), "order 1, of tick 0: 'state_hash' is no order that a session can be given"),
        (_order("__init__"), "'__init__' is no order"),
        (_order("drive", speed="fast", yaw_rate=0.0), "drive: speed: input should be a valid number"),
        (_order("drive", speed=50.0, yaw_rate=0.0), "drive: speed: input should be less than or equal to 10"),
        (_order("kidnap", x=1e300, y=0.0), "kidnap: x: it must be at most 1e[+]09, got 1e[+]300"),
        (_order("put_packet", x=1, y=2, share=1.0), "put_packet: share: input should be less than or equal to 0.95"),
        (_order("put_packet", x=-1, y=2), "put_packet: x: input should be greater than or equal to 0"),
        (_order("forget_view", view=-1), "forget_view: view: input should be greater"),
        (_order("put_box", box={**BOX, "width": 1e9}), "put_box: box.width: input should be less than or equal to 20"),
        (_order("put_box", box={**BOX, "colour": ["a", 1, 2]}), "box: box.colour.0: input should be a valid integer"),
        (_order("put_box", box={**BOX, "height": None}), "put_box: box.height"),
        (_order("put_box", box={"name": "b"}), "put_box: box.x: field required"),
        (_order("kidnap", x=1.0, z=1.0), "kidnap: z: extra inputs are not permitted"),
        (_order("set_mode", mode="fly"), "set_mode: mode: input should be 'explore', 'manual' or 'goal'"),
        (_order("edit_world", edit={"from": 0}), "an edit of the world cannot be made again"),
    ]:
        with subtests.test(change=change, words=words):
            document = {**json.loads(FILE), **change}
            for text in (json.dumps(document), packed(document)):
                with pytest.raises(ValueError, match=words):
                    read_situation(text)


def test_what_is_no_situation_is_refused_in_a_sentence(subtests: pytest.Subtests) -> None:
    for text, words in [
        ("", "neither the file of a situation nor a link with #run="),
        ("http://127.0.0.1:8000/", "neither the file"),
        ("run=", "cut off"),
        ("run=%%%", "damaged"),
        ("run=AAAA", "damaged"),
        (LINK[:-40], "cut off|damaged"),
        ("{", "it is no situation of this program"),
        ('{"walls": []}', "it is no situation of this program: format: field required"),
        (FILE.replace("0.31", "1e999"), "values"),
        (FILE.replace("0.31", "NaN"), "it is no situation"),
        (packed("x" * (17 << 20)), "longer than any run"),
    ]:
        with subtests.test(text=text[:40], words=words), pytest.raises(ValueError, match=words):
            read_situation(text)


@given(st.binary(max_size=60))
def test_any_bytes_are_refused_in_a_sentence(raw: bytes) -> None:
    for data in (raw, zlib.compress(raw)):
        with pytest.raises(ValueError, match=r"."):
            read_situation("run=" + base64.urlsafe_b64encode(data).decode())


def test_defaults_that_were_others_are_told() -> None:
    assert "defaults" in read_situation(packed({**json.loads(FILE), "defaults": 7})).notes[0]


def test_every_order_that_a_session_takes_can_be_checked() -> None:
    named, experience, place = {"name": "a"}, {"experience": 1}, {"x": 1.0, "y": 2.0}
    right: dict[str, dict[str, Any]] = {
        "set_goal": place, "go_to_place_of": experience, "go_to": experience, "tag": named, "untag": named,
        "go_to_tag": named, "set_mode": {"mode": "explore"}, "drive": {"speed": 0.1, "yaw_rate": 0.1},
        "put_packet": {"x": 1, "y": 2}, "forget_view": {"view": 1}, "set_parameters": {"values": {}},
        "edit_world": {"world": "{}"}, "set_door": {"name": "a", "is_open": True}, "set_lamp": {"name": "a", "on": True},
        "put_box": {"box": BOX}, "remove_box": named,
        "begin_companion": {"first": "a", "name": "b", "values": {}, "anew": False},
    }  # fmt: skip
    names = list(METHODS)
    assert len(names) >= 18
    for name in names:
        with pytest.raises(ValueError, match=f"^{name}: nonsense: extra"):
            check_order(Order(0, name, {"nonsense": 1, **right.get(name, {})}))
