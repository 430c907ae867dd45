"""What is true between two steps of the experience map, of its experiences and links, and of the local view beneath it."""

# Laws look at all of a state, and take nothing for granted.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

import numpy as np

from ratslam_core.experience_map.experience_map import ExperienceMap, _Arrival
from ratslam_core.extensions.evidence import CEILING, SUBMAP, Belief, Evidence
from ratslam_core.extensions.evidence import MOST as MOST_HYPOTHESES
from ratslam_core.extensions.exact_solver import ExactSolver
from ratslam_core.extensions.familiar_ground import MOST_NEAR, FamiliarGround
from ratslam_core.extensions.odometry_edges import OdometryEdges
from ratslam_core.laws.measures import FAR_M, MOST, TURN, apart, array, number, pose, true, whole, within
from ratslam_core.local_view.recogniser import LocalView
from ratslam_core.local_view.view_links import ViewLinks, in_use
from ratslam_core.pose_graph.experiences import Experiences
from ratslam_core.pose_graph.transitions import BEHAVIOURS, Adjacency, PreintegratedOdometry, Transitions
from ratslam_core.types import Recognition

LARGEST = 1e12  # of metres, seconds and weights
FASTEST = 10.0  # rad/s, the largest yaw bias


def experience_map(map_: ExperienceMap, views: int) -> None:
    """ValueError names the first law that does not hold. views: how many local view cells there are."""
    true(map_._experiences.shape == map_.shape, "the experiences must be of the same pose cells")
    true(map_._temporal_map._map is map_, "the temporal map must be of the same experiences")
    experiences(map_._experiences, views)
    n = len(map_)
    within("a submap", map_._experiences.submap[:n], 0, map_.submaps.begun)
    transitions(map_.transitions, n)
    whole("the active experience", map_.here, 0 if n else -1, n - 1)
    pose("the robot's place", map_.pose_filter.local)
    number("how far off it may be", map_.pose_filter.sigma_m, 0.0, LARGEST)
    pose("offset", map_._offset)
    pose("travel", map_._travel)
    for name in ("_driven_m", "_driving_s", "_sigma"):
        number(name[1:], getattr(map_, name), 0.0, LARGEST)
    number("yaw bias", map_.yaw_bias, -FASTEST, FASTEST)
    for name in ("closures", "steps", "corrected"):
        whole(name, getattr(map_, name))
    _leg(map_._leg)
    if isinstance(map_._edges, OdometryEdges):
        whole("the latest experience", map_._edges.latest, -1, n - 1)
        _leg(map_._edges.since)
    if isinstance(map_.ground, FamiliarGround):
        _ground(map_.ground, n, views)
    if isinstance(map_.optimiser, ExactSolver):
        _solver(map_.optimiser)
    if map_._arrival is not None:
        _arrival(map_._arrival, map_.transitions.count)
    whole("the latest submap", map_.submaps.begun)
    whole("the submap", map_.submaps.current, 0, map_.submaps.begun)
    whole("merged submaps", map_.submaps.merged, 0, map_.submaps.begun)
    least = 0
    for merge in map_.submaps.merges:
        whole("the first experience of a merge", merge.first, least, n)
        number("the log odds of a merge", merge.log_odds, -LARGEST, LARGEST)
        least = merge.first + 1
    _evidence(map_.evidence, n, map_.submaps.begun)


def _evidence(evidence: Evidence, n: int, submaps: int) -> None:
    whole("experiences among which the evidence is", evidence.known, 0, n)
    whole("hypotheses", evidence._count, 0, MOST_HYPOTHESES)
    rows = array("hypotheses", evidence._rows, np.float64, (MOST_HYPOTHESES, 7))
    within("a hypothesis", rows[:, :CEILING], -FAR_M, FAR_M)
    true(not np.isnan(rows[:, CEILING]).any(), "a hypothesis must have a ceiling")
    within("a hypothesis' submap", rows[: evidence._count, SUBMAP], 0, submaps)
    number("the way since the last observation", evidence._units, 0.0, 1.0)
    number("the way since echoes were asked", evidence._unheard, 0.0, LARGEST)
    number("the way since a doubt", evidence._quiet, 0.0, LARGEST)
    number("log odds of here", evidence.here, -FAR_M, FAR_M)
    true(isinstance(evidence.in_doubt, bool), "in_doubt must be true or false")
    if evidence.belief is not None:
        true(isinstance(evidence.belief, Belief), "what is believed must be a belief")
        whole("the experience that is believed", evidence.belief.experience, 0, n - 1)
        pose("the place that is believed", evidence.belief.pose)
        number("log odds", evidence.belief.log_odds, -FAR_M, FAR_M)
        number("the facing that is believed", evidence.belief.facing_rad, -FAR_M, FAR_M)


