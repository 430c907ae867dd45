"""What a page may send over its websocket, and what it is answered."""

from __future__ import annotations

from types import SimpleNamespace

import orjson
import pytest

from tests import patience
from tests.unit.web.doubles import house
from tests.unit.web.frames import until
from web.http import asking, security
from web.messages import Drive, Pause, Refused


@pytest.fixture
def server():
    with house() as made:
        yield made


def test_a_command_with_an_id_is_answered(server):
    with server.stream() as socket:
        socket.send_text('{"type": "pause", "id": 7}')
        assert until(socket, "answer") == {"type": "answer", "id": 7, "accepted": True, "tick": 5}
    assert server.engine.commands == [Pause(type="pause")]


@pytest.mark.parametrize(
    ("text", "status", "reason"),
    [
        ('{"type": "dance", "id": 1}', 422, "is not a command"),
        ('{"type": "set_goal", "x": 1, "id": 1}', 422, "y is missing"),
        ('{"type": "view", "name": "moon", "id": 1}', 422, "view takes name, one of: all, office"),
        ('{"type": "camera", "name": "map", "at": {"position": [1, 2]}, "id": 1}', 422, "camera takes at: "),
        (
            '{"type": "camera", "name": "moon", "at": {"position": [1, 2, 3], "look_at": [0, 0, 0], "fov_rad": 0.5}, "id": 1}',
            422,
            "camera takes name, one of: all, office",
        ),
        ('{"type": "theme", "name": "dark", "more": 1, "id": 1}', 422, "theme takes name, one of: dark, light"),
    ],
)
def test_what_is_wrong_is_answered_with_its_id(server, text, status, reason):
    with server.stream() as socket:
        socket.send_text(text)
        answer = until(socket, "answer")
        assert (answer["id"], answer["accepted"], answer["status"]) == (1, False, status)
        assert reason in answer["detail"][0]["reason"]


def test_no_json_is_answered_and_the_socket_lives(server):
    with server.stream() as socket:
        socket.send_text("what?")
        assert until(socket, "answer")["id"] is None
        socket.send_text('{"type": ["odd"]}')
        assert until(socket, "answer")["status"] == 422
        socket.send_text('{"type": "pause", "id": 2}')
        assert until(socket, "answer")["accepted"]


def test_refused_silent_and_broken_engines_are_told(server, monkeypatch):
    monkeypatch.setattr(asking, "ANSWER_TIMEOUT_S", 0.02)
    with server.stream() as socket:
        for answer, status in [(Refused("x", 1, "no"), 422), (None, 503), (RuntimeError("oh"), 500)]:
            server.engine.answer = answer
            socket.send_text('{"type": "kidnap"}')
            assert until(socket, "answer")["status"] == status


def test_other_commands_10_a_second(server, monkeypatch):
    monkeypatch.setattr(security, "time", SimpleNamespace(monotonic=lambda: 7.0))  # all at the same moment
    with server.stream() as socket:
        for number in range(14):
            socket.send_text(orjson.dumps({"type": "pause", "id": number}).decode())
        answers = [until(socket, "answer") for _ in range(14)]
        refused = [answer for answer in answers if not answer["accepted"]]
        assert [answer["status"] for answer in refused] == 4 * [429]


def test_the_robot_stops_when_the_socket_that_drove_closes(server):
    with server.stream() as socket:
        socket.send_text('{"type": "drive", "speed": 0.4, "yaw_rate": 0}')
        patience.until(lambda: server.engine.commands)
    patience.until(lambda: len(server.engine.commands) == 2)
    assert server.engine.commands[-1] == Drive(type="drive", speed=0.0, yaw_rate=0.0)


def test_no_stop_is_sent_when_it_stood_already_or_never_drove(server):
    with server.stream() as socket:
        socket.send_text('{"type": "drive", "speed": 0, "yaw_rate": 0}')
        patience.until(lambda: server.engine.commands)
    with server.stream() as socket:
        until(socket, "state")
    assert len(server.engine.commands) == 1


@pytest.mark.parametrize(
    "message", ['"type": "theme", "name": "dark"', '"type": "view", "name": "map"', '"type": "got"']
)
def test_whatever_has_an_id_is_answered(server, message):
    with server.stream() as socket:
        socket.send_text(f'{{{message}, "id": "mine"}}')
        assert until(socket, "answer") == {"type": "answer", "id": "mine", "accepted": True, "tick": 12}


def test_what_is_nested_too_deeply_is_answered_and_the_socket_stays(server):
    with server.stream() as socket:
        for levels in (21, 255, 1023, 50_000):
            socket.send_text('{"id": 1, "type": ' + "[" * levels + "]" * levels + "}")
            answer = until(socket, "answer")
            assert (answer["id"], answer["status"]) == (None, 422)
        socket.send_text('{"type": "pause", "id": 2}')
        assert until(socket, "answer")["accepted"]
