"""Put a packet of activity into the pose cells by hand and watch it compete. A demonstration: no sensor asks for it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.commands.outcome import Outcome, attempt
from app.engine.engine import Engine
from app.session import Session
from ratslam_core.pose_cells.attractor_kernels import gaussian
from ratslam_core.types import wrap_angle
from web.messages import InjectPacket

SIGMA, REACH = 1.2, 3  # in cells along x' and y', in layers along theta'


def inject_packet(engine: Engine, command: InjectPacket) -> Outcome:
    run = engine.run

    def inject() -> None:
        run.event_log.note("packet", put_packet(run.session, command))
        run.snapshots.walk = None  # it shows the pose cells as they were before the packet

    return attempt("x, y", (command.x, command.y), inject)


def put_packet(session: Session, command: InjectPacket) -> str:
    """Inject a packet, which competes from the next tick on. Returns what was done, in words. ValueError outside the
    pose cells.

    `command.share` is the packet's share of all activity once it is in.
    """
    pose_cells = session.brain.pose_cells
    n_theta, n_y, n_x = pose_cells.shape
    if not (command.x < n_x and command.y < n_y):
        raise ValueError(
            f"a pose cell has x from 0 to {n_x - 1} and y from 0 to {n_y - 1}, got {command.x} and {command.y}"
        )
    layer = round(wrap_angle(command.heading_rad) / math.tau * n_theta) % n_theta
    flat, value = _blob(pose_cells.shape, layer, command.y, command.x)
    value *= command.share / (1 - command.share) / value.sum()
    pose_cells.inject(flat, value.astype(np.float32))
    pose_cells.settle()
    return f"a packet of {command.share:.0%} put at cell ({command.x}, {command.y}) by hand"


def _blob(shape: tuple[int, int, int], layer: int, y: int, x: int) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """The cells (flat indices) within REACH of one cell, wrapped on the torus, and their Gaussian weights."""
    n_theta, n_y, n_x = shape
    around, weights = np.arange(-REACH, REACH + 1), gaussian(SIGMA, REACH).astype(np.float64)
    thetas, ys, xs = np.meshgrid((layer + around) % n_theta, (y + around) % n_y, (x + around) % n_x, indexing="ij")
    flat = ((thetas * n_y + ys) * n_x + xs).ravel().astype(np.int32)
    return flat, np.einsum("t,y,x->tyx", weights, weights, weights).ravel()
