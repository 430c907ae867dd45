"""A run as a film: what the camera sees, the map as the robot has it over the office, and the pose cells."""

# OpenCV tells the types of its functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import cv2
import numpy as np
from numpy.typing import NDArray

from app.protocol.trace import placed, plan_of
from app.session import Session
from ratslam_core import Pose2

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
        """Plan, links, experiences; where the robot truly is (filled) and where it believes to be (ring)."""
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