def _ground(ground: FamiliarGround, n: int, views: int) -> None:
    true(ground.let_go.keys() == FamiliarGround().let_go.keys(), "what was let go must be counted by its kinds")
    for name, count in ground.let_go.items():
        whole(name, count)
    share = array("shares", ground._share, np.float64, (None,))
    true(len(share) >= n, "each experience must have a share of recognised observations")
    within("a share", share, 0.0, 1.0)
    unseen = array("unseen", ground._unseen, np.int64, share.shape)
    within("a count of observations", unseen, 0, MOST)
    whole("the faded view", ground.faded, -1, views - 1)
    near = array("what is near", ground._near, np.int64, (MOST_NEAR,))
    within("an experience nearby", near[: whole("how many are near", ground._found, 0, MOST_NEAR)], 0, n - 1)


def _solver(solver: ExactSolver) -> None:
    for name in ("_solved_at", "_closures_at_solve"):
        whole(name, getattr(solver, name))
    number("the rest after a solution", solver._rest_after_solve, 0.0, LARGEST)


def _leg(leg: PreintegratedOdometry) -> None:
    pose("a leg's move", leg.moved)
    for name in ("way_m", "turning_s", "time_s"):
        number(f"a leg's {name}", getattr(leg, name), 0.0, LARGEST)


def _arrival(arrival: _Arrival, rows: int) -> None:
    true(isinstance(arrival, _Arrival), "the arrival must be one")
    whole("the arrival's row", arrival.row, 0, rows - 1)
    within("the arrival's move", array("the arrival's move", arrival.move, np.float64, (3,)), -FAR_M, FAR_M)
    number("the arrival's weight", arrival.weight, 0.0, LARGEST)
    pose("where the robot came from", arrival.came)
    number("the arrival's sigma", arrival.sigma, 0.0, LARGEST)


def experiences(known: Experiences, views: int) -> None:
    """ValueError names the first law that does not hold. views: how many local view cells there are."""
    room = len(array("poses", known.pose, np.float64, (None, 3)))
    array("states", known.at, np.float64, (room, 3))
    array("the experiences' views", known.view, np.int64, (room,))
    n = whole("the number of experiences", known.count, 0, room)
    within("a submap", array("submaps", known.submap, np.int32, (room,))[:n], 0, MOST)
    within("a place in the map", known.pose[:n, :2], -FAR_M, FAR_M)
    within("a heading in the map", known.pose[:n, 2], -TURN, TURN)
    for axis in range(3):
        within("a state", known.at[:n, axis], 0.0, known.shape[2 - axis])
    within("an experience's view", known.view[:n], -1, views - 1)


def transitions(t: Transitions, nodes: int) -> None:
    """nodes: how many experiences there are."""
    _adjacency(t.graph, nodes)
    room = len(array("ends", t.ends, np.int64, (None, 2)))
    n = whole("the number of transitions", t.count, 0, room)
    array("moves", t.move, np.float64, (room, 3))
    within("an end", t.ends[:n], 0, nodes - 1)
    within("a move", t.move[:n], -FAR_M, FAR_M)
    for name, high in (("weight", LARGEST), ("believed", LARGEST), ("turning_s", LARGEST), ("time_s", LARGEST),
                       ("confidence", 1.0)):  # fmt: skip
        within(name, array(name, getattr(t, name), np.float64, (room,))[:n], 0.0, high)
    for name in ("passages", "trials"):
        within(name, array(name, getattr(t, name), np.int64, (room,))[:n], 0, MOST)
    within("behaviour", array("behaviour", t.behaviour, np.int8, (room,))[:n], 0, BEHAVIOURS - 1)
    travelled = array("travelled", t.travelled, np.bool_, (room,))[:n]
    array("chain", t.chain, np.bool_, (room,))
    rows = np.flatnonzero(travelled)
    ways = {(i, j): row for (i, j), row in zip(t.ends[rows].tolist(), rows.tolist(), strict=True)}
    true(t.row_of == ways, "the rows of links must be those that were travelled")
    for row in t.free:
        whole("an empty row", row, 0, n - 1)
        empty = not travelled[row] and t.weight[row] == 0 == t.believed[row]
        true(empty, "a row that is used again must be no way and of no weight")
    true(len(set(t.free)) == len(t.free), "a row must be empty only once")
    for ends in t.dropped:
        true(isinstance(ends, tuple) and len(ends) == 2, "a dropped link must have two ends")
        for end in ends:
            whole("the end of a dropped link", end, 0, nodes - 1)
    _halves(t, n, nodes)


