"""The made-up session at a tick."""

from __future__ import annotations

import math

import numpy as np

from web.messages import Pose, Snapshot, Timing

from .books import event_log, parameter_list, series_until
from .experience_map import NODES, goal_layer, map_layer, times_layer, to_map
from .frozen import frozen
from .long_walk import positions, truth_at
from .office import office, office_fit
from .pose_cells import SNAP_EVERY, goal_memory_layer, occupancy_layer, pose_cell_layer
from .senses import senses_at

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
        run=run,
        tick=tick,
        time_s=time_s,
        mode="goal" if goal else "explore",
        doing="following the route" if goal else "following the wall",
        running=True,
        speed=1.0,
        real_time_factor=1.0,
        seed=3,
        fault=None,
        lost=lost,
        world=office(),
        worlds=(("office", "Office, 10 x 8 m"), ("loop", "Loop of corridors"), ("empty", "Empty room")),
        truth=truth,
        trail=frozen(positions(np.arange(max(0, tick - 1200), tick + 1, 4)).astype(np.float32)),
        estimate=estimate,
        senses=senses_at(tick, truth),
        pose_cells=pose_cell_layer(tick, truth, lost),
        map=fresh,
        times=times,
        goal=goal_layer(tick, nodes, estimate, lost) if goal else None,
        views=min(nodes, 600 + tick // 10),
        experiences=nodes,
        links=len(fresh.links),
        relocalisations=snap_count,
        coverage=min(1.0, time_s / 600),
        error_map_m=0.21 + 0.03 * math.sin(time_s / 20),
        error_odometry_m=0.2 + time_s * 0.005,
        revisit_consistency=0.97 if tick > 50 else None,
        series=series_until(tick // 10),
        timings=tuple(Timing(part, 0.1 * k + 0.05, 0.3 * k + 0.1) for k, part in enumerate(PARTS)),
        events=event_log(snap_count, goal),
        parameters=parameter_list(),
        no_room=office_fit().refusal,
        occupancy=occupancy_layer(tick // 20),
        goal_memory=goal_memory_layer(tick // 5, goal),
    )
