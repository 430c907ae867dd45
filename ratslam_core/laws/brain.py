"""What is true of a whole brain: of each part, and between the parts."""

# Laws look at all of a state, and take nothing for granted.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ratslam_core.extensions.kidnap_detector import MOST_USUAL, KidnapDetector
from ratslam_core.laws import memories
from ratslam_core.laws.beats import beats
from ratslam_core.laws.experience_map import LONGEST, experience_map
from ratslam_core.laws.kinds import same_kind
from ratslam_core.laws.measures import array, number, true, whole, within
from ratslam_core.laws.pose_cells import pose_cells
from ratslam_core.laws.views import learnt, local_view, view_links
from ratslam_core.local_view.recogniser import LocalView
from ratslam_core.params import RatSlamParams
from ratslam_core.slam import RatSlam


def check(brain: RatSlam) -> None:
    """ValueError names the first law that does not hold."""
    same_kind("params", brain.params, RatSlamParams())
    handed = _handed_in(brain)
    fresh = RatSlam(brain.params, np.random.default_rng(0), sonar_angles_rad=_sonars(brain), **handed)
    same_kind("brain", brain, fresh)
    _agree(brain, handed)
    _are_the_brains(brain)
    if "pose_cells" not in handed:
        pose_cells(brain.pose_cells, fresh.pose_cells)
    if _is_ours(brain.local_view):
        local_view(brain.local_view)
    views, shape = len(brain.local_view), brain.pose_cells.shape
    view_links(brain.view_links, views, math.prod(shape))
    if "experience_map" not in handed:
        experience_map(brain.experience_map, views)
    association = brain.association
    learnt(association._learnt_s, views, number("time", association._time_s, 0.0, LONGEST))
    number("learning rate", association.learning_rate, 0.0, 2.0)
    memories.goal_memory(brain.goal_memory, number("time under way", brain.memories._under_way_s, 0.0, LONGEST))
    sonars = 0
    if brain.occupancy is not None and brain.map_grid is not None:
        sonars = memories.occupancy(brain.occupancy, shape)
        memories.map_grid(brain.map_grid, len(brain.experience_map), sonars)
    if isinstance(brain.kidnap_detector, KidnapDetector):
        _kidnap_detector(brain.kidnap_detector, len(brain.experience_map), sonars)
    whole("relocalisations", brain.relocalisations)
    beats(brain.beats)


def _sonars(brain: RatSlam) -> tuple[float, ...]:
    """The angles that a brain like this one is made with; none when there is no occupancy."""
    true((brain.occupancy is None) == (brain.map_grid is None), "both pictures of occupancy must be there, or none")
    if brain.occupancy is None:
        return ()
    angles = array("sonar angles", brain.occupancy._angles, np.float64, (None,))
    true(angles.size <= memories.MOST_SONARS, f"there are {angles.size} sonars; at most {memories.MOST_SONARS}")
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
    true(
        cells.pose_cells is brain.pose_cells and cells.association is brain.association,
        "the brain moves other pose cells",
    )
    held = (memories.goal_memory, memories.occupancy, memories.map_grid)
    own = (brain.goal_memory, brain.occupancy, brain.map_grid)
    true(all(a is b for a, b in zip(held, own, strict=True)), "the brain learns in other memories")


def _kidnap_detector(detector: KidnapDetector, experiences: int, sonars: int) -> None:
    whole("known before", detector._known_before, 0, experiences)
    whole("agreed", detector._agreed)
    whole("settled", detector._settled)
    number("the usual change", detector._usual, 0.0, MOST_USUAL)
    last = detector._scans._last
    if last is not None:
        true(sonars > 0, "a brain without sonars has no last scan")
        within("the last scan", array("the last scan", last, np.float64, (sonars,)), 0.0, float("inf"))
