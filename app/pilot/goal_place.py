"""Which experiences a place of the map stands for as a goal. ACRA 2005 3.6."""

from __future__ import annotations

import numpy as np

from app.pilot.params import RouteParams
from ratslam_core import ExperienceMap


def at_place(experiences: ExperienceMap, x: float, y: float, p: RouteParams) -> tuple[int, ...]:
    """The experiences that stand for the place (x, y), m, map frame, the nearest first. ValueError off the map.

    A place has several, since the robot made one for each way that it faced and for each way that it came. They are those
    within `goal_place_m` of the one nearest to (x, y), on its island. If some of these lie on the robot's own island, and
    thus can be reached, the nearest of them takes its place. With `goal_place_m` 0 the nearest stands alone.
    test_goal_place.py::{test_whichever_way_they_face, test_what_can_be_reached_comes_first}.
    """
    poses = experiences.poses
    away = np.hypot(poses[:, 0] - x, poses[:, 1] - y)
    nearest = int(np.argmin(away))
    reach = p.goal_reach_m
    if not away[nearest] <= reach:  # written so that NaN is refused, too
        raise ValueError(
            f"({x:g}, {y:g}) is off the map: the nearest experience is {away[nearest]:.1f} m away, "
            f"at ({poses[nearest, 0]:.1f}, {poses[nearest, 1]:.1f}); choose a place within {reach:g} m of one"
        )
    if p.goal_place_m <= 0:
        return (nearest,)
    apart = np.hypot(poses[:, 0] - poses[nearest, 0], poses[:, 1] - poses[nearest, 1])
    near = np.flatnonzero(apart <= p.goal_place_m)
    own = experiences.island_of[near] == experiences.island_of[experiences.active]
    near = near[own] if own.any() else near[experiences.island_of[near] == experiences.island_of[nearest]]
    return tuple(near[np.argsort(away[near], kind="stable")].tolist())
