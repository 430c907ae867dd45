"""Poses and points of one frame in another: of the map in the office and back, and on the map's plate."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from web.messages import Pose
from web.viewer.fits.map_fit import MapFit


def placed(points: NDArray[np.float64], frame: Pose) -> NDArray[np.float64]:
    """(n, 2) points of a frame, in the frame in which that lies."""
    c, s = math.cos(frame.heading_rad), math.sin(frame.heading_rad)
    return points @ np.array([[c, s], [-s, c]]) + (frame.x, frame.y)


def into_map(points: NDArray[np.float64], map_in_office: Pose) -> NDArray[np.float64]:
    """From (n, 2) in the office to the map: the inverse of `placed`."""
    c, s = math.cos(map_in_office.heading_rad), math.sin(map_in_office.heading_rad)
    return (points - (map_in_office.x, map_in_office.y)) @ np.array([[c, -s], [s, c]])


def compose(frame: Pose, pose: Pose) -> Pose:
    """A pose of a frame, in the frame in which that lies."""
    x, y = placed(np.array([[pose.x, pose.y]]), frame)[0].tolist()
    return Pose(x, y, frame.heading_rad + pose.heading_rad)


def on_plate(pose: Pose, fit: MapFit) -> Pose:
    """A pose of the map, on its plate."""
    x, y = fit.to_plate(np.array([[pose.x, pose.y]]))[0].tolist()
    return Pose(x, y, pose.heading_rad + fit.turn_rad)
