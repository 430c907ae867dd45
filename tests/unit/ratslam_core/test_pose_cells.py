from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from numpy.typing import NDArray

from ratslam_core import PoseCellParams, PoseCells
from ratslam_core.pose_cells import activity_kernels as kernels
from ratslam_core.pose_cells import attractor_kernels, packet_kernels

from . import literal

DT = 0.1
DEEP = 0.25  # metres in a cell


def settled(x: int = 32, y: int = 32, theta: int = 0, params: PoseCellParams | None = None) -> PoseCells:
    """A packet in the shape that the attractor gives it."""
    pose_cells = PoseCells(params)
    pose_cells.place(x, y, theta)
    rest(pose_cells, 60)
    return pose_cells


def rest(pose_cells: PoseCells, steps: int) -> None:
    for _ in range(steps):
        pose_cells.step(speed=0.0, yaw_rate=0.0, dt=DT)


def drive(pose_cells: PoseCells, cells_a_step: float, layers_a_step: float, steps: int) -> NDArray[np.float64]:
    """Drive and add up the winner's movement: x, y in cells, heading in layers."""
    n_theta, n_y, n_x = pose_cells.shape
    turn = layers_a_step * 2 * math.pi / n_theta / DT
    size = np.array([n_x, n_y, n_theta])
    way = np.zeros(3)
    before = where(pose_cells)
    for _ in range(steps):
        pose_cells.step(speed=cells_a_step * DEEP / DT, yaw_rate=turn, dt=DT)
        after = where(pose_cells)
        way += (after - before + size / 2) % size - size / 2
        before = after
    return way


def where(pose_cells: PoseCells) -> NDArray[np.float64]:
    winner = pose_cells.winner
    return np.array([winner.x, winner.y, winner.heading_rad * pose_cells.shape[0] / (2 * math.pi)])


# ---------------------------------------------------------------- path integration


@pytest.mark.parametrize("heading", [0.0, 1.7, 9.5, 23.2])  # layers: 0, 17, 95, 232 degrees
@pytest.mark.parametrize("cells_a_step", [*np.geomspace(0.01, 3.0, 9).tolist(), 1.0])
def test_gain_is_one_at_any_speed(cells_a_step: float, heading: float) -> None:
    pose_cells = turned_to(heading)
    steps = max(40, round(4 / cells_a_step))
    angle = pose_cells.winner.heading_rad
    way = drive(pose_cells, cells_a_step, 0.0, steps) / (steps * cells_a_step)
    assert way[:2] == pytest.approx([math.cos(angle), math.sin(angle)], abs=0.01)
    assert pose_cells.winner.heading_rad == pytest.approx(angle, abs=math.radians(0.5))


@pytest.mark.parametrize("layers_a_step", [-2.3, -1.0, -0.1, 0.01, 0.02, 0.4, 1.0, 3.0])
def test_gain_of_turning_is_one(layers_a_step: float) -> None:
    pose_cells = turned_to(0.6)
    steps = max(40, round(4 / abs(layers_a_step)))
    way = drive(pose_cells, 0.0, layers_a_step, steps)
    assert way[2] / (steps * layers_a_step) == pytest.approx(1.0, abs=0.01)
    assert np.abs(way[:2]).max() < 0.01


@pytest.mark.parametrize("layers_a_step", [-0.7, 0.05, 0.3, 1.4])
@pytest.mark.parametrize("cells_a_step", [0.02, 0.15, 1.0, 3.0])
def test_an_arc_ends_where_it_should(cells_a_step: float, layers_a_step: float) -> None:
    """Driving and turning at once gives a circle. Euler steps would end up to a cell beside it."""
    pose_cells = turned_to(2.7)
    heading, turn = pose_cells.winner.heading_rad, layers_a_step * 2 * math.pi / 36
    steps = max(40, round(8 / cells_a_step))
    way = drive(pose_cells, cells_a_step, layers_a_step, steps)
    end = cmath.exp(1j * heading) * cells_a_step * (cmath.exp(1j * turn * steps) - 1) / (1j * turn)
    assert abs(complex(way[0], way[1]) - end) < 0.01 * steps * cells_a_step
    assert way[2] == pytest.approx(steps * layers_a_step, rel=0.01)


