"""How the robot follows a route to its goal, and when it gives one up."""

from __future__ import annotations

from dataclasses import dataclass

from ratslam_core.params.parameter import param


@dataclass(frozen=True)
class RouteParams:
    """All times are simulated times."""

    goal_reach_m: float = param(
        1.5, unit="m", low=0.1, high=100.0, meaning="a goal farther than this from every experience is refused",
        source="ours",
    )  # fmt: skip
    lookahead_m: float = param(
        0.6, unit="m", low=0.2, high=3.0, meaning="how far ahead on the route the robot aims", source="ours"
    )
    arrival_m: float = param(
        0.3,
        unit="m",
        low=0.05,
        high=2.0,
        meaning="a robot nearer to its goal than this has arrived",
        source="C III.B: a cell",
    )
    close_by_share: float = param(
        2.0,
        low=1.0,
        high=10.0,
        meaning="within so many arrival distances is close by: it has arrived, too, if it gets no nearer",
        source="ours",
    )
    close_by_s: float = param(
        5.0,
        unit="s",
        low=0.0,
        high=60.0,
        meaning="how long it must get no nearer to have arrived close by",
        source="ours",
    )
    nearer_m: float = param(
        0.02,
        unit="m",
        low=0.0,
        high=1.0,
        meaning="to get nearer means to get nearer by more than this",
        source="ours",
    )
    coast_s: float = param(
        8.0,
        unit="s",
        low=0.0,
        high=120.0,
        meaning="how long the robot follows a route that could not be planned anew",
        source="D 4.4; value ours",
    )
    replan_s: float = param(
        1.0, unit="s", low=0.1, high=60.0, meaning="time after which the route is planned anew", source="ours"
    )
    credited_plans: float = param(
        2.0,
        low=1.0,
        high=100.0,
        meaning="a route older than so many planning periods earns no successful trials",
        source="ours",
    )
    near_m: float = param(
        0.6, unit="m", low=0.0, high=5.0,
        meaning="a route may start at any experience this near, as if a link led there",
        source="ours",
    )  # fmt: skip
    near_speed: float = param(
        0.3, unit="m/s", low=0.01, high=2.0, meaning="speed assumed on such a link", source="ours"
    )
    near_turn_cost: float = param(
        0.3, unit="s/rad", low=0.0, high=10.0, meaning="time assumed for the turn at its end", source="ours"
    )
    lost_s: float = param(
        25.0,
        unit="s",
        low=0.0,
        high=600.0,
        meaning="a goal is called unreachable when no route is known for this long",
        source="ours",
    )
    headway_s: float = param(
        0.5, unit="s", low=0.0, high=60.0, meaning="headway means that the travel time left shrinks by more than this",
        source="ours",
    )  # fmt: skip
    trial_s: float = param(
        3.0, unit="s", low=0.1, high=60.0, meaning="no headway for this long is a failed trial of the links ahead",
        source="D 3.4; value ours",
    )  # fmt: skip
    bar_ahead_m: float = param(
        0.4, unit="m", low=0.05, high=3.0, meaning="these are the links across a bar so far ahead of the robot ...",
        source="ours",
    )  # fmt: skip
    bar_m: float = param(1.4, unit="m", low=0.1, high=10.0, meaning="... and so wide", source="ours")
    no_headway_s: float = param(
        25.0,
        unit="s",
        low=1.0,
        high=600.0,
        meaning="no headway for this long: the robot looks around ...",
        source="ours",
    )
    look_around_s: float = param(
        15.0, unit="s", low=0.0, high=600.0,
        meaning="... for this long, since what the map takes for a way may be a wall",
        source="ours",
    )  # fmt: skip
