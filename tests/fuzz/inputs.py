"""Worlds, plans, pictures, parameters and commands: how each is spoilt, and by which way it comes in."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable
from functools import cache
from random import Random
from typing import Any

import cv2
import numpy as np

from app.config import Config, from_toml, parse_value, to_toml
from app.session import Session
from sim2d import load_world
from sim2d.importers import import_world
from sim2d.world.world_file import WORLDS, complaints
from tests.fuzz import recordings, runs, states
from tests.fuzz.mutators import bytes_spoilt, text_of, tree_spoilt
from tests.fuzz.states import BRAINS, SESSIONS

YAML = "image: plan.pgm\nresolution: 0.05\norigin: [0.0, -1.0, 0.1]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
ROOM = [[0, 0, 8, 0], [8, 0, 8, 6], [8, 6, 0, 6], [0, 6, 0, 0], [3, 0, 3, 2.5],
        {"p0": {"x": 5, "y": 3}, "p1": {"x": 5, "y": 6}}]  # fmt: skip
VALUES = ("1", "0", "-1", "1e400", "nan", "inf", "true", "x", "[[1]]", "{a=1}", "'", '"\\ud800"', "9" * 5000, "[" * 2000,
          "2020-13-01", "1979-05-27", "a.b", "0x1_", "1000", "360", "8", "12", "0.0", "{" * 500, "=", "\n[robot]")  # fmt: skip
COMMANDS: tuple[dict[str, Any], ...] = (
    {"type": "set_goal", "x": 1.0, "y": 0.5}, {"type": "cancel_goal"}, {"type": "tag", "name": "desk"},
    {"type": "go_to_tag", "name": "desk"}, {"type": "untag", "name": "desk"}, {"type": "set_mode", "mode": "manual"},
    {"type": "drive", "speed": 0.2, "yaw_rate": -0.4}, {"type": "kidnap", "x": 2.0, "y": 2.0, "heading_rad": 0.1},
    {"type": "pause"}, {"type": "resume"}, {"type": "step", "ticks": 2}, {"type": "set_speed", "factor": 4.0},
    {"type": "reset", "world": "loop", "seed": 3}, {"type": "set_parameter", "name": "robot.image_width", "value": 64},
    {"type": "set_parameter", "name": "pose_cells.inhibit", "value": 0.0003}, {"type": "set_door", "name": "d", "open": True},
    {"type": "set_lamp", "name": "l", "on": False}, {"type": "remove_box", "name": "crate"},
    {"type": "put_box", "name": "crate", "x": 2.0, "y": 2.0, "width": 0.4, "depth": 0.4, "height": 0.5, "angle_rad": 0.2},
    {"type": "use_preset", "name": "ideal"}, {"type": "step_stage", "back": True},
    {"type": "inject_packet", "x": 3, "y": 4, "heading_rad": 1.0, "share": 0.3}, {"type": "inspect", "experience": 0},
    {"type": "predict", "choice": 1}, {"type": "vote", "lesson": "loop", "voter": "abcdefgh", "choice": 0},
    {"type": "run_until", "what": "place", "place": "desk", "within_s": 1.0}, {"type": "begin_lesson", "name": "packet"},
    {"type": "inspect", "x": 3, "y": 5}, {"type": "inspect", "view": 0}, {"type": "undo_edit"}, {"type": "redo_edit"},
    {"type": "edit_world", "edition": None, "steps": [
        {"do": "add", "list": "walls", "number": None, "item": {
            "from": [2.0, 2.0], "to": [3.0, 2.5], "kind": "partition", "height": 1.5, "colour": "#A0B0C0", "panels": [
                {"at": 0.1, "width": 0.5, "bottom": 0.2, "top": 1.0, "texture": "poster", "colour": "#112233", "seed": 4}]}},
        {"do": "change", "list": "boxes", "number": 0, "item": {"name": "b", "x": 2, "y": 2, "width": 1, "depth": 1}}]},
    {"type": "view", "name": "map"}, {"type": "theme", "name": "light"}, {"type": "got"},
)  # fmt: skip


def world(rng: Random) -> str:
    tree = _worlds()[rng.randrange(len(_worlds()))]
    data = text_of(tree_spoilt(tree, rng)).encode("utf-8", "surrogatepass")
    if rng.random() < 0.3:
        data = bytes_spoilt(json.dumps(tree).encode(), rng)
    complaints(data.decode("utf-8", "replace"), "w.json")
    return _drive_in({"w.json": data})


def vector_plan(rng: Random) -> str:
    text = text_of(tree_spoilt(ROOM, rng)).encode() if rng.random() < 0.8 else None
    return _drive_in({"plan.json": bytes_spoilt(json.dumps(ROOM).encode(), rng) if text is None else text})


def picture(rng: Random) -> str:
    kind = rng.choice(("pgm", "png", "bmp", "jpg", "ppm"))
    data = bytes_spoilt(_picture(kind), rng, _picture(rng.choice(("png", "jpg", "pgm"))))
    return _drive_in({f"plan.{rng.choice((kind, 'png'))}": data}, scale_m=rng.choice((0.05, 0.05, 1.0, 0.001)))


def map_server(rng: Random) -> str:
    text, plan = YAML.encode(), _picture("pgm")
    if rng.random() < 0.8:
        text = bytes_spoilt(text, rng, rng.choice(VALUES).encode() * 20)
    if rng.random() < 0.3:
        plan = bytes_spoilt(plan, rng)
    return _drive_in({"map.yaml": text, "plan.pgm": plan})


def parameters(rng: Random) -> str:
    """A TOML file, as given with --config."""
    lines = [line for line in to_toml(Config()).splitlines() if line and not line.startswith("#")]
    for _ in range(rng.choice((1, 1, 2, 5))):
        at = rng.randrange(len(lines))
        name = lines[at].partition(" =")[0]
        lines[at] = f"{name} = {rng.choice(VALUES)}" if rng.random() < 0.8 else rng.choice(VALUES)
    text = "\n".join(lines)
    if rng.random() < 0.3:
        text = bytes_spoilt(text.encode(), rng).decode("utf-8", "replace")
    return _wake(from_toml(text))


def setting(rng: Random) -> str:
    """Some --set NAME=VALUE at once."""
    config, names = Config(), [name for name, _, _ in Config().items()]
    for _ in range(rng.choice((1, 2, 6))):
        number = repr(rng.choice((0, 1, 8, 1000, 1e-3, 0.2, 1e308, 640, 480)))
        config = config.with_value(rng.choice(names), parse_value(rng.choice(VALUES) if rng.random() < 0.6 else number))
    return _wake(config)


def command(rng: Random) -> bytes:
    """One message for the HTTP API or the websocket."""
    tree = dict(rng.choice(COMMANDS))
    if rng.random() < 0.15:
        return bytes_spoilt(json.dumps(tree).encode(), rng)
    if rng.random() < 0.15:
        return text_of(tree).encode()
    return text_of(tree_spoilt(tree, rng)).encode("utf-8", "surrogatepass")


def upload(rng: Random) -> dict[str, Any]:
    """What the page sends when a plan is dropped on it."""
    name, data = rng.choice(
        (("plan.png", _picture("png")), ("w.json", json.dumps(_worlds()[0]).encode()), ("a.yaml", YAML.encode()))
    )
    return {"files": [{"name": name, "data": base64.b64encode(data).decode()}], "scale_m": 0.05, "seed": 1}


def warm() -> None:
    """Compile whatever a case needs."""
    BRAINS.warm()
    SESSIONS.warm()
    recordings.warm()
    runs.warm()
    for kind in ("pgm", "png", "jpg", "bmp", "ppm"):
        _drive_in({f"plan.{kind}": _picture(kind)}, 0.05)
    for tree in _worlds():
        _drive_in({"w.json": json.dumps(tree).encode()})
    _drive_in({"map.yaml": YAML.encode(), "plan.pgm": _picture("pgm")})
    _drive_in({"plan.json": json.dumps(ROOM).encode()})


@cache
def _worlds() -> list[Any]:
    return [
        json.loads((WORLDS / f"{name}.json").read_text("utf-8")) for name in ("loop", "two-goals", "living", "twins")
    ]


@cache
def _picture(kind: str) -> bytes:
    plan = np.full((120, 160), 254, np.uint8)
    cv2.rectangle(plan, (4, 4), (155, 115), 0, 2)
    cv2.line(plan, (70, 4), (70, 70), 0, 2)
    cv2.circle(plan, (120, 60), 9, 0, -1)
    return cv2.imencode(f".{kind}", cv2.merge([plan] * 3) if kind == "ppm" else plan)[1].tobytes()


def _drive_in(files: dict[str, bytes], scale_m: float | None = None) -> str:
    return _tick(Session(import_world(next(iter(files)), files, scale_m, 1), 1))


def _wake(config: Config) -> str:
    return _tick(Session(load_world("loop"), 1, config, None, states.before()))


def _tick(session: Session) -> str:
    for _ in range(2):
        session.tick()
    return "taken"


KINDS: dict[str, tuple[Callable[[Random], str], int]] = {
    "brain file": (BRAINS.file, 15), "brain state": (BRAINS.state, 30), "session file": (SESSIONS.file, 5),
    "session state": (SESSIONS.state, 20), "world": (world, 15), "vector plan": (vector_plan, 8),
    "picture": (picture, 8), "map_server": (map_server, 7), "parameters": (parameters, 8), "setting": (setting, 4),
    "recording": (recordings.recording, 30), "run": (runs.run_file, 30),
}  # fmt: skip
