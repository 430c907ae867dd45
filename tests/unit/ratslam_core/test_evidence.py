"""Where a robot that was carried is, by the evidence; and a submap, which is merged as a whole when it is strong enough."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from ratslam_core import ExperienceMap, ExperienceMapParams, Odometry, Packet, Pose2, Recognition
from ratslam_core.experience_map import experience_map
from ratslam_core.extensions import evidence as law
from ratslam_core.extensions.evidence import AGAINST, FOR, LIKENESS, NATS, PRIOR, Evidence, nats
from ratslam_core.extensions.submaps import Merge, Submaps, move
from ratslam_core.params import EvidenceParams
from ratslam_core.parts import Matched
from ratslam_core.pose_graph.transitions import Transitions

from .drives import CELL_M, SHAPE, relative

COLUMN_RAD = math.radians(50) / 12
DRIVE = Odometry(0.3, 0.0, 0.1)
poses = st.builds(Pose2, st.floats(-9, 9), st.floats(-9, 9), st.floats(-3, 3))


@dataclass
class Views:
    """A local view that sees the robot's true place: views taken near it are a third as unlike as others are."""

    taken: list[Pose2]
    robot: Pose2 = field(default_factory=lambda: Pose2(0.0, 0.0, 0.0))
    twin: Pose2 | None = None  # a place that looks the same as where the robot is
    column_rad: float = COLUMN_RAD

    def apart_at(self, views: np.ndarray, shifts: np.ndarray, slack: int) -> tuple[np.ndarray, np.ndarray]:
        apart, by = 10.0 + views % 7 / 7, shifts.copy()
        for k, view in enumerate(views):
            for place in (self.robot, *([self.twin] if self.twin is not None else [])):
                seen = self.taken[view].inverse().compose(place)
                shift = round(seen.heading_rad / COLUMN_RAD)
                if (
                    math.hypot(seen.x, seen.y) <= 0.5
                    and abs(seen.heading_rad) <= 0.3
                    and abs(shift - shifts[k]) <= slack
                ):
                    apart[k], by[k] = 3.0 + 2.0 * math.hypot(seen.x, seen.y), shift
        return apart, by

    def difference_to(self, view: int) -> float:
        return float(self.apart_at(np.array([view]), np.zeros(1, np.int64), 6)[0][0])

    @property
    def recognition(self) -> Recognition:
        return Recognition(-1, False, -1, math.inf)


@dataclass
class Known:
    """A map of a corridor along x: a view each 0.4 m, facing along it."""

    count: int = 30
    robot_here: Pose2 = Pose2(0.0, 0.0, 0.0)
    prior: float = PRIOR
    log_prior_of_new: float = -EvidenceParams().unnoticed
    cell_m: float = CELL_M

    def __post_init__(self) -> None:
        self.poses = np.array([[0.4 * k, 0.0, 0.0] for k in range(self.count)])
        self.views, self.submap_of = np.arange(self.count), np.zeros(self.count, np.int32)
        self.taken = [Pose2(*row) for row in self.poses.tolist()]

    def log_prior(self, _experience: int, _pose: Pose2) -> float:
        return self.prior


def carried(known: Known, expected: Pose2 | None = None) -> Evidence:
    evidence = Evidence(EvidenceParams(), CELL_M)
    evidence.begin(expected or Pose2(50.0, 50.0, 0.0), 0, known.count)
    return evidence


def drive(evidence: Evidence, known: Known, views: Views, ticks: int, odometry: Odometry = DRIVE) -> None:
    """The robot sees after each tick."""
    for _ in range(ticks):
        turn = odometry.yaw_rate * odometry.dt
        way = odometry.speed * odometry.dt
        moved = Pose2(way * math.cos(turn / 2), way * math.sin(turn / 2), turn)
        views.robot = views.robot.compose(moved)
        views.twin = None if views.twin is None else views.twin.compose(moved)
        evidence.move(odometry)
        evidence.observe(known, views, 0 if evidence.in_doubt else 1)


def test_the_less_alike_the_less_it_says_and_never_too_much() -> None:
    for ring in range(len(NATS)):
        said = [nats(likeness, ring) for likeness in np.linspace(0, 3, 200)]
        assert np.all(np.diff(said) <= 0)
        assert AGAINST <= min(said) < 0 < max(said) <= FOR
        assert nats(float(LIKENESS[3]), ring) == pytest.approx(NATS[ring][3])


