"""The made-up office: how it is drawn, where the robot fits in it, goes in it, and what it sees and hears there."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sim2d import FreeSpace, Start, Wall, World
from sim2d.world.free_space import RobotFit
from web.messages import Pose, Senses, WorldDrawing

SONAR_RAD = np.radians([-90, -50, -30, -10, 10, 30, 50, 90]).astype(np.float32)
FOV_RAD = math.radians(90)
DESKS = [(2.0, 5.4, 3.6, 6.0), (1.6, 2.1, 2.8, 2.7), (2.8, 2.1, 4.0, 2.7), (6.4, 5.0, 8.1, 5.7), (6.35, 2.6, 7.0, 3.3)]
DESKS += [(6.35, 1.8, 7.0, 2.5)]
PARTITIONS = [(1.5, 5.3, 3.9, 5.3), (1.5, 2.0, 4.1, 2.0), (2.8, 2.0, 2.8, 3.4), (7.2, 5.7, 7.2, 6.7)]
PARTITIONS += [(6.3, 1.7, 6.3, 3.8), (6.3, 2.55, 8.2, 2.55)]
_PALETTE = [(230, 159, 0), (86, 180, 233), (0, 158, 115), (240, 228, 66), (0, 114, 178), (213, 94, 0), (204, 121, 167)]
STEP_M = 0.03  # the robot's way in a tick
_STOPS = [(0.8, 0.8), (5.0, 0.8), (9.1, 0.8), (0.8, 4.1), (4.9, 3.9), (9.1, 4.2), (0.8, 7.2), (5.0, 7.2), (9.1, 7.2)]
_STOPS += [(2.4, 4.2), (8.6, 1.6), (7.3, 4.2), (5.2, 5.6), (2.5, 1.0), (3.0, 7.1)]


def frozen(array: NDArray) -> NDArray:  # type: ignore[type-arg]
    """One that nobody can write to, as those of real snapshots are."""
    array.setflags(write=False)
    return array


@lru_cache(maxsize=1)
def office() -> WorldDrawing:
    rows: list[tuple[float, float, float, float]] = [(0, 0, 10, 0), (10, 0, 10, 8), (10, 8, 0, 8), (0, 8, 0, 0)]
    heights, kinds = [2.5] * 4, ["wall"] * 4
    rows += PARTITIONS
    heights += [1.4] * len(PARTITIONS)
    kinds += ["partition"] * len(PARTITIONS)
    for x1, y1, x2, y2 in DESKS:
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
        name="office", title="Office, 10 x 8 m", bounds=(0.0, 0.0, 10.0, 8.0), walls=frozen(np.array(rows, np.float32)),
        wall_height_m=frozen(np.array(heights, np.float32)), wall_kind=tuple(kinds),
        panels=frozen(np.array(panels, np.float32)), panel_rgb=frozen(np.array(colours, np.uint8)),
        places=(("printer", 9.1, 7.2), ("kitchen", 0.8, 0.8), ("desk of Ada", 4.9, 3.9)), robot_radius_m=0.2,
        camera_fov_rad=FOV_RAD, sonar_angles_rad=frozen(SONAR_RAD.copy()),
    )  # fmt: skip


@lru_cache(maxsize=1)
def office_fit() -> RobotFit:
    """The same check of fit as in a real session, over the same walls."""
    drawn = office()
    walls = [
        Wall(*map(float, row), kind, float(height), (0, 0, 0), outer=i < 4)
        for i, (row, kind, height) in enumerate(zip(drawn.walls, drawn.wall_kind, drawn.wall_height_m, strict=True))
    ]
    start = Start("here", 5.0, 0.8, 0.0)
    return RobotFit(FreeSpace(World("office", drawn.title, "", tuple(walls), (start,), ()), drawn.robot_radius_m))


@lru_cache(maxsize=1)
def long_walk() -> NDArray[np.float64]:
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
    points = a + np.linspace(0, 1, 40)[:, None] * (b - a)
    low, high = np.sort(np.array(DESKS + PARTITIONS).reshape(-1, 2, 2), axis=1).transpose(1, 0, 2)
    inside = (low - 0.35 < points[:, None]) & (points[:, None] < high + 0.35)
    return math.dist(a, b) <= 5.5 and not inside.all(axis=2).any()


def positions(ticks: NDArray[np.int64]) -> NDArray[np.float64]:
    way = long_walk()
    arc = (ticks * STEP_M / 0.05) % (len(way) - 2)
    low = arc.astype(int)
    return way[low] + (arc - low)[:, None] * (way[low + 1] - way[low])


def truth_at(tick: int) -> Pose:
    here, ahead = positions(np.array([tick, tick + 3]))
    return Pose(float(here[0]), float(here[1]), math.atan2(ahead[1] - here[1], ahead[0] - here[0]))


def senses_at(tick: int, truth: Pose) -> Senses:
    camera = _camera(truth)
    template = _shrink(camera)
    wobble = np.random.default_rng(tick // 5).normal(0, 5, template.shape)
    best = np.clip(template + wobble, 0, 255).astype(np.uint8)
    difference = float(np.abs(best.astype(float) - template).mean())
    view = (tick // 7 * 37) % 600
    return Senses(
        camera=frozen(camera), front_end="template", seen=frozen(template.astype(np.uint8)), best=frozen(best),
        seen_words="12 x 8 grey levels", best_words="12 x 8 grey levels", best_view=view, active_view=view,
        difference=difference, threshold=8.0, recruited=tick % 70 < 3, false_positive=False, false_positives=0,
        ranges_m=frozen(np.minimum(_cast(truth, truth.heading_rad + SONAR_RAD)[0], 4.0).astype(np.float32)),
    )  # fmt: skip


def _shrink(camera: NDArray[np.uint8]) -> NDArray[np.float64]:
    grey = camera.mean(2)
    columns = np.array_split(np.arange(grey.shape[1]), 12)
    return np.stack([grey[:, c].reshape(8, -1, len(c)).mean((1, 2)) for c in columns], 1)


def _cast(pose: Pose, angles: NDArray[np.floating]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Distance to the nearest wall along each angle, and its row."""
    walls = office().walls.astype(float)
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
    height = office().wall_height_m[row]
    image = np.empty((48, 64, 3))
    image[:24], image[24:] = 205, 92
    base = np.array([(150 + 60 * math.sin(k * 2.1), 150 + 50 * math.sin(k * 1.3), 140 + 50 * math.cos(k)) for k in row])
    shade = np.clip(1.15 - gap / 9, 0.3, 1)
    v = np.arange(48)[:, None]
    inside = (v > 24 - (height - 0.5) / gap * 30) & (v < 24 + 0.5 / gap * 30)
    return np.where(inside[..., None], (base * shade[:, None])[None], image).astype(np.uint8)
