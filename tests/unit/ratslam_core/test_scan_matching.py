"""Scan matching: what the sonars say of where the robot is to a place that it recognises."""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray

from ratslam_core import Odometry, Pose2
from ratslam_core.extensions import scan_matching
from ratslam_core.extensions.scan_matching import AGREES_M, ALONG_M, CELL_M, NEAR, UNHEARD_M, ScanMatching

ANGLES = tuple(math.radians(a) for a in (90, 50, 30, 10, -10, -30, -50, -90))
ROOM = ((-2.0, -1.5), (3.0, -1.5), (3.0, 2.0), (1.0, 2.0), (1.0, 1.2), (-2.0, 1.2))  # its corners, m: an L
CORRIDOR = ((-90.0, -1.2), (90.0, -1.2), (90.0, 1.2), (-90.0, 1.2))  # no beam hears it ahead
HALL = ((-4.0, -3.4), (3.4, -3.4), (3.4, 3.0), (-4.0, 3.0))
NO_ECHO_M = 5.0

_Corners = tuple[tuple[float, float], ...]


def ranges(corners: _Corners, at: Pose2) -> NDArray[np.float64]:
    """How far it is from this pose to the walls between the corners, along each beam."""
    found = np.full(len(ANGLES), NO_ECHO_M)
    for k, angle in enumerate(ANGLES):
        c, s = math.cos(at.heading_rad + angle), math.sin(at.heading_rad + angle)
        for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
            ux, uy, dx, dy = bx - ax, by - ay, ax - at.x, ay - at.y
            across = c * uy - s * ux
            if across != 0:
                way, share = (dx * uy - dy * ux) / across, (dx * s - dy * c) / across
                if way > 0 and 0 <= share <= 1:
                    found[k] = min(found[k], way)
    return found


class _Map:
    def __init__(self, poses: NDArray[np.float64], submap_of: NDArray[np.int32]) -> None:
        self.poses, self.submap_of = poses, submap_of

    def __len__(self) -> int:
        return len(self.poses)


class Visit:
    """A robot that drove two metres along a line, making an experience each 0.2 m, and drives there once more, aside."""

    def __init__(self, corners: _Corners, *, stays: bool = False) -> None:
        self.corners, self.scans = corners, ScanMatching(ANGLES)
        self.poses = [Pose2(-1.0 + 0.2 * k, 0.0, 0.0) for k in range(10)]
        for k, pose in enumerate(self.poses):
            self.scans.sense(ranges(corners, pose), Odometry(2.0 * (k > 0), 0.0, 0.1), 1)
            self.scans.made(k)
        if not stays:
            self.scans.forget()
        poses = np.array([(p.x, p.y, p.heading_rad) for p in self.poses])
        self.map = _Map(poses, np.zeros(10, np.int32))

    def come(self, true: Pose2, corners: _Corners = ()) -> None:
        """It comes to this pose, straight ahead for two metres, perhaps in another room."""
        for k in range(11):
            pose = true.compose(Pose2(0.2 * (k - 10), 0.0, 0.0))
            self.scans.sense(ranges(corners or self.corners, pose), Odometry(2.0 * (k > 0), 0.0, 0.1), 1)

    def told(self, observation: Pose2, experience: int = 5) -> tuple[Pose2, float] | None:
        return self.scans.verified(cast(Any, self.map), experience, observation)


@pytest.mark.parametrize("off", [Pose2(0.4, -0.3, 0.0), Pose2(-0.3, 0.4, 0.1), Pose2(0.0, 0.0, -0.15)])
def test_echoes_say_where_in_a_room_the_robot_is(off: Pose2) -> None:
    visit = Visit(ROOM)
    true = Pose2(0.3, 0.25, 0.1)
    visit.come(true)
    here = visit.poses[5].inverse().compose(true)
    found = visit.told(Pose2(here.x + off.x, here.y + off.y, here.heading_rad + off.heading_rad))
    assert found is not None
    pose, sigma_m = found
    assert math.hypot(pose.x - here.x, pose.y - here.y) < 0.15
    assert abs(pose.heading_rad - here.heading_rad) < 0.08
    assert 0 < sigma_m < 0.15


