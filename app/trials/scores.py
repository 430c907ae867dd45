"""The scores that every trial has."""

from __future__ import annotations

import math
import statistics

from app.trials.course import Course


def scores_of(course: Course) -> dict[str, float]:
    """The scores of a trial that has ended, by name; what does not apply to it is left out."""
    session, map_ = course.session, course.session.brain.experience_map
    evaluation = session.evaluation
    error_m, odometry_m = evaluation.errors(map_)
    scores = {
        "error_m": error_m,
        "odometry_m": odometry_m,
        "path_m": evaluation.path_m,
        "simulated_s": session.time_s,
        "old_ground": evaluation.revisit_share,
        "views": len(session.brain.local_view),
        "experiences": len(map_),
        "links": map_.link_count,
        "snaps": session.brain.relocalisations,
        "false_positives": session.brain.local_view.false_positives,
        **_visits(course),
        **_kidnaps(course),
    }
    consistency = evaluation.revisit_consistency
    if consistency is not None:
        scores["consistent"] = consistency
    return {name: float(value) for name, value in scores.items() if math.isfinite(value)}


def _visits(course: Course) -> dict[str, float]:
    if not course.visits:
        return {}
    scores = {"goals": float(len(course.visits)), "reached": float(sum(visit.reached for visit in course.visits))}
    for number, visit in enumerate(course.visits, start=1):
        scores[f"goal_{number}_s"] = visit.time_s
        scores[f"goal_{number}_m"] = visit.path_m
        scores[f"goal_{number}_miss_m"] = visit.miss_m
    return scores


def _kidnaps(course: Course) -> dict[str, float]:
    kidnaps = course.session.evaluation.kidnaps
    if not kidnaps:
        return {}
    scores = {"kidnaps": float(len(kidnaps)), "recovered": float(sum(k.after_s is not None for k in kidnaps))}
    after = [kidnap.after_s for kidnap in kidnaps if kidnap.after_s is not None]
    if after:
        scores["kidnap_median_s"] = statistics.median(after)
    for number, kidnap in enumerate(kidnaps, start=1):
        if kidnap.after_s is not None:
            scores[f"kidnap_{number}_s"], scores[f"kidnap_{number}_m"] = kidnap.after_s, kidnap.after_m or 0.0
    return scores