@given(st.lists(st.tuples(st.floats(-1, 1), st.floats(-2, 2), st.floats(0.01, 0.5)), max_size=20), poses)
def test_hypotheses_move_by_odometry(ticks: list[tuple[float, float, float]], start: Pose2) -> None:
    evidence = carried(Known(), start)
    pose = start
    for speed, yaw_rate, dt in ticks:
        evidence.move(Odometry(speed, yaw_rate, dt))
        turn = yaw_rate * dt
        pose = pose.compose(Pose2(speed * dt * math.cos(turn / 2), speed * dt * math.sin(turn / 2), turn))
    x, y, heading = evidence.hypotheses[0, :3]
    assert (x, y) == pytest.approx((pose.x, pose.y), abs=1e-9)
    assert math.remainder(heading - pose.heading_rad, math.tau) == pytest.approx(0.0, abs=1e-9)


def test_it_believes_where_it_is_and_is_surer_with_every_metre() -> None:
    known = Known()
    evidence, views = carried(known), Views(known.taken, Pose2(2.0, 0.1, 0.05))
    drive(evidence, known, views, 4)
    assert evidence.belief is None  # one observation, however good
    drive(evidence, known, views, 30)
    believed = evidence.belief
    assert believed is not None
    assert math.hypot(believed.pose.x - views.robot.x, believed.pose.y - views.robot.y) < 0.4
    assert abs(believed.pose.heading_rad - views.robot.heading_rad) < 0.15
    odds = believed.log_odds
    drive(evidence, known, views, 50)
    assert evidence.belief is not None
    assert evidence.belief.log_odds > max(odds, evidence.params.merge)


def test_who_stands_still_sees_one_thing() -> None:
    known = Known()
    evidence, views = carried(known), Views(known.taken, Pose2(2.0, 0.0, 0.0))
    drive(evidence, known, views, 1)
    before = evidence.hypotheses[:, law.ODDS].copy()
    drive(evidence, known, views, 100, Odometry(0.0, 0.0, 0.1))
    assert evidence.hypotheses[: len(before), law.ODDS] == pytest.approx(before)
    assert evidence.belief is None


@settings(max_examples=10, deadline=None)
@given(st.floats(-0.4, 0.4))
def test_on_new_ground_it_believes_nothing(yaw_rate: float) -> None:
    known = Known()
    evidence, views = carried(known), Views(known.taken, Pose2(0.0, 40.0, 1.0))
    for _ in range(20):
        drive(evidence, known, views, 5, Odometry(0.3, yaw_rate, 0.1))
        assert evidence.belief is None


def test_of_two_places_that_look_the_same_neither_is_believed() -> None:
    """In a twin corridor the same can be seen, metre by metre."""
    known = Known(60)
    evidence = carried(known)
    views = Views(known.taken, Pose2(2.0, 0.0, 0.0), Pose2(14.0, 0.0, 0.0))
    for _ in range(12):
        drive(evidence, known, views, 5)
        assert evidence.belief is None
    odds = np.sort(evidence.hypotheses[:, law.ODDS])[-2:]
    assert odds[0] == pytest.approx(odds[1], abs=0.5)


def two_passes(apart_m: float) -> Known:
    """A corridor that was driven twice, as the map has it while nothing has closed that loop."""
    known = Known()
    passes = np.concatenate([known.poses, known.poses + np.array([0.0, apart_m, 0.0])])
    known.poses, known.taken, known.count = passes, 2 * known.taken, len(passes)
    known.views, known.submap_of = np.arange(known.count), np.zeros(known.count, np.int32)
    return known


@pytest.mark.parametrize(("apart_m", "believed"), [(0.8, True), (3.0, False)])
def test_two_passes_side_by_side_are_no_rivals(apart_m: float, believed: bool) -> None:
    known = two_passes(apart_m)
    evidence = carried(known)
    drive(evidence, known, Views(known.taken, Pose2(2.0, 0.0, 0.0)), 60)
    assert (evidence.belief is not None) == believed