def test_along_a_corridor_the_observation_decides() -> None:
    """Its walls say how far it is to either side, and nothing else."""
    visit = Visit(CORRIDOR)
    visit.come(Pose2(0.3, 0.3, 0.0))
    found = visit.told(Pose2(-0.2, -0.1, 0.0))
    assert found is not None
    pose, sigma_m = found
    assert pose.x == pytest.approx(-0.2, abs=0.05)
    assert pose.y == pytest.approx(0.3, abs=0.1)
    assert sigma_m == ALONG_M


def test_another_room_is_not_confirmed() -> None:
    visit = Visit(ROOM)
    visit.come(Pose2(0.3, 0.25, 0.1), HALL)
    assert visit.told(Pose2(0.3, 0.25, 0.1)) is None


def test_an_observation_in_a_hall_is_worth_little() -> None:
    """Where nothing was heard at all, it is taken as it is; where a robot hears no wall, views are alike for metres."""
    visit = Visit(ROOM)
    observation = Pose2(0.2, 0.1, 0.0)
    assert visit.told(observation) == (observation, math.inf), "nothing was heard since it was carried"
    nowhere = ((-900.0, -900.0), (900.0, -900.0), (900.0, 900.0), (-900.0, 900.0))
    visit.come(Pose2(0.2, 0.1, 0.0), nowhere)
    assert visit.told(observation) == (observation, UNHEARD_M), "no wall is within reach"


def test_what_was_heard_before_a_kidnap_tells_nothing_of_after() -> None:
    visit = Visit(ROOM)
    visit.come(Pose2(0.3, 0.25, 0.1), HALL)
    visit.scans.forget()
    visit.come(Pose2(0.3, 0.25, 0.1))
    found = visit.told(Pose2(0.5, 0.25, 0.1))
    assert found is not None
    assert math.hypot(found[0].x - 0.3, found[0].y - 0.25) < 0.15


def test_no_echo_is_laid_over_itself() -> None:
    """It would lie where odometry has it, whatever errors that has."""
    visit = Visit(ROOM, stays=True)
    observation = Pose2(0.6, 0.1, 0.0)
    assert visit.told(observation) == (observation, math.inf)


def test_the_way_counts_not_the_time() -> None:
    """A robot that stands, or is asked more often, remembers the same scans."""
    slow, quick = ScanMatching(ANGLES), ScanMatching(ANGLES)
    for k in range(40):
        scan = ranges(ROOM, Pose2(-1.0 + 0.05 * k, 0.0, 0.0))
        slow.sense(scan, Odometry(0.5 * (k > 0), 0.0, 0.1), 1)
        slow.sense(scan, Odometry(0.0, 0.0, 0.1), 3)
        quick.sense(scan, Odometry(0.5 * (k > 0), 0.0, 0.1), 1)
    np.testing.assert_array_equal(slow._recent, quick._recent)
    np.testing.assert_array_equal(slow._from, quick._from)


def test_distances_are_those_of_a_literal_search() -> None:
    rng = np.random.default_rng(5)
    old, new = rng.uniform(-3, 3, (60, 2)), rng.uniform(-2, 2, (40, 2))
    x, y, heading = 0.3, -0.2, 0.4
    c, s = math.cos(heading), math.sin(heading)
    seen = new @ np.array([[c, s], [-s, c]]) + (x, y)
    nearest = np.hypot(*(seen[:, None] - old[None]).transpose(2, 0, 1)).min(axis=1)
    literal = np.minimum(nearest, NEAR * CELL_M).mean()
    found = scan_matching._apart(scan_matching._picture(old), new, 1, x, y, heading)
    assert found == pytest.approx(literal, abs=CELL_M / 4), "each is that of the middle of its cell"
    assert AGREES_M < NEAR * CELL_M
