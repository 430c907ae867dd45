"""What is true of a whole brain between two steps: of each part, and between the parts."""

# Laws look at all of a state, and take nothing for granted.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ratslam_core.beats import EARLY, Beats
from ratslam_core.extensions.echo_closures import EchoClosures
from ratslam_core.extensions.kidnap_detector import MOST_USUAL, KidnapDetector
from ratslam_core.extensions.scan_matching import RECENT, ScanMatching
from ratslam_core.goal_memory import FREE, GoalMemory, _Iteration, misplaced
from ratslam_core.laws.experience_map import LARGEST, experience_map, learnt, local_view, view_links
from ratslam_core.laws.measures import FAR_M, MOST, array, number, pose, same_kind, true, whole, within
from ratslam_core.local_view.recogniser import LocalView
from ratslam_core.occupancy_grid import BOUND, KEPT, MapGrid
from ratslam_core.params import RatSlamParams
from ratslam_core.pose_cells import activity_kernels as kernels
from ratslam_core.pose_cells import packet_kernels
from ratslam_core.pose_cells.network import PoseCells
from ratslam_core.slam import RatSlam

MOST_LIT = 16_384  # cells of the plane above a share of the strongest: many packets, each as wide as its window
MOST_SONARS = 1024
MOST_ACTIVITY = 1e6  # packets injected by hand add to the sum of 1 until the next step
ROUNDING = 1e-6


def check(brain: RatSlam) -> None:
    """ValueError names the first law that does not hold."""
    same_kind("params", brain.params, RatSlamParams())
    handed = _handed_in(brain)
    sonars = _sonars(brain)
    fresh = RatSlam(brain.params, np.random.default_rng(0), sonar_angles_rad=sonars, **handed)
    same_kind("brain", brain, fresh)
    _agree(brain, handed)
    _are_the_brains(brain)
    if "pose_cells" not in handed:
        _pose_cells(brain.pose_cells, fresh.pose_cells)
    if _is_ours(brain.local_view):
        local_view(brain.local_view)
    views, shape = len(brain.local_view), brain.pose_cells.shape
    view_links(brain.view_links, views, math.prod(shape))
    if "experience_map" not in handed:
        experience_map(brain.experience_map, views)
    association = brain.association
    learnt(association._learnt_s, views, number("time", association._time_s, 0.0, LARGEST))
    number("learning rate", association.learning_rate, 0.0, 2.0)
    _goal_memory(brain.goal_memory, number("time under way", brain.memories._under_way_s, 0.0, LARGEST))
    if brain.occupancy is not None and brain.map_grid is not None:
        within("log odds", array("log odds", brain.occupancy._log_odds, np.float32, shape[1:]), -BOUND, BOUND)
        _map_grid(brain.map_grid, len(brain.experience_map), len(sonars))
    if brain.scans is not None:
        _scan_matching(brain.scans, len(brain.experience_map), len(sonars))
    _echo_closures(brain.echo_closures, len(brain.experience_map))
    if isinstance(brain.kidnap_detector, KidnapDetector):
        _kidnap_detector(brain.kidnap_detector, len(brain.experience_map), len(sonars))
    whole("relocalisations", brain.relocalisations)
    beats(brain.beats)


def _sonars(brain: RatSlam) -> tuple[float, ...]:
    """The angles that a brain like this one is made with; none when there is no occupancy."""
    true((brain.occupancy is None) == (brain.map_grid is None), "both pictures of occupancy must be there, or none")
    if brain.occupancy is None:
        return ()
    angles = array("sonar angles", brain.occupancy._angles, np.float64, (None,))
    true(angles.size <= MOST_SONARS, f"there are {angles.size} sonars; at most {MOST_SONARS}")
    within("a sonar's angle", angles, -100.0, 100.0)
    return tuple(angles.tolist())


def _is_ours(part: object) -> bool:
    return type(part).__module__.split(".")[0] == RatSlam.__module__.split(".")[0]


