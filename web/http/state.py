"""A snapshot as JSON: exactly the contract of `/api/state`, and what the page needs beyond it.

Numbers that are not finite become null; the speed "as fast as possible" (infinite) becomes 0, as in `set_speed`.
"""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

import numpy as np
import orjson

from web.messages import (
    BesideView,
    CellReport,
    Event,
    ExperienceReport,
    Goal,
    KnownPlace,
    LivingLayer,
    MapLayer,
    OfficeEdition,
    Packet,
    Pose,
    Report,
    Side,
    SituationView,
    Snapshot,
    TickWalk,
    TimeView,
    ViewReport,
    WhyReport,
)
from web.messages.robot_status import Facts, goal_status, robot_status

SEES = "local_view.enabled"
WORTH_M = 0.05  # nothing would be seen of a smaller correction


class StateText:
    """The newest snapshot's texts, each made at most once, however many ask for it."""

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
            self._map, self._shown = to_json(_map(*shown)), shown
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


def to_json(document: object) -> bytes:
    """Compact JSON; NaN and infinities become null."""
    return orjson.dumps(document, option=orjson.OPT_SERIALIZE_NUMPY)


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
        "robot": None if snapshot.truth is None else _pose(snapshot.truth),
        "estimate": _pose(snapshot.estimate),
        "pose_cells": {
            "shape": snapshot.pose_cells.shape,
            "packets": [_packet(packet) for packet in snapshot.pose_cells.packets],
        },
        "views": snapshot.views,
        "experiences": snapshot.experiences,
        "links": snapshot.links,
        "relocalisations": snapshot.relocalisations,
        "goal": None if snapshot.goal is None else _goal(snapshot.goal),
        "error_m": {"map": snapshot.error_map_m, "odometry": snapshot.error_odometry_m},
        "living": None if snapshot.living is None else _living(snapshot.living),
        "trial": None if snapshot.trial is None else asdict(snapshot.trial),
        "lesson": None if snapshot.lesson is None else asdict(snapshot.lesson),
        "until": None if snapshot.until is None else asdict(snapshot.until),
        "beside": None if snapshot.beside is None else beside_fields(snapshot.beside),
    }


def _pose(pose: Pose) -> dict[str, float]:
    return {"x": pose.x, "y": pose.y, "heading_rad": pose.heading_rad}


def _packet(packet: Packet) -> dict[str, float]:
    return {"x": packet.x, "y": packet.y, "heading_rad": packet.heading_rad, "mass": packet.mass}


def _goal(goal: Goal) -> dict[str, Any]:
    return {
        "experience": goal.experience,
        "x": goal.x,
        "y": goal.y,
        "state": goal.state,
        "eta_s": goal.eta_s,
        "remaining_m": goal.remaining_m,
    }


def _living(layer: LivingLayer) -> dict[str, Any]:
    """Doors from 0 (shut) to 1 (open), lamps that shine, how many people and boxes are there, daylight (1 = as painted)."""
    return {
        "doors": dict(zip(layer.door_names, layer.door_opening.tolist(), strict=True)),
        "lamps": dict(zip(layer.lamp_names, (layer.lamps[:, 3] > 0).tolist(), strict=True)),
        "people": len(layer.people),
        "boxes": len(layer.boxes),
        "daylight": layer.daylight,
    }


def beside_fields(beside: BesideView) -> dict[str, Any]:
    """Two brains in figures, and since when they differ in what."""
    return {
        "first": asdict(beside.first),
        "second": asdict(beside.second),
        "since_s": beside.since_s,
        "error_odometry_m": beside.error_odometry_m,
        "estimate": _pose(beside.estimate),
        "differences": [asdict(difference) for difference in beside.differences],
        "changed": [asdict(changed) for changed in beside.changed],
    }


def _map(layer: MapLayer, turn_rad: float) -> dict[str, Any]:
    """The map's nodes: ids and places (map frame, metres) row by row, the links between these rows, and the angle by which the
    page turns them."""
    return {"ids": layer.ids, "xy": layer.xy, "links": layer.links, "turn_rad": turn_rad}