def turned_to(layers: float) -> PoseCells:
    """A settled packet that heads between two layers."""
    pose_cells = settled(theta=int(layers))
    drive(pose_cells, 0.0, (layers - int(layers)) / 20, 20)
    rest(pose_cells, 60)
    return pose_cells


def test_every_packet_is_moved_not_only_the_winner() -> None:
    """Two hypotheses with different headings, both slow: each goes its own way with its own carry."""
    pose_cells = two_packets(20, 0.5, turned=9)
    rest(pose_cells, 5)
    starts = {p.id: p for p in pose_cells.packets}
    drive(pose_cells, 0.04, 0.0, 50)
    assert len(starts) == len(pose_cells.packets) == 2
    for packet in pose_cells.packets:
        start = starts[packet.id]
        way = packet.x - start.x, packet.y - start.y
        assert way == pytest.approx((2 * math.cos(start.heading_rad), 2 * math.sin(start.heading_rad)), abs=0.02)


def test_a_fast_packet_stays_one() -> None:
    """Its layers drift apart, but those that lag behind must not become a packet of their own."""
    pose_cells = turned_to(0.5)
    for _ in range(40):
        drive(pose_cells, 1.0, 0.0, 1)
        assert [p.id for p in pose_cells.packets] == [pose_cells.winner.id]


def test_without_carry_a_slow_packet_is_pinned() -> None:
    """The reason for `carry`: the attractor swallows part of a small shift."""
    with_carry, without = (
        drive(settled(params=PoseCellParams(carry=carry)), 0.03, 0.0, 200)[0] for carry in (True, False)
    )
    assert without < 0.97 * 200 * 0.03
    assert with_carry == pytest.approx(200 * 0.03, rel=0.01)


def test_standing_still_does_not_drift() -> None:
    pose_cells = settled(5, 60, 30)
    drive(pose_cells, 0.37, 0.21, 25)  # to somewhere between the cells
    rest(pose_cells, 40)  # settle there
    before, shape = where(pose_cells), pose_cells.activity
    rest(pose_cells, 1000)
    assert np.abs(where(pose_cells) - before).max() < 0.01
    assert np.abs(pose_cells.activity - shape).max() < 1e-3


@pytest.mark.parametrize(("speed", "yaw_rate"), [(0.5, 0.0), (0.3, 0.4), (-0.4, -0.7), (0.5, 1.3)])
def test_the_end_point_does_not_depend_on_the_rate(speed: float, yaw_rate: float) -> None:
    ends = []
    for rate in (5, 10, 50):
        pose_cells = settled()
        for _ in range(8 * rate):
            pose_cells.step(speed=speed, yaw_rate=yaw_rate, dt=1 / rate)
        ends.append(pose_cells.winner)
    for end in ends[:2]:
        assert pose_cells.cells_apart(end.x, end.y, ends[2].x, ends[2].y) < 1.0
        assert abs(math.remainder(end.heading_rad - ends[2].heading_rad, 2 * math.pi)) < math.radians(10)


# ---------------------------------------------------------------- the torus

FACES = {"+x": (0, 0.8, 0.0), "-x": (18, 0.8, 0.0), "+y": (9, 0.8, 0.0), "-y": (27, 0.8, 0.0)}
FACES |= {"+theta": (0, 0.0, 0.7), "-theta": (0, 0.0, -0.7), "corner": (4, 0.9, 0.3)}


@pytest.mark.parametrize("face", FACES)
def test_a_packet_crosses_every_face_unchanged(face: str) -> None:
    theta, forwards, turn = FACES[face]
    size = PoseCellParams(n_x=24, n_y=24, n_theta=36)
    inside, across = settled(3, 4, theta, size), settled(12, 12, theta, size)
    for step in range(60):  # 48 cells: twice around
        drive(inside, forwards, turn, 1)
        drive(across, forwards, turn, 1)
        shifted = np.roll(inside.activity, (8, 9), (1, 2))
        assert np.abs(across.activity - shifted).max() < 1e-5, f"step {step}"
        assert across.activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)
        assert across.winner.mass > 0.9


def test_a_packet_turns_through_the_last_layer_unchanged() -> None:
    """Layers are headings, so the plane turns with them: 9 layers make a quarter turn."""
    size = PoseCellParams(n_x=24, n_y=24, n_theta=36)
    inside, across = settled(12, 12, 14, size), settled(12, 12, 32, size)
    for _ in range(20):
        drive(inside, 0.0, 0.7, 1)
        drive(across, 0.0, 0.7, 1)
        assert np.abs(across.activity - np.roll(inside.activity, 18, 0)).max() < 1e-5


