"""What the reports of runs have in common. docs/reports.md tells what each key means."""

from __future__ import annotations

import math
from typing import Any

from app.evaluation import Coverage, backbone, looks, loops_closed
from app.session import Session
from ratslam_core import RatSlam

# Keys that tell of the machine; all others are the same whenever the same run is made.
MACHINE = ("wall_s", "real_time_factor", "real_time_factors", "rss_mb")
ISLAND_M2 = 4.0  # a loop leads round an island that is at least this large; desks are none


def counts(session: Session, wall_s: float) -> dict[str, Any]:
    """World, length and size of a run."""
    return {
        "world": session.world.name,
        "seed": session.seed,
        "simulated_s": round(session.time_s, 3),
        "wall_s": round(wall_s, 3),
        "real_time_factor": round(session.time_s / max(wall_s, 1e-9), 1),
        "ticks": session.tick_count,
        "metres": round(session.evaluation.path_m, 3),
        **size(session.brain),
    }


def size(brain: RatSlam) -> dict[str, Any]:
    """What a brain has learnt."""
    return {
        "views": len(brain.local_view),
        "false_positives": brain.local_view.false_positives,
        "experiences": len(brain.experience_map),
        "links": brain.experience_map.link_count,
        "view_links": brain.view_links.count,
        "let_go": {**brain.experience_map.ground.let_go, "view_links": brain.view_links.forgotten},
        "relocalisations": brain.relocalisations,
    }


def judged(session: Session) -> dict[str, Any]:
    """The map compared with the truth."""
    evaluation, map_ = session.evaluation, session.brain.experience_map
    map_error, odometry_error = evaluation.errors(map_)
    consistency = evaluation.revisit_consistency
    births = evaluation.births(len(map_))
    found, floor = looks(map_, births), session.simulator.free_space
    islands, true = floor.islands(ISLAND_M2), found.ends[~found.false]
    return {
        "error_m": {"map": rounded(map_error), "odometry": rounded(odometry_error)},
        "revisit_consistency": {"within_half_metre": None if consistency is None else round(consistency, 4)},
        "revisit_share": round(evaluation.revisit_share, 4),
        "looks": {
            "all": len(found.ends),
            "false": int(found.false.sum()),
            "false_believed": int((found.false & found.believed).sum()),
            "odometry_false": int(backbone(map_, births).false.sum()),
        },
        "coverage": round(Coverage().follow(floor, evaluation.path), 4),
        "loops": {
            "closed": loops_closed(true, births, evaluation.path, islands, session.frame.dt),
            "of": len(islands),
        },
    }


def kidnaps(session: Session) -> list[dict[str, Any]]:
    """Each kidnap, and whether and after how long the robot knew again where it was."""
    return [
        {
            "at_s": k.at_s,
            "recovered": k.after_s is not None,
            "after_s": rounded(k.after_s),
            "after_m": rounded(k.after_m),
        }
        for k in session.evaluation.kidnaps
    ]


def rounded(value: float | None) -> float | None:
    """Rounded to millimetres (or milliseconds); None if not finite, since JSON has no such number."""
    return round(value, 3) if value is not None and math.isfinite(value) else None
