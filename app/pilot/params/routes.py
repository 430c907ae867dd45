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
    goal_place_m: float = param(
        0.2, unit="m", low=0.0, high=5.0,
        meaning="all experiences within this of the one nearest to a click stand for its place; 0 = that one only",
        source="B 3.6; value ours",
    )  # fmt: skip
    lookahead_m: float = param(
        0.6, unit="m", low=0.2, high=3.0, meaning="how far ahead on the route the robot aims", source="ours"
    )
    arrival_m: float = param(
        0.1, unit="m", low=0.02, high=2.0,
        meaning="a robot nearer to its goal than this has arrived",
        source="C III.B: a cell; value ours",
    )  # fmt: skip
    approach_m: float = param(
        1.0, unit="m", low=0.0, high=5.0,
        meaning="nearer to its goal than this, it drives straight there if the sonars find the way free; 0 = never",
        source="ours",
    )  # fmt: skip
    close_by_m: float = param(
        0.6, unit="m", low=0.0, high=5.0,
        meaning="nearer than this is close by: it has arrived, too, if it gets no nearer",
        source="ours",
    )  # fmt: skip
    close_by_s: float = param(
        6.0, unit="s", low=0.0, high=60.0,
        meaning="how long it must get no nearer to have arrived close by; at half that distance, half as long",
        source="ours",
    )  # fmt: skip
    good_enough_m: float = param(
        1.0, unit="m", low=0.0, high=5.0,
        meaning="a robot that is blocked nearer to its goal than this has arrived, as where the map has the goal in a wall",
        source="ours",
    )  # fmt: skip
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
    near_cost: float = param(
        3.0, unit="s", low=0.0, high=60.0, meaning="time added for it, since nobody has driven it", source="ours"
    )
    stay_s: float = param(
        4.0, unit="s", low=0.0, high=600.0,
        meaning="the robot leaves the route that it follows for another only if that saves more than this",
        source="ours",
    )  # fmt: skip
    near_blind_m: float = param(
        0.2, unit="m", low=0.0, high=5.0,
        meaning="the sonars must find such a link free but for so much",
        source="ours",
    )  # fmt: skip
    near_doubt_s: float = param(
        15.0, unit="s", low=0.0, high=600.0,
        meaning="and so much for each bar and failure: where the robot fails, the map may show places side by side "
        "that are not",
        source="ours",
    )  # fmt: skip
    near_growth: float = param(
        0.1, unit="m/s", low=0.0, high=5.0, meaning="while no route is known, that distance grows at this rate ...",
        source="ours",
    )  # fmt: skip
    near_most_m: float = param(2.0, unit="m", low=0.0, high=20.0, meaning="... up to this", source="ours")
    window_m: float = param(
        1.5, unit="m", low=0.1, high=100.0,
        meaning="the robot is looked for on so much of the route ahead, not where the route comes past again later",
        source="ours",
    )  # fmt: skip
    headway_m: float = param(
        0.1, unit="m", low=0.0, high=5.0,
        meaning="headway is to come nearer, by odometry, to the points headed for by more than this ...",
        source="ours",
    )  # fmt: skip
    headway_rad: float = param(
        0.3, unit="rad", low=0.01, high=3.0, meaning="... or to turn towards them by more than this", source="ours"
    )
    trial_s: float = param(
        2.0, unit="s", low=0.1, high=60.0, meaning="no headway for this long is a failed trial of the way ahead",
        source="D 3.4; value ours",
    )  # fmt: skip
    bar_ahead_m: float = param(
        0.4, unit="m", low=0.05, high=3.0, meaning="it puts a bar across the way so far ahead of the robot ...",
        source="ours",
    )  # fmt: skip
    bar_m: float = param(0.6, unit="m", low=0.1, high=10.0, meaning="... and so wide; each time it fails there again,",
        source="ours",
    )  # fmt: skip
    widest_bar_m: float = param(
        1.4, unit="m", low=0.1, high=10.0, meaning="it becomes as much wider, up to this", source="ours"
    )
    bar_fade_s: float = param(
        45.0, unit="s", low=0.0, high=1e5,
        meaning="time in which a bar fades, doubled each time the robot fails there again; "
        "0 = bars stay, and links across them are deleted in the end",
        source="ours; 0: D 3.4",
    )  # fmt: skip
    longest_bar_s: float = param(
        90.0, unit="s", low=1.0, high=1e6, meaning="longest time in which a bar fades", source="ours"
    )
    bar_delay_s: float = param(
        30.0, unit="s", low=0.0, high=1e5,
        meaning="a new bar delays each way across it by this, times how often the robot failed there",
        source="ours",
    )  # fmt: skip
    place_m: float = param(
        1.0, unit="m", low=0.1, high=20.0, meaning="a robot that stays within this ...", source="ours"
    )
    no_headway_s: float = param(
        25.0,
        unit="s",
        low=1.0,
        high=600.0,
        meaning="... for this long looks around ...",
        source="ours",
    )
    look_around_s: float = param(
        15.0, unit="s", low=0.0, high=600.0,
        meaning="... for this long, since what the map takes for a way may be a wall",
        source="ours",
    )  # fmt: skip
    gap_m: float = param(
        0.8, unit="m", low=0.0, high=3.0,
        meaning="if less than this is free towards the next point, the robot heads for the freest direction beside it; "
        "0 = straight on",
        source="ours",
    )  # fmt: skip
    gap_rad: float = param(
        1.4, unit="rad", low=0.1, high=3.0, meaning="how far beside it such a direction may lie", source="ours"
    )
    gap_steps: int = param(8, low=1, high=90, meaning="so many directions are tried to each side", source="ours")
    gap_cost: float = param(
        0.3, unit="m/rad", low=0.0, high=10.0, meaning="free way that a turn from the point's direction is worth",
        source="ours",
    )  # fmt: skip
