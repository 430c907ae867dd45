"""Which experience fits best: the two energies, with and without the scene, against loops over all of them."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import ExperienceMap, ExperienceMapParams, Odometry, Packet, Pose2, Recognition
from ratslam_core.pose_graph import experiences
from ratslam_core.pose_graph.experiences import Experiences

from .literal import also_interpreted

SHAPES = [(36, 64, 64), (36, 8, 8), (10, 9, 21)]
STILL = Odometry(0.0, 0.0, 0.1)
START = Pose2(0.0, 0.0, 0.0)
BLIND_M = 1.0


def literal_energy(known: Experiences, i: int, packet: Packet, view: int, p: ExperienceMapParams) -> float:
    """D1-D4, trying every way round the torus."""
    n_theta, n_y, n_x = known.shape
    x, y, theta = known.at[i]
    layer = packet.heading_rad * n_theta / (2 * math.pi)
    r = min(
        math.hypot(packet.x - x + a, packet.y - y + b)
        for a in (-2 * n_x, -n_x, 0, n_x, 2 * n_x) for b in (-2 * n_y, -n_y, 0, n_y, 2 * n_y)
    ) / p.zone_xy  # fmt: skip
    q = min(abs(layer - theta + c) for c in (-2 * n_theta, -n_theta, 0, n_theta)) / p.zone_theta
    switch = not p.match_view or view == known.view[i]
    return 0.0 if r > 1 or q > 1 or not switch else 2 - r - q


cells = st.one_of(st.floats(0, 63.99), st.sampled_from([0.0, 0.5, 7.9, 62.0, 63.9]))
headings = st.one_of(st.floats(-3.14, math.pi), st.sampled_from([math.pi, -3.1, 0.0, -1e-17]))
states = st.tuples(cells, cells, headings, st.integers(-1, 3))
params = st.builds(
    ExperienceMapParams,
    match_view=st.booleans(),
    zone_xy=st.one_of(st.just(2.0), st.floats(0.5, 20.0)),
    zone_theta=st.one_of(st.just(2.0), st.floats(0.5, 20.0)),
    threshold=st.one_of(st.just(0.0), st.floats(0.0, 2.0)),
)


@also_interpreted(experiences)
@settings(max_examples=300)
@given(st.sampled_from(SHAPES), params, states, states)
@pytest.mark.slow
def test_energy_is_that_of_the_papers(shape, p: ExperienceMapParams, made, now) -> None:
    known = Experiences(shape)
    known.add(Packet(*made[:3], 1.0), made[3], START)
    packet = Packet(now[0] % shape[2], now[1] % shape[1], now[2], 1.0)
    expected = literal_energy(known, 0, packet, now[3], p)
    assert known.energy(0, packet, now[3], p) == pytest.approx(expected, abs=1e-9)


@also_interpreted(experiences)
@settings(max_examples=300)
@given(st.sampled_from(SHAPES), params, st.lists(states, max_size=40), states)
@pytest.mark.slow
def test_the_choice_is_that_of_a_loop_over_all(shape, p: ExperienceMapParams, made, now) -> None:
    """The oldest of those with the most energy."""
    known = Experiences(shape)
    for x, y, heading, view in made:
        known.add(Packet(x, y, heading, 1.0), view, Pose2(x / 4, y / 4, heading))
    robot = Pose2(3.0, 3.0, 0.0)
    packet, view = Packet(now[0] % shape[2], now[1] % shape[1], now[2], 1.0), now[3]
    best, most = -1, p.threshold
    for i in range(len(made)):
        far = math.hypot(known.pose[i, 0] - robot.x, known.pose[i, 1] - robot.y) > BLIND_M
        energy = known.energy(i, packet, view, p)
        if energy > most and not (p.match_view and view < 0 and far):
            best, most = i, energy
    assert known.most_energetic(packet, view, p, robot, BLIND_M) == best


def test_outside_its_zone_in_any_variable_an_experience_is_not_there() -> None:
    """The right place with a wrong heading does not count, nor the other way round; without the scene the same cells do."""
    turned, beside = (Packet(20.0, 20.0, 2.0, 1.0), 0), (Packet(26.0, 20.0, 0.0, 1.0), 0)
    other = Packet(20.0, 20.0, 0.0, 1.0), 5
    for (packet, view), params, energy in (
        (turned, ExperienceMapParams(), 0.0),
        (beside, ExperienceMapParams(), 0.0),
        (other, ExperienceMapParams(match_view=False), 2.0),
        (other, ExperienceMapParams(match_view=True), 0.0),
    ):
        made = ExperienceMap((36, 64, 64), 0.25, params)
        made.step(Packet(20.0, 20.0, 0.0, 1.0), Recognition(0, True, -1, math.inf), STILL)
        assert made.energy(0, packet, view) == pytest.approx(energy)
        assert made.step(packet, Recognition(view, view > 0, 0, 0.0), STILL) is (energy == 0.0)


@also_interpreted(experiences)
def test_limits_are_reached_just_as_they_are() -> None:
    """The edge of a zone belongs to it, energy has to be above the threshold, the oldest of equals is taken, and nothing to
    see is known again as near as `blind_m`."""
    known, here = Experiences((36, 64, 64)), Packet(20.0, 20.0, 0.0, 1.0)
    for _ in range(3):
        known.add(here, 0, START)
    known.add(here, -1, Pose2(3.0, 1.0, 0.0))
    zones = ExperienceMapParams(zone_xy=2.0, zone_theta=9.0)
    for beside in (replace(here, x=22.0), replace(here, y=18.0), replace(here, heading_rad=math.pi / 2)):  # nine layers
        assert known.energy(0, beside, 0, zones) == 1.0
    assert known.energy(0, replace(here, heading_rad=math.pi / 2 + 1e-6), 0, zones) == 0.0
    for match_view, (threshold, found) in product(
        (True, False), ((1.5, -1), (1.4375, 0))
    ):  # 1.5 at a cell from the middle
        p = replace(zones, match_view=match_view, threshold=threshold)
        assert known.most_energetic(replace(here, x=21.0), 0, p, START, BLIND_M) == found
    for apart_m, found in ((2.0, 3), (2.001, -1)):
        for robot in (Pose2(3.0 + apart_m, 1.0, 0.0), Pose2(3.0, 1.0 - apart_m, 0.0)):
            assert known.most_energetic(here, -1, ExperienceMapParams(), robot, 2.0) == found


@pytest.mark.slow
def test_thousands_of_experiences_are_each_found() -> None:
    known = Experiences((36, 64, 64))
    for k in range(3000):
        known.add(Packet(k % 64, k // 64, 0.0, 1.0), k % 7, START)
    for match_view, k in product((True, False), (0, 1, 1023, 1024, 2999)):
        p = ExperienceMapParams(match_view=match_view)
        assert known.most_energetic(Packet(k % 64, k // 64, 0.0, 1.0), k % 7, p, START, BLIND_M) == k


@given(st.lists(st.tuples(st.booleans(), st.integers(-1, 4)), max_size=60))
def test_a_view_that_is_no_more_leaves_blind_experiences(steps: list[tuple[bool, int]]) -> None:
    """Experiences are added, and views forgotten, in any order: nothing else changes."""
    known, expected = Experiences((36, 64, 64)), list[int]()
    for forget, view in steps:
        if forget and view >= 0:
            known.forget_view(view)
            expected = [-1 if one == view else one for one in expected]
        else:
            known.add(Packet(3.0, 4.0, 0.1, 1.0), view, START)
            expected.append(view)
        assert known.view[: known.count].tolist() == expected
