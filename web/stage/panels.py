"""The side panel: seven tabs docked right - Senses, Memory, Inspect, Tick, Truth, Office, Tune."""

from __future__ import annotations

from collections.abc import Callable

import viser

from web.messages import Command, Snapshot
from web.stage.hand import Answer
from web.stage.inspect_panel import InspectPanel
from web.stage.memory_panel import MemoryPanel
from web.stage.office_panel import OfficePanel
from web.stage.palette import Palette
from web.stage.rates import Layer
from web.stage.senses_panel import SensesPanel
from web.stage.switches import Switches
from web.stage.tick_panel import TickPanel
from web.stage.truth_panel import TruthPanel
from web.stage.tune_panel import TunePanel

WIDTH_PX = 340


class Panels:
    def __init__(
        self,
        gui: viser.GuiApi,
        palette: Palette,
        send: Callable[[Command, Callable[[Answer], None]], None],
        complain: Callable[[int, str, str], None],
    ) -> None:
        gui.set_panel_label("RatSLAM")
        gui.main_panel.dock_right()
        gui.main_panel.set_width(WIDTH_PX)
        tabs = gui.add_tab_group()
        with tabs.add_tab("Senses"):
            self.senses = SensesPanel(gui, palette)
        with tabs.add_tab("Memory"):
            self.switches = Switches(gui)
            self.memory = MemoryPanel(gui)
        with tabs.add_tab("Inspect"):
            self.inspect = InspectPanel(gui, send, complain)
        with tabs.add_tab("Tick"):
            self.tick = TickPanel(gui, palette, send, complain)
        with tabs.add_tab("Truth"):
            self.truth = TruthPanel(gui, palette)
        self.office = OfficePanel(gui, tabs.add_tab("Office"), send, complain)
        self.tune = TunePanel(gui, tabs.add_tab("Tune"), send, complain)
        self._layers = {
            "views": Layer(8, self.senses.draw_views),
            "cells": Layer(5, self.senses.draw_cells),
            "memory": Layer(2, self.memory.draw),
            "inspected": Layer(4, self.inspect.draw),
            "walk": Layer(10, self.tick.draw_walk),
            "timings": Layer(1, self.tick.draw_timings),
            "numbers": Layer(2, self.truth.draw_numbers),
            "series": Layer(1, self.truth.draw_series),
            "office": Layer(5, self.office.follow),
            "tune": Layer(5, self.tune.follow),
        }

    def draw(self, snapshot: Snapshot, now_s: float) -> None:
        offer = self._layers
        self.senses.remember(snapshot.senses)
        self.inspect.remember(snapshot)
        offer["views"].offer(now_s, snapshot.senses)
        offer["cells"].offer(now_s, snapshot.pose_cells, snapshot)
        offer["memory"].offer(now_s, snapshot)
        offer["inspected"].offer(now_s, snapshot.inspected)
        offer["walk"].offer(now_s, snapshot.walk)
        offer["timings"].offer(now_s, snapshot.timings)
        offer["numbers"].offer(now_s, snapshot)
        offer["series"].offer(now_s, snapshot.series)
        offer["office"].offer(now_s, snapshot.living, snapshot.parameters, snapshot.presets, snapshot.preset)
        self.office.send_pending()
        offer["tune"].offer(now_s, snapshot.parameters)
        self.tune.send_pending(now_s)

    def set_palette(self, palette: Palette) -> None:
        """Draws all of it again in other colours."""
        self.senses.palette = palette
        self.truth.set_palette(palette)
        self.tick.palette = palette
        for layer in self._layers.values():
            layer.forget()

    def reset(self) -> None:
        """Another run begins."""
        self.senses.reset()
