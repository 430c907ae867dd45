"""The laws of `ratslam_core.laws` hold for running brains, whatever happens to them, and for those read from a file."""

from __future__ import annotations

import numpy as np
import pytest

from app.config import Config
from app.protocol.steps import spread_goals
from app.session import Session
from ratslam_core import laws, restore_snapshot, take_snapshot
from sim2d import load_world

ROBOTS = {
    "as it is": {},
    "complex cells on a small torus": {"local_view.front_end": "complex cells", "pose_cells.n_x": 16, "pose_cells.n_y": 13},
    "hue, shortcuts": {"local_view.front_end": "hue and saturation", "experience_map.shortcut_m": 0.5},
    "scene numbers": {"local_view.front_end": "scene numbers"},
    "links that are dropped": {"experience_map.link_trials": 1, "experience_map.link_confidence": 0.9},
    "false positives, every step solved": {"local_view.false_positives": 0.5, "experience_map.solve_every": 1,
                                           "local_view.rest": 0.0},
}  # fmt: skip


@pytest.mark.parametrize("robot", ROBOTS)
def test_they_hold_of_a_robot_that_drives_and_is_carried_off(robot: str) -> None:
    config = Config()
    for name, value in ROBOTS[robot].items():
        config = config.with_value(name, value)
    session = Session(load_world(), 3, config)
    laws.check(session.brain)
    for tick in range(160):
        if tick == 60:
            session.kidnap()
        if tick == 90:
            session.put_packet(x=3, y=4, heading_rad=1.0, share=0.9)
            laws.check(session.brain)
        if tick == 120:
            session.pilot.set_goal(spread_goals(session, 1)[0])
        session.tick()
        if tick % 40 == 0:
            laws.check(session.brain)
    laws.check(session.brain)
    laws.check(restore_snapshot(take_snapshot(session.brain)))


def test_many_packets_at_once_have_room_to_move() -> None:
    """The rows of packets swap with their spares; the arrays of their movements must have room for either."""
    session = Session(load_world(), 3)
    cells = session.brain.pose_cells
    rng = np.random.default_rng(5)
    for packets in (60, 12, 60):
        cells.place(1, 2, 3)
        cells.place(1, 2, 3)  # once more, so that the rows are swapped
        flat = np.sort(rng.choice(cells.slot.size, packets, replace=False)).astype(np.int32)
        cells.inject(flat, np.full(packets, 0.05, np.float32))
        cells.attract()
        laws.check(session.brain)
        cells.integrate(0.05, 0.01)
