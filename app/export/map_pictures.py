"""Pictures of a run at one moment: the experience map over the plan, the temporal map, and the paths in the office."""

# matplotlib tells the types of its own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from numpy.typing import NDArray

from app.evaluation.agreement import alignment
from app.experiments.figures.canvas import BLUE, FAINT, INK, ORANGE, VERMILION, WALL, frame, panels, png_of, style
from app.protocol.trace import placed, plan_of
from app.session import Session

_WIDTH_IN = 6.4
_MARGIN_M = 0.4


def map_pictures(session: Session) -> dict[str, bytes]:
    """PNG files by name. The map is turned and shifted so that the robot's path fits the true one best, never bent."""
    draw = {"map": _experiences, "times": _times, "paths": _paths}
    return {name: _picture(session, panel) for name, panel in draw.items()}


def _picture(session: Session, draw: Callable[[Axes, Session], None]) -> bytes:
    x1, y1, x2, y2 = session.simulator.world.bounds
    high = _WIDTH_IN * min(max((y2 - y1) / (x2 - x1), 0.25), 1.6) + 0.5
    with style():
        figure, axes = panels(1, 1, _WIDTH_IN, high)
        panel: Axes = axes[0, 0]
        draw(panel, session)
        _plan(panel, session)
        frame(panel)
        said = f"{session.world.title}, seed {session.seed}, {session.time_s:.1f} s"
        panel.set_title(f"{said}, {len(session.brain.experience_map)} experiences", loc="left")
        if panel.get_legend_handles_labels()[0]:
            figure.legend(loc="outside lower center", ncols=4)
        return png_of(figure)


def _plan(panel: Axes, session: Session) -> None:
    plan = plan_of(session.simulator.world)
    panel.add_collection(LineCollection(list(plan.walls.reshape(-1, 2, 2)), colors=WALL, linewidths=0.8, zorder=1))
    panel.add_collection(PolyCollection(list(plan.boxes), facecolors="none", edgecolors=WALL, linewidths=0.5))
    x1, y1, x2, y2 = plan.bounds
    panel.set(xlim=(x1 - _MARGIN_M, x2 + _MARGIN_M), ylim=(y1 - _MARGIN_M, y2 + _MARGIN_M), aspect="equal")


def _in_office(session: Session) -> NDArray[np.float64]:
    """(n, 3): the experiences where they lie when the map is laid over the office."""
    map_ = session.brain.experience_map
    truth, mapped, _ = session.evaluation.trajectories(map_)
    return placed(map_.poses, alignment(mapped, truth))


def _links(panel: Axes, session: Session, poses: NDArray[np.float64], colour: str) -> None:
    ends = poses[session.brain.experience_map.links, :2]
    panel.add_collection(LineCollection(list(ends), colors=colour, linewidths=0.7, zorder=2))


def _experiences(panel: Axes, session: Session) -> None:
    poses = _in_office(session)
    _links(panel, session, poses, BLUE)
    panel.plot(*poses[:, :2].T, ".", ms=2.5, color=BLUE, zorder=3)
    panel.plot(*poses[session.brain.experience_map.active, :2], "o", ms=6, mfc="none", mec=VERMILION, zorder=4)


def _times(panel: Axes, session: Session) -> None:
    """Seconds to the place where the robot is."""
    map_, poses = session.brain.experience_map, _in_office(session)
    seconds = map_.temporal_map.times_to(map_.active)
    known = np.isfinite(seconds)
    _links(panel, session, poses, FAINT)
    drawn = panel.scatter(*poses[known, :2].T, c=seconds[known], s=9, cmap="viridis_r", linewidths=0, zorder=3)
    figure = panel.get_figure(root=True)
    assert figure is not None
    figure.colorbar(drawn, ax=panel, shrink=0.7, pad=0.02, aspect=25).set_label("seconds to the robot")


def _paths(panel: Axes, session: Session) -> None:
    truth, mapped, odometry = session.evaluation.trajectories(session.brain.experience_map, every=2)
    start = session.world.starts[0]
    from_start = np.array([[start.x, start.y]])
    c, s = np.cos(start.heading_rad), np.sin(start.heading_rad)
    panel.plot(
        *(odometry @ np.array([[c, s], [-s, c]]) + from_start).T, color=ORANGE, lw=0.7, zorder=2, label="odometry"
    )
    panel.plot(*truth.T, color=INK, lw=1.4, zorder=3, label="truth")
    fit = placed(mapped, alignment(mapped, truth))
    panel.plot(*fit.T, color=BLUE, lw=0.7, zorder=4, label="as the map tells it")
