"""Memory: what has been stored, the goal, the last snap, and the packets that compete."""

from __future__ import annotations

import math
from typing import Any

from web.messages import Belief, Goal, PoseCellLayer, Snap, Snapshot
from web.messages.robot_status import goal_status, odds_words, share_words
from web.panel.part import Content, clock, counted, number, often, percent, table, thousands

LOG = 8
SNAP_KINDS = ("snap", "kidnap", "recovered", "lost")


def memory(snapshot: Snapshot) -> Content:
    cells = snapshot.pose_cells
    tables = [
        _belief(snapshot),
        _counts(snapshot),
        _packets(cells),
        _attractor(cells),
        _goal(snapshot.goal),
        _log(snapshot),
        *_causes(cells.last_snap),
    ]
    return Content({"tables": tables})


def _counts(snapshot: Snapshot) -> dict[str, Any]:
    counts = {
        "local view cells": snapshot.views,
        "experiences": snapshot.experiences,
        "links of the map": snapshot.links,
        "relocalisations": snapshot.relocalisations,
    }
    if snapshot.belief is not None:
        counts |= {
            "views spared on familiar ground": snapshot.belief.spared,
            "links spared": snapshot.belief.links_spared,
            "links to pose cells forgotten": snapshot.belief.forgotten,
        }
    if snapshot.goal_memory is not None:
        counts["links of the goal memory"] = snapshot.goal_memory.links
    return table("Stored", [(name, thousands(value)) for name, value in counts.items()])


def _belief(snapshot: Snapshot) -> dict[str, Any]:
    """The uncertainty of the pose estimate, and the hypotheses beside it."""
    belief, title = snapshot.belief, "Pose estimate"
    if belief is None:
        return table(title, [], "it has no experience map")
    known = math.isfinite(belief.off_m)
    rows = [
        ("uncertainty", number(belief.off_m, "m", 2) if known else "unknown"),
        ("rival hypothesis", _elsewhere(belief, snapshot)),
        ("beliefs revised", often(belief.corrected) if belief.corrected else "never"),
    ]
    if belief.odds is not None:
        rows.append(("odds", odds_words(belief.odds)))
    if belief.places:
        rows.append(("hypotheses", thousands(belief.places)))
    if belief.apart or belief.joined:
        rows.append(("submaps merged", thousands(belief.joined)))
        rows.append(("experiences on other submaps", thousands(belief.apart)))
    return table(title, rows)


def _elsewhere(belief: Belief, snapshot: Snapshot) -> str:
    if not belief.others:
        return "none"
    likeliest = belief.others[0]
    away = math.hypot(likeliest.x - snapshot.estimate.x, likeliest.y - snapshot.estimate.y)
    return f"{away:.1f} m away, {share_words(likeliest.share)}"


def _packets(layer: PoseCellLayer) -> dict[str, Any]:
    rows: list[tuple[str, str]] = []
    for packet in layer.packets:
        x, y, turn = packet.x * layer.cell_m, packet.y * layer.cell_m, math.degrees(packet.heading_rad) % 360
        rows.append((f"{packet.id}: {100 * packet.mass:.0f} %", f"x′ {x:.1f} m, y′ {y:.1f} m, θ′ {turn:.0f}°"))
    return table("Packets: share of the activity, place", rows, "no activity yet")


def _attractor(layer: PoseCellLayer) -> dict[str, Any]:
    """What must hold after excitation, inhibition and normalisation, checked here. ACRA 2004 eqs. 10-12."""
    whole, positive = abs(layer.total - 1) < 1e-4, layer.least >= 0
    verdict = "broken" if not positive else "holds" if whole else "not normalised yet"
    rows = [
        ("sum of all activity", f"{layer.total:.6f}"),
        ("lowest activity", f"{layer.least:.1e}"),
        ("active cells", f"{thousands(layer.active_cells)} of {thousands(math.prod(layer.shape))}"),
        ("sum 1, none negative", verdict),
    ]
    return table("Attractor", rows)


def _goal(goal: Goal | None) -> dict[str, Any]:
    if goal is None:
        return table("Goal", [], "none: click the map")
    others = len(goal.places_xy) - 1
    rows = [
        ("state", ": ".join(filter(None, (goal_status(goal).words, goal.why)))),
        ("experience", f"#{goal.experience}" + (f" or {others} others" if others > 0 else "")),
    ]
    rows += [("time to goal", number(goal.eta_s, "s", 0)), ("distance to goal", number(goal.remaining_m, "m"))]
    return table("Goal", [*rows, ("position", f"{goal.x:.2f}, {goal.y:.2f} m")])


def _log(snapshot: Snapshot) -> dict[str, Any]:
    is_past = snapshot.time is not None and snapshot.time.past
    until_s = snapshot.time_s + 1e-9 if is_past else math.inf  # those that are still to come are none yet
    snaps = [event for event in snapshot.events if event.kind in SNAP_KINDS and event.time_s <= until_s][-LOG:]
    rows = [(clock(event.time_s), event.text) for event in reversed(snaps)]
    return table("Snaps", rows, _no_snaps(snapshot))


def _causes(snap: Snap | None) -> list[dict[str, Any]]:
    """The links that made the last snap: views, their looks, and what they put where the snap has led."""
    if snap is None:
        return []
    rows = [
        (
            f"view {cause.view}",
            f"{counted(cause.looks, 'look', 'looks')}, {percent(cause.share)} of the injected activity; "
            f"{counted(cause.links, 'link', 'links')} there, up to {cause.strongest:.2f}; learnt {cause.age_s:.0f} s before",
        )
        for cause in snap.causes
    ]
    return [table(f"Views that made the snap of {clock(snap.time_s)}", rows, "none: no view injected there")]


def _no_snaps(snapshot: Snapshot) -> str:
    if snapshot.relocalisations:
        return f"none recently; {snapshot.relocalisations} so far"
    if snapshot.revisit_consistency is None:
        return "none yet: no view has been recognised"
    return "none yet: recognised views agreed with odometry"