@pytest.mark.parametrize(("prior", "closed"), [(-2.0, True), (-EvidenceParams().unnoticed, False)])
def test_what_is_seen_here_too_says_nothing_against_the_pass_beside_it(prior: float, closed: bool) -> None:
    """If odometry can have drifted from one to the other; else here is here, and there a twin."""
    known = two_passes(2.0)
    evidence, views = in_doubt(known, prior), Views(known.taken, Pose2(2.0, 0.0, 0.0))
    known.robot_here = Pose2(2.0, 2.0, 0.0)
    for _ in range(80):
        drive(evidence, known, views, 1)
        known.robot_here = known.robot_here.compose(Pose2(0.03, 0.0, 0.0))
    assert evidence.here > 1.0
    assert (evidence.belief is not None and evidence.belief.log_odds >= evidence.params.merge) == closed


def test_the_likeliest_of_those_that_meet_stays_and_what_was_gathered_fades_with_the_way() -> None:
    rows = np.zeros((law.MOST, 7))
    rows[:4, :4] = [[0, 0, 0, 1.0], [0.2, 0, 0.1, 3.0], [5, 0, 0, 2.0], [9, 9, 0, law.FORGOTTEN - 1]]
    assert law._merge(rows, 4, law.FORGOTTEN, CELL_M) == 2
    assert rows[:2, law.ODDS].tolist() == [3.0, 2.0]
    rows[:2, law.SUBMAP] = [0, 1]
    rows[1, :3] = rows[0, :3]
    assert law._merge(rows, 2, law.FORGOTTEN, CELL_M) == 2  # on two submaps, the same numbers are two places
    rows[:2, law.ODDS] = 4.0, -3.0  # no doubt fades
    law._weigh(rows[:2], np.full(2, -1), np.full(2, np.inf), 0.5)
    assert rows[:2, law.ODDS].tolist() == pytest.approx([4.0 * (1 - 0.5 * law.LEAK), -3.0])


# ---------------------------------------------------------------- submaps


@given(poses, poses, st.lists(poses, min_size=1, max_size=6))
def test_what_is_moved_keeps_its_shape(robot: Pose2, claimed: Pose2, made: list[Pose2]) -> None:
    rows = np.array([[p.x, p.y, p.heading_rad] for p in [*made, robot]])
    before = rows.copy()
    move(np.arange(len(made) + 1), rows, robot, claimed)
    assert rows[-1, :2] == pytest.approx([claimed.x, claimed.y], abs=1e-9)
    for k in range(len(made)):
        was, now = relative(before[-1], before[k]), relative(rows[-1], rows[k])
        assert (now.x, now.y) == pytest.approx((was.x, was.y), abs=1e-9)


def test_the_younger_submap_becomes_part_of_the_older() -> None:
    for at, other, moved in ((2, 1, [1.0, 2.0]), (1, 2, [-1.0, -2.0])):
        submaps, of, rows = Submaps(), np.array([0, 0, 1, 2, 2], np.int32), np.zeros((5, 3))
        for _ in range(2):
            submaps.begin()
        submaps.current = at
        submaps.merge(other, of, rows, Pose2(0.0, 0.0, 0.0), Pose2(1.0, 2.0, 0.0), 7.0)
        assert of.tolist() == [0, 0, 1, 1, 1]
        assert rows[:, :2].tolist() == [[0.0, 0.0]] * 3 + [moved] * 2
        assert (submaps.current, submaps.begun, submaps.merged) == (1, 2, 1)