def page_fields(snapshot: Snapshot) -> dict[str, Any]:
    """What the header and the timeline show beyond the contract. The map's size lets a page notice a new one."""
    return {
        "run": snapshot.run,
        "doing": snapshot.doing,
        "trip": None
        if snapshot.trip is None
        else {"x": snapshot.trip.x, "y": snapshot.trip.y, "reason": snapshot.trip.reason},
        "status": _status(snapshot),
        "fault": snapshot.fault,
        "real_time_factor": snapshot.real_time_factor,
        "title": title(snapshot),
        "worlds": snapshot.worlds,
        "places": () if snapshot.world is None else snapshot.world.places,
        "recording": None if snapshot.recording is None else asdict(snapshot.recording),
        "office": None if snapshot.office is None else office_fields(snapshot.office),
        "inspected": None if snapshot.inspected is None else _inspected(snapshot.inspected),
        "walk": None if snapshot.walk is None else _walk(snapshot.walk),
        "moving": None if snapshot.living is None else _moving(snapshot.living),
        "time": None if snapshot.time is None else _time(snapshot.time),
        "situation": None if snapshot.situation is None else _situation(snapshot.situation),
        "back": snapshot.back,
        **_stage(snapshot),
    }


def _status(snapshot: Snapshot) -> dict[str, Any]:
    """The robot's sentence and the goal's."""
    goal, time, situation, belief = snapshot.goal, snapshot.time, snapshot.situation, snapshot.belief
    facts = Facts(
        snapshot.lost, len(snapshot.pose_cells.packets), 0 if belief is None else belief.places,
        None if belief is None else belief.odds, snapshot.mode, None if goal is None else goal.state,
        running=snapshot.running, past=time is not None and time.past, faulty=snapshot.fault is not None,
        over=snapshot.recording is not None and snapshot.recording.over,
        played_ahead=snapshot.stepping or (situation is not None and situation.state == "playing"),
    )  # fmt: skip
    return {"robot": asdict(robot_status(facts)), "goal": None if goal is None else asdict(goal_status(goal))}


def title(snapshot: Snapshot) -> str:
    """Of the office, or of the recording."""
    if snapshot.recording is not None:
        return snapshot.recording.name
    return "" if snapshot.world is None else snapshot.world.title


def office_fields(office: OfficeEdition) -> dict[str, Any]:
    return {"edition": office.number, "undo": office.undo, "redo": office.redo, "saved": office.saved}


def _inspected(report: Report) -> str:
    match report:
        case ExperienceReport():
            return f"experience #{report.id}"
        case ViewReport():
            return f"view #{report.id}"
        case CellReport():
            return f"pose cells at {report.x}, {report.y}"
        case WhyReport():
            return f"{report.kind} at {report.time_s:.1f} s"


def _walk(walk: TickWalk) -> dict[str, Any]:
    stage = walk.stages[walk.at]
    return {"at": walk.at + 1, "of": len(walk.stages), "title": stage.title, "words": stage.words}


def _moving(layer: LivingLayer) -> dict[str, Any]:
    """Where people are (x, y, heading) by name, and the names of the boxes that are there."""
    places = layer.people[:, :3].round(3).tolist()
    return {"walkers": dict(zip(layer.person_names, places, strict=True)), "boxes": layer.box_names}


def _time(time: TimeView) -> dict[str, Any]:
    return {
        "past": time.past,
        "end_tick": time.end_tick,
        "end_s": time.end_s,
        "begin_s": time.begin_s,
        "branch": time.branch,
        "branches": [asdict(branch) for branch in time.branches],
        "loop": time.loop,
        "bookmarks": [asdict(bookmark) for bookmark in time.bookmarks],
        "differs": time.differs,
        "doing": time.doing,
        "done": round(time.done, 3),
        "sides": [_side(side) for side in time.sides],
    }


def _side(side: Side) -> dict[str, Any]:
    """One branch beside another. Its map is some of its experiences, centimetres."""
    return {
        "number": side.number,
        "time_s": side.time_s,
        "error_m": {"map": side.error_map_m, "odometry": side.error_odometry_m},
        "views": side.views,
        "experiences": side.experiences,
        "links": side.links,
        "packet": _packet(side.packet),
        "xy": side.xy.round(2),
        "robot": _pose(side.robot),
        "turn_rad": side.turn_rad,
    }


