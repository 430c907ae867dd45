"""Memory: what the network has stored, where it wants to go, when it snapped, which packets compete."""

from __future__ import annotations

import html
import math

import viser

from web.messages import Goal, PoseCellLayer, Snapshot

LOG = 8


class MemoryPanel:
    def __init__(self, gui: viser.GuiApi) -> None:
        self._page = gui.add_html("")

    def draw(self, snapshot: Snapshot) -> None:
        parts = [_counts(snapshot), _packets(snapshot.pose_cells), _goal(snapshot.goal), _log(snapshot)]
        self._page.content = f'<div style="font-size:13px;line-height:1.5;padding:0 4px">{"".join(parts)}</div>'


def table(title: str, rows: list[tuple[str, str]], empty: str = "") -> str:
    """Two columns of plain words; `empty` says why there are none."""
    head = f'<div style="font-weight:600;margin:10px 0 2px">{html.escape(title)}</div>'
    if not rows:
        return f'{head}<div style="opacity:.7">{html.escape(empty)}</div>'
    lines = "".join(
        f'<tr><td style="opacity:.75;padding-right:10px">{html.escape(name)}</td>'
        f'<td style="text-align:right;font-variant-numeric:tabular-nums">{html.escape(value)}</td></tr>'
        for name, value in rows
    )
    return f'{head}<table style="width:100%;border-collapse:collapse">{lines}</table>'


def clock(seconds: float) -> str:
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


def number(value: float | None, unit: str, digits: int = 1) -> str:
    return "-" if value is None or not math.isfinite(value) else f"{value:.{digits}f} {unit}"


def _counts(snapshot: Snapshot) -> str:
    rows = [("local view cells", snapshot.views), ("experiences", snapshot.experiences), ("links between them", snapshot.links)]
    rows += [("relocalisations", snapshot.relocalisations), ("active pose cells", snapshot.pose_cells.active_cells)]
    return table("Stored", [(name, f"{value:,}".replace(",", " ")) for name, value in rows])


def _packets(layer: PoseCellLayer) -> str:
    rows = [
        (f"{k + 1}   {p.mass:.0%} of the activity", f"x′ {p.x * layer.cell_m:.1f}  y′ {p.y * layer.cell_m:.1f} m  θ′ {math.degrees(p.heading_rad) % 360:.0f}°")
        for k, p in enumerate(layer.packets)
    ]
    return table("Packets", rows, "no activity yet")


def _goal(goal: Goal | None) -> str:
    if goal is None:
        return table("Goal", [], "none: click on the map and the robot goes there")
    rows = [("state", goal.state), ("experience", f"#{goal.experience}"), ("time to get there", number(goal.eta_s, "s", 0))]
    rows += [("way to go", number(goal.remaining_m, "m")), ("place (map frame)", f"{goal.x:.2f}, {goal.y:.2f} m")]
    return table("Goal", rows)


def _log(snapshot: Snapshot) -> str:
    snaps = [event for event in snapshot.events if event.kind in ("snap", "kidnap", "recovered", "lost")][-LOG:]
    rows = [(clock(event.time_s), event.text) for event in reversed(snaps)]
    return table("Snaps", rows, "none yet: nothing seen before has come into view again")