def _handed_in(brain: RatSlam) -> dict[str, Any]:
    """The parts whose class is not ours. Such a part is checked by its own method `check`, if it has one."""
    parts: dict[str, Any] = {name: getattr(brain, name) for name in ("local_view", "pose_cells", "kidnap_detector")}
    parts |= {"experience_map": brain.experience_map, "optimiser": getattr(brain.experience_map, "optimiser", None)}
    handed = {name: part for name, part in parts.items() if part is not None and not _is_ours(part)}
    for part in handed.values():
        getattr(part, "check", lambda: None)()
    front_end = getattr(brain.local_view, "front_end", None)
    if "local_view" not in handed and not _is_ours(front_end):
        handed["local_view"] = LocalView(brain.params.local_view, front_end=front_end)
    return handed


def _agree(brain: RatSlam, handed: dict[str, Any]) -> None:
    """All parts have the brain's parameters, and the shape and cell size of its pose cells."""
    p = brain.params
    parts: list[tuple[Any, object]] = [
        (brain.view_links, p.local_view), (brain.association, p.local_view), (brain.goal_memory, p.goal_memory),
        (brain.localisation, p.pose_cells), (brain.memories, p.occupancy),
    ]  # fmt: skip
    of_ours = (("pose_cells", p.pose_cells), ("local_view", p.local_view), ("experience_map", p.experience_map))
    parts += [(getattr(brain, name), own) for name, own in of_ours if name not in handed]
    for part, own in parts:
        true(part.params == own, f"the parameters of {type(part).__name__} must be the brain's")
    shape, cell_m = (p.pose_cells.n_theta, p.pose_cells.n_y, p.pose_cells.n_x), p.pose_cells.cell_m
    cells = [getattr(brain, name) for name in ("pose_cells", "experience_map") if name not in handed]
    for part in (*cells, brain.goal_memory):
        true(part.shape == shape, f"the shape of {type(part).__name__} must be {shape}, got {part.shape}")
    maps = [brain.experience_map] if "experience_map" not in handed else []
    lengths: list[Any] = [part for map_ in maps for part in (map_.evidence, map_.pose_filter)]
    for part in (*maps, *lengths, brain.goal_memory, *((brain.occupancy,) if brain.occupancy else ())):
        true(part.cell_m == cell_m, f"a cell of {type(part).__name__} must be {cell_m} m wide")


def _are_the_brains(brain: RatSlam) -> None:
    """What holds parts of the brain holds no others."""
    cells, memories = brain.localisation, brain.memories
    moved = cells.pose_cells is brain.pose_cells and cells.association is brain.association
    true(moved, "the brain moves other pose cells")
    held = (memories.goal_memory, memories.occupancy, memories.map_grid)
    own = (brain.goal_memory, brain.occupancy, brain.map_grid)
    true(all(a is b for a, b in zip(held, own, strict=True)), "the brain learns in other memories")


def _pose_cells(cells: PoseCells, fresh: PoseCells) -> None:
    """fresh: a network that was just made with the same parameters."""
    _buffers(cells)
    _derived(cells, fresh)
    _activity(cells)
    _packets(cells)


def _buffers(cells: PoseCells) -> None:
    p = cells.params
    true(cells.shape == (p.n_theta, p.n_y, p.n_x), f"the pose cells' shape must be {(p.n_theta, p.n_y, p.n_x)}")
    room = len(array("cells", cells._cells, np.int32, (None, 4)))
    array("slot", cells._slot, np.int32, (p.n_theta * p.n_y * p.n_x,))
    array("spare cells", cells._spare_cells, np.int32, (room, 4))
    for name in ("_values", "_spare_values"):
        array(name[1:], getattr(cells, name), np.float32, (room,))
    for name in ("_owner", "_peaks"):
        array(name[1:], getattr(cells, name), np.int32, (room,))
    array("bounds", cells._bounds, np.int8, (room, 6))