class Robot:
    """Maps a corridor, is carried, and drives on. Its packet is where odometry has it, and each of its views is new at first."""

    def __init__(self, ticks: int = 400, *, recognises: bool = False, **params: Any) -> None:
        """It has driven so many ticks; recognises: from now on, views that it took before."""
        known = ExperienceMapParams(odometry_drift=0.03, sweeps=0, solve_every=0, **params)
        self.map = ExperienceMap(SHAPE, CELL_M, known)
        self.pose = Pose2(0.0, 0.0, 0.0)
        self.views = Views([])
        self.confirmed = True
        self.echoes: dict[int, Matched] = {}
        self.recognises = False
        self.drive(ticks)
        self.recognises = recognises

    def drive(self, ticks: int) -> None:
        for tick in range(ticks):
            self.pose = self.pose.compose(Pose2(0.03, 0.0, 0.0))
            self.views.robot = self.pose
            alike = [view for view in range(len(self.views.taken)) if self.views.difference_to(view) < 5]
            known = self.recognises and bool(alike)
            new = tick % 13 == 0 and not known
            if new:
                self.views.taken.append(self.pose)
            view = alike[0] if known else len(self.views.taken) - 1
            packet = Packet(32 + 4 * self.pose.x % 64, 32 + self.pose.y % 64, self.pose.heading_rad, 1.0)
            self.step(packet, Recognition(view, new, view, 1.0, 0.0))

    def see_aliased(self, view: int) -> None:
        """Perceptual aliasing: see a view where the pose cells were when it was taken."""
        self.step(Packet(*self.map.cell_state(view)[:3], 1.0), Recognition(view, False, view, 1.0, 0.0))

    def step(self, packet: Packet, seen: Recognition) -> None:
        self.map.step(packet, seen, DRIVE, views=self.views, verification=self)  # type: ignore[arg-type]

    def verified(self, _map: object, _experience: int, observation: Pose2) -> tuple[Pose2, float] | None:
        return (observation, math.inf) if self.confirmed else None

    def match(self, _map: object, experience: int, _observation: Pose2) -> Matched | None:
        """What its sonars say of a place where it may be."""
        return self.echoes.get(experience)

    def carry(self, to: Pose2, *, noticed: bool = True) -> None:
        if noticed:
            self.map.declare_kidnapped()
        self.pose = to

    @property
    def off_m(self) -> float:
        """How far from the truth it believes to be, on the map."""
        return math.hypot(self.map.robot.x - self.pose.x, self.map.robot.y - self.pose.y)


def test_echoes_say_which_of_two_places_it_is_and_where() -> None:
    """They raise the odds of one, lower those of the other, and say nothing of a third; who agrees moves to where they agree."""
    robot = Robot()
    map_, evidence = robot.map, robot.map.evidence
    robot.carry(Pose2(2.0, 0.1, 0.0))
    at = [map_.pose(k) for k in (3, 12, 20)]
    evidence._rows[:3] = [(p.x + 0.1, p.y, p.heading_rad, 1.0, 2.0, map_.submap_of[0], 1.5) for p in at]
    evidence._count = 3
    robot.echoes = {
        3: Matched(Pose2(0.15, -0.05, 0.02), 0.05, 0.06, 99),
        12: Matched(Pose2(0.0, 0.0, 0.0), 0.5, 0.3, 99),
    }
    evidence._unheard = 1.0  # unit of way
    evidence._hear(map_, robot)
    rows = evidence.hypotheses
    assert rows[0, 3] == 1.5, "no more than can be said for any place"
    assert rows[1, 3] < 0.0
    assert rows[2].tolist() == [at[2].x + 0.1, at[2].y, at[2].heading_rad, 1.0, 2.0, map_.submap_of[0], 1.5]
    assert rows[0, :3] == pytest.approx((at[0].x + 0.15, at[0].y - 0.05, at[0].heading_rad + 0.02))
    assert rows[1, :2] == pytest.approx((at[1].x + 0.1, at[1].y)), "which is off by too much to say where"


def test_what_is_believed_changes_no_map_and_a_submap_is_merged_as_a_whole() -> None:
    robot = Robot()
    map_, known = robot.map, len(robot.map)
    before = map_.poses.copy()
    robot.carry(Pose2(2.0, 0.1, 0.0))
    assert map_.lost
    believed = 0
    while map_.submaps.merged == 0:
        robot.drive(1)
        assert np.array_equal(map_.poses[:known], before)
        if map_.belief is not None:
            believed += 1
            assert not map_.lost
            assert map_.active < known <= map_.here  # it acts on the map, and learns beside it
            assert robot.off_m < 0.5
            assert not any(min(ends) < known <= max(ends) for ends in map_.transitions.row_of)
    assert believed > 5
    assert not map_.carried
    assert not map_.lost
    assert map_.active < known
    assert np.all(map_.submap_of == 0)
    made = np.array([[p.x, p.y] for p in robot.views.taken[known:]])
    off = map_.poses[known:, :2] - made[: len(map_) - known]
    assert np.ptp(off, axis=0) == pytest.approx([0.0, 0.0], abs=0.05)  # as a whole
    assert np.abs(off).max() < 0.5


