"""A moment in which people know much that the robot does not: for the stage and for pictures of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.fake_snapshots import fake_snapshot
from tests.fake_snapshots.experience_map import NODES
from web.messages import (
    BesideView,
    BrainFigures,
    Closure,
    Ghost,
    KnownPlace,
    LessonMark,
    LessonOutcome,
    LessonPrediction,
    LessonView,
    LessonVotes,
    Pose,
    Snapshot,
    Spread,
    TaggedPlace,
)

FRAME = Pose(1.0, 0.5, 0.1)
NO_LINKS = np.zeros((0, 2), np.int32)


def judged(tick: int = 430, off_m: float = 0.0, nodes: int = NODES, **more: object) -> Snapshot:
    """Ghost, true walls, error, doubt and two closures. off_m: how far the ghost is beside the map."""
    plain = fake_snapshot(tick, nodes=nodes)
    path = np.column_stack([np.linspace(0, 3 + off_m, 60), np.zeros(60)]).astype(np.float32)
    xy, count = plain.map.xy, len(plain.map.xy)
    closures = tuple(
        Closure(k, plain.time_s - 9 + k, 0, row, NO_LINKS, xy, xy, 0.4 * k)
        for k, row in enumerate((count // 3, count // 2))
    )
    held = Snapshot.__dataclass_fields__.keys() & more.keys()
    assert held == more.keys()
    return replace(
        plain, map_in_office=FRAME, closures=closures, spread=Spread(0.5, 0.25, 0.3, "packet"),
        ghost=Ghost(Pose(3.0 + off_m, 0.0, 0.0), path, Pose(2.0, 3.0, 0.0), Pose(0.0, 0.0, 0.0)), **more,
    )  # fmt: skip


def crowded() -> Snapshot:
    """Library, tag, closure and the wheels' ghost in one place of the map, near to where the robot believes it is."""
    plain = fake_snapshot(430, goal=False)
    row = len(plain.map.xy) // 2
    x, y = (float(v) for v in plain.map.xy[row])
    start = Pose(0.0, 0.0, 0.0)
    return replace(
        plain, map_in_office=FRAME, estimate=Pose(x - 0.6, y, 0.0), tags=(TaggedPlace("tea", row, x, y),),
        closures=(Closure(7, plain.time_s - 1, 0, row, NO_LINKS, plain.map.xy, plain.map.xy, 1.3),),
        places=(KnownPlace("library", 2.0, 6.0, (x, y - 0.6)),),
        ghost=Ghost(Pose(x, y, 0.0), np.zeros((0, 2), np.float32), start, start),
    )  # fmt: skip


def taught() -> Snapshot:
    """A lesson is over: what happened on all plates, and what was predicted on the map."""
    marks = (
        LessonMark("office", 2.0, 2.0, None, "put down here", 50), LessonMark("map", 2.0, 2.0, 0.0, "felt lost", 50),
        LessonMark("cells", 2.0, 10.0, 0.5, "a snap", 50, (58.0, 10.0, 0.5)),
    )  # fmt: skip
    ended = LessonOutcome("it drifted", "", False, x=1.0, y=-0.5, distance_m=2.0)
    said = LessonPrediction(x=0.0, y=0.8)
    nobody = LessonVotes((), ())
    lesson = LessonView(
        "dark", "Eyes shut", "compared", "", None, 1, 1, "", 2, said, nobody, ended, marks, False, "map"
    )
    return judged(lesson=lesson)


def two_brains(tick: int = 430, of: int = 300) -> Snapshot:
    """The second brain is as the first was some time before."""
    other = fake_snapshot(of)
    first = BrainFigures("with vision", 200, 150, 160, 1, 0.2, 0.1, False)
    second = BrainFigures("without vision", 0, 150, 149, 0, 2.0, 2.1, False)
    beside = BesideView(
        first, second, 0.0, 0.9, (), (), other.pose_cells, other.map, other.times, other.estimate, (), other.goal, 0.3
    )
    return judged(tick, beside=beside)
