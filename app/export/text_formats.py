"""A run, or its experience map, as text that other programs read: CSV, TUM, g2o, GraphML."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator
from typing import IO
from xml.etree import ElementTree as Tree

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from ratslam_core import Pose2

_Array = NDArray[np.float64]
COLUMNS = (
    "tick", "time_s", "dt_s", "true_x", "true_y", "true_heading_rad", "speed", "yaw_rate", "odometry_x", "odometry_y",
    "odometry_heading_rad", "x", "y", "heading_rad", "experience", "created", "view", "recruited", "cell_x", "cell_y",
    "cell_heading_rad", "cell_mass", "snapped", "lost", "off_m", "off_rad", "mode", "behaviour", "bumped",
)  # fmt: skip
_NODE = {"x": "double", "y": "double", "heading_rad": "double", "view": "long", "island": "long"}
_EDGE = {"time_s": "double", "distance_m": "double", "behaviour": "long", "passages": "long", "confidence": "double"}


def write_csv(ticks: Iterator[Session], file: IO[bytes]) -> int:
    """Write a run as a table, a row for each tick below a line of headings; returns the number of rows.

    true_* is what was true; speed (m/s) and yaw_rate (rad/s) are what the robot was told, with errors; x, y, heading_rad what
    it believed, in the map's frame; off_m and off_rad how far it was from there, as app/evaluation judges it, empty where that
    has no meaning. What a recording does not have is empty.
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
    driven = session.source.driven
    return (
        session.tick_count, round(session.time_s, 9), told.dt, *true, told.speed,
        told.yaw_rate, odometry.x, odometry.y, odometry.heading_rad, robot.x, robot.y, robot.heading_rad,
        estimate.experience, int(estimate.created), seen.view, int(seen.recruited), packet.x, packet.y,
        packet.heading_rad, packet.mass, int(estimate.relocalised), int(session.brain.lost),
        *("" if math.isnan(value) else value for value in off), session.pilot.mode if driven else "recorded",
        session.pilot.behaviour.number if driven else "",
        int(session.frame.bumped),
    )  # fmt: skip


def tum_files(ticks: Iterator[Session]) -> dict[str, bytes]:
    """Three paths in the format of the TUM benchmark: a line "timestamp x y z qx qy qz qw" for each tick, as evo reads it.

    They are the truth (office frame), the estimate as the map tells it at the end, and what was believed at the time. The
    second is the path that SLAM programs are compared by: corrections of the map have moved what came before. The first is
    absent where a recording has no truth.
    """
    time_s: list[float] = []
    true_s: list[float] = []
    truth: list[tuple[float, float, float]] = []
    believed: list[tuple[float, float, float]] = []
    local: list[tuple[float, float, float]] = []
    at: list[int] = []
    session = None
    for session in ticks:
        true, map_ = session.truth, session.brain.experience_map
        robot, inside = session.estimate.pose_map_robot, map_.local_pose
        time_s.append(session.time_s)
        if true is not None:
            true_s.append(session.time_s)
            truth.append((true.x, true.y, true.heading_rad))
        believed.append((robot.x, robot.y, robot.heading_rad))
        local.append((inside.x, inside.y, inside.heading_rad))
        at.append(map_.active)
    if session is None:
        return {}
    mapped = _through(session.brain.experience_map.poses[at], np.array(local))
    paths = {"estimate": (time_s, mapped), "believed": (time_s, np.array(believed))}
    if truth:
        paths = {"truth": (true_s, np.array(truth)), **paths}
    return {name: _tum(*path) for name, path in paths.items()}


def _through(poses: _Array, local: _Array) -> _Array:
    """(n, 3): poses that are given in frames which themselves lie at these poses."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x = poses[:, 0] + c * local[:, 0] - s * local[:, 1]
    y = poses[:, 1] + s * local[:, 0] + c * local[:, 1]
    return np.stack([x, y, poses[:, 2] + local[:, 2]], axis=1)


def _tum(time_s: list[float], poses: _Array) -> bytes:
    lines = [
        f"{at:.6f} {x:.6f} {y:.6f} 0 0 0 {math.sin(heading / 2):.9f} {math.cos(heading / 2):.9f}\n"
        for at, (x, y, heading) in zip(time_s, poses.tolist(), strict=True)
    ]
    return "".join(lines).encode()


def g2o_text(session: Session) -> bytes:
    """The experience map as a pose graph in the format g2o: VERTEX_SE2 for experiences, EDGE_SE2 for what holds them together.

    Numbers are exact: read back, they are the map's own. An edge is a row of the transitions that map correction uses; its
    information is `believed` in all three directions, as correction weighs it (1 for the odometry of one step). A way that no
    longer counts in correction is left out.
    """
    map_ = session.brain.experience_map
    rows = map_.transitions
    lines = [f"VERTEX_SE2 {i} {x!r} {y!r} {heading!r}\n" for i, (x, y, heading) in enumerate(map_.poses.tolist())]
    for row in np.flatnonzero(rows.believed[: rows.count] > 0).tolist():
        (i, j), (dx, dy, turn), weight = rows.ends[row].tolist(), rows.move[row].tolist(), float(rows.believed[row])
        lines.append(f"EDGE_SE2 {i} {j} {dx!r} {dy!r} {turn!r} {weight!r} 0 0 {weight!r} 0 {weight!r}\n")
    return "".join(lines).encode()


def graphml_text(session: Session) -> bytes:
    """The experience map as GraphML, which networkx, Gephi and yEd read: experiences, ways between them, how long they take.

    A directed graph. Lengths in m; numbers are exact.
    """
    map_ = session.brain.experience_map
    root = Tree.Element("graphml", xmlns="http://graphml.graphdrawing.org/xmlns")
    for kind, columns in (("node", _NODE), ("edge", _EDGE)):
        for name, value in columns.items():
            key = {"id": f"{kind}-{name}", "for": kind, "attr.name": name, "attr.type": value}
            Tree.SubElement(root, "key", key)
    graph = Tree.SubElement(root, "graph", id=session.source.name, edgedefault="directed")
    columns = zip(map_.poses.tolist(), map_.views.tolist(), map_.submap_of.tolist(), strict=True)
    for i, (pose, view, island) in enumerate(columns):
        _add(Tree.SubElement(graph, "node", id=str(i)), "node", dict(zip(_NODE, (*pose, view, island), strict=True)))
    for (i, j), time_s in zip(map_.links.tolist(), map_.link_times.tolist(), strict=True):
        link = map_.link(i, j)
        values = (time_s, link.distance_m, link.behaviour, link.passages, link.confidence)
        edge = Tree.SubElement(graph, "edge", source=str(i), target=str(j))
        _add(edge, "edge", dict(zip(_EDGE, values, strict=True)))
    Tree.indent(root, " ")
    out = io.BytesIO()
    Tree.ElementTree(root).write(out, encoding="utf-8", xml_declaration=True)
    return out.getvalue()


def _add(element: Tree.Element, kind: str, values: dict[str, float]) -> None:
    for name, value in values.items():
        Tree.SubElement(element, "data", key=f"{kind}-{name}").text = repr(value)