# ---------------------------------------------------------------- competition


def two_packets(apart: int, share: float, turned: int = 0) -> PoseCells:
    """The first has this share of the activity; the second is `apart` cells along x' and `turned` layers on."""
    one = settled().activity.astype(np.float64)
    pose_cells = PoseCells()
    literal.fill(pose_cells, share * one + (1 - share) * np.roll(one, (turned, apart), (0, 2)))
    return pose_cells


def test_two_packets_close_together_merge() -> None:
    pose_cells = two_packets(3, 0.5)
    rest(pose_cells, 100)
    assert len(pose_cells.packets) == 1
    assert pose_cells.winner.x == pytest.approx(33.5, abs=0.1)
    along_x = pose_cells.activity.sum((0, 1))
    assert np.argmax(along_x) in (33, 34)
    assert np.all(np.diff(along_x[30:34]) >= 0)
    assert np.all(np.diff(along_x[34:38]) <= 0)


@pytest.mark.parametrize("apart", [20, 32])
@pytest.mark.parametrize("share", [0.45, 0.6])
def test_two_packets_far_apart_compete_and_the_heavier_wins(apart: int, share: float) -> None:
    pose_cells = two_packets(apart, share)
    pose_cells.attract()
    assert len(pose_cells.packets) == 2
    assert sum(p.mass for p in pose_cells.packets) == pytest.approx(1.0, abs=1e-5)
    assert pose_cells.packets[0].mass > pose_cells.packets[1].mass
    rest(pose_cells, 400)
    assert len(pose_cells.packets) == 1
    assert pose_cells.winner.x == pytest.approx(32 if share > 0.5 else (32 + apart) % 64, abs=0.01)


def test_nothing_is_carried_over_when_another_packet_wins() -> None:
    """A jump of the winner is not a motion that the attractor swallowed."""
    pose_cells = settled()
    other = np.roll(pose_cells.activity, 20, 2)
    drive(pose_cells, 0.37, 0.0, 3)
    flats = np.flatnonzero(other)
    pose_cells.inject(flats.astype(np.int32), (3 * other.flat[flats]).astype(np.float32))
    pose_cells.attract()
    before = where(pose_cells)
    assert before[0] == pytest.approx(52, abs=0.01)
    rest(pose_cells, 1)
    assert np.abs(where(pose_cells) - before).max() < 0.005


def test_more_packets_than_can_be_reported() -> None:
    params = PoseCellParams(inhibit=0.0)
    pose_cells = PoseCells(params)
    dense = np.zeros(pose_cells.shape)
    dense[5, 10, 4::14] = 1.0
    dense[20, 40, 4::14] = np.arange(2, 7)
    literal.fill(pose_cells, dense / dense.sum())
    pose_cells.attract()
    masses = [p.mass for p in pose_cells.packets]
    assert len(masses) == 8
    assert masses == sorted(masses, reverse=True)
    assert masses[:5] == pytest.approx([0.24, 0.20, 0.16, 0.12, 0.08], abs=1e-3)


# ---------------------------------------------------------------- ids


def ids(pose_cells: PoseCells) -> list[int]:
    return [p.id for p in pose_cells.packets]


def test_a_packet_keeps_its_id_while_it_moves_wraps_and_turns() -> None:
    pose_cells = PoseCells()
    assert ids(pose_cells) == [1]
    for _ in range(150):  # 135 cells and 90 layers: around the torus in every direction
        drive(pose_cells, 0.9, 0.6, 1)
        assert ids(pose_cells) == [1]
    pose_cells.place(3, 4, 5)
    assert ids(pose_cells) == [1]


