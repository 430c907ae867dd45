"""Memory: what the network has stored, where it wants to go, when it snapped, which packets compete."""

from __future__ import annotations

import math

import viser

from web.messages import Goal, PoseCellLayer, Snapshot
from web.stage import markup

LOG = 8
SNAP_KINDS = ("snap", "kidnap", "recovered", "lost")


class MemoryPanel:
    def __init__(self, gui: viser.GuiApi) -> None:
        self._page = gui.add_html("")

    def draw(self, snapshot: Snapshot) -> None:
        goal, cells = _goal(snapshot.goal), _packets(snapshot.pose_cells)
        self._page.content = markup.page(
            _counts(snapshot), cells, _invariants(snapshot.pose_cells), goal, _log(snapshot)
        )


def clock(seconds: float) -> str:
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


def number(value: float | None, unit: str, digits: int = 1) -> str:
    return "-" if value is None or not math.isfinite(value) else f"{value:.{digits}f} {unit}"


def _counts(snapshot: Snapshot) -> str:
    counts = {
        "local view cells": snapshot.views,
        "experiences": snapshot.experiences,
        "links between them": snapshot.links,
        "relocalisations": snapshot.relocalisations,
    }
    if snapshot.goal_memory is not None:
        counts["links of the goal memory"] = snapshot.goal_memory.links
    return markup.table("Stored", [(name, f"{value:,}".replace(",", " ")) for name, value in counts.items()])


def _packets(layer: PoseCellLayer) -> str:
    rows = []
    for packet in layer.packets:
        x, y, turn = packet.x * layer.cell_m, packet.y * layer.cell_m, math.degrees(packet.heading_rad) % 360
        rows.append((f"{packet.id}: {packet.mass:.0%} of the activity", f"x′ {x:.1f}  y′ {y:.1f} m  θ′ {turn:.0f}°"))
    return markup.table("Packets", rows, "no activity yet")


def _invariants(layer: PoseCellLayer) -> str:
    """What excitation, inhibition and normalisation leave as it is, checked here and now. ACRA 2004 eqs. 10-12."""
    whole, positive = abs(layer.total - 1) < 1e-4, layer.least >= 0
    verdict = "broken" if not positive else "holds" if whole else "not normalised yet"
    rows = [("sum of all activity", f"{layer.total:.6f}"), ("least activity of an active cell", f"{layer.least:.1e}")]
    count = f"{layer.active_cells:,} of {math.prod(layer.shape):,}".replace(",", " ")
    rows += [("active cells", count), ("sum 1, nothing below 0", verdict)]
    return markup.table("Attractor", rows)


def _goal(goal: Goal | None) -> str:
    if goal is None:
        return markup.table("Goal", [], "none: click on the map and the robot goes there")
    rows = [("state", goal.state), ("experience", f"#{goal.experience}")]
    rows += [("time to get there", number(goal.eta_s, "s", 0)), ("way to go", number(goal.remaining_m, "m"))]
    return markup.table("Goal", [*rows, ("place (map frame)", f"{goal.x:.2f}, {goal.y:.2f} m")])


def _log(snapshot: Snapshot) -> str:
    snaps = [event for event in snapshot.events if event.kind in SNAP_KINDS][-LOG:]
    rows = [(clock(event.time_s), event.text) for event in reversed(snaps)]
    return markup.table("Snaps", rows, "none yet: nothing seen before has come into view again")
