"""Every addition of ours: what it adds, why, and the values that switch it off, so that what is left is the papers'."""

from __future__ import annotations

from dataclasses import dataclass

Value = float | int | bool | str


@dataclass(frozen=True, slots=True)
class Addition:
    """off: dotted names of parameters and the values with which the engine does what the paper says."""

    name: str
    adds: str
    why: str
    off: dict[str, Value]


ADDITIONS = (
    Addition(
        "image and sonars",
        "views are levels in even light together with the sonars' echoes; what tells little is doubted, and nothing is no view",
        "grey levels change with every lamp, and walls look alike where echoes differ",
        {"local_view.front_end": "template"},
    ),
    Addition(
        "waiting time of new views",
        "a new view injects nothing for some seconds",
        "otherwise it would hold the packet back where it has just been learnt",
        {"local_view.rest": 0.0},
    ),
    Addition(
        "heading from the shift",
        "the shift of the matched image gives the robot's heading relative to the stored view",
        "closures need it: the heading of the pose cells is precise to some degrees only",
        {"local_view.facing": False},
    ),
    Addition(
        "best observation",
        "a transition is measured where the robot comes nearest to the experience",
        "the robot enters a zone at its edge, half a metre from where the experience was made",
        {"experience_map.best_observation": False},
    ),
    Addition(
        "scan matching",
        "the sonars measure where the robot is to an old place, and whether it is there, and close loops",
        "a view is much the same a metre aside, in a hall for metres, and is known from one side only",
        {"experience_map.scan_matching": False},
    ),
    Addition(
        "uncertain looks",
        "an observation is weighed against odometry, and a passage in map correction, by how precisely it is known",
        "observations are imprecise, odometry over one step is not; taken as they are, the estimate swerves and the map bends",
        {"experience_map.anchor_sigma": 0.0, "experience_map.odometry_drift": 0.0},
    ),
    Addition(
        "robust closures",
        "outliers, which the map contradicts, weigh less in its correction; closures that no map brings together are given up",
        "false loop closures must not bend the whole map",
        {"experience_map.robust": False},
    ),
    Addition(
        "odometry edges",
        "odometry alone ties experiences made one after the other, even when known ones lie between",
        "observations, averaged into the rigid chain of odometry or interrupting it, bend and shrink the map",
        {"experience_map.odometry_edges": False},
    ),
    Addition(
        "exact solver",
        "the fixed point of the sweeps is computed directly from time to time; sweeps go by experience",
        "sweeps alone lag behind a growing map",
        {"experience_map.exact_solver": False, "experience_map.solve_every": 0, "experience_map.sweep": "by link"},
    ),
    Addition(
        "yaw bias",
        "the bias of the yaw rate is learnt from what the map cannot explain, held against how large it may be",
        "it is the largest error of odometry, and closed loops reveal it",
        {"experience_map.calibrate": False},
    ),
    Addition(
        "law of evidence",
        "what is seen where the robot cannot be is weighed; a robot that was carried maps a submap, merged at odds of 1000 to 1",
        "perceptual aliasing, believed at once, makes false loop closures between places far apart",
        {"experience_map.submaps": False},
    ),
    Addition(
        "kidnap detector",
        "a jump of image and sonars that driving cannot explain counts as a kidnap",
        "otherwise the way the robot was carried becomes a link and bends the map",
        {"kidnap.enabled": False},
    ),
    Addition(
        "pace floor",
        "a link takes at least as long as its length in the map at the robot's average pace",
        "a route over many short links would promise to arrive in half the time",
        {"experience_map.pace_floor": False},
    ),
    Addition(
        "familiar ground",
        "where enough of the observations are recognised, no more views, experiences and links are learnt",
        "otherwise the memory grows for as long as the robot drives, in a place that never changes",
        {"experience_map.familiar_ground": False},
    ),
    Addition(
        "bounded links of a view",
        "a view keeps only its strongest links to pose cells",
        "it is linked to every cell that was ever active while it was seen, and these links fill most of the memory",
        {"local_view.most_links": 0},
    ),
    Addition(
        "sparse links of the goal memory",
        "cells above half of the peak are linked, once every half metre, and not across jumps",
        "at 10 Hz a packet is wider than its movement in a tick, so link times would not depend on speed",
        {"goal_memory.share": 0.0, "goal_memory.stride_m": 0.0, "goal_memory.over_jumps": True},
    ),
)