def test_ids_stay_when_packets_swap_rank() -> None:
    """The lighter of two packets gets activity while both drive on, so that they take turns in leading."""
    pose_cells = two_packets(20, 0.55, turned=18)
    pose_cells.attract()
    both = set(ids(pose_cells))
    led = []
    for _ in range(60):
        lighter = pose_cells.packets[1]
        flat = (round(lighter.heading_rad * 18 / math.pi) % 36 * 64 + round(lighter.y) % 64) * 64 + round(
            lighter.x
        ) % 64
        pose_cells.inject(np.array([flat], np.int32), np.array([0.05], np.float32))
        drive(pose_cells, 0.3, 0.4, 1)
        near = min(pose_cells.packets, key=lambda p: pose_cells.cells_apart(p.x, p.y, lighter.x, lighter.y))
        assert near.id == lighter.id
        assert set(ids(pose_cells)) == both
        led.append(pose_cells.winner.id)
    assert set(led) == both


@pytest.mark.parametrize("share", [0.4, 0.6])
def test_a_merged_packet_keeps_the_heavier_one_s_id(share: float) -> None:
    """The injection says that the robot is between the two."""
    pose_cells = two_packets(8, share)
    pose_cells.attract()
    left, right = sorted(pose_cells.packets, key=lambda p: p.x)
    between = np.roll(settled().activity, 4, 2)
    flats = np.flatnonzero(between).astype(np.int32)
    pose_cells.inject(flats, between.flat[flats])
    pose_cells.attract()
    assert ids(pose_cells) == [left.id if share > 0.5 else right.id]
    assert pose_cells.winner.x == pytest.approx(36, abs=1)


def test_the_least_free_number_is_used_again() -> None:
    pose_cells = two_packets(20, 0.6)
    pose_cells.attract()
    first, second = ids(pose_cells)
    for _ in range(5):
        rest(pose_cells, 400)
        assert ids(pose_cells) == [first]
        pose_cells.inject(np.array([7], np.int32), np.array([0.3], np.float32))
        pose_cells.attract()
        assert ids(pose_cells) == [first, second]
    assert {first, second} == {1, 2}


def test_a_packet_does_not_get_the_number_of_one_that_has_just_gone() -> None:
    pose_cells = PoseCells()
    pose_cells.place(3, 4, 5)
    pose_cells.attract()
    before = pose_cells.winner.id
    flats = np.flatnonzero(np.roll(pose_cells.activity, (18, 30), (0, 2))).astype(np.int32)
    pose_cells.inject(flats, np.full(flats.size, 1e5, np.float32))  # nothing of the old one is left
    pose_cells.attract()
    assert ids(pose_cells) != [before]
    rest(pose_cells, 3)
    assert len(ids(pose_cells)) == 1


def test_what_was_injected_is_a_packet_at_once() -> None:
    pose_cells = two_packets(20, 0.6)
    pose_cells.attract()
    known = pose_cells.packets
    pose_cells.inject(np.array([7], np.int32), np.array([0.5], np.float32))
    pose_cells.settle()
    assert pose_cells.active[1].sum() == pytest.approx(1.0)
    assert [p.id for p in pose_cells.packets] == [known[0].id, 3, known[1].id]
    assert [p.mass for p in pose_cells.packets] == pytest.approx([0.4, 1 / 3, 0.8 / 3], abs=0.02)
    new = pose_cells.packets[1]
    assert (new.x, new.y, new.heading_rad) == (7.0, 0.0, 0.0)


def test_ids_beyond_those_reported() -> None:
    """All packets are tracked: one that was too light to be reported appears with the id that it has always had."""
    pose_cells = PoseCells(PoseCellParams(inhibit=0.0))
    dense = np.zeros(pose_cells.shape)
    dense[5, 10, 4::14] = [8, 7, 6, 5, 4]
    dense[20, 40, 4::14] = [3.9, 3.8, 3.7, 3.6, 3.5]
    literal.fill(pose_cells, dense / dense.sum())
    pose_cells.attract()
    known = ids(pose_cells)
    assert len(known) == 8
    pose_cells.inject(np.array([(20 * 64 + 40) * 64 + 60], np.int32), np.array([0.5], np.float32))
    pose_cells.attract()
    newest = pose_cells.winner
    assert newest.id not in known
    assert newest.id == max(known) + 2  # as many were tracked


# ---------------------------------------------------------------- the attractor


