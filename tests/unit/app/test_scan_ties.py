"""A laser ties experiences by their scans, and says whether an observation is true."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.recordings.recording import About
from app.recordings.scans import ScanRules, ScanTies
from ratslam_core import ExperienceMap, Odometry, Packet, Pose2, RatSlam, Recognition

from .made_scans import ANGLES, between_walls, room

ABOUT = About("laser", "test", 2, 1.0, frozenset({"ranges"}), beam_angles_rad=tuple(ANGLES.tolist()))
HERE, LOOK = Pose2(0.2, 0.1, 0.1), Pose2(-0.2, 0.4, -0.05)


def _made(ties: ScanTies, scan: np.ndarray) -> ExperienceMap:
    """A map of one experience, made where this was seen."""
    map_ = RatSlam().experience_map
    map_.step(Packet(9.0, 9.0, 0.0, 1.0), Recognition(0, True, -1, math.inf), Odometry(0.0, 0.0, 1.0))
    ties.see(scan)
    ties.made(map_)
    return map_


def test_a_scan_ties_an_experience_to_an_old_one_where_it_belongs() -> None:
    """Odometry is 0.3 m and 0.1 rad wrong when the robot comes back; the scan says so, and the map follows."""
    ties, map_ = ScanTies(ABOUT), RatSlam().experience_map
    path = [(0.0, 0.0, 0.0)] + [(0.1 * k, 0.0, 0.0) for k in range(1, 20)] + [(0.3, 0.0, 0.1)]
    before = path[0]
    for k, at in enumerate(path):
        way = (at[0] - before[0], at[2] - before[2])
        seen = Recognition(k, True, -1, math.inf)
        map_.step(Packet(3.0 * k % 64, 9.0, 0.0, 1.0), seen, Odometry(way[0], way[1], 1.0))
        true = (0.0, 0.0, 0.0) if k == len(path) - 1 else at
        ties.see(room(*true))
        ties.made(map_)
        before = at
    assert map_.closures > 0
    for _ in range(400):
        map_.correct()
    first, last = map_.pose(0), map_.pose(len(path) - 1)
    assert math.hypot(last.x - first.x, last.y - first.y) < 0.15


def test_a_true_observation_becomes_as_precise_as_the_scans() -> None:
    ties = ScanTies(ABOUT)
    map_ = _made(ties, room(0, 0, 0))
    ties.see(room(HERE.x, HERE.y, HERE.heading_rad))
    found = ties.verified(map_, 0, LOOK)
    assert found is not None
    assert (found[0].x, found[0].y, found[0].heading_rad) == pytest.approx((HERE.x, HERE.y, HERE.heading_rad), abs=0.03)
    assert found[1] < 0.1


def test_a_false_loop_closure_is_found_out_by_its_scan() -> None:
    """The view is said to be that of the room, but the walls are those of a corridor. The plain twin believes it."""
    ties = ScanTies(ABOUT)
    map_ = _made(ties, room(0, 0, 0))
    ties.see(between_walls(0.6))
    assert ties.verified(map_, 0, LOOK) is None
    plain = ScanTies(ABOUT, ScanRules(confirmed=False))
    assert plain.verified(_made(plain, room(0, 0, 0)), 0, LOOK) == (LOOK, math.inf)


def test_a_scan_must_fit_along_and_both_ways() -> None:
    """A bare corridor does not say where along it the robot is. A corner fits that of a room, but in the room there is more
    to be seen than a corner."""
    corner = np.where(np.abs(ANGLES - 0.5) < 0.4, room(0.1, 0.0, 0.0), np.inf)
    for rules, before, now, look, believed in (
        (ScanRules(), between_walls(0.0), between_walls(0.0), 0.4, False),
        (ScanRules(weighed=False, mutual=False), between_walls(0.0), between_walls(0.0), 0.4, True),
        (ScanRules(), room(0, 0, 0), corner, 0.0, False),
        (ScanRules(mutual=False), room(0, 0, 0), corner, 0.0, True),
    ):
        ties = ScanTies(ABOUT, rules)
        map_ = _made(ties, before)
        ties.see(now)
        assert (ties.verified(map_, 0, Pose2(look, 0.0, 0.0)) is not None) is believed, (rules, look)


class _Says:
    """A verification with one answer."""

    def __init__(self, answer: tuple[Pose2, float] | None) -> None:
        self.answer = answer

    def verified(self, _map: object, _experience: int, _observation: Pose2) -> tuple[Pose2, float] | None:
        return self.answer

    def match(self, _map: object, _experience: int, _observation: Pose2) -> None:
        """It cannot tell."""


@pytest.mark.parametrize(
    ("verification", "active", "x"),
    [
        (None, 0, 0.0),
        (_Says((Pose2(0.3, 0.0, 0.0), math.inf)), 0, 0.3),
        (_Says((Pose2(0.3, 0.0, 0.0), 1e-6)), 0, 0.3),
        (_Says(None), 2, 0.4),
    ],
    ids=["nobody", "who cannot say how precisely", "who measures", "who denies it"],
)
def test_the_map_asks_for_geometric_verification(verification: _Says | None, active: int, x: float) -> None:
    """The robot is 0.4 m from its first experience by odometry, and sees its view again, where its packet is."""
    map_, at = RatSlam().experience_map, Packet(9.0, 9.0, 0.0, 1.0)
    map_.step(at, Recognition(0, True, -1, math.inf), Odometry(0.0, 0.0, 1.0))
    map_.step(Packet(30.0, 9.0, 0.0, 1.0), Recognition(1, True, -1, math.inf), Odometry(1.0, 0.0, 1.0))
    map_.pose_filter.sigma_m = 100.0  # it knows nothing, so that an observation that it believes is all that it knows
    map_.step(at, Recognition(0, False, 0, 0.0), Odometry(-0.6, 0.0, 1.0), verification=verification)
    assert map_.active == active
    assert map_.robot.x == pytest.approx(x, abs=0.02)