def _derived(cells: PoseCells, fresh: PoseCells) -> None:
    """Arrays that follow from the parameters, and scratch arrays between two steps."""
    for name in ("_patch", "_headings", "_excite"):
        wanted = getattr(fresh, name)
        found = array(name[1:], getattr(cells, name), wanted.dtype, wanted.shape)
        true(np.array_equal(found, wanted), f"{name[1:]} must be as in a network that was just made")
    for name in ("_box_a", "_box_b"):
        array(name[1:], getattr(cells, name), np.float32, getattr(fresh, name).shape)


def _activity(cells: PoseCells) -> None:
    n_theta, n_y, n_x = cells.shape
    n = whole("the number of active cells", cells._n, 1, min(len(cells._cells), cells._slot.size))
    rows, values = cells.active
    for column, size in ((kernels.X, n_x), (kernels.Y, n_y), (kernels.THETA, n_theta)):
        within(f"column {column} of the active cells", rows[:, column], 0, size - 1)
    x, y, theta, flat = rows.astype(np.int64).T
    true((flat == (theta * n_y + y) * n_x + x).all(), "each active cell's index must be that of its place")
    true((cells._slot[flat] == np.arange(1, n + 1)).all(), "slot must name the row of each active cell")
    true(np.count_nonzero(cells._slot) == n, "slot must name no cell that is not active")
    within("activity", values, 0.0, MOST_ACTIVITY)
    number("the sum of all activity", float(values.sum(dtype=np.float64)), 0.99, MOST_ACTIVITY)


def _packets(cells: PoseCells) -> None:
    k, spare = len(array("packets", cells._rows, np.float64, (None, packet_kernels.ROW))), len(cells._spare_rows)
    array("spare packets", cells._spare_rows, np.float64, (None, packet_kernels.ROW))
    ids = array("ids", cells._ids, np.int64, (k,))
    array("spare ids", cells._spare_ids, np.int64, (spare,))
    found = whole("the number of packets", cells._found, 1, min(k, cells._n))
    within("owner", cells._owner[: cells._n], 0, found - 1)
    within("ids", ids[:found], 1, np.iinfo(np.int32).max)
    rows = cells._rows[:found]
    for axis in range(3):
        within("a packet's place", rows[:, axis], 0.0, cells.shape[2 - axis])
    within("a packet's mass", rows[:, packet_kernels.MASS], 0.0, MOST_ACTIVITY)
    within("a packet's headings", rows[:, [packet_kernels.COS, packet_kernels.SIN]], -1.001, 1.001)


