"""A run in pictures. At one moment: the experience map over the plan, the temporal map, and the paths in the office. As a
film: what the camera sees, the map as the robot has it over the office, and the pose cells.
"""

# matplotlib and OpenCV tell the types of their own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO

import cv2
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from numpy.typing import NDArray

from app.evaluation.agreement import alignment
from app.experiments.figures.canvas import BLUE, FAINT, INK, ORANGE, VERMILION, WALL, frame, panels, png_of, style
from app.protocol.trace import placed, plan_of
from app.session import Session
from ratslam_core import Pose2

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


FPS = 20
SIDE, FOOT = 360, 28  # pixels of a panel and of the line of words below
_CODEC = "vp09"  # in an .mp4, every browser plays it without licence
_PAPER, _INK, _WALL = (24, 20, 16), (230, 230, 230), (120, 110, 100)  # BGR
_LINK, _PLACE, _TRUE, _BELIEVED = (110, 95, 70), (240, 201, 76), (61, 122, 255), (141, 93, 255)

_Image = NDArray[np.uint8]


def write_mp4(ticks: Iterator[Session], file: IO[bytes], speed: float = 10.0) -> int:
    """Write a film that runs `speed` times as fast as the run. Returns the number of its pictures.

    ValueError when this machine's OpenCV cannot write films.
    """
    if not 0.1 <= speed <= 1000:
        raise ValueError(f"--speed must be from 0.1 to 1000 times, got {speed:g}")
    with tempfile.TemporaryDirectory(prefix="ratslam-film-") as folder:  # OpenCV writes to a name and nothing else
        film = Path(folder) / "film.mp4"
        size = (3 * SIDE, SIDE + FOOT)
        writer = cv2.VideoWriter(str(film), cv2.VideoWriter.fourcc(*_CODEC), FPS, size)
        if not writer.isOpened():
            raise ValueError(f"the OpenCV of this machine cannot write films ({_CODEC}); take --to png or mcap")
        try:
            count = _write(ticks, writer, speed)
        finally:
            writer.release()
        if not film.is_file():
            raise OSError(f"the film could not be written to {folder}")
        with film.open("rb") as made:
            while part := made.read(1 << 20):
                file.write(part)
    return count


def _write(ticks: Iterator[Session], writer: cv2.VideoWriter, speed: float) -> int:
    """Each picture stands for 1 / FPS s of the film; a tick that lasts longer is shown in several."""
    count, plate, begin_s = 0, None, 0.0
    for session in ticks:
        if plate is None:
            plate, begin_s = _Plate(session), session.time_s
        due = int((session.time_s - begin_s) * FPS / speed + 1e-6) + 1
        if due > count:
            picture = plate.picture(session)
            for _ in range(due - count):
                writer.write(picture)
            count = due
    return count


class _Plate:
    """Draws the pictures of one film. The map is laid over the office as it lay at the film's beginning."""

    def __init__(self, session: Session) -> None:
        truth, robot = session.simulator.truth, session.estimate.pose_map_robot
        self._map_in_office = Pose2(truth.x, truth.y, truth.heading_rad).compose(robot.inverse())
        x1, y1, x2, y2 = session.simulator.world.bounds
        self._scale = (SIDE - 20) / max(x2 - x1, y2 - y1)
        self._middle = (x1 + x2) / 2, (y1 + y2) / 2

    def picture(self, session: Session) -> _Image:
        """One picture, BGR."""
        panels = [_camera(session), self._map(session), _cells(session)]
        foot = np.full((FOOT, 3 * SIDE, 3), _PAPER, np.uint8)
        map_ = session.brain.experience_map
        words = f"{session.world.name}  {session.time_s:7.1f} s   {len(map_)} experiences  {map_.link_count} links"
        if session.brain.lost:
            words += "   lost"
        cv2.putText(foot, words, (10, 19), cv2.FONT_HERSHEY_SIMPLEX, 0.45, _INK, 1, cv2.LINE_AA)
        return np.vstack([np.hstack(panels), foot])

    def _pixels(self, points: NDArray[np.float64]) -> NDArray[np.int32]:
        """(n, 2) pixels of points in the office (n, 2), m."""
        shifted = (points - self._middle) * (self._scale, -self._scale) + SIDE / 2
        return np.clip(np.round(shifted), -4 * SIDE, 4 * SIDE).astype(np.int32)

    def _map(self, session: Session) -> _Image:
        """Plan, links, experiences; ground truth (filled) and pose estimate (ring)."""
        panel, map_ = _empty(), session.brain.experience_map
        walls = self._pixels(plan_of(session.simulator.world).walls.reshape(-1, 2)).reshape(-1, 2, 2)
        cv2.polylines(panel, list(walls), False, _WALL, 1, cv2.LINE_AA)
        poses = self._pixels(placed(map_.poses[:, :2], self._map_in_office))
        cv2.polylines(panel, list(poses[map_.links]), False, _LINK, 1, cv2.LINE_AA)
        for x, y in poses.tolist():
            cv2.circle(panel, (x, y), 1, _PLACE, -1)
        truth, robot = session.simulator.truth, session.estimate.pose_map_robot
        believed = placed(np.array([[robot.x, robot.y]]), self._map_in_office)
        here, there = self._pixels(np.array([[truth.x, truth.y]]))[0], self._pixels(believed)[0]
        cv2.circle(panel, (int(here[0]), int(here[1])), 5, _TRUE, -1, cv2.LINE_AA)
        cv2.circle(panel, (int(there[0]), int(there[1])), 8, _BELIEVED, 2, cv2.LINE_AA)
        return panel


def _empty() -> _Image:
    return np.full((SIDE, SIDE, 3), _PAPER, np.uint8)


def _inside(picture: _Image, how: int) -> _Image:
    """A panel with this picture in its middle, as large as it fits."""
    panel, (high, wide) = _empty(), picture.shape[:2]
    scale = (SIDE - 20) / max(high, wide)
    large = cv2.resize(picture, (round(wide * scale), round(high * scale)), interpolation=how)
    top, left = (SIDE - large.shape[0]) // 2, (SIDE - large.shape[1]) // 2
    panel[top : top + large.shape[0], left : left + large.shape[1]] = large
    return panel


def _camera(session: Session) -> _Image:
    return _inside(np.ascontiguousarray(session.frame.image[..., ::-1]), cv2.INTER_NEAREST)


def _cells(session: Session) -> _Image:
    """From above: of each column the layer with the most activity, brighter than in proportion so that weak packets show."""
    above = session.brain.pose_cells.activity.max(axis=0)
    bright = np.sqrt(above / max(float(above.max()), 1e-12)) * 255
    coloured = cv2.applyColorMap(bright.astype(np.uint8)[::-1].copy(), cv2.COLORMAP_INFERNO)
    return _inside(np.asarray(coloured, np.uint8), cv2.INTER_NEAREST)