def test_a_submap_is_not_merged_without_geometric_verification() -> None:
    robot = Robot()
    robot.carry(Pose2(2.0, 0.1, 0.0))
    robot.confirmed = False
    sure = 0
    while sure < 5:
        robot.drive(1)
        belief = robot.map.evidence.belief
        sure += belief is not None and belief.log_odds > robot.map.evidence.params.merge
        assert robot.map.submaps.merged == 0
    robot.confirmed = True
    robot.drive(1)
    assert robot.map.submaps.merged == 1


def test_without_submaps_the_first_observation_is_believed() -> None:
    robot = Robot(submaps=False)
    robot.carry(Pose2(2.0, 0.1, 0.0))
    robot.see_aliased(4)
    assert robot.map.active == 4
    assert robot.map.evidence.known == 0


def test_who_was_perhaps_carried_maps_on_and_is_moved_when_it_was() -> None:
    """What it made since then comes along, the way that was never driven goes, and odometry is not to blame."""
    robot = Robot()
    map_, known = robot.map, len(robot.map)
    before, weights = map_.poses[:known].copy(), map_.transitions.weight[: map_.transitions.count].copy()
    assert map_.suspect_kidnap()
    assert not map_.carried
    assert map_.log_prior(0, Pose2(50.0, 50.0, 0.0)) == PRIOR
    robot.carry(Pose2(1.0, 0.1, 0.0), noticed=False)
    robot.drive(40)
    robot.recognises = True
    while map_.submaps.merged == 0:
        assert map_.suspects_kidnap
        robot.drive(1)
        assert robot.pose.x < 6.0
    assert map_.corrected == 0
    made = np.array([[p.x, p.y] for p in robot.views.taken[known : known + 3]])
    assert map_.poses[known : known + 3, :2] == pytest.approx(made, abs=0.5)
    assert np.array_equal(map_.poses[:known], before)
    assert np.array_equal(map_.transitions.weight[: len(weights)], weights)
    assert (map_.transitions.weight[: map_.transitions.count] > 0)[across(map_.transitions, known)].sum() == 1


def test_who_was_not_carried_after_all_has_the_map_that_it_would_have() -> None:
    told, suspicious = Robot(recognises=True), Robot(recognises=True)
    assert suspicious.map.suspect_kidnap()
    for robot in (told, suspicious):
        robot.drive(250)
    assert not suspicious.map.evidence.in_doubt
    assert suspicious.map.corrected == suspicious.map.submaps.begun == 0
    assert np.array_equal(told.map.poses, suspicious.map.poses)
    assert np.array_equal(told.map.links, suspicious.map.links)


def test_an_alarm_that_was_false_leaves_the_map_as_sure_as_before() -> None:
    """What is found where it should be speaks for all that was mapped since, and a merge of before is still in question."""
    robot = Robot(recognises=True)
    map_, merge = robot.map, Merge(5, 9.0)
    map_.submaps.merges = [merge]
    back = Pose2(1.0, 0.0, 0.0)
    robot.carry(back, noticed=False)
    map_.pose_filter.local = map_.pose(map_.here).inverse().compose(back)
    assert map_.suspect_kidnap()
    assert map_.log_prior_of_new == PRIOR
    while map_.evidence.in_doubt:
        robot.drive(1)
    robot.drive(1)
    assert map_.submaps.merges == [merge]
    assert map_.log_prior_of_new == -merge.log_odds < -9.0


def test_of_several_merges_the_least_sure_is_in_question() -> None:
    submaps = Submaps()
    submaps.merges = [Merge(3, 7.0), Merge(10, 8.0)]
    submaps.suspect(20, 2.0)
    assert [submaps.least_sure(before) for before in (-1, 5, 10, 20)] == [
        Merge(20, 2.0),
        Merge(20, 2.0),
        Merge(20, 2.0),
        None,
    ]
    submaps.confirm(9.0)
    assert [submaps.least_sure(before) for before in (-1, 5, 10)] == [Merge(3, 7.0), Merge(10, 8.0), Merge(20, 9.0)]
    submaps.suspect(20, 2.0)  # again, before anything was made
    assert submaps.merges == [Merge(3, 7.0), Merge(10, 8.0), Merge(20, 2.0)]


