"""A made-up session, snapshot by snapshot, to develop and test the page with: test material only.

`fake_snapshot(tick)` depends on its arguments alone. Parts that seldom change stay the same objects for as long as a
real session would keep them.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from sim2d import FreeSpace, Start, Wall, World
from sim2d.world.robot_fit import RobotFit
from web.messages import (
    CellReport,
    Event,
    ExperienceReport,
    Goal,
    GoalMemoryLayer,
    HebbianReport,
    LinkReport,
    MapLayer,
    OccupancyLayer,
    OccupancyPicture,
    Packet,
    Parameter,
    Pose,
    PoseCellLayer,
    Report,
    Senses,
    Series,
    Snap,
    Snapshot,
    TickStage,
    TickWalk,
    Times,
    TimesLayer,
    Timing,
    ViewReport,
    WorldDrawing,
)

NODES = 1500
SPACING_M = 0.25  # between experiences
STEP_M = 0.03  # the robot's way in a tick
SHAPE = (36, 64, 64)
CELL_M = 0.25
SNAP_EVERY = 400  # ticks
SONAR_RAD = np.radians([-90, -50, -30, -10, 10, 30, 50, 90]).astype(np.float32)
PARTS = ("pilot", "office and senses", "view match", "attractor", "correction", "judging")
FOV_RAD = math.radians(90)
_DESKS = [(2.0, 5.4, 3.6, 6.0), (1.6, 2.1, 2.8, 2.7), (2.8, 2.1, 4.0, 2.7), (6.4, 5.0, 8.1, 5.7), (6.35, 2.6, 7.0, 3.3)]
_DESKS += [(6.35, 1.8, 7.0, 2.5)]
_PARTITIONS = [(1.5, 5.3, 3.9, 5.3), (1.5, 2.0, 4.1, 2.0), (2.8, 2.0, 2.8, 3.4), (7.2, 5.7, 7.2, 6.7)]
_PARTITIONS += [(6.3, 1.7, 6.3, 3.8), (6.3, 2.55, 8.2, 2.55)]
_STOPS = [(0.8, 0.8), (5.0, 0.8), (9.1, 0.8), (0.8, 4.1), (4.9, 3.9), (9.1, 4.2), (0.8, 7.2), (5.0, 7.2), (9.1, 7.2)]
_STOPS += [(2.4, 4.2), (8.6, 1.6), (7.3, 4.2), (5.2, 5.6), (2.5, 1.0), (3.0, 7.1)]
_PALETTE = [(230, 159, 0), (86, 180, 233), (0, 158, 115), (240, 228, 66), (0, 114, 178), (213, 94, 0), (204, 121, 167)]


def fake_snapshot(tick: int, goal: bool = True, *, nodes: int = NODES, run: int = 1) -> Snapshot:
    """The session after `tick` ticks of 0.1 s; two packets compete for the first eight seconds of every forty."""
    time_s = tick * 0.1
    truth = _truth(tick)
    lost = tick % SNAP_EVERY < 80 and tick >= SNAP_EVERY
    fresh = _map(tick // 10, nodes)
    times = _times(tick // 10, nodes, goal)
    snap_count = tick // SNAP_EVERY
    now = _to_map(np.array([[truth.x, truth.y]]))[0]
    estimate = Pose(float(now[0]), float(now[1]), math.remainder(truth.heading_rad + 0.0, math.tau))
    return Snapshot(
        run=run,
        tick=tick,
        time_s=time_s,
        mode="goal" if goal else "explore",
        doing="following the route" if goal else "following the wall",
        running=True,
        speed=1.0,
        real_time_factor=1.0,
        seed=3,
        fault=None,
        lost=lost,
        world=_world(),
        worlds=(("office", "Office, 10 x 8 m"), ("loop", "Loop of corridors"), ("empty", "Empty room")),
        truth=truth,
        trail=_frozen(_positions(np.arange(max(0, tick - 1200), tick + 1, 4)).astype(np.float32)),
        estimate=estimate,
        senses=_senses(tick, truth),
        pose_cells=_pose_cells(tick, truth, lost),
        map=fresh,
        times=times,
        goal=_goal(tick, nodes, estimate) if goal else None,
        views=min(nodes, 600 + tick // 10),
        experiences=nodes,
        links=len(fresh.links),
        relocalisations=snap_count,
        error_map_m=0.21 + 0.03 * math.sin(time_s / 20),
        error_odometry_m=0.2 + time_s * 0.005,
        revisit_consistency=0.97 if tick > 50 else None,
        series=_series(tick // 10),
        timings=tuple(Timing(part, 0.1 * k + 0.05, 0.3 * k + 0.1) for k, part in enumerate(PARTS)),
        events=_events(snap_count, goal),
        parameters=_parameters(),
        no_room=_fit().refusal,
        occupancy=_occupancy(tick // 20),
        goal_memory=_goal_memory(tick // 5, goal),
    )


# ---------------------------------------------------------------- the world


@lru_cache(maxsize=1)
def _world() -> WorldDrawing:
    rows: list[tuple[float, float, float, float]] = [(0, 0, 10, 0), (10, 0, 10, 8), (10, 8, 0, 8), (0, 8, 0, 0)]
    heights, kinds = [2.5] * 4, ["wall"] * 4
    for row in _PARTITIONS:
        rows.append(row)
        heights.append(1.4)
        kinds.append("partition")
    for x1, y1, x2, y2 in _DESKS:
        rows += [(x1, y1, x2, y1), (x2, y1, x2, y2), (x2, y2, x1, y2), (x1, y2, x1, y1)]
        heights += [0.75] * 4
        kinds += ["desk"] * 4
    panels, colours = [], []
    for k, x in enumerate((0.8, 2.1, 3.4, 4.7, 6.0, 7.3)):
        panels.append((x, 8, x + (0.5 if k == 3 else 0.8), 8, 1.0, 1.9))
        colours.append(_PALETTE[k])
    panels += [(8.4, 8, 9.3, 8, 0.0, 2.1), (0, 6.6, 0, 7.5, 0.0, 2.1)]
    colours += [(139, 84, 30), (139, 84, 30)]
    for k, y in enumerate((0.6, 1.7, 3.4, 4.6, 5.7)):
        panels += [(10, y, 10, y + 0.7, 0.9, 1.9), (0, y, 0, y + 0.7, 0.9, 1.9)]
        colours += [_PALETTE[5 - k], _PALETTE[(k + 3) % 7]]
    return WorldDrawing(
        name="office",
        title="Office, 10 x 8 m",
        bounds=(0.0, 0.0, 10.0, 8.0),
        walls=_frozen(np.array(rows, np.float32)),
        wall_height_m=_frozen(np.array(heights, np.float32)),
        wall_kind=tuple(kinds),
        panels=_frozen(np.array(panels, np.float32)),
        panel_rgb=_frozen(np.array(colours, np.uint8)),
        places=(("printer", 9.1, 7.2), ("kitchen", 0.8, 0.8), ("desk of Ada", 4.9, 3.9)),
        robot_radius_m=0.2,
        camera_fov_rad=FOV_RAD,
        sonar_angles_rad=_frozen(SONAR_RAD.copy()),
    )


@lru_cache(maxsize=1)
def _fit() -> RobotFit:
    """The same check of fit as in a real session, over the same walls."""
    drawn = _world()
    walls = [
        Wall(*map(float, row), kind, float(height), (0, 0, 0), outer=i < 4)
        for i, (row, kind, height) in enumerate(zip(drawn.walls, drawn.wall_kind, drawn.wall_height_m, strict=True))
    ]
    start = Start("here", 5.0, 0.8, 0.0)
    return RobotFit(FreeSpace(World("office", drawn.title, "", tuple(walls), (start,), ()), drawn.robot_radius_m))


@lru_cache(maxsize=1)
def _way() -> NDArray[np.float64]:
    """A long walk between stops in sight of each other, (n, 2): a point every 5 cm, with rounded corners."""
    rng = np.random.default_rng(7)
    stops = np.array(_STOPS)
    sees = [[j for j in range(len(stops)) if j != i and _clear(stops[i], stops[j])] for i in range(len(stops))]
    here, before, chain = 4, -1, [stops[4]]
    visits = np.zeros(len(stops))
    for _ in range(190):
        choices = [j for j in sees[here] if j != before] or sees[here]
        before, here = here, min(choices, key=lambda j: visits[j] + rng.uniform(0, 1.5))
        visits[here] += 1
        chain.append(stops[here] + rng.normal(0, 0.12, 2))
    corners = np.array(chain)
    arc = np.r_[0, np.cumsum(np.hypot(*np.diff(corners, axis=0).T))]
    fine = np.arange(0, arc[-1], 0.05)
    way = np.column_stack([np.interp(fine, arc, corners[:, k]) for k in (0, 1)])
    window = np.hanning(19)
    padded = np.pad(way, ((9, 9), (0, 0)), mode="edge")
    return np.column_stack([np.convolve(padded[:, k], window / window.sum(), "valid") for k in (0, 1)])


def _clear(a: NDArray[np.float64], b: NDArray[np.float64]) -> bool:
    if math.dist(a, b) > 5.5:
        return False
    for t in np.linspace(0, 1, 40):
        x, y = a + t * (b - a)
        for x1, y1, x2, y2 in _DESKS + _PARTITIONS:
            if x1 - 0.35 < x < x2 + 0.35 and y1 - 0.35 < y < y2 + 0.35:
                return False
    return True


def _positions(ticks: NDArray[np.int64]) -> NDArray[np.float64]:
    way = _way()
    arc = (ticks * STEP_M / 0.05) % (len(way) - 2)
    low = arc.astype(int)
    return way[low] + (arc - low)[:, None] * (way[low + 1] - way[low])


def _truth(tick: int) -> Pose:
    here, ahead = _positions(np.array([tick, tick + 3]))
    return Pose(float(here[0]), float(here[1]), math.atan2(ahead[1] - here[1], ahead[0] - here[0]))


# ---------------------------------------------------------------- what the robot made of it


def _to_map(xy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Office to map frame, with the bends that a map has."""
    start = _way()[0]
    moved = xy - start
    bend = np.column_stack([0.25 * np.sin(xy[:, 1] * 0.9), 0.2 * np.sin(xy[:, 0] * 0.7 + 1)])
    bend0 = np.array([0.25 * math.sin(start[1] * 0.9), 0.2 * math.sin(start[0] * 0.7 + 1)])
    return moved + bend - bend0


