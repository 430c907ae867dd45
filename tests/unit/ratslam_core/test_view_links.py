from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from ratslam_core import LocalViewParams, PoseCells, ViewLinks
from ratslam_core.local_view import view_links

from .literal import also_interpreted


def learn(links: ViewLinks, view: int, pose_cells: PoseCells) -> None:
    cells, activity = pose_cells.active
    links.learn(view, cells, activity, pose_cells.slot)


def dense(links: ViewLinks, view: int, size: int) -> np.ndarray:
    """beta of one view over all pose cells; no cell twice."""
    cells, strength = links.of(view)
    assert len(set(cells.tolist())) == len(cells)
    beta = np.zeros(size)
    beta[cells] = strength
    return beta


@pytest.mark.parametrize("decay", [0.0, 0.1, 1.0])
@also_interpreted(view_links)
def test_learning_is_hebbian(decay: float) -> None:
    links = ViewLinks(LocalViewParams(learning_rate=0.3, decay=decay, most_links=0))
    pose_cells = PoseCells()
    beta = np.zeros((3, pose_cells.slot.size))
    rng = np.random.default_rng(0)
    for _ in range(25):
        pose_cells.step(speed=float(rng.uniform(0, 2)), yaw_rate=float(rng.uniform(-1, 1)), dt=0.1)
        view = int(rng.integers(3))
        learn(links, view, pose_cells)
        beta[view] = (1 - decay) * beta[view] + 0.3 * pose_cells.activity.ravel()
        for each in range(3):
            assert np.abs(dense(links, each, beta.shape[1]) - beta[each]).max() < 1e-6


def test_one_link_injects_no_more_than_its_saturation() -> None:
    params = LocalViewParams(saturation=0.02, learning_rate=1.0)
    links, pose_cells = ViewLinks(params), PoseCells()
    pose_cells.attract()
    for _ in range(3):
        learn(links, 0, pose_cells)
    cells, values = links.recall(0)
    expected = np.minimum(3 * pose_cells.activity.ravel()[cells], 0.02)
    assert values == pytest.approx(expected, rel=1e-5)
    assert values.max() == pytest.approx(0.02)
    assert values.min() < 0.02


def test_a_lost_robot_s_view_injects_more() -> None:
    """A half in all, in proportion to its links, however weak; one never seen injects nothing. None of it changes the links."""
    links, pose_cells = ViewLinks(), PoseCells()
    for _ in range(30):
        pose_cells.attract()
    for _ in range(20):
        learn(links, 0, pose_cells)
    known = links.of(0)[1].copy()
    _, usual = links.recall(0)
    cells, values = links.recall(0, lost=True)
    assert values.sum(dtype=np.float64) == pytest.approx(0.5, rel=1e-5)
    assert usual.sum() < 0.5
    assert values / values.sum() == pytest.approx(usual / usual.sum(), rel=1e-4)
    assert np.array_equal(cells, links.of(0)[0])
    assert np.array_equal(known, links.of(0)[1])
    for view, lost in product((7, 1023, 1024, 5000), (False, True)):
        assert [len(part) for part in links.recall(view, lost=lost)] == [0, 0]


@also_interpreted(view_links)
def test_the_views_at_a_column_are_those_linked_there() -> None:
    links, pose_cells = ViewLinks(), PoseCells()
    _, n_y, n_x = pose_cells.shape
    for view in range(3):
        for _ in range(4):
            learn(links, view, pose_cells)
            pose_cells.step(speed=2.0, yaw_rate=0.3, dt=0.1)
    for x, y in ((n_x // 2, n_y // 2), (n_x // 2 + 3, n_y // 2), (0, 0)):
        expected = [dense(links, v, pose_cells.slot.size).reshape(-1, n_y, n_x)[:, y, x].sum() for v in range(3)]
        views, strength = links.views_at(y * n_x + x, n_y * n_x, 3)
        assert views.tolist() == np.flatnonzero(expected).tolist()
        assert strength == pytest.approx(np.array(expected)[views], rel=1e-5)
        assert len(links.views_at(y * n_x + x, n_y * n_x, 0)[0]) == 0


def active_cells(flats: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells, activities and slot as `learn` takes them."""
    slot = np.zeros(147_456, np.int32)
    slot[flats] = np.arange(len(flats)) + 1
    cells = np.zeros((len(flats), 4), np.int32)
    cells[:, 3] = flats
    return cells, np.full(len(flats), value, np.float32), slot


def test_the_arena_takes_hardly_more_room_than_the_links() -> None:
    """Over hours of views, blocks that moved leave no gaps for long, and the spare room is a fraction, not a doubling."""
    links, rng = ViewLinks(), np.random.default_rng(4)
    for turn in range(3):
        for view in range(400 * (turn + 1)):
            links.learn(view, *active_cells(100 * view + turn * 40 + np.arange(int(rng.integers(200, 600))), 1.0))
            if view % 40 == 39 and (turn or view > 200):
                used = sum(len(links.of(k)[0]) for k in range(400 * (turn + 1)))
                assert links.room <= 2 * used


def test_the_arena_grows_when_it_is_full_and_not_before() -> None:
    links = ViewLinks(LocalViewParams(most_links=0))
    room = links.room
    for _ in range(2):  # the second time the links are there already
        links.learn(0, *active_cells(np.arange(room), 1.0))
        assert links.room == room
    links.learn(0, *active_cells(np.arange(room + 1), 1.0))
    assert 2 * room < links.room < 4 * room
    assert links.of(0)[0].tolist() == list(range(room + 1))
    links.learn(1, *active_cells(np.arange(5), 1.0))
    assert links.of(1)[0].tolist() == list(range(5))


def test_a_view_keeps_its_strongest_links() -> None:
    """The strongest as they were when it had too many; of equals the older. Without a limit it keeps all."""
    kept, every = (ViewLinks(LocalViewParams(learning_rate=0.3, most_links=most)) for most in (40, 0))
    pose_cells = PoseCells()
    rng = np.random.default_rng(0)
    for _ in range(25):
        pose_cells.step(speed=float(rng.uniform(0, 2)), yaw_rate=float(rng.uniform(-1, 1)), dt=0.1)
        before = dict(zip(*(part.tolist() for part in kept.of(0)), strict=True))
        flats = pose_cells.active[0][:, 3].tolist()
        learn(kept, 0, pose_cells)
        learn(every, 0, pose_cells)
        would = {**before, **dict.fromkeys(set(flats) - set(before), 0.0)}
        would = {cell: beta + 0.3 * float(pose_cells.activity.ravel()[cell]) for cell, beta in would.items()}
        cells, strength = kept.of(0)
        assert len(cells) == (40 if len(would) > 50 else len(would))
        assert dict(zip(cells.tolist(), strength.tolist(), strict=True)) == pytest.approx(
            {cell: would[cell] for cell in cells.tolist()}, rel=1e-5
        )
        assert strength.min() >= sorted(would.values())[-len(cells)] * (1 - 1e-5)
    assert kept.forgotten > 0 == every.forgotten
    assert len(every.of(0)[0]) > 100
