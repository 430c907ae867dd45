"""What vision does to the pose cells: nothing without it, nothing of views too young, and how fast it is learnt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from disk import encode
from ratslam_core import (
    ExperienceMapParams,
    LocalViewParams,
    Odometry,
    Packet,
    PoseCellParams,
    PoseCells,
    RatSlamParams,
    Recognition,
)
from ratslam_core.beats import Tick
from ratslam_core.local_view.view_links import VisualAssociation
from ratslam_core.localisation import Localisation
from tests.unit.ratslam_core import literal
from tests.unit.ratslam_core.drives import LAP, RADIUS_M, STEP_RAD, start


def test_without_vision_there_is_path_integration_only() -> None:
    params = RatSlamParams(local_view=LocalViewParams(enabled=False))
    params = replace(params, experience_map=replace(params.experience_map, calibrate=False))
    circle, brain = start(params=params)
    alone = PoseCells()
    alone.step(speed=0.0, yaw_rate=0.0, dt=0.1)
    for estimate in circle.advance(brain, LAP + 50):
        packet = alone.step(speed=RADIUS_M * STEP_RAD / 0.1, yaw_rate=STEP_RAD / 0.1, dt=0.1)
        assert estimate.packet == packet
        assert not estimate.relocalised
    assert len(brain.local_view) == 0


def test_a_young_view_does_not_hold_the_packet_back() -> None:
    """While a view is too young to inject, the pose cells move as if it were not there."""
    plain = ExperienceMapParams(calibrate=False)
    seeing, blind = (
        start(params=RatSlamParams(local_view=LocalViewParams(rest=r, enabled=e), experience_map=plain))
        for r, e in [(1e6, True), (0, False)]
    )
    for _ in range(80):
        a, b = seeing[0].advance(seeing[1], 1)[0], blind[0].advance(blind[1], 1)[0]
        assert a.packet == b.packet


def seen(view: int, recruited: bool = False) -> Recognition:
    return Recognition(view, recruited, view, 1.0)


def injected(association: VisualAssociation, what: Recognition, pose_cells: PoseCells, dt: float = 0.5) -> float:
    """How much activity a step adds. The pose cells then rest."""
    association.step(what, 1.0, dt, pose_cells, False)
    more = float(pose_cells.active[1].sum(dtype=np.float64)) - 1.0
    pose_cells.settle()
    return more


def test_a_view_injects_from_the_moment_it_is_as_old_as_rest() -> None:
    """Each has its own age, and learns from the first."""
    association, pose_cells = (
        VisualAssociation(LocalViewParams(rest=2.0, learning_rate=0.01, saturation=1.0)),
        PoseCells(),
    )
    # at 0.5, 1.0 ... seconds
    views = [(0, True), (0, False), (1, True), (0, False), (0, False), (1, False), (1, False)]
    amounts = [injected(association, seen(*one), pose_cells) for one in views]
    assert amounts == pytest.approx([0, 0, 0, 0, 0.04, 0, 0.03], abs=1e-6)
    learnt = association.links.of(0)[1].sum()
    assert learnt == pytest.approx(0.04, rel=1e-3)


def test_what_was_injected_is_told_and_is_no_part_of_the_state() -> None:
    association, pose_cells = VisualAssociation(LocalViewParams(rest=0.0)), PoseCells()
    injected(association, seen(0, True), pose_cells)
    for _ in range(3):
        more = injected(association, seen(0), pose_cells)
        told = association.injection
        assert told is not None
        assert told.view == 0
        assert float(told.values.sum(dtype=np.float64)) == pytest.approx(more, abs=1e-6)
        assert set(told.cells.tolist()) <= set(association.links.of(0)[0].tolist())
    assert association.age_s(0) == pytest.approx(1.5)
    before = encode(association).digest()
    assert injected(association, seen(-1), pose_cells, 1e-300) == pytest.approx(0, abs=1e-6)
    assert association.injection is None
    assert encode(association).digest() == before  # nothing seen changes nothing


def test_a_view_learns_and_then_injects_what_it_has_learnt() -> None:
    params = LocalViewParams(rest=0.0, learning_rate=0.01, decay=0.0, saturation=1.0)
    association, pose_cells = VisualAssociation(params), PoseCells()
    for sight in range(1, 4):
        assert injected(association, seen(0, sight == 1), pose_cells) == pytest.approx(0.01 * sight, abs=1e-6)
        assert association.links.of(0)[1].sum() == pytest.approx(0.01 * sight, abs=1e-6)


def test_the_adaptive_rate_follows_vision_and_confidence() -> None:
    """It is twice the rate times strength times confidence, and none while the robot is lost. The fixed rate is fixed."""
    two = np.zeros(PoseCells().shape)
    two[3, 10, 10], two[20, 40, 40] = 0.6, 0.4
    for adaptive, strength, lost, rate in (
        (True, 1.0, False, 0.6), (True, 0.25, False, 0.15), (True, 1.0, True, 0.0), (False, 0.25, False, 0.5)
    ):  # fmt: skip
        pose_cells = PoseCells()
        literal.fill(pose_cells, two)
        pose_cells.settle()
        association = VisualAssociation(LocalViewParams(adaptive=adaptive, learning_rate=0.5))
        association.step(seen(0, True), strength, 0.1, pose_cells, lost)
        assert association.learning_rate == pytest.approx(rate)
        assert association.links.of(0)[1].sum() == pytest.approx(rate)


def test_what_is_seen_after_several_beats_is_seen_in_the_last_of_them() -> None:
    """The attractor runs in between. At 10 Hz a tick is one beat, and this is the papers' order."""
    order = list[str]()

    class Cells:
        winner = Packet(0.0, 0.0, 0.0, 1.0)

        def integrate(self, *_way: float) -> None:
            order.append("integrate")

        def attract(self) -> Packet:
            order.append("attract")
            return self.winner

        def cells_apart(self, *_ends: float) -> float:
            return 0.0

    class Association:
        def step(self, *_seen: object) -> None:
            order.append("associate")

    robot = Localisation(Cells(), Association(), PoseCellParams())  # type: ignore[arg-type]
    for beats, expected in (
        (1, ["associate", "integrate", "attract"]),
        (2, ["integrate", "attract", "associate", "attract", "associate", "integrate", "attract"]),
    ):
        order.clear()
        moved = Odometry(0.3, 0.0, 0.1)
        robot.step(Recognition(3, False, 3, 0.0, None), 1.0, Tick(beats, moved, moved, 0.0), False, lambda _stage: None)
        assert order == expected