@lru_cache(maxsize=4)
def _map(second: int, nodes: int) -> MapLayer:
    way = _way()
    rows = (np.arange(nodes) * int(SPACING_M / 0.05)) % (len(way) - 8)
    xy = _to_map(way[rows])
    rng = np.random.default_rng(1)
    xy += rng.normal(0, 0.05, xy.shape)
    xy += 0.03 * np.sin(second * 0.3 + np.arange(nodes) * 0.01)[:, None]
    ahead = way[rows + 7] - way[rows]
    return MapLayer(
        ids=_frozen(np.arange(nodes, dtype=np.int32)),
        xy=_frozen(xy.astype(np.float32)),
        heading_rad=_frozen(np.arctan2(ahead[:, 1], ahead[:, 0]).astype(np.float32)),
        links=_links(nodes),
    )


@lru_cache(maxsize=4)
def _links(nodes: int) -> NDArray[np.int32]:
    way = _way()
    xy = way[(np.arange(nodes) * int(SPACING_M / 0.05)) % (len(way) - 8)]
    chain = np.column_stack([np.arange(nodes - 1), np.arange(1, nodes)])
    closures = []
    for i in range(40, nodes, 2):
        gaps = np.hypot(*(xy[: i - 30] - xy[i]).T) if i > 40 else np.array([9.0])
        if gaps.min() < 0.16:
            closures.append((int(gaps.argmin()), i))
    return _frozen(np.vstack([chain, np.array(closures, dtype=np.int64).reshape(-1, 2)]).astype(np.int32))


