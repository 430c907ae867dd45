"""When the robot leaves off wandering and where it goes then."""

from __future__ import annotations

from dataclasses import dataclass

from ratslam_core.params.parameter import param


@dataclass(frozen=True)
class SeekingParams:
    """Without `seek`, the robot only follows walls, looks back and crosses at random."""

    seek: bool = param(
        True, meaning="the robot seeks where its map is thin and goes back to old ground; off = it only wanders",
        source="ours; off: C IV.D",
    )  # fmt: skip
    seek_after_s: float = param(
        45.0,
        unit="s",
        low=0.0,
        high=1e5,
        meaning="time of wandering between two trips, unless there is more to see far off",
        source="ours",
    )
    openings_every: int = param(
        2, low=1, high=1000, meaning="of so many trips one goes into an opening, the others to places long not visited",
        source="ours",
    )  # fmt: skip
    small_map_s: float = param(
        60.0, unit="s", low=0.0, high=1e6,
        meaning="... but every trip does while the robot can reach all that it knows within this time", source="ours",
    )  # fmt: skip
    search: bool = param(
        True, meaning="on an island, as after a kidnap, it only goes on to new ground, so that it meets the rest of its map",
        source="ours",
    )  # fmt: skip
    search_share: float = param(
        0.1, low=0.0, high=1.0, meaning="... while there is another island, no smaller than this share of its own",
        source="ours",
    )  # fmt: skip
    search_home: float = param(
        2.0, low=0.0, high=100.0,
        meaning="... a metre between an opening and where its island began counts as so many metres of the way there ...",
        source="ours",
    )  # fmt: skip
    search_beams: int = param(
        1, low=1, high=100, meaning="... where so many beams must have seen an opening", source="ours"
    )
    trip_most_s: float = param(
        150.0, unit="s", low=1.0, high=1e4, meaning="a trip is given up after this time", source="ours"
    )
    return_after_m: float = param(
        25.0, unit="m", low=1.0, high=1e5,
        meaning="after so long a way on new ground the robot goes back to old ground; twice as long each time it came back",
        source="ours",
    )  # fmt: skip
    old_after_s: float = param(
        60.0, unit="s", low=1.0, high=1e5, meaning="an experience is old ground when it was made so long ago",
        source="ours",
    )  # fmt: skip
    long_ago_s: float = param(
        120.0, unit="s", low=0.0, high=1e6, meaning="places visited more lately than this are not sought again",
        source="ours",
    )  # fmt: skip
    place_reach_m: float = param(
        1.5, unit="m", low=0.1, high=20.0, meaning="a visit to a place counts for all experiences this near",
        source="ours",
    )  # fmt: skip
    opening_m: float = param(
        2.0, unit="m", low=0.5, high=10.0, meaning="sonars that see as far as this see open floor", source="ours"
    )
    opening_gap_m: float = param(
        0.7, unit="m", low=0.0, high=5.0, meaning="its place is so much before the echo ...", source="ours"
    )
    opening_most_m: float = param(
        2.5, unit="m", low=0.1, high=10.0, meaning="... and at most so far away", source="ours"
    )
    opening_beams: int = param(3, low=1, high=100, meaning="so many beams must have seen an opening", source="ours")
    opening_again_s: float = param(
        120.0, unit="s", low=0.0, high=1e6,
        meaning="an opening that has been tried is tried again after this time, after twice as long the next time",
        source="ours",
    )  # fmt: skip
    thin_m: float = param(
        0.8, unit="m", low=0.1, high=10.0, meaning="the map is thin where no experience is about this near",
        source="ours",
    )  # fmt: skip
    far_openings: bool = param(False, meaning="far openings are sought first, one after the other", source="ours")
    far_m: float = param(
        2.8, unit="m", low=0.5, high=20.0, meaning="an opening is far when it is so far from all experiences",
        source="ours",
    )  # fmt: skip
    far_fine: int = param(
        4,
        low=1,
        high=100,
        meaning="what is near an experience is marked in cells of this part of that distance",
        source="ours",
    )
    home_share: float = param(
        0.5, low=0.0, high=10.0,
        meaning="a metre that such an opening is away from where the map began counts as so much of a metre of the way there",
        source="ours",
    )  # fmt: skip
    return_sigma_m: float = param(
        3.0, unit="m", low=0.01, high=1e3,
        meaning="it also goes back when odometry may be wrong by this since it left old ground",
        source="ours",
    )  # fmt: skip
    loop_m: float = param(
        30.0, unit="m", low=1.0, high=1e5,
        meaning="known ground that is at least this far by the links closes a loop if it is near ...", source="ours",
    )  # fmt: skip
    loop_share: float = param(
        0.0, low=0.0, high=1.0, meaning="... that is, nearer than this share of the way by the links ...", source="ours"
    )
    loop_most_m: float = param(
        150.0, unit="m", low=1.0, high=1e5, meaning="... of which no more counts than this", source="ours"
    )
    loop_drive_m: float = param(
        25.0,
        unit="m",
        low=0.5,
        high=100.0,
        meaning="... and followed for this far, so that it is recognised",
        source="ours",
    )
    loop_again_s: float = param(
        300.0,
        unit="s",
        low=0.0,
        high=1e6,
        meaning="from the same place it is tried again after this time",
        source="ours",
    )
    far_look_back_m: float = param(
        20.0, unit="m", low=1.0, high=1000.0,
        meaning="on a trip into far openings: distance driven before it turns back to look; each turn costs heading",
        source="ours",
    )  # fmt: skip
    middle_m: float = param(
        0.5, unit="m", low=0.0, high=5.0,
        meaning="on such trips the robot keeps to the middle between left and right, steering aside by at most this ...",
        source="ours",
    )  # fmt: skip
    middle_ahead_m: float = param(
        1.5, unit="m", low=0.1, high=10.0, meaning="... at a point so far ahead", source="ours"
    )
    into_s: float = param(
        25.0, unit="s", low=0.0, high=600.0, meaning="driving into an opening ends after this time at the latest",
        source="ours",
    )  # fmt: skip
    into_reach_m: float = param(
        0.4, unit="m", low=0.05, high=5.0, meaning="... or this near to its place ...", source="ours"
    )
    into_free_m: float = param(
        0.2, unit="m", low=0.0, high=5.0, meaning="... or when less than this is free towards it", source="ours"
    )
