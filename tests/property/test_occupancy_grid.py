"""The sonar beam against a literal loop of its equations over every cell, on tori of any size."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import MapGrid, OccupancyGrid, Packet, Pose2
from ratslam_core.occupancy_grid import BOUND, DEPTH_M, FARTHEST_M, FREE, HALF_BEAM_RAD, OCCUPIED

CELL_M = 0.25


def literal_scan(log_odds: np.ndarray, packet: Packet, angles: list[float], ranges: list[float]) -> None:
    """p = (1 - free E) / 2 before the echo, (1 + occupied O) / 2 at it; l <- clip(l + log p / (1 - p)), beam by beam."""
    n_y, n_x = log_odds.shape
    reach = math.ceil((FARTHEST_M + DEPTH_M) / CELL_M) + 2
    eps = DEPTH_M + CELL_M / 2
    for angle, range_m in zip(angles, ranges, strict=True):
        R, echo = min(range_m, FARTHEST_M), range_m < FARTHEST_M
        for row in range(math.floor(packet.y) - reach, math.ceil(packet.y) + reach + 1):
            for column in range(math.floor(packet.x) - reach, math.ceil(packet.x) + reach + 1):
                dx, dy = (column - packet.x) * CELL_M, (row - packet.y) * CELL_M
                d = math.hypot(dx, dy)
                width = HALF_BEAM_RAD + math.asin(min(1.0, CELL_M / 2 / max(d, 1e-9)))
                theta = math.remainder(math.atan2(dy, dx) - packet.heading_rad - angle, 2 * math.pi) if d > 0 else 0.0
                side = max(0.0, 1 - (theta / width) ** 2)
                before = R - eps
                if d < before:
                    probability = 0.5 * (1 - FREE * (1 - (d / before) ** 2) * side)
                elif echo and abs(d - R) < eps:
                    probability = 0.5 * (1 + OCCUPIED * (1 - ((d - R) / eps) ** 2) * side)
                else:
                    continue
                at = row % n_y, column % n_x
                odds = log_odds[at] + math.log(probability / (1 - probability))
                log_odds[at] = min(max(odds, -BOUND), BOUND)


number = st.integers(0, 1000).map(lambda k: k / 1000)  # the model's only step is exactly in the middle of a cell


@settings(max_examples=60)
@given(
    st.integers(1, 30),
    st.integers(1, 30),
    st.lists(st.tuples(number, number, st.floats(-7.0, 7.0), st.floats(0.0, 6.0), st.floats(0.0, 6.0)), max_size=8),
)
def test_the_beam_is_its_equations(n_y: int, n_x: int, looks: list[tuple[float, ...]]) -> None:
    angles = [0.4, -1.5]
    grid, slow = OccupancyGrid((36, n_y, n_x), CELL_M, angles), np.zeros((n_y, n_x))
    for x, y, heading, *ranges in looks:
        packet = Packet(x * n_x, y * n_y, heading, 1.0)
        grid.update(packet, np.array(ranges))
        literal_scan(slow, packet, angles, ranges)
    assert np.abs(grid.log_odds - slow).max() < 1e-4
    assert np.abs(grid.log_odds).max() <= BOUND
    assert np.abs(grid.probability - 1 / (1 + np.exp(-slow))).max() < 1e-4


off_centre = st.integers(-3000, 3000).map(lambda k: k / 1000 + 0.0003)  # never exactly the middle of a cell, see above
pose = st.builds(Pose2, off_centre, off_centre, st.floats(-3, 3))


@settings(max_examples=60)
@given(pose, pose, st.lists(pose, min_size=1, max_size=5))
def test_moving_the_map_by_whole_cells_moves_the_picture(experience: Pose2, other: Pose2, seen: list[Pose2]) -> None:
    grid = MapGrid([0.5, -0.5])
    for k, local in enumerate(seen):
        grid.add(k % 2, local, np.array([1.0 + 0.3 * k, 2.0]))
    poses = np.array([[e.x, e.y, e.heading_rad] for e in (experience, other)])
    first, moved = grid.draw(poses), grid.draw(poses + np.array([4.0, -2.5, 0.0]))
    x, y = first.origin_xy_m
    dx, dy = (round((b - a) / CELL_M) for a, b in zip((x + 4.0, y - 2.5), moved.origin_xy_m, strict=True))
    assert abs(dx) <= 1  # rounding may move the edge, where nothing is known, into the next cell
    assert abs(dy) <= 1
    assert (first.probability > 0.5).any()
    known = np.sort(first.probability[first.probability != 0.5]), np.sort(moved.probability[moved.probability != 0.5])
    assert abs(len(known[0]) - len(known[1])) <= 2
    assert abs(float((known[0] - 0.5).sum() - (known[1] - 0.5).sum())) < 1e-2
