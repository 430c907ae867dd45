"""The state of a run as JSON: the recording, trial or situation that plays, its branches, the brain beside it."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from web.messages import (
    BesideView,
    OfficeEdition,
    Pose,
    RecordingView,
    Side,
    SituationView,
    TimeView,
    TrialView,
)


def pose_fields(pose: Pose) -> dict[str, float]:
    return {"x": pose.x, "y": pose.y, "heading_rad": pose.heading_rad}


def recording_fields(recording: RecordingView) -> dict[str, Any]:
    return {
        "name": recording.name,
        "format": recording.format,
        "moments": recording.moments,
        "seconds": recording.seconds,
        "has": recording.has,
        "over": recording.over,
    }


def situation_fields(situation: SituationView) -> dict[str, Any]:
    return {
        "state": situation.state,
        "tick": situation.tick,
        "end_tick": situation.end_tick,
        "words": situation.words,
        "state_hash": situation.state_hash,
        "look": situation.look.model_dump(),
    }


def office_fields(office: OfficeEdition) -> dict[str, Any]:
    return {"edition": office.number, "undo": office.undo, "redo": office.redo, "saved": office.saved}


def time_fields(time: TimeView) -> dict[str, Any]:
    branches = [
        {"number": branch.number, "parent": branch.parent, "from_s": branch.from_s, "end_s": branch.end_s}
        for branch in time.branches
    ]
    return {
        "past": time.past,
        "end_tick": time.end_tick,
        "end_s": time.end_s,
        "begin_s": time.begin_s,
        "branch": time.branch,
        "branches": branches,
        "loop": time.loop,
        "bookmarks": [{"tick": each.tick, "time_s": each.time_s, "name": each.name} for each in time.bookmarks],
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
        "packet": {
            "x": side.packet.x,
            "y": side.packet.y,
            "heading_rad": side.packet.heading_rad,
            "mass": side.packet.mass,
        },
        "xy": side.xy.round(2),
        "robot": pose_fields(side.robot),
        "turn_rad": side.turn_rad,
    }


def beside_fields(beside: BesideView) -> dict[str, Any]:
    """Two brains in figures, and since when they differ in what."""
    return {
        "first": asdict(beside.first),
        "second": asdict(beside.second),
        "since_s": beside.since_s,
        "error_odometry_m": beside.error_odometry_m,
        "estimate": pose_fields(beside.estimate),
        "differences": [asdict(difference) for difference in beside.differences],
        "changed": [asdict(changed) for changed in beside.changed],
    }


def trial_fields(trial: TrialView) -> dict[str, Any]:
    return {
        "experiment": trial.experiment,
        "title": trial.title,
        "engine": trial.engine,
        "levels": trial.levels,
        "seed": trial.seed,
        "id": trial.id,
        "state": trial.state,
        "doing": trial.doing,
        "about_s": trial.about_s,
        "ahead": trial.ahead,
        "altered": trial.altered,
        "outcome": trial.outcome,
    }