def test_where_nothing_can_be_found_out_a_suspicion_is_a_kidnap() -> None:
    lost = Robot(50)
    lost.map.declare_kidnapped()
    assert not lost.map.suspect_kidnap()
    assert not Robot(submaps=False).map.suspect_kidnap()


# ---------------------------------------------------------------- in doubt: it does not know of any kidnap


def in_doubt(known: Known, prior: float) -> Evidence:
    known.prior = prior
    evidence = Evidence(EvidenceParams(), CELL_M)
    evidence.doubt(known.count)
    return evidence


def test_observations_alone_never_prevail_against_odometry() -> None:
    """On new ground that looks like a known place, to the last detail and for metre after metre, the robot is where it went."""
    known = Known(60)
    known.robot_here = Pose2(0.0, 40.0, 0.0)
    evidence, views = in_doubt(known, -EvidenceParams().unnoticed), Views(known.taken, Pose2(2.0, 0.0, 0.0))
    for _ in range(60):
        drive(evidence, known, views, 10)
        assert evidence.belief is None
    assert evidence.hypotheses[:, law.ODDS].max() == law.MOST_SAID - evidence.params.unnoticed


def test_what_is_missing_where_it_should_be_speaks_against_odometry() -> None:
    known = Known(60)
    evidence, views = in_doubt(known, -EvidenceParams().unnoticed), Views(known.taken, Pose2(2.0, 0.0, 0.0))
    known.robot_here = Pose2(14.0, 0.0, 0.0)
    while evidence.belief is None or evidence.belief.log_odds < evidence.params.merge:
        drive(evidence, known, views, 1)
        known.robot_here = known.robot_here.compose(Pose2(0.03, 0.0, 0.0))
        assert views.robot.x < 10.0
    assert evidence.here < -2.0
    assert math.hypot(evidence.belief.pose.x - views.robot.x, evidence.belief.pose.y) < 0.5


def test_what_lies_within_the_drift_of_odometry_needs_observations_only() -> None:
    known = Known(60)
    known.robot_here = Pose2(0.0, 40.0, 0.0)
    evidence, views = in_doubt(known, -2.0), Views(known.taken, Pose2(2.0, 0.0, 0.0))
    while evidence.belief is None or evidence.belief.log_odds < evidence.params.merge:
        drive(evidence, known, views, 1)
        assert views.robot.x < 8.0
    assert evidence.here == 0.0


def test_where_it_is_mapping_is_no_other_place() -> None:
    known = Known(60)
    evidence, views = in_doubt(known, 0.0), Views(known.taken, Pose2(2.0, 0.0, 0.0))
    for _ in range(50):
        drive(evidence, known, views, 1)
        known.robot_here = views.robot.compose(Pose2(0.3, 0.2, 0.2))
        assert evidence.belief is None
    elsewhere, here = evidence.weighed(known)
    assert evidence.hypotheses[:, law.ODDS].max() > 1.0  # beside exactly where it maps, since the map is a little off
    assert (len(elsewhere), max(here)) == (0, 0.0)


def test_a_doubt_ends_when_nothing_speaks_for_it() -> None:
    known = Known()
    evidence = in_doubt(known, 0.0)
    for _ in range(round(law.QUIET / 0.03) - 1):
        evidence.move(DRIVE)
        assert not evidence.over(known)
    for _ in range(3):
        evidence.move(DRIVE)
    assert evidence.over(known)
    evidence.doubt(known.count)
    assert not evidence.over(known)


@pytest.mark.parametrize(("off_m", "likelier"), [(9.0, True), (0.3, False)])
def test_a_doubt_goes_on_while_another_place_is_likelier(off_m: float, likelier: bool) -> None:
    """What was said for minutes must not be forgotten. A hypothesis beside *here* is no other place."""
    known = Known()
    evidence = in_doubt(known, 0.0)
    for _ in range(round(law.QUIET / 0.03) + 2):
        evidence.move(DRIVE)
    here = known.robot_here
    evidence._count = law._begin(evidence._rows, 0, np.array([here.x, here.y + off_m, here.heading_rad]), 1.0, 0, 14.0)
    assert evidence.over(known) is not likelier
    evidence.here = 1.5
    assert evidence.over(known)


