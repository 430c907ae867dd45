"""A page is told of its open tabs, and switches are turned for all who look."""

from __future__ import annotations

import orjson
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.doubles import house
from tests.unit.web.frames import read_frame, until


@pytest.fixture
def server():
    with house() as made:
        yield made


def parts(socket, count: int) -> list[str]:
    """The names of the next `count` parts of the panel that arrive."""
    named = []
    while len(named) < count:
        message = socket.receive()
        raw = message.get("bytes")
        head = read_frame(raw)[0] if raw else orjson.loads(message["text"])
        if head["type"] == "panel":
            named.append(head["part"])
    return named


def test_only_open_tabs_are_told_and_each_page_has_its_own(server):
    with server.stream() as one, server.stream() as two:
        one.send_text('{"type": "tabs", "names": ["Senses"]}')
        assert parts(one, 2) == ["views", "cells"]
        two.send_text('{"type": "tabs", "names": ["Tune", "Memory"]}')
        assert parts(two, 3) == ["switches", "memory", "tune"]
        one.send_text('{"type": "tabs", "names": ["Truth"]}')
        assert parts(one, 3) == ["switches", "numbers", "series"]
        two.send_text('{"type": "tabs", "names": []}')
        server.latest.put(fake_snapshot(13))
        assert until(two, "state")["state"]["tick"] == 13
        two.send_text('{"type": "got", "id": 1}')
        assert until(two, "answer")["accepted"]  # and nothing of the panel was before it


def test_a_switch_is_turned_for_all_who_look(server):
    with server.stream() as one, server.stream() as two:
        for socket in (one, two):
            socket.send_text('{"type": "tabs", "names": ["Inspect"]}')
            assert parts(socket, 3) == ["switches", "active", "inspected"]
        assert not server.switches.is_on("click_inspects")
        one.send_text('{"type": "switch", "name": "click_inspects", "on": true, "id": 3}')
        assert until(one, "answer")["accepted"]
        assert parts(two, 1) == ["switches"]
        assert server.switches.is_on("click_inspects")


@pytest.mark.parametrize(
    "fields", ['"name": "moon", "on": true', '"name": "occupancy"', '"name": "occupancy", "on": 1']
)
def test_a_switch_that_is_none_is_a_sentence(server, fields):
    with server.stream() as socket:
        socket.send_text(f'{{"type": "switch", {fields}}}')
        (wrong,) = until(socket, "answer")["detail"]
        assert wrong["reason"].startswith("switch takes on, true or false, and name, one of: occupancy, ")


@pytest.mark.parametrize("names", ["null", '"Senses"', '["Senses", 3]', '["Sense"]', '[["Senses"]]', "[{}]"])
def test_tabs_that_do_not_exist_are_a_sentence(server, names):
    with server.stream() as socket:
        socket.send_text(f'{{"type": "tabs", "names": {names}}}')
        wrong = until(socket, "answer")["detail"][0]
        assert wrong["field"] == "names"
        assert wrong["reason"].startswith("tabs takes names, a list of: Senses, Memory")
