"""A run as a table, a row for each tick: what was true, what the robot was told, what it believed."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator
from typing import IO

from app.session import Session
from ratslam_core import Pose2

COLUMNS = (
    "tick", "time_s", "dt_s", "true_x", "true_y", "true_heading_rad", "speed", "yaw_rate", "odometry_x", "odometry_y",
    "odometry_heading_rad", "x", "y", "heading_rad", "experience", "created", "view", "recruited", "cell_x", "cell_y",
    "cell_heading_rad", "cell_mass", "snapped", "lost", "off_m", "off_rad", "mode", "behaviour", "bumped",
)  # fmt: skip


def write_csv(ticks: Iterator[Session], file: IO[bytes]) -> int:
    """Write the table with a line of headings; returns the number of rows.

    speed (m/s) and yaw_rate (rad/s) are what the robot was told, with errors; x, y, heading_rad what it believed, in the map's
    frame; off_m and off_rad how far it was from there, as app/evaluation judges it, empty where that has no meaning. What a
    recording does not have is empty.
    """
    text = io.TextIOWrapper(file, encoding="utf-8", newline="", write_through=True)
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    count, odometry = 0, Pose2(0.0, 0.0, 0.0)
    for session in ticks:
        if count > 0:
            told = session.odometry
            step, turn = told.speed * told.dt, told.yaw_rate * told.dt
            odometry = odometry.compose(Pose2(step * math.cos(turn / 2), step * math.sin(turn / 2), turn))
        table.writerow(_row(session, odometry))
        count += 1
    text.detach()
    return count


def _row(session: Session, odometry: Pose2) -> tuple[object, ...]:
    truth, told, estimate = session.truth, session.odometry, session.estimate
    robot, seen, packet = estimate.pose_map_robot, estimate.recognition, estimate.packet
    off = (math.nan, math.nan) if truth is None else session.evaluation.belief_off(truth, session.brain.experience_map)
    true = ("", "", "") if truth is None else (truth.x, truth.y, truth.heading_rad)
    recorded = session.recording is not None
    return (
        session.tick_count, round(session.time_s, 9), told.dt, *true, told.speed,
        told.yaw_rate, odometry.x, odometry.y, odometry.heading_rad, robot.x, robot.y, robot.heading_rad,
        estimate.experience, int(estimate.created), seen.view, int(seen.recruited), packet.x, packet.y,
        packet.heading_rad, packet.mass, int(estimate.relocalised), int(session.brain.lost),
        *("" if math.isnan(value) else value for value in off), "recorded" if recorded else session.pilot.mode,
        "" if recorded else session.pilot.behaviour.number,
        int(session.frame.bumped),
    )  # fmt: skip