def test_perceptual_aliasing_closes_no_loop() -> None:
    robot = Robot(recognises=True)
    robot.see_aliased(3)
    assert robot.map.evidence.in_doubt
    assert robot.map.active == len(robot.map) - 1  # it is taken for a new place
    assert (robot.map.closures, robot.map.belief) == (0, None)


def test_who_was_carried_unnoticed_gives_way_and_its_odometry_with_it() -> None:
    robot = Robot(recognises=True)
    map_, known, weights = robot.map, len(robot.map), robot.map.transitions.weight.copy()
    before = map_.poses[:known].copy()
    robot.carry(Pose2(6.0, 0.0, 0.0), noticed=False)
    map_.pose_filter.local = map_.pose(map_.here).inverse().compose(Pose2(2.0, 0.0, 0.0))  # it thinks
    while map_.evidence.in_doubt or not map_.closures:
        robot.drive(1)
        assert robot.pose.x < 11.9
        if map_.evidence.in_doubt:
            assert np.array_equal(map_.poses[:known], before)
            assert map_.evidence.known == known  # what is made in doubt says nothing of where it is
    assert map_.corrected == 1
    assert robot.off_m < 0.5
    softer = map_.transitions.weight[: map_.transitions.count] < weights[: map_.transitions.count]
    assert softer.any()


def test_in_a_large_map_it_is_less_likely_to_have_been_carried_to_one_place(monkeypatch: pytest.MonkeyPatch) -> None:
    map_ = Robot().map
    assert map_._against_error(0) == map_.evidence.params.unnoticed
    monkeypatch.setattr(experience_map, "MANY", len(map_) / math.e)
    assert map_._against_error(0) == pytest.approx(map_.evidence.params.unnoticed + 1.0)


def test_a_merge_is_disproved_by_what_is_missing_there() -> None:
    """Perhaps it was carried, and it was, to where it had never been: it misses what it should see if it had not been."""
    robot = Robot(recognises=True)
    map_, known = robot.map, len(robot.map)
    before = map_.poses.copy()
    robot.carry(Pose2(2.0, 40.0, 0.0), noticed=False)
    map_.pose_filter.local = map_.pose(map_.here).inverse().compose(Pose2(2.0, 0.0, 0.0))
    assert map_.suspect_kidnap()
    while not map_.carried:
        robot.drive(1)
        assert robot.pose.x < 6.0
    assert map_.lost
    assert len(map_) > known
    assert map_.submap_of.tolist() == [0] * known + [1] * (len(map_) - known)
    assert np.array_equal(map_.poses[:known], before)
    assert not (map_.transitions.weight[: map_.transitions.count] > 0)[across(map_.transitions, known)].any()


def test_a_hypothesis_that_is_a_little_off_is_no_proof_against_odometry() -> None:
    """It was not carried: what it sees is put 2.5 m beside where odometry led, farther than that can have drifted."""
    robot = Robot(recognises=True)
    map_, known, weights = robot.map, robot.map.transitions.count, robot.map.transitions.weight.copy()
    robot.carry(Pose2(6.0, 0.0, 0.0), noticed=False)
    map_.pose_filter.local = map_.pose(map_.here).inverse().compose(Pose2(3.5, 0.0, 0.0))
    while map_.evidence.in_doubt or not map_.closures:
        robot.drive(1)
        assert robot.pose.x < 11.9
    assert robot.off_m < 0.5
    assert map_.corrected == 0
    assert np.array_equal(map_.transitions.weight[:known], weights[:known])


def merged_wrongly(robot: Robot, sure: float) -> int:
    """It was carried to x = 1 m, and its submap is merged six metres farther on, with a closure there."""
    map_, known = robot.map, len(robot.map)
    robot.carry(Pose2(1.0, 0.0, 0.0))
    robot.recognises = False
    robot.drive(40)
    claimed = Pose2(robot.pose.x + 6.0, 0.0, 0.0)
    map_.submaps.merge(0, map_.submap_of, map_.poses, map_.robot_here, claimed, sure)
    assert map_.submaps.merges == [Merge(known, sure)]
    t = map_.transitions
    row = t.add(len(map_) - 1, known - 10, travelled=True)
    t.measure(row, Pose2(0.0, 0.0, 0.0), 0.5, t.move[row], 0.0)
    t.take_time(row, 1.0, 0.0)
    map_.evidence.end()
    map_.declare_found()
    robot.recognises = True
    return known


