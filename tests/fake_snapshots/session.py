"""The made-up session at a tick, what is kept of it, one of each kind that can be inspected, and a tick walked through."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np

from web.messages import (
    CellReport,
    Event,
    ExperienceReport,
    HebbianReport,
    LinkReport,
    Packet,
    Parameter,
    Pose,
    Report,
    SeenView,
    Series,
    Snapshot,
    TickStage,
    TickWalk,
    Times,
    Timing,
    ViewReport,
    WhyReport,
)

from .experience_map import NODES, goal_layer, map_layer, times_layer, to_map
from .office import frozen, office, office_fit, positions, senses_at, truth_at
from .pose_cells import SHAPE, SNAP_EVERY, goal_memory_layer, occupancy_layer, pose_cell_layer

PARTS = ("pilot", "office and senses", "view match", "attractor", "correction", "judging")


def fake_snapshot(tick: int, goal: bool = True, *, nodes: int = NODES, run: int = 1) -> Snapshot:
    """The session after `tick` ticks of 0.1 s; two packets compete for the first eight seconds of every forty."""
    time_s = tick * 0.1
    truth = truth_at(tick)
    lost = tick % SNAP_EVERY < 80 and tick >= SNAP_EVERY
    fresh = map_layer(tick // 10, nodes)
    times = times_layer(tick // 10, nodes, goal)
    snap_count = tick // SNAP_EVERY
    now = to_map(np.array([[truth.x, truth.y]]))[0]
    estimate = Pose(float(now[0]), float(now[1]), math.remainder(truth.heading_rad + 0.0, math.tau))
    return Snapshot(
        run=run, tick=tick, time_s=time_s, mode="goal" if goal else "explore",
        doing="following the route" if goal else "following the wall", running=True, speed=1.0, real_time_factor=1.0, seed=3,
        fault=None, lost=lost, world=office(),
        worlds=(("office", "Office, 10 x 8 m"), ("loop", "Loop of corridors"), ("empty", "Empty room")), truth=truth,
        trail=frozen(positions(np.arange(max(0, tick - 1200), tick + 1, 4)).astype(np.float32)), estimate=estimate,
        senses=senses_at(tick, truth), pose_cells=pose_cell_layer(tick, truth, lost), map=fresh, times=times,
        goal=goal_layer(tick, nodes, estimate, lost) if goal else None, views=min(nodes, 600 + tick // 10),
        experiences=nodes, links=len(fresh.links), relocalisations=snap_count, coverage=min(1.0, time_s / 600),
        error_map_m=0.21 + 0.03 * math.sin(time_s / 20), error_odometry_m=0.2 + time_s * 0.005,
        revisit_consistency=0.97 if tick > 50 else None, series=series_until(tick // 10),
        timings=tuple(Timing(part, 0.1 * k + 0.05, 0.3 * k + 0.1) for k, part in enumerate(PARTS)),
        events=event_log(snap_count, goal), parameters=parameter_list(), no_room=office_fit().refusal,
        occupancy=occupancy_layer(tick // 20), goal_memory=goal_memory_layer(tick // 5, goal),
    )  # fmt: skip


@lru_cache(maxsize=4)
def series_until(second: int) -> Series:
    time_s = np.linspace(0, max(second, 1), min(600, second + 2))
    return Series(
        time_s=frozen(time_s),
        map_error_m=frozen(0.22 + 0.05 * np.sin(time_s / 9)),
        odometry_error_m=frozen(0.2 + 0.005 * time_s),
        explored_percent=frozen(np.minimum(100.0, time_s / 6)),
        views=frozen(600 * (1 - np.exp(-time_s / 90))),
        experiences=frozen(NODES * (1 - np.exp(-time_s / 120))),
        residual_mm=frozen(3 + np.sin(time_s / 7)),
        residual_mrad=frozen(4 + 1.0 * np.sin(time_s / 5)),
    )


@lru_cache(maxsize=8)
def event_log(snaps: int, goal: bool) -> tuple[Event, ...]:
    events = [Event(k, k * 40.0 + 8, "snap", f"snapped 5.6 m, snap {k}") for k in range(1, snaps + 1)]
    return tuple(([Event(0, 2.0, "goal", "goal set: printer")] if goal else []) + events)


@lru_cache(maxsize=1)
def parameter_list() -> tuple[Parameter, ...]:
    rows: list[tuple[Any, ...]] = [
        ("local_view.threshold", 8.0, "s_m", "grey", 0.0, 64.0, "a view counts as known below", "ACRA 2004", True),
        ("local_view.width", 12, "w", "px", 4, 64, "columns of a stored view", "ACRA 2004", False),
        ("pose_cells.injection", 0.1, "delta", "", 0.0, 1.0, "strength of visual input", "ACRA 2004", True),
        ("pose_cells.inhibition", 0.002, "phi", "", 0.0, 0.1, "global inhibition", "ACRA 2004", True),
        ("pose_cells.cells", 64, "n_x", "cells", 8, 128, "cells along x' and y'", "ACRA 2004", False),
        ("experience_map.correction", 0.5, "alpha", "", 0.0, 1.0, "share of an error put right", "ACRA 2004", True),
        ("pilot.speed", 0.3, "v", "m/s", 0.05, 0.5, "cruising speed", "ours", True),
        ("pilot.wander", True, "", "", None, None, "explore when there is no goal", "ours", True),
        ("views.kind", "sad", "", "", None, None, "how views are compared", "ours", False),
    ]
    return tuple(Parameter(name, value, value, *about) for name, value, *about in rows)


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
            12, (31.2, 22.1, 3.4), 7, picture, pose, 2.5, 2.0, 1.25, True, links, hebbian, times,
        ),
        "view": ViewReport(
            7, picture, frozen(255 - picture), camera, 12.5, 8.0, False, (12, 40), hebbian, Times(None, None, 0),
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
