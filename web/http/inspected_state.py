"""What people look into, as JSON: an experience, and in words what is inspected or walked through."""

from __future__ import annotations

from typing import Any

from web.http.run_state import pose_fields
from web.messages import (
    CellReport,
    ExperienceReport,
    Report,
    TickWalk,
    ViewReport,
    WhyReport,
)


def experience_fields(report: ExperienceReport) -> dict[str, Any]:
    """`/api/experience/{id}`. The strongest links of its view to pose cells are rows theta', y', x' with strengths."""
    x, y, theta = report.cell
    return {
        "id": report.id,
        "active": report.active,
        "energy": report.energy,
        "pose_cells": {"x": x, "y": y, "theta": theta},
        "zone": {"xy": report.zone_xy, "theta": report.zone_theta},
        "map": pose_fields(report.pose),
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


def inspected_words(report: Report) -> str:
    match report:
        case ExperienceReport():
            return f"experience #{report.id}"
        case ViewReport():
            return f"view #{report.id}"
        case CellReport():
            return f"pose cells at {report.x}, {report.y}"
        case WhyReport():
            return f"{report.kind} at {report.time_s:.1f} s"


def walk_fields(walk: TickWalk) -> dict[str, Any]:
    stage = walk.stages[walk.at]
    return {"at": walk.at + 1, "of": len(walk.stages), "title": stage.title, "words": stage.words}
