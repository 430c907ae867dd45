"""Which experiences a place of the map stands for as a goal. ACRA 2005 3.6."""

from __future__ import annotations

import numpy as np

from app.pilot.params import PilotParams
from ratslam_core import ExperienceMap

GOAL_REACH_M = 1.5  # a goal farther than this from every experience is refused


def nearest_to(experiences: ExperienceMap, x: float, y: float) -> int:
    """The experience nearest to (x, y), m, map frame. ValueError off the map."""
    poses = experiences.poses
    away = np.hypot(poses[:, 0] - x, poses[:, 1] - y)
    nearest = int(np.argmin(away))
    reach = GOAL_REACH_M
    if not away[nearest] <= reach:  # written so that NaN is refused, too
        raise ValueError(
            f"({x:g}, {y:g}) is off the map: the nearest experience is {away[nearest]:.1f} m away, "
            f"at ({poses[nearest, 0]:.1f}, {poses[nearest, 1]:.1f}); choose a place within {reach:g} m of one"
        )
    return nearest


def of_its_place(experiences: ExperienceMap, experience: int, p: PilotParams) -> tuple[int, ...]:
    """The experiences that stand for the same place as this one, which comes first, the nearest before the others.

    A place has several, since the robot made one for each way that it faced and for each way that it came. They are those
    within `goal_place_m`, on the robot's own island; if none lies there, and thus can be reached, on the island of this
    one. With `goal_place_m` 0 it stands alone.
    test_goal_place.py::{test_whichever_way_they_face, test_what_can_be_reached_comes_first}.
    """
    if p.goal_place_m <= 0:
        return (experience,)
    poses, islands = experiences.poses, experiences.island_of
    apart = np.hypot(poses[:, 0] - poses[experience, 0], poses[:, 1] - poses[experience, 1])
    near = np.flatnonzero(apart <= p.goal_place_m)
    own = islands[near] == islands[experiences.active]
    near = near[own if own.any() else islands[near] == islands[experience]]
    order = np.lexsort((near != experience, apart[near]))  # some lie at exactly the same place
    return tuple(near[order].tolist())