def test_golden_numbers_of_the_attractor() -> None:
    """Stored results of another implementation: one unit of activity in one cell, standing still (docs: peers)."""
    params = PoseCellParams(
        n_x=21, n_y=21, n_theta=36, excite_sigma=1.0, excite_radius=3, inhibit=2e-5,
        local_inhibit=1.0, local_inhibit_sigma=2.0, local_inhibit_radius=2,
    )  # fmt: skip
    pose_cells = PoseCells(params)
    pose_cells.place(10, 10, 18)
    golden = {1: 0.113585533, 2: 0.064391511, 3: 0.051676944, 5: 0.044672531, 10: 0.042833774, 50: 0.042770436}
    for step in range(1, 51):
        pose_cells.step(speed=0.0, yaw_rate=0.0, dt=DT)
        if step in golden:
            assert pose_cells.activity.max() == pytest.approx(golden[step], abs=2e-7)
    activity = pose_cells.activity
    assert np.count_nonzero(activity) == 93
    along_x = activity.sum((0, 1), dtype=np.float64)
    assert math.sqrt(along_x @ (np.arange(21) - 10) ** 2) == pytest.approx(0.990, abs=0.001)


def test_growing_room_changes_nothing() -> None:
    """More cells become active than there was room for at first."""
    params = PoseCellParams(inhibit=0.0, n_x=24, n_y=24, n_theta=24)
    pose_cells = PoseCells(params)
    dense = np.random.default_rng(3).random(pose_cells.shape)
    dense /= dense.sum()
    literal.fill(pose_cells, dense)
    assert np.abs(pose_cells.activity - dense).max() < 1e-9
    pose_cells.attract()
    assert pose_cells.active[0].shape == (24**3, 4)
    assert pose_cells.activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)
    for axis in range(3):
        dense = sum(w * np.roll(dense, k - 2, axis) for k, w in enumerate(literal.gaussian(0.5, 2)))
    assert np.abs(pose_cells.activity - dense).max() < 1e-9


def test_active_slot_and_activity_say_the_same() -> None:
    pose_cells = settled(63, 0, 35)
    cells, values = pose_cells.active
    dense = np.zeros(pose_cells.shape, np.float32)
    dense[cells[:, kernels.THETA], cells[:, kernels.Y], cells[:, kernels.X]] = values
    assert np.array_equal(dense, pose_cells.activity)
    assert np.array_equal(np.flatnonzero(pose_cells.slot), np.sort(cells[:, kernels.FLAT]))
    assert np.array_equal(pose_cells.slot[cells[:, kernels.FLAT]], np.arange(len(cells)) + 1)