def _goal_memory(memory: GoalMemory, now_s: float) -> None:
    """now_s: for how long the robot has been under way."""
    plane = memory.shape[1] * memory.shape[2]
    place = array("the plane", memory._place, np.int32, (plane,))
    true(not place.any(), "the plane must be empty between two steps")
    keys = array("keys", memory._keys, np.int64, (None,))
    times = array("times", memory._times, np.float32, keys.shape)
    true(keys.size & (keys.size - 1) == 0, f"the table must have a power of two of places, got {keys.size}")
    used = keys != FREE
    links = whole("the number of links", memory._used, 0, keys.size // 2)
    true(links == np.count_nonzero(used), f"there must be as many keys as links, {links}")
    within("a key", keys[used], 0, plane * plane - 1)
    true((keys[used] // plane < keys[used] % plane).all(), "a key must name two cells, the smaller first")
    true(misplaced(keys) < 0, "each key must lie where it is looked for")
    within("a time", times[used], 0.0, float(np.finfo(np.float32).max))
    if memory._last is not None:
        _iteration(memory._last, memory.shape, now_s)


def _iteration(last: _Iteration, shape: tuple[int, int, int], now_s: float) -> None:
    true(isinstance(last, _Iteration), "the last iteration must be one")
    flats = array("what was active", last.flats, np.int64, (None,))
    true(len(np.unique(flats)) == len(flats) <= MOST_LIT, f"at most {MOST_LIT} cells were active, each once")
    within("what was active", flats, 0, shape[1] * shape[2] - 1)
    activity = array("its activity", last.activity, np.float64, flats.shape)
    within("its activity", activity, float(np.finfo(np.float32).tiny), 1e6)
    number("its x", last.x, 0.0, shape[2])
    number("its y", last.y, 0.0, shape[1])
    number("its time", last.time_s, 0.0, number("its latest time", last.latest_s, 0.0, now_s))


def _map_grid(grid: MapGrid, experiences: int, sonars: int) -> None:
    within("a sonar's angle", array("sonar angles", grid._angles, np.float64, (sonars,)), -100.0, 100.0)
    count = array("counts of scans", grid._count, np.int64, (None,))
    scans = array("scans", grid._scans, np.float32, (len(count), KEPT, 3 + sonars))
    known = whole("experiences with scans", grid._known, 0, min(len(count), experiences))
    within("a count of scans", count, 0, MOST)
    true(not count[known:].any(), f"only the first {known} experiences may have scans")
    real = scans[:known][np.arange(KEPT) < count[:known, None]]
    within("where a scan was made", real[:, :3], -FAR_M, FAR_M)
    within("a range", real[:, 3:], 0.0, math.inf)


def _scan_matching(scans: ScanMatching, experiences: int, sonars: int) -> None:
    within("a sonar's angle", array("sonar angles", scans._angles, np.float64, (sonars,)), -100.0, 100.0)
    since = array("the counts at which experiences were made", scans._since, np.int64, (None,))
    true(len(since) >= experiences, f"there must be a count for each of {experiences} experiences, got {len(since)}")
    kept = whole("scans of the way here", scans._count)
    within("the count at which an experience was made", since, 0, kept)
    whole("the first scan since it was carried", scans._begun, 0, kept)
    within("a range", array("scans of experiences", scans._scans, np.float32, (len(since), sonars)), 0.0, math.inf)
    within("a range", array("scans of the way here", scans._recent, np.float64, (RECENT, sonars)), 0.0, math.inf)
    within("where a scan was made", array("places of scans", scans._from, np.float64, (RECENT, 3)), -FAR_M, FAR_M)
    pose("where odometry has led", scans._at)
    if scans._scan is not None:
        within("the newest scan", array("the newest scan", scans._scan, np.float64, (sonars,)), 0.0, math.inf)


def _echo_closures(closures: EchoClosures, experiences: int) -> None:
    whole("ties by echoes", closures.count)
    whole("scans kept at a match", closures._at)
    if closures._moved is not None:
        pose("what a match said", closures._moved)
    true(isinstance(closures.last, tuple) and len(closures.last) == 2, "a tie has two ends")
    for end in closures.last:
        whole("the end of a tie", end, -1, max(experiences - 1, -1))


def _kidnap_detector(detector: KidnapDetector, experiences: int, sonars: int) -> None:
    whole("known before", detector._known_before, 0, experiences)
    whole("agreed", detector._agreed)
    whole("settled", detector._settled)
    number("the usual change", detector._usual, 0.0, MOST_USUAL)
    last = detector._scans._last
    if last is not None:
        true(sonars > 0, "a brain without sonars has no last scan")
        within("the last scan", array("the last scan", last, np.float64, (sonars,)), 0.0, math.inf)


def beats(beats: Beats) -> None:
    """ValueError names the first law that does not hold."""
    true(isinstance(beats, Beats), f"the beats are a {type(beats).__name__}")
    true(isinstance(beats._begun, bool), "beats have begun or not")
    number("the part of a beat that is over", beats._over, -EARLY - ROUNDING, 1.0)
    number("the way since the last beat", beats._distance_m, -FAR_M, FAR_M)
    number("the turn since the last beat", beats._turn_rad, -FAR_M, FAR_M)
    number("the time since the last beat", beats._time_s, 0.0, FAR_M)
