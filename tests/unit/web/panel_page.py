"""A page that looks at the panel, and what it has been told."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.unit.web.frames import read_message
from web.messages import Snapshot
from web.panel.panel import TABS, Panel, PanelReader
from web.switches import Switches

Told = dict[str, tuple[dict[str, Any], dict[str, np.ndarray]]]


class Page:
    """One page with open tabs; by default, time advances by as much as any part may wait."""

    def __init__(self, *tabs: str, panel: Panel | None = None) -> None:
        self.panel, self.now_s = panel or Panel(Switches()), 100.0
        self.reader = PanelReader(self.panel)
        self.reader.tabs = tabs or TABS

    def told(self, snapshot: Snapshot, after_s: float = 2.0) -> Told:
        """Data and arrays by part."""
        self.now_s += after_s
        self.panel.remember(snapshot)
        read = [read_message(message) for message in self.reader.news(snapshot, self.now_s)]
        return {head["part"]: (head["data"], arrays) for head, arrays in read}


def told(snapshot: Snapshot, part: str) -> tuple[Any, dict[str, np.ndarray]]:
    """What a page that has just come is told of one part: its data and its arrays."""
    return Page().told(snapshot)[part]


def memory(snapshot: Snapshot) -> str:
    """The words of the tab Memory."""
    tables = told(snapshot, "memory")[0]["tables"]
    return "\n".join(f"{t['title']}\n{t['rows']}\n{t['empty']}" for t in tables)