def _situation(situation: SituationView) -> dict[str, Any]:
    return {
        "state": situation.state,
        "tick": situation.tick,
        "end_tick": situation.end_tick,
        "words": situation.words,
        "state_hash": situation.state_hash,
        "look": situation.look.model_dump(),
    }


def _stage(snapshot: Snapshot) -> dict[str, Any]:
    seeing = next((row.value for row in snapshot.parameters if row.name == SEES), True)
    seen = [closure for closure in snapshot.closures if closure.moved_m >= WORTH_M]
    last = None
    if seen:
        last = {"event": seen[-1].event, "time_s": seen[-1].time_s, "moved_m": round(seen[-1].moved_m, 2)}
    return {
        "vision": bool(seeing),
        "closure": last,
        "pairs": [asdict(pair) for pair in snapshot.pairs],
        "additions_off": asdict(snapshot.additions_off),
    }


def event_fields(event: Event) -> dict[str, Any]:
    since_s = event.time_s if event.since_s is None else event.since_s
    return {
        "number": event.number, "time_s": event.time_s, "kind": event.kind, "text": event.text,
        "line": event.line, "count": event.count, "since_s": since_s,
    }  # fmt: skip


def experience_fields(report: ExperienceReport) -> dict[str, Any]:
    """`/api/experience/{id}`. The strongest links of its view to pose cells are rows theta', y', x' with strengths."""
    x, y, theta = report.cell
    return {
        "id": report.id,
        "active": report.active,
        "energy": report.energy,
        "pose_cells": {"x": x, "y": y, "theta": theta},
        "zone": {"xy": report.zone_xy, "theta": report.zone_theta},
        "map": _pose(report.pose),
        "view": report.view,
        "picture": report.picture,
        "links": [
            {
                "from": link.start,
                "to": link.end,
                "distance_m": link.distance_m,
                "bearing_rad": link.bearing_rad,
                "facing_rad": link.facing_rad,
                "time_s": link.time_s,
                "behaviour": link.behaviour,
                "passages": link.passages,
                "trials": link.trials,
                "confidence": link.confidence,
            }
            for link in report.links
        ],
        "view_links": {
            "count": report.hebbian.count,
            "cells": report.hebbian.cells,
            "strength": report.hebbian.strength,
        },
        "first_s": report.times.first_s,
        "last_s": report.times.last_s,
        "visits": report.times.visits,
    }


def _named(place: KnownPlace, layer: MapLayer) -> dict[str, Any]:
    """A place of the office by its name. Once the map has something there it can be gone to by it; `why` says why not yet."""
    if place.map_xy is None or not len(layer.ids):
        why = "it has not been near it yet: explores until it comes there"
        return {"name": place.name, "experience": None, "x": None, "y": None, "why": why}
    x, y = place.map_xy
    nearest = int(np.hypot(*(layer.xy - np.array([x, y])).T).argmin())
    return {"name": place.name, "experience": int(layer.ids[nearest]), "x": x, "y": y, "why": None}


def places_of(snapshot: Snapshot) -> dict[str, Any]:
    """`/api/places`, for a list to choose from without seeing the map."""
    layer, times = snapshot.map, snapshot.times
    here = snapshot.estimate
    seconds = times.seconds if len(times.seconds) == len(layer.ids) else [math.inf] * len(layer.ids)
    return {
        "robot": {"x": here.x, "y": here.y, "heading_rad": here.heading_rad},
        "to_goal": times.to_goal,
        "tags": [{"name": tag.name, "experience": tag.experience, "x": tag.x, "y": tag.y} for tag in snapshot.tags],
        "named": [_named(place, layer) for place in snapshot.places],
        "experiences": [
            {"id": int(id_), "x": float(x), "y": float(y), "seconds": float(s) if math.isfinite(s) else None}
            for id_, (x, y), s in zip(layer.ids, layer.xy, seconds, strict=True)
        ],
    }
