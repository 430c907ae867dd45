"""What the page shows beside the plates: whether the robot sees, which brains could be compared, and the last loop closure that
can be played again."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from web.messages import Snapshot

SEES = "local_view.enabled"
WORTH_M = 0.05  # nothing would be seen of a smaller correction


def stage_fields(snapshot: Snapshot) -> dict[str, Any]:
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
