"""What the robot sees and hears in the made-up office."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from web.messages import Pose, Senses

from .frozen import frozen
from .office import FOV_RAD, SONAR_RAD, office


def senses_at(tick: int, truth: Pose) -> Senses:
    camera = _camera(truth)
    template = _shrink(camera)
    wobble = np.random.default_rng(tick // 5).normal(0, 5, template.shape)
    best = np.clip(template + wobble, 0, 255).astype(np.uint8)
    difference = float(np.abs(best.astype(float) - template).mean())
    return Senses(
        camera=frozen(camera),
        front_end="template",
        seen=frozen(template.astype(np.uint8)),
        seen_words="12 x 8 grey levels",
        best=frozen(best),
        best_words="12 x 8 grey levels",
        best_view=(tick // 7 * 37) % 600,
        difference=difference,
        threshold=8.0,
        active_view=(tick // 7 * 37) % 600,
        recruited=tick % 70 < 3,
        false_positive=False,
        false_positives=0,
        ranges_m=frozen(np.minimum(_cast(truth, truth.heading_rad + SONAR_RAD)[0], 4.0).astype(np.float32)),
    )


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
