"""Truth: how far map and odometry are from where the robot really is, and how far the map is from its own links."""

from __future__ import annotations

import math

import numpy as np
import viser
from viser import uplot

from web.messages import Series, Snapshot
from web.stage import markup
from web.stage.memory_panel import number
from web.stage.palette import Palette, mix

_PLAIN: dict[str, uplot.Scale] = {"x": uplot.Scale(time=False)}  # seconds, not dates


class TruthPanel:
    def __init__(self, gui: viser.GuiApi, palette: Palette) -> None:
        self._page = gui.add_html("")
        nothing = np.array([0.0, 1.0])
        self._errors = gui.add_uplot(
            (nothing, nothing * 0, nothing * 0), _error_series(palette), axes=_axes(palette), scales=_PLAIN, height=190
        )
        self._counts = gui.add_uplot(
            (nothing, nothing * 0, nothing * 0), _count_series(palette), axes=_axes(palette), scales=_PLAIN, height=170
        )
        self._residual_words = gui.add_html("")
        self._residual = gui.add_uplot(
            (nothing, nothing * 0, nothing * 0),
            _residual_series(palette),
            axes=_axes(palette),
            scales=_PLAIN,
            height=170,
        )
        self._palette = palette

    def set_palette(self, palette: Palette) -> None:
        self._palette = palette
        self._errors.series, self._errors.axes = _error_series(palette), _axes(palette)
        self._counts.series, self._counts.axes = _count_series(palette), _axes(palette)
        self._residual.series, self._residual.axes = _residual_series(palette), _axes(palette)

    def draw_numbers(self, snapshot: Snapshot) -> None:
        again = snapshot.revisit_consistency
        rows = [
            ("map error, after alignment", number(snapshot.error_map_m, "m", 2)),
            ("odometry alone", number(snapshot.error_odometry_m, "m", 2)),
        ]
        rows += [("revisits within half a metre", "no revisits yet" if again is None else f"{again:.0%}")]
        errors = markup.table("Error against the true world", rows)
        self._page.content = markup.page(markup.note("The robot knows none of this."), errors)

    def draw_series(self, series: Series) -> None:
        if len(series.time_s) < 2:
            return
        self._errors.data = (series.time_s, series.map_error_m, series.odometry_error_m)
        self._counts.data = (series.time_s, series.views, series.experiences)
        self._residual.data = (series.time_s, series.residual_mm, series.residual_mrad)
        self._residual_words.content = markup.page(*residual_words(series))


def residual_words(series: Series) -> list[str]:
    now = f"{series.residual_mm[-1]:.1f} mm and {math.degrees(series.residual_mrad[-1] / 1000):.2f}°"
    why = "A closed loop makes links and map disagree; correction spreads the difference over the map."
    return [markup.heading(f"Map correction: a residual of {now}"), markup.note(why)]


def _residual_series(palette: Palette) -> tuple[uplot.Series, ...]:
    angle = uplot.Series(label="angle (mrad)", stroke=markup.css(palette.robot), width=2, dash=(6, 4))
    return (
        uplot.Series(label="s"),
        uplot.Series(label="distance (mm)", stroke=markup.css(palette.packets[1]), width=2),
        angle,
    )


def _axes(palette: Palette) -> tuple[uplot.Axis, ...]:
    grid = {"stroke": markup.css(mix(palette.panel, palette.text_2, 0.25)), "width": 1}
    axis = uplot.Axis(stroke=markup.css(palette.text_2), grid=grid, ticks=grid)  # type: ignore[typeddict-item]
    return axis, uplot.Axis(**axis, size=54)  # type: ignore[misc]


def _error_series(palette: Palette) -> tuple[uplot.Series, ...]:
    odometry = uplot.Series(label="odometry (m)", stroke=markup.css(palette.robot), width=2, dash=(6, 4))
    return (
        uplot.Series(label="s"),
        uplot.Series(label="map (m)", stroke=markup.css(palette.packets[1]), width=2),
        odometry,
    )


def _count_series(palette: Palette) -> tuple[uplot.Series, ...]:
    experiences = uplot.Series(label="experiences", stroke=markup.css(palette.packets[1]), width=2, dash=(6, 4))
    return (
        uplot.Series(label="s"),
        uplot.Series(label="views", stroke=markup.css(palette.packets[0]), width=2),
        experiences,
    )