@pytest.mark.parametrize("local_inhibit", [0.0, 0.4])
def test_interpreted_kernels_do_what_the_compiled_ones_do(
    local_inhibit: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    params = PoseCellParams(n_x=9, n_y=8, n_theta=10, inhibit=1e-4, local_inhibit=local_inhibit)
    runs = []
    for interpreted in (False, True):
        if interpreted:
            literal.interpret(kernels, monkeypatch)
            literal.interpret(attractor_kernels, monkeypatch)
            literal.interpret(packet_kernels, monkeypatch)
        pose_cells = PoseCells(params)
        pose_cells.place(7, 7, 9)
        activity = []
        for forwards, turn in [(0.0, 0.0), (0.3, 0.2), (-1.7, 0.0), (0.0, -2.5), (1.0, 1.0)]:
            drive(pose_cells, forwards, turn, 1)
            pose_cells.inject(np.array([5, 300], np.int32), np.array([0.05, 0.02], np.float32))
            activity.append(pose_cells.activity)
        runs.append(np.array(activity))
    assert np.abs(runs[0] - runs[1]).max() < 1e-6


def test_interpreted_kernels_far_from_everything(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cells of one layer too far apart to be shifted together, a packet without activity near it, an invalid cell."""
    runs = []
    for interpreted in (False, True):
        if interpreted:
            literal.interpret(kernels, monkeypatch)
            literal.interpret(attractor_kernels, monkeypatch)
            literal.interpret(packet_kernels, monkeypatch)
        pose_cells = PoseCells()
        for forwards, row in ((0.4, 0), (0.0, 60), (1.3, 20)):
            flats = (np.array([0, 1, 20, 40, 41], np.int32) + row * 64).astype(np.int32)
            pose_cells.inject(flats, np.full(5, 0.1, np.float32))
            pose_cells.integrate(0.25 * forwards, 0.1)
            pose_cells._rows[pose_cells._found - 1, kernels.THETA] += 18
            pose_cells.attract()
        with pytest.raises(ValueError, match="got cell 5 with -1 in row 1"):
            pose_cells.inject(np.array([4, 5], np.int32), np.array([0, -1], np.float32))
        runs.append(pose_cells.activity)
    assert np.abs(runs[0] - runs[1]).max() < 1e-6


# ---------------------------------------------------------------- parameters and refusals


def test_live_parameters_act_at_once_and_the_size_is_fixed() -> None:
    pose_cells = settled()
    sharp = len(pose_cells.active[0])
    pose_cells.set_params(PoseCellParams(excite_sigma=1.0, excite_radius=3))
    rest(pose_cells, 30)
    assert len(pose_cells.active[0]) > sharp
    for other in ({"n_x": 65}, {"n_y": 63}, {"n_theta": 72}, {"cell_m": 0.5}):
        with pytest.raises(ValueError, match="size of the pose cells is fixed at 64 x 64 x 36 until a reset"):
            pose_cells.set_params(PoseCellParams(**other))


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_refused(bad: float) -> None:
    pose_cells = PoseCells()
    with pytest.raises(ValueError, match="speed must be a finite number, got"):
        pose_cells.step(speed=bad, yaw_rate=0.0, dt=DT)
    with pytest.raises(ValueError, match="yaw_rate must be a finite number, got"):
        pose_cells.step(speed=0.0, yaw_rate=bad, dt=DT)
    with pytest.raises(ValueError, match="dt must be a positive number of seconds, got"):
        pose_cells.step(speed=0.0, yaw_rate=0.0, dt=bad)
    assert pose_cells.activity[0, 32, 32] == 1.0  # nothing moved


@pytest.mark.parametrize("dt", [0.0, -0.1])
def test_time_must_pass(dt: float) -> None:
    with pytest.raises(ValueError, match=f"dt must be a positive number of seconds, got {dt}"):
        PoseCells().step(speed=0.0, yaw_rate=0.0, dt=dt)


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ((64, 0, 0), "x must be a cell from 0 to 63, got 64"),
        ((0, -1, 0), "y must be a cell from 0 to 63, got -1"),
        ((0, 0, 36), "theta must be a cell from 0 to 35, got 36"),
        ((0.5, 0, 0), "x must be a cell from 0 to 63, got 0.5"),
        ((0, True, 0), "y must be a cell from 0 to 63, got True"),
        ((0, 0, math.nan), "theta must be a cell from 0 to 35, got nan"),
        (("3", 0, 0), "x must be a cell from 0 to 63, got '3'"),
    ],
)
def test_a_place_outside_is_refused(place: tuple[int, int, int], message: str) -> None:
    pose_cells = PoseCells()
    with pytest.raises(ValueError, match=message):
        pose_cells.place(*place)
    assert pose_cells.activity[0, 32, 32] == 1.0


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_movement_that_is_not_finite_is_refused(bad: float) -> None:
    pose_cells = PoseCells()
    with pytest.raises(ValueError, match="distance_m must be a finite number, got"):
        pose_cells.integrate(bad, 0.0)
    with pytest.raises(ValueError, match="turn_rad must be a finite number, got"):
        pose_cells.integrate(0.0, bad)
    assert pose_cells.activity[0, 32, 32] == 1.0


CELLS, VALUES = np.array([5, 9], np.int32), np.array([0.1, 0.2], np.float32)


@pytest.mark.parametrize(
    ("cells", "values", "message"),
    [
        ([5, 9], VALUES, r"cells must be an int32 array of shape \(k,\), got \[5, 9\]"),
        (CELLS.astype(np.int64), VALUES, r"cells must be an int32 array of shape \(k,\), got int64 \(2,\)"),
        (CELLS.reshape(1, 2), VALUES, r"cells must be an int32 array of shape \(k,\), got int32 \(1, 2\)"),
        (CELLS, VALUES.astype(np.float64), r"values must be a float32 array of shape \(2,\), got float64 \(2,\)"),
        (CELLS, VALUES[:1], r"values must be a float32 array of shape \(2,\), got float32 \(1,\)"),
        (CELLS, 0.1, r"values must be a float32 array of shape \(2,\), got 0.1"),
        (
            np.array([5, -1], np.int32),
            VALUES,
            r"from 0 to 147455 and values finite and >= 0, got cell -1 with 0.2 in row 1",
        ),
        (np.array([147456, 9], np.int32), VALUES, "got cell 147456 with 0.1 in row 0"),
        (CELLS, np.array([0.1, -0.5], np.float32), "got cell 9 with -0.5 in row 1"),
        (CELLS, np.array([0.1, math.nan], np.float32), "got cell 9 with nan in row 1"),
        (CELLS, np.array([math.inf, 0.1], np.float32), "got cell 5 with inf in row 0"),
    ],
)
def test_an_injection_that_is_none_is_refused(cells: object, values: object, message: str) -> None:
    pose_cells = settled()
    before = pose_cells.activity
    with pytest.raises(ValueError, match=message):
        pose_cells.inject(cells, values)  # type: ignore[arg-type]
    assert np.array_equal(pose_cells.activity, before)


def test_a_cell_injected_twice_gets_both_and_nothing_is_no_fault() -> None:
    pose_cells = PoseCells()
    pose_cells.inject(np.array([7, 7], np.int32), np.array([0.25, 0.5], np.float32))
    pose_cells.inject(np.zeros(0, np.int32), np.zeros(0, np.float32))
    assert pose_cells.activity[0, 0, 7] == 0.75
    pose_cells.inject(np.arange(90_000, 90_100, dtype=np.int32), np.zeros(100, np.float32))
    assert pose_cells.attract() == pose_cells.winner
    assert pose_cells.activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("local_inhibit", [0.0, 0.3])
def test_inhibition_that_takes_all_activity_is_refused_and_changes_nothing(local_inhibit: float) -> None:
    pose_cells = settled()
    before, packet, carry = pose_cells.activity, pose_cells.winner, pose_cells.carry
    too_much = PoseCellParams(excite_sigma=3.0, excite_radius=9, inhibit=0.02, local_inhibit=local_inhibit)
    pose_cells.set_params(too_much)
    with pytest.raises(ValueError, match=r"inhibit = 0\.02 is above the activity of every cell"):
        pose_cells.attract()
    assert np.array_equal(pose_cells.activity, before)
    assert pose_cells.winner == packet
    assert pose_cells.carry == pytest.approx(carry, abs=1e-12)
    pose_cells.set_params(PoseCellParams())
    rest(pose_cells, 1)
    assert pose_cells.winner.id == packet.id


# ---------------------------------------------------------------- sizes


@pytest.mark.parametrize("n_theta", [8, 36, 360])
@pytest.mark.parametrize("n", [8, 13, 1000])
def test_any_size_holds_its_mass_across_every_face(n: int, n_theta: int) -> None:
    if n == 1000 and n_theta == 360:
        n_theta = 37  # 1.4 GB of address space otherwise
    pose_cells = PoseCells(PoseCellParams(n_x=n, n_y=n, n_theta=n_theta))
    for forwards in (0.9, -1.7):
        for heading in range(0, n_theta, max(1, n_theta // 4)):
            pose_cells.place(n - 1, 0, heading)
            for _ in range(3):
                drive(pose_cells, forwards, 0.8, 1)
                _, values = pose_cells.active
                assert values.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)
            assert np.count_nonzero(pose_cells.slot) == len(values) if n < 1000 else True


@pytest.mark.parametrize("n", [256, 540, 1000])
def test_large_networks_take_less_than_six_bytes_a_cell(n: int) -> None:
    pose_cells = PoseCells(PoseCellParams(n_x=n, n_y=n))
    drive(pose_cells, 0.7, 0.3, 30)
    assert 4 * n * n * 36 <= pose_cells.memory_bytes <= 6 * n * n * 36


@pytest.mark.slow
def test_standing_still_for_ever_does_not_drift() -> None:
    """100,000 steps, or fewer once the whole state recurs bit for bit, since nothing new can happen from then on."""
    pose_cells = settled(5, 60, 30)
    drive(pose_cells, 0.37, 0.21, 25)
    rest(pose_cells, 40)
    before, seen = where(pose_cells), set()
    for _ in range(100_000):
        rest(pose_cells, 1)
        cells, values = pose_cells.active
        rows = pose_cells._rows[: pose_cells._found]
        state = cells.tobytes() + values.tobytes() + rows.tobytes()
        if state in seen:
            break
        seen.add(state)
        assert np.abs(where(pose_cells) - before).max() < 0.01
