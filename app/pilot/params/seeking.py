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
        45.0, unit="s", low=0.0, high=1e5, meaning="time of wandering between two trips", source="ours"
    )
    openings_every: int = param(
        2, low=1, high=1000, meaning="of so many trips one goes into an opening, the others to places long not visited",
        source="ours",
    )  # fmt: skip
    trip_most_s: float = param(
        150.0, unit="s", low=1.0, high=1e4, meaning="a trip is given up after this time", source="ours"
    )
    return_after_m: float = param(
        25.0, unit="m", low=1.0, high=1e5,
        meaning="after so long a way on new ground the robot goes back to old ground",
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
    thin_m: float = param(
        0.9, unit="m", low=0.1, high=10.0, meaning="the map is thin where no experience is about this near",
        source="ours",
    )  # fmt: skip
    into_s: float = param(
        15.0, unit="s", low=0.0, high=600.0, meaning="driving into an opening ends after this time at the latest",
        source="ours",
    )  # fmt: skip
    into_reach_m: float = param(
        0.4, unit="m", low=0.05, high=5.0, meaning="... or this near to its place ...", source="ours"
    )
    into_free_m: float = param(
        0.2, unit="m", low=0.0, high=5.0, meaning="... or when less than this is free towards it", source="ours"
    )
