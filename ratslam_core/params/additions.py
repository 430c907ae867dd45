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
        "order of the stages",
        "path integration comes before association",
        "the image belongs to the end of the movement; else every view is linked one step behind",
        {"pose_cells.move_first": False},
    ),
    Addition(
        "carry",
        "the motion that the attractor swallowed is given back",
        "an attractor pins slow packets to its lattice",
        {"pose_cells.carry": False},
    ),
    Addition(
        "division by the spread",
        "a packet's way is divided by the mean resultant length of its headings, along the arc",
        "headings that spread shorten the way, and the end must not depend on the rate",
        {"pose_cells.divide_spread": False, "pose_cells.arc": False},
    ),
    Addition(
        "iterations a cell",
        "an attractor iteration for each cell driven",
        "layers of one packet drift apart as they are driven fast",
        {"pose_cells.iterations": 1},
    ),
    Addition(
        "capped injection",
        "all links of a view inject at most so much together",
        "one look-alike must not move a packet, a row of agreeing views must",
        {"local_view.capped": False},
    ),
    Addition(
        "rest of young views",
        "a young view injects nothing, an old one what it had learnt before",
        "it would hold the packet back where it was just learnt",
        {"local_view.rest": 0.0, "local_view.learn_first": True},
    ),
    Addition(
        "gate for bland views",
        "what shows nothing is no view",
        "walls at arm's length look alike everywhere",
        {"local_view.min_contrast": 0.0, "local_view.min_edges": 0.0, "local_view.min_colour": 0.0},
    ),
    Addition(
        "heading by shift",
        "the shift of the matched image tells how the robot is turned",
        "closures need it: the pose cells' own heading is known to some degrees",
        {"local_view.facing": False},
    ),
    Addition(
        "place in the zone",
        "the robot enters an experience beside its centre, and a transition is measured where it comes nearest",
        "it enters a zone at its edge, half a metre from where the experience was made",
        {"experience_map.zone_offset": False, "experience_map.best_look": False},
    ),
    Addition(
        "weighted transitions",
        "a passage counts in map correction by how well it is known",
        "looks are loose, odometry over a step is not",
        {"experience_map.anchor_sigma": 0.0, "experience_map.odometry_drift": 0.0},
    ),
    Addition(
        "robust weights",
        "what the map contradicts weighs less in its exact correction",
        "a wrong closure must not bend all",
        {"experience_map.robust": False},
    ),
    Addition(
        "odometry edges",
        "odometry ties experiences made one after the other past known ones",
        "known places cut the rigid chain of odometry, and the map shrinks",
        {"experience_map.odometry_edges": False},
    ),
    Addition(
        "exact solver",
        "the fixed point of the sweeps, now and then; sweeps by experience",
        "sweeps alone lag behind a growing map",
        {"solver.enabled": False, "experience_map.solve_every": 0, "experience_map.sweep": "by link"},
    ),
    Addition(
        "yaw bias",
        "the bias of the yaw rate is learnt from what the map cannot explain",
        "it is the largest error of odometry, and the map knows it",
        {"experience_map.calibrate": False},
    ),
    Addition(
        "pose filter",
        "a look is weighed against odometry",
        "looks taken at their word make the robot swerve",
        {"pose_filter.enabled": False},
    ),
    Addition(
        "kidnap detector",
        "image and sonars that jump though the wheels did not are a kidnap",
        "otherwise the carried way becomes a link and bends the map",
        {"kidnap.enabled": False},
    ),
    Addition(
        "pace floor",
        "a link takes at least what its length in the map takes",
        "a route over many short links would promise to be there in half the time",
        {"experience_map.pace_floor": False},
    ),
    Addition(
        "trials of links",
        "a link is tried when a route takes it, and the newest trials count most",
        "where many ways leave a place none of them is what a behaviour is expected to bring",
        {"experience_map.link_trials_are": "departures", "experience_map.link_recency": 0.0},
    ),
    Addition(
        "strides of the goal memory",
        "cells above half of the peak are linked, every half metre, not over jumps",
        "at 10 Hz a packet is wider than its move, and times would know nothing of speed",
        {"goal_memory.share": 0.0, "goal_memory.stride_m": 0.0, "goal_memory.over_jumps": True},
    ),
)
