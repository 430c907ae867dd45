"""How the robot follows a route to its goal, and when it gives one up."""

from __future__ import annotations

from dataclasses import dataclass

from ratslam_core.params.parameter import param


@dataclass(frozen=True)
class RouteParams:
    """All times are simulated ones."""

    goal_reach_m: float = param(
        1.5, unit="m", low=0.1, high=100.0, meaning="a goal farther than this from every experience is refused",
        source="ours",
    )  # fmt: skip
    lookahead_m: float = param(
        0.6, unit="m", low=0.2, high=3.0, meaning="how far ahead on the route the robot aims", source="ours"
    )
    arrival_m: float = param(
        0.3, unit="m", low=0.05, high=2.0, meaning="nearer to the goal than this is there", source="C III.B: a cell"
    )
    close_by_share: float = param(
        2.0,
        low=1.0,
        high=10.0,
        meaning="so many times as far is close by: there, when it gets no nearer",
        source="ours",
    )
    close_by_s: float = param(
        5.0, unit="s", low=0.0, high=60.0, meaning="how long it gets no nearer before close by is there", source="ours"
    )
    nearer_m: float = param(
        0.02, unit="m", low=0.0, high=1.0, meaning="what brings it less than this nearer does not", source="ours"
    )
    coast_s: float = param(
        8.0, unit="s", low=0.0, high=120.0, meaning="how long an old route is relied on", source="D 4.4; value ours"
    )
    replan_s: float = param(
        1.0, unit="s", low=0.1, high=60.0, meaning="time between two plans of the route", source="ours"
    )
    credited_plans: float = param(
        2.0, low=1.0, high=100.0, meaning="a route older than so many plans is credited with no trial", source="ours"
    )
    near_m: float = param(
        0.6, unit="m", low=0.0, high=5.0, meaning="how far a link that is only thought of leads to an experience",
        source="ours",
    )  # fmt: skip
    near_speed: float = param(
        0.3, unit="m/s", low=0.01, high=2.0, meaning="speed that such a link is thought to be driven at", source="ours"
    )
    near_turn_cost: float = param(
        0.3, unit="s/rad", low=0.0, high=10.0, meaning="time that a turn at its end is thought to take", source="ours"
    )
    lost_s: float = param(
        25.0, unit="s", low=0.0, high=600.0, meaning="a goal is called unreachable without a route for", source="ours"
    )
    headway_s: float = param(
        0.5, unit="s", low=0.0, high=60.0, meaning="headway is when the way that is left gets so much shorter",
        source="ours",
    )  # fmt: skip
    trial_s: float = param(
        3.0, unit="s", low=0.1, high=60.0, meaning="no headway for so long is a failed trial of the ways ahead",
        source="D 3.4; value ours",
    )  # fmt: skip
    bar_ahead_m: float = param(
        0.4, unit="m", low=0.05, high=3.0, meaning="such ways lead across a bar so far ahead of the robot ...",
        source="ours",
    )  # fmt: skip
    bar_m: float = param(1.4, unit="m", low=0.1, high=10.0, meaning="... and so wide", source="ours")
    no_headway_s: float = param(
        25.0,
        unit="s",
        low=1.0,
        high=600.0,
        meaning="no headway for so long: it looks around instead ...",
        source="ours",
    )
    look_around_s: float = param(
        15.0, unit="s", low=0.0, high=600.0, meaning="... for so long: what the map takes for a way may be a wall",
        source="ours",
    )  # fmt: skip
