"""One of each kind that can be inspected, and a tick that is walked through."""

from __future__ import annotations

import math

import numpy as np

from web.messages import (
    CellReport,
    ExperienceReport,
    HebbianReport,
    LinkReport,
    Packet,
    Pose,
    Report,
    SeenView,
    TickStage,
    TickWalk,
    Times,
    ViewReport,
    WhyReport,
)

from .experience_map import NODES, map_layer
from .frozen import frozen
from .pose_cells import SHAPE
from .session import fake_snapshot


def fake_reports() -> dict[str, Report]:
    """One of each kind that can be inspected."""
    picture = frozen(np.arange(96, dtype=np.uint8).reshape(8, 12) * 2)
    cells = frozen(np.array([[3, 22, 31], [4, 22, 31], [4, 23, 32]], np.int32))
    camera = fake_snapshot(430).senses.camera
    hebbian = HebbianReport(140, cells, frozen(np.array([0.05, 0.04, 0.01], np.float32)), 0.1)
    links = (
        LinkReport(12, 13, 1.5, math.pi / 4, -0.2, 5.25, "following the wall", 3, 5, 0.8),
        LinkReport(11, 12, 0.4, -0.0001, 0.1, 1.5, "crossing the room", 1, 0, 1.0),
    )
    times = Times(65.0, 130.0, 4)
    layer = map_layer(43, NODES)
    pose = Pose(float(layer.xy[12, 0]), float(layer.xy[12, 1]), 0.5)
    by_heading = np.zeros(SHAPE[0], np.float32)
    by_heading[3:5] = 0.2
    return {
        "experience": ExperienceReport(
            12, (31.2, 22.1, 3.4), 7, picture, pose, 2.5, 2.0, 1.25, True, links, hebbian, times
        ),
        "view": ViewReport(
            7, picture, frozen(255 - picture), camera, 12.5, 8.0, False, (12, 40), hebbian, Times(None, None, 0)
        ),
        "cell": CellReport(31, 22, frozen(by_heading), Packet(31.2, 22.4, 0.6, 0.62, 3), ((7, 0.05),), 1, (12, 40)),
        "why": WhyReport(
            9, 63.2, "snap", "relocalised by view 7", ((60.0, "view 7 is seen"), (63.2, "packet 2 wins")), camera,
            (SeenView(7, "100 % of what was injected", picture),), SHAPE, (Packet(31.2, 22.4, 0.6, 0.62, 3),),
            (Packet(11.0, 12.0, 0.6, 0.7, 4), Packet(31.2, 22.4, 0.6, 0.3, 3)), (12, 40), 60.0, (7,),
        ),
    }  # fmt: skip


def fake_walk(at: int) -> TickWalk:
    """A tick of three stages, at stage `at`."""
    names = ("image", "injection", "correction")
    return TickWalk(tuple(TickStage(n, n.capitalize(), f"This is what the {n} did.") for n in names), at)
