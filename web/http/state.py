"""A snapshot as JSON: exactly the contract of `/api/state`, and what the page needs beyond it.

Numbers that are not finite become null; the speed "as fast as possible" (infinite) becomes 0, as in `set_speed`.
Each text is made at most once per snapshot, however many ask for it.
"""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

import orjson

from web.http.inspected_state import inspected_words, walk_fields
from web.http.run_state import (
    beside_fields,
    office_fields,
    pose_fields,
    recording_fields,
    situation_fields,
    time_fields,
    trial_fields,
)
from web.http.stage_state import stage_fields
from web.messages import Event, Goal, LivingLayer, MapLayer, Snapshot
from web.messages.told import Facts, goal_told, robot_told

_OPTIONS = orjson.OPT_SERIALIZE_NUMPY


def state(snapshot: Snapshot) -> dict[str, Any]:
    """The fields of the contract, without the map."""
    return {
        "tick": snapshot.tick,
        "time_s": snapshot.time_s,
        "mode": snapshot.mode,
        "running": snapshot.running,
        "speed": snapshot.speed if math.isfinite(snapshot.speed) else 0,
        "world": None if snapshot.world is None or snapshot.recording is not None else snapshot.world.name,
        "seed": snapshot.seed,
        "robot": None if snapshot.truth is None else pose_fields(snapshot.truth),
        "estimate": pose_fields(snapshot.estimate),
        "pose_cells": {
            "shape": snapshot.pose_cells.shape,
            "packets": [
                {"x": packet.x, "y": packet.y, "heading_rad": packet.heading_rad, "mass": packet.mass}
                for packet in snapshot.pose_cells.packets
            ],
        },
        "views": snapshot.views,
        "experiences": snapshot.experiences,
        "links": snapshot.links,
        "relocalisations": snapshot.relocalisations,
        "goal": None if snapshot.goal is None else _goal(snapshot.goal),
        "error_m": {"map": snapshot.error_map_m, "odometry": snapshot.error_odometry_m},
        "living": None if snapshot.living is None else _living(snapshot.living),
        "trial": None if snapshot.trial is None else trial_fields(snapshot.trial),
        "lesson": None if snapshot.lesson is None else asdict(snapshot.lesson),
        "until": None if snapshot.until is None else asdict(snapshot.until),
        "beside": None if snapshot.beside is None else beside_fields(snapshot.beside),
    }


def map_fields(layer: MapLayer, turn_rad: float) -> dict[str, Any]:
    """The map's nodes: ids and places (map frame, metres) row by row, the links between these rows, and the angle by which the
    page turns them."""
    return {"ids": layer.ids, "xy": layer.xy, "links": layer.links, "turn_rad": turn_rad}


def page_fields(snapshot: Snapshot) -> dict[str, Any]:
    """What the header and the timeline show beyond the contract. The map's size lets a page notice a new one."""
    return {
        "run": snapshot.run,
        "doing": snapshot.doing,
        "told": _told(snapshot),
        "fault": snapshot.fault,
        "real_time_factor": snapshot.real_time_factor,
        "title": title(snapshot),
        "worlds": snapshot.worlds,
        "places": () if snapshot.world is None else snapshot.world.places,
        "recording": None if snapshot.recording is None else recording_fields(snapshot.recording),
        "office": None if snapshot.office is None else office_fields(snapshot.office),
        "inspected": None if snapshot.inspected is None else inspected_words(snapshot.inspected),
        "walk": None if snapshot.walk is None else walk_fields(snapshot.walk),
        "moving": None if snapshot.living is None else _moving(snapshot.living),
        "time": None if snapshot.time is None else time_fields(snapshot.time),
        "situation": None if snapshot.situation is None else situation_fields(snapshot.situation),
        **stage_fields(snapshot),
    }


def _told(snapshot: Snapshot) -> dict[str, Any]:
    """The robot's sentence and the goal's."""
    goal, time, situation, belief = snapshot.goal, snapshot.time, snapshot.situation, snapshot.belief
    facts = Facts(
        snapshot.lost, len(snapshot.pose_cells.packets), 0 if belief is None else belief.places,
        None if belief is None else belief.odds, snapshot.mode, None if goal is None else goal.state,
        running=snapshot.running, past=time is not None and time.past, faulty=snapshot.fault is not None,
        over=snapshot.recording is not None and snapshot.recording.over,
        played_ahead=situation is not None and situation.state == "playing",
    )  # fmt: skip
    return {"robot": asdict(robot_told(facts)), "goal": None if goal is None else asdict(goal_told(goal))}


def title(snapshot: Snapshot) -> str:
    """Of the office, or of the recording."""
    if snapshot.recording is not None:
        return snapshot.recording.name
    return "" if snapshot.world is None else snapshot.world.title


def event_fields(event: Event) -> dict[str, Any]:
    since_s = event.time_s if event.since_s is None else event.since_s
    return {
        "number": event.number, "time_s": event.time_s, "kind": event.kind, "text": event.text,
        "line": event.line, "count": event.count, "since_s": since_s,
    }  # fmt: skip


def to_json(document: object) -> bytes:
    """Compact JSON; NaN and infinities become null."""
    return orjson.dumps(document, option=_OPTIONS)


class StateText:
    """The newest snapshot's texts, each made at most once."""

    def __init__(self) -> None:
        self._snapshot: Snapshot | None = None
        self._texts: dict[str, bytes] = {}
        self._shown: tuple[MapLayer, float] | None = None
        self._map: bytes = b""

    def light(self, snapshot: Snapshot) -> bytes:
        """`/api/state`."""
        return self._once(snapshot, "light")

    def full(self, snapshot: Snapshot) -> bytes:
        """`/api/state?map=1`."""
        shown = (snapshot.map, snapshot.map_turn_rad)
        if self._shown is None or self._shown[0] is not shown[0] or self._shown[1] != shown[1]:
            self._map, self._shown = to_json(map_fields(*shown)), shown
        return self.light(snapshot)[:-1] + b',"map":' + self._map + b"}"

    def page(self, snapshot: Snapshot) -> bytes:
        """What the page needs beyond the contract."""
        return self._once(snapshot, "page")

    def _once(self, snapshot: Snapshot, kind: str) -> bytes:
        if snapshot is not self._snapshot:
            self._snapshot, self._texts = snapshot, {}
        if kind not in self._texts:
            self._texts[kind] = to_json(state(snapshot) if kind == "light" else page_fields(snapshot))
        return self._texts[kind]


def _living(layer: LivingLayer) -> dict[str, Any]:
    """Doors from 0 (shut) to 1 (open), lamps that shine, how many people and boxes are there, daylight (1 = as painted)."""
    return {
        "doors": dict(zip(layer.door_names, layer.door_opening.tolist(), strict=True)),
        "lamps": dict(zip(layer.lamp_names, (layer.lamps[:, 3] > 0).tolist(), strict=True)),
        "people": len(layer.people),
        "boxes": len(layer.boxes),
        "daylight": layer.daylight,
    }


def _moving(layer: LivingLayer) -> dict[str, Any]:
    """Where people are (x, y, heading) by name, and the names of the boxes that are there."""
    places = layer.people[:, :3].round(3).tolist()
    return {"walkers": dict(zip(layer.person_names, places, strict=True)), "boxes": layer.box_names}


def _goal(goal: Goal) -> dict[str, Any]:
    return {
        "experience": goal.experience,
        "x": goal.x,
        "y": goal.y,
        "state": goal.state,
        "eta_s": goal.eta_s,
        "remaining_m": goal.remaining_m,
    }
