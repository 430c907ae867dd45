"""A server whose engine answers from one world, and files to drop on its page."""

from __future__ import annotations

import base64
import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from sim2d import World, load_world
from tests.unit.web.doubles import House, house
from web.messages import Accepted, OfficeEdition, OpenWorld, ReadFiled, ReadWorld, Refused, WorldSaved

OFFICE = load_world("office")
EDITION = OfficeEdition(7, "wall drawn", "", False)


class Engine:
    """Answers as the engine would, from one world."""

    def __init__(self) -> None:
        self.world: World = OFFICE
        self.filed: dict[str, World] = {}
        self.got: list[Any] = []
        self.refuses = False

    def __call__(self, request: Any) -> Accepted | Refused:
        self.got.append(request)
        if self.refuses and not isinstance(request, ReadWorld):
            return Refused("world", "plan", "the robot cannot start there")
        match request:
            case ReadWorld():
                return Accepted(5, (self.world, EDITION))
            case ReadFiled(name):
                return Accepted(5, self.filed.get(name))
            case OpenWorld(world, _):
                return Accepted(5, world.name)
            case WorldSaved(_, world):
                self.world = self.filed[world.name] = world
        return Accepted(5)


@contextlib.contextmanager
def house_of_worlds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[House]:
    """A server with a folder of its own for worlds, and an engine that answers from one world."""
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path / "worlds"))
    with house() as made:
        made.engine.answer = Engine()
        yield made


def post(server: House, path: str, body: Any) -> tuple[int, Any]:
    answer = server.client.post(path, content=json.dumps(body), headers={"Content-Type": "application/json"})
    return answer.status_code, answer.json()


def files(**given: bytes) -> list[dict[str, str]]:
    return [{"name": name.replace("__", "."), "data": base64.b64encode(data).decode()} for name, data in given.items()]


def plan_png() -> bytes:
    """A room of 80 x 60 pixels with a wall in it."""
    picture = np.zeros((70, 90), np.uint8)
    picture[5:65, 5:85] = 255
    picture[5:40, 44:47] = 0
    return cv2.imencode(".png", picture)[1].tobytes()


def why(answer: Any) -> str:
    return answer["detail"][0]["reason"]
