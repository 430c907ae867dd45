"""A page that looks at the panel, and what it has been told."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np

from tests.unit.web.frames import read_message
from web.messages import Snapshot
from web.panel.panel import TABS, Panel, PanelReader

Told = dict[str, tuple[dict[str, Any], dict[str, np.ndarray]]]


class Page:
    """One page with open tabs; by default, time advances by as much as any part may wait."""

    def __init__(self, panel: Panel, tabs: Collection[str] = TABS) -> None:
        self.panel, self.reader, self.now_s = panel, PanelReader(panel), 100.0
        self.reader.tabs = tabs

    def told(self, snapshot: Snapshot, after_s: float = 2.0) -> Told:
        """Data and arrays by part."""
        self.now_s += after_s
        self.panel.remember(snapshot)
        read = [read_message(message) for message in self.reader.news(snapshot, self.now_s)]
        return {head["part"]: (head["data"], arrays) for head, arrays in read}


def words_of(tables: list[dict[str, Any]]) -> str:
    return "\n".join(f"{t['title']}\n{t['rows']}\n{t['empty']}" for t in tables)