def _goal_row(nodes: int) -> int:
    xy = _map(0, nodes).xy
    return int(np.hypot(*(xy - _to_map(np.array([[9.1, 7.2]]))[0]).T).argmin())


@lru_cache(maxsize=8)
def _search(second: int, nodes: int, row: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    layer = _map(second, nodes)
    a, b = layer.links.T
    seconds = np.hypot(*(layer.xy[a] - layer.xy[b]).T) / 0.3 + 0.05
    graph = coo_matrix((seconds, (a, b)), shape=(nodes, nodes)).tocsr()
    return dijkstra(graph, directed=False, indices=row, return_predecessors=True)


@lru_cache(maxsize=4)
def _times(second: int, nodes: int, to_goal: bool) -> TimesLayer:
    row = _goal_row(nodes) if to_goal else _near(second, nodes)
    return TimesLayer(to_goal, _frozen(_search(second, nodes, row)[0].astype(np.float32)))


def _near(second: int, nodes: int) -> int:
    truth = _truth(second * 10)
    return int(np.hypot(*(_map(second, nodes).xy - _to_map(np.array([[truth.x, truth.y]]))[0]).T).argmin())


@lru_cache(maxsize=4)
def _goal(tick: int, nodes: int, estimate: Pose) -> Goal:
    second = tick // 10
    target = _goal_row(nodes)
    seconds, before = _search(second, nodes, target)
    row = _near(second, nodes)
    chain = [row]
    while chain[-1] != target and before[chain[-1]] >= 0:
        chain.append(int(before[chain[-1]]))
    layer = _map(second, nodes)
    route = np.vstack([[estimate.x, estimate.y], layer.xy[chain]]).astype(np.float32)
    arrival = np.r_[0.0, seconds[row] - seconds[chain] + 0.2].astype(np.float32)
    return Goal(
        experience=target,
        x=float(layer.xy[target, 0]),
        y=float(layer.xy[target, 1]),
        state="tracking",
        eta_s=float(arrival[-1]),
        remaining_m=float(np.hypot(*np.diff(route, axis=0).T).sum()),
        route_xy=_frozen(route),
        route_arrival_s=_frozen(arrival),
    )


# ---------------------------------------------------------------- cells and senses


def _cell(truth: Pose, shift: tuple[float, float, float]) -> Packet:
    """Where the packet of this pose is, in cells, `shift` (x, y, heading) away."""
    x = (truth.x / CELL_M + 40 + shift[0]) % SHAPE[2]
    y = (truth.y / CELL_M + 8 + shift[1]) % SHAPE[1]
    return Packet(x, y, math.remainder(truth.heading_rad + shift[2], math.tau), 1.0)


def _pose_cells(tick: int, truth: Pose, lost: bool) -> PoseCellLayer:
    share = 1 - 0.42 * (1 - (tick % SNAP_EVERY) / 80) if lost else 1.0
    first, second = _cell(truth, (0, 0, 0)), _cell(truth, (22, 14, 1.4))
    number = 2 * (tick // SNAP_EVERY) + 1
    packets = [Packet(first.x, first.y, first.heading_rad, share, number)]
    if lost:
        packets.append(Packet(second.x, second.y, second.heading_rad, 1 - share, number + 1))
    cells, values = zip(*[_blob(p) for p in packets], strict=True)
    cell, value = np.vstack(cells), np.concatenate(values)
    order = np.argsort(-value, kind="stable")
    keep = order[:500]
    path = [_cell(_truth(t), (0, 0, 0)) for t in range(max(0, tick - 1200), tick + 1, 12)]
    return PoseCellLayer(
        shape=SHAPE,
        cell_m=CELL_M,
        cells=_frozen(cell[keep].astype(np.int32)),
        activity=_frozen(value[keep].astype(np.float32)),
        active_cells=len(order),
        packets=tuple(packets),
        path=_frozen(np.array([(p.x, p.y, p.heading_rad) for p in path], np.float32)),
        last_snap=_snap(tick // SNAP_EVERY),
    )


def _blob(packet: Packet) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    turn = (packet.heading_rad % math.tau) / math.tau * SHAPE[0]
    t, y, x = (round(v) + np.arange(-4, 5) for v in (turn, packet.y, packet.x))
    grid = np.stack(np.meshgrid(t, y, x, indexing="ij"), -1).reshape(-1, 3)
    gap = ((grid - (turn, packet.y, packet.x)) ** 2).sum(1)
    value = np.exp(-gap / (2 * 1.6**2))
    keep = value > 0.005
    return grid[keep] % SHAPE, value[keep] / value.sum() * packet.mass


@lru_cache(maxsize=4)
def _snap(count: int) -> Snap | None:
    if count == 0:
        return None
    truth = _truth(count * SNAP_EVERY + 80)
    return Snap(count * SNAP_EVERY * 0.1 + 8, _cell(truth, (22, 14, 1.4)), _cell(truth, (0, 0, 0)))


def _senses(tick: int, truth: Pose) -> Senses:
    camera = _camera(truth)
    template = _shrink(camera)
    wobble = np.random.default_rng(tick // 5).normal(0, 5, template.shape)
    best = np.clip(template + wobble, 0, 255).astype(np.uint8)
    difference = float(np.abs(best.astype(float) - template).mean())
    return Senses(
        camera=_frozen(camera),
        front_end="template",
        seen=_frozen(template.astype(np.uint8)),
        seen_words="12 x 8 grey levels",
        best=_frozen(best),
        best_words="12 x 8 grey levels",
        best_view=(tick // 7 * 37) % 600,
        difference=difference,
        threshold=8.0,
        active_view=(tick // 7 * 37) % 600,
        recruited=tick % 70 < 3,
        false_positive=False,
        false_positives=0,
        ranges_m=_frozen(np.minimum(_cast(truth, truth.heading_rad + SONAR_RAD)[0], 4.0).astype(np.float32)),
    )


def _shrink(camera: NDArray[np.uint8]) -> NDArray[np.float64]:
    grey = camera.mean(2)
    columns = np.array_split(np.arange(grey.shape[1]), 12)
    return np.stack([grey[:, c].reshape(8, -1, len(c)).mean((1, 2)) for c in columns], 1)


def _cast(pose: Pose, angles: NDArray[np.floating]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Distance to the nearest wall along each angle, and its row."""
    walls = _world().walls.astype(float)
    a, e = walls[:, :2], walls[:, 2:] - walls[:, :2]
    d = np.column_stack([np.cos(angles), np.sin(angles)])[:, None]
    r = a[None] - (pose.x, pose.y)
    cross = d[..., 0] * e[None, :, 1] - d[..., 1] * e[None, :, 0]
    cross = np.where(np.abs(cross) < 1e-9, 1e-9, cross)
    along = (r[..., 0] * e[None, :, 1] - r[..., 1] * e[None, :, 0]) / cross
    part = (r[..., 0] * d[..., 1] - r[..., 1] * d[..., 0]) / cross
    along = np.where((along > 0) & (part >= 0) & (part <= 1), along, np.inf)
    return along.min(1), along.argmin(1)


def _camera(pose: Pose) -> NDArray[np.uint8]:
    offsets = np.linspace(FOV_RAD / 2, -FOV_RAD / 2, 64)
    gap, row = _cast(pose, pose.heading_rad + offsets)
    gap = np.clip(gap * np.cos(offsets), 0.05, 20)
    height = _world().wall_height_m[row]
    image = np.empty((48, 64, 3))
    image[:24], image[24:] = 205, 92
    base = np.array([(150 + 60 * math.sin(k * 2.1), 150 + 50 * math.sin(k * 1.3), 140 + 50 * math.cos(k)) for k in row])
    shade = np.clip(1.15 - gap / 9, 0.3, 1)
    v = np.arange(48)[:, None]
    inside = (v > 24 - (height - 0.5) / gap * 30) & (v < 24 + 0.5 / gap * 30)
    return np.where(inside[..., None], (base * shade[:, None])[None], image).astype(np.uint8)


# ---------------------------------------------------------------- what lies below


@lru_cache(maxsize=2)
def _occupancy(_version: int) -> OccupancyLayer:
    cells = np.full(SHAPE[1:], 0.5, np.float32)
    cells[8:40, 40:] = 0.2
    cells[8, 40:], cells[39, 40:] = 0.95, 0.95
    picture = np.full((16, 20), 0.2, np.float32)
    picture[[0, -1]], picture[:, [0, -1]] = 0.95, 0.95
    drawn = OccupancyPicture(_frozen(picture), (-2.5, -2.0), CELL_M)
    return OccupancyLayer(_frozen(cells), lambda: drawn)


@lru_cache(maxsize=2)
def _goal_memory(_version: int, goal: bool) -> GoalMemoryLayer:
    if not goal:
        return GoalMemoryLayer(9000, None, None, None)
    y, x = np.mgrid[: SHAPE[1], : SHAPE[2]]
    seconds = np.hypot(x - 50, y - 20) * 0.8
    seconds[seconds > 15] = np.inf
    return GoalMemoryLayer(9000, (50, 20), _frozen(seconds.astype(np.float32)), 0.7)


# ---------------------------------------------------------------- the books


@lru_cache(maxsize=4)
def _series(second: int) -> Series:
    time_s = np.linspace(0, max(second, 1), min(600, second + 2))
    return Series(
        time_s=_frozen(time_s),
        map_error_m=_frozen(0.22 + 0.05 * np.sin(time_s / 9)),
        odometry_error_m=_frozen(0.2 + 0.005 * time_s),
        views=_frozen(600 * (1 - np.exp(-time_s / 90))),
        experiences=_frozen(NODES * (1 - np.exp(-time_s / 120))),
        residual_mm=_frozen(3 + np.sin(time_s / 7)),
        residual_mrad=_frozen(4 + 1.0 * np.sin(time_s / 5)),
    )


@lru_cache(maxsize=8)
def _events(snaps: int, goal: bool) -> tuple[Event, ...]:
    events = [Event(k, k * 40.0 + 8, "snap", f"snapped 5.6 m, snap {k}") for k in range(1, snaps + 1)]
    return tuple(([Event(0, 2.0, "goal", "goal set: printer")] if goal else []) + events)


@lru_cache(maxsize=1)
def _parameters() -> tuple[Parameter, ...]:
    paper = "ACRA 2004"
    return (
        Parameter(
            "local_view.threshold", 8.0, 8.0, "s_m", "grey", 0.0, 64.0, "a view counts as known below", paper, True
        ),
        Parameter("local_view.width", 12, 12, "w", "px", 4, 64, "columns of a stored view", paper, False),
        Parameter("pose_cells.injection", 0.1, 0.1, "delta", "", 0.0, 1.0, "strength of visual input", paper, True),
        Parameter("pose_cells.inhibition", 0.002, 0.002, "phi", "", 0.0, 0.1, "global inhibition", paper, True),
        Parameter("pose_cells.cells", 64, 64, "n_x", "cells", 8, 128, "cells along x' and y'", paper, False),
        Parameter(
            "experience_map.correction", 0.5, 0.5, "alpha", "", 0.0, 1.0, "share of an error put right", paper, True
        ),
        Parameter("pilot.speed", 0.3, 0.3, "v", "m/s", 0.05, 0.5, "cruising speed", "ours", True),
        Parameter("pilot.wander", True, True, "", "", None, None, "explore when there is no goal", "ours", True),
        Parameter("views.kind", "sad", "sad", "", "", None, None, "how views are compared", "ours", False),
    )


def fake_reports() -> dict[str, Report]:
    """One of each kind that can be inspected."""
    picture = _frozen(np.arange(96, dtype=np.uint8).reshape(8, 12) * 2)
    cells = _frozen(np.array([[3, 22, 31], [4, 22, 31], [4, 23, 32]], np.int32))
    camera = fake_snapshot(430).senses.camera
    hebbian = HebbianReport(140, cells, _frozen(np.array([0.05, 0.04, 0.01], np.float32)), 0.1)
    links = (
        LinkReport(12, 13, 1.5, math.pi / 4, -0.2, 5.25, "following the wall", 3, 5, 0.8),
        LinkReport(11, 12, 0.4, -0.0001, 0.1, 1.5, "crossing the room", 1, 0, 1.0),
    )
    times = Times(65.0, 130.0, 4)
    layer = _map(43, NODES)
    pose = Pose(float(layer.xy[12, 0]), float(layer.xy[12, 1]), 0.5)
    by_heading = np.zeros(SHAPE[0], np.float32)
    by_heading[3:5] = 0.2
    return {
        "experience": ExperienceReport(
            12, (31.2, 22.1, 3.4), 7, picture, pose, 2.5, 2.0, 1.25, True, links, hebbian, times
        ),
        "view": ViewReport(
            7, picture, _frozen(255 - picture), camera, 12.5, 8.0, False, (12, 40), hebbian, Times(None, None, 0)
        ),
        "cell": CellReport(31, 22, _frozen(by_heading), Packet(31.2, 22.4, 0.6, 0.62, 3), ((7, 0.05),), 1, (12, 40)),
    }


def fake_walk(at: int) -> TickWalk:
    """A tick of three stages, at stage `at`."""
    names = ("image", "injection", "correction")
    return TickWalk(tuple(TickStage(n, n.capitalize(), f"This is what the {n} did.") for n in names), at)


def _frozen(array: NDArray) -> NDArray:  # type: ignore[type-arg]
    array.setflags(write=False)
    return array