def test_a_merge_that_proves_wrong_is_undone() -> None:
    robot = Robot(recognises=True)
    map_ = robot.map
    known = merged_wrongly(robot, sure=7.0)
    t = map_.transitions
    before, weights, ties = map_.poses[:known].copy(), t.weight[: t.count].copy(), across(t, known)
    assert t.travelled[: t.count][ties].any()
    while map_.submaps.merged == 1:
        robot.drive(1)
        assert robot.pose.x < 8.0
    assert robot.off_m < 0.5
    made = np.array([[p.x, p.y] for p in robot.views.taken[known : known + 3]])
    assert map_.poses[known : known + 3, :2] == pytest.approx(made, abs=0.5)
    assert np.array_equal(map_.poses[:known], before)
    assert t.weight[: len(weights)] == pytest.approx(np.where(ties, 0.0, weights))  # odometry is not to blame
    assert (t.weight[: t.count] > 0)[across(t, known)].sum() == 1  # the new merge
    assert map_.dropped_links == ()  # nothing failed, and nobody is told so


def across(t: Transitions, known: int) -> NDArray[np.bool_]:
    """Which rows tie what came with the submap to the map of before."""
    ends = t.ends[: t.count]
    return (ends.min(axis=1) < known) & (ends.max(axis=1) >= known)


def test_who_drives_on_unchallenged_need_not_undo_its_merge() -> None:
    submaps = Submaps()
    submaps.merges = [Merge(3, 7.0)]
    for metres in (50.0, 49.0):
        submaps.move(metres / CELL_M, 11.0)
        assert submaps.merges
    submaps.move(2.0 / CELL_M, 11.0)
    assert not submaps.merges
    submaps.merges = [Merge(3, 7.0)]
    submaps.begin()
    assert not submaps.merges


def test_a_long_loop_closes_and_odometry_is_not_to_blame() -> None:
    """Where it is puts the robot within what twelve metres without a closure may drift."""
    robot = Robot(recognises=True)
    map_ = robot.map
    robot.carry(Pose2(1.0, 0.0, 0.0), noticed=False)
    map_.params = replace(map_.params, odometry_drift=0.6)
    map_.pose_filter.sigma_m = 0.1  # by what it has just seen: that says nothing of the way round
    while not map_.closures:
        robot.drive(1)
        assert robot.pose.x < 8.0
    assert map_.corrected == 0
    assert map_.active < 30


@given(st.floats(0.0, 20.0), st.floats(0.01, 0.2))
def test_the_prior_is_what_odometry_can_have_drifted(off: float, drift: float) -> None:
    robot = Robot(60)
    map_ = robot.map
    map_.params = replace(map_.params, odometry_drift=drift)
    map_.evidence.doubt(len(map_))
    here = map_.robot_here
    way = float(np.hypot(*map_.transitions.move[: map_.transitions.count, :2].T).sum())
    sigma = math.hypot(map_.pose_filter.sigma_m, drift * way)
    prior = map_.log_prior(0, Pose2(here.x, here.y + off, 0.0))
    assert prior == pytest.approx(max(-0.5 * (off / sigma) ** 2, -map_.evidence.params.unnoticed))
    map_.evidence.end()
    assert map_.log_prior(0, here) == PRIOR


def test_an_observation_that_turns_the_robot_is_outside_the_validation_gate() -> None:
    """As near as it puts the robot: one whose heading is sure is not turned by perceptual aliasing. By the papers it is."""
    packet = Packet(32.0, 32.0, 0.0, 1.0)
    for submaps in (False, True):
        map_ = ExperienceMap(SHAPE, CELL_M, ExperienceMapParams(sweeps=0, submaps=submaps))
        for view in (0, 1):
            map_.step(packet, Recognition(view, True, view, 1.0, 0.0), DRIVE)
        map_.step(packet, Recognition(0, False, 0, 1.0, 1.5), DRIVE)
        assert map_.evidence.in_doubt is submaps
        assert (map_.active == 0) is not submaps
        assert map_.robot.heading_rad == pytest.approx(0.0 if submaps else 1.5)