def _adjacency(graph: Adjacency, nodes: int) -> None:
    room = len(array("start", graph.start, np.uint32, (None,)))
    used, rooms = (array(name, a, np.uint32, (room,)) for name, a in (("used", graph.used), ("room", graph._room)))
    size = len(array("half-edges", graph.half, np.uint32, (None,)))
    other = array("other ends", graph.other, np.uint32, (size,))
    true(whole("the number of nodes", graph._nodes, 0, room) == nodes, f"there must be {nodes} nodes")
    apart("blocks of half-edges", graph.start[:nodes], rooms[:nodes], whole("their end", graph._end, 0, size), size)
    true((rooms[:nodes] > 0).all(), "a block of half-edges must have room to double")
    true((used[:nodes] <= rooms[:nodes]).all(), "a block of half-edges must have room for those in use")
    at = in_use(graph.start[:nodes].astype(np.int64), used[:nodes].astype(np.int64))
    if nodes:
        within("an other end", other[at], 0, nodes - 1)
    whole("changes", graph.changes)


def _halves(t: Transitions, n: int, nodes: int) -> None:
    """Every row appears twice, at its beginning and at its end, and each of the two names the other."""
    graph, used = t.graph, t.graph.used[:nodes].astype(np.int64)
    at = in_use(graph.start[:nodes].astype(np.int64), used)
    half, other = graph.half[at].astype(np.int64), graph.other[at].astype(np.int64)
    node = np.repeat(np.arange(nodes), used)
    true(np.array_equal(np.sort(half), np.arange(2 * n)), "each transition must have its two half-edges")
    row, end = half >> 1, half & 1
    right = (t.ends[row, end] == node) & (t.ends[row, 1 - end] == other)
    true(right.all(), "a half-edge must name the ends of its transition")


def local_view(view: LocalView) -> None:
    """ValueError names the first law that does not hold."""
    size = whole("columns", view.front_end.columns, 1, 4096) * whole("rows", view.front_end.rows, 1, 4096)
    size += whole("echoes", view.front_end.echoes, 0, 4096)
    known = array("templates", view._templates, np.uint8, (None, size))
    true(len(known) > 1, "templates must have room to grow by half")
    count = whole("the number of views", view._count, 0, len(known))
    array("features", view.features, np.uint8, (size,))
    if view._last is not None:
        array("the last features", view._last, np.uint8, (size,))
    number("surprise", view.image_change, 0.0)
    whole("false positives", view.false_positives)
    _recognition(view.recognition, count)


def _recognition(seen: Recognition, count: int) -> None:
    whole("the recognised view", seen.view, -1, count - 1)
    whole("the best view", seen.best_view, -1, count - 1)
    number("its difference", seen.difference, 0.0)
    if seen.facing_rad is not None:
        number("its facing", seen.facing_rad, -20.0, 20.0)


def view_links(links: ViewLinks, views: int, cells: int) -> None:
    """views: how many are known; cells: how many pose cells there are."""
    size = len(array("linked cells", links._cells, np.int32, (None,)))
    strength = array("strengths", links._strength, np.float32, (size,))
    start, used, room = array("blocks", links._blocks, np.int64, (None, 3)).T
    whole("forgotten links", links.forgotten)
    array("seen", links._seen, np.bool_, (None,))
    apart("blocks of links", start, room, whole("their end", links._end, 0, size), size)
    true(((used >= 0) & (used <= room)).all(), "a block of links must have room for those in use")
    true(not used[views:].any(), f"only the {views} known views may have links")
    at = in_use(start, used)
    within("a linked cell", links._cells[at], 0, cells - 1)
    within("a strength", strength[at], 0.0, float(np.finfo(np.float32).max))


def learnt(times_s: list[float], views: int, now_s: float) -> None:
    """When each view was recruited."""
    true(len(times_s) == views, f"each of {views} views must have a time, got {len(times_s)}")
    for time_s in times_s:
        number("when a view was recruited", time_s, 0.0, now_s)
