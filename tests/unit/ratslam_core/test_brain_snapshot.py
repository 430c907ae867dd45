from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ratslam_core import (
    BrainSnapshot,
    GoalMemoryParams,
    LocalViewParams,
    PoseCellParams,
    RatSlam,
    RatSlamParams,
    load_brain,
    restore_snapshot,
    save_brain,
    take_snapshot,
)
from ratslam_core.brain_snapshot import _Writer
from tests.unit.ratslam_core.drives import Circle

SONARS = (-0.5, 0.0, 0.5)


def drive(circle: Circle, brain: RatSlam, ticks: int) -> None:
    for _ in range(ticks):
        circle.advance(
            brain, 1, ranges_m=np.array([1.0, 2.0, 5.0], np.float32) + np.float32(0.1 * np.sin(circle.angle))
        )


def driven(ticks: int = 420) -> tuple[Circle, RatSlam]:
    params = RatSlamParams(
        PoseCellParams(n_x=32, n_y=24), LocalViewParams(adaptive=True), goal_memory=GoalMemoryParams(rate=0.3)
    )
    circle, brain = Circle(3), RatSlam(params, np.random.default_rng(5), sonar_angles_rad=SONARS)
    drive(circle, brain, ticks)
    return circle, brain


@pytest.mark.parametrize("ticks", [1, 250, 420])
def test_a_restored_brain_goes_on_as_if_it_had_never_stopped(tmp_path: Path, ticks: int) -> None:
    circle, brain = driven(ticks)
    if ticks == 420:
        circle.angle += 2.6  # lost, with competing packets
        drive(circle, brain, 1)
        assert brain.lost
    save_brain(brain, tmp_path / "brain.npz")
    copies = [restore_snapshot(take_snapshot(brain)), load_brain(tmp_path / "brain.npz")]
    here = circle.angle
    drive(circle, brain, 200)
    for copy in copies:
        circle.angle = here
        drive(circle, copy, 200)
        assert copy.digest() == brain.digest()
        assert copy.rng.random() == np.random.default_rng(5).random()
        assert copy.pose_cells.activity.tobytes() == brain.pose_cells.activity.tobytes()
        assert copy.experience_map.poses.tobytes() == brain.experience_map.poses.tobytes()
        assert copy.params == brain.params


def test_who_asked_for_times_is_not_part_of_the_brain() -> None:
    _, brain = driven(50)
    before = take_snapshot(brain).digest()
    times = brain.experience_map.temporal_map.times_to(3)
    assert take_snapshot(brain).digest() == before
    copy = restore_snapshot(take_snapshot(brain))
    assert np.array_equal(copy.experience_map.temporal_map.times_to(3), times)


def test_a_snapshot_is_a_copy() -> None:
    circle, brain = driven(50)
    snapshot = take_snapshot(brain)
    before = snapshot.digest()
    drive(circle, brain, 50)
    assert snapshot.digest() == before != take_snapshot(brain).digest()
    one, other = restore_snapshot(snapshot), restore_snapshot(snapshot)
    drive(circle, one, 20)
    assert take_snapshot(other).digest() == before


def test_it_is_arrays_and_plain_json() -> None:
    snapshot = take_snapshot(driven(20)[1])
    assert json.loads(json.dumps(snapshot.tree, allow_nan=False)) == snapshot.tree
    assert all(isinstance(array, np.ndarray) and array.dtype != object for array in snapshot.arrays)


def test_what_the_engine_does_not_own_is_not_written() -> None:
    with pytest.raises(TypeError, match=r"a brain must not hold a pathlib\.\w*Path"):
        _Writer().encode(Path())


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("brain") / "brain.npz"
    save_brain(driven(20)[1], path)
    return path


def rewritten(file: Path, to: Path, change: Any, *, signed: bool = True) -> Path:
    """The same file after `change(tree, arrays)`, with a digest that fits."""
    with np.load(file) as old:
        tree = json.loads(old["json"].tobytes())
        arrays = [old[f"a{k}"] for k in range(len(old.files) - 1)]
    digest = tree.pop("digest")
    change(tree, arrays)
    head = {"digest": BrainSnapshot(tree, arrays).digest() if signed else digest, **tree}
    named = {f"a{k}": array for k, array in enumerate(arrays)}
    np.savez_compressed(to, json=np.frombuffer(json.dumps(head).encode(), np.uint8), **named)
    return to


def test_a_changed_file_is_refused(file: Path, tmp_path: Path) -> None:
    def change(_tree: Any, arrays: list[np.ndarray]) -> None:
        next(a for a in arrays if a.dtype == np.float32 and a.size > 100).flat[3] += 1

    with pytest.raises(ValueError, match="damaged"):
        load_brain(rewritten(file, tmp_path / "b.npz", change, signed=False))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda tree, _: tree.update(format=2), "format must be 1, got 2"),
        (lambda tree, _: tree.update(brain={"list": []}), "must hold a RatSlam, got list"),
        (lambda tree, _: tree["brain"].update(object="os:system"), "os:system is none of the engine's classes"),
        (lambda tree, _: tree["brain"].update(object="ratslam_core.slam:NOTHING"), "none of the engine's classes"),
        (lambda tree, _: tree["brain"].update(object="ratslam_core.slam:PoseCells"), "none of the engine's classes"),
        (lambda tree, _: tree["brain"]["state"]["pose_cells"]["state"].update(more=1), "PoseCells differs in more"),
        (lambda tree, _: tree["brain"]["state"]["params"]["state"]["pose_cells"]["state"].update(n_x=7), "n_x must be"),
        (lambda _, arrays: arrays.pop(), "no brain"),
    ],
)
def test_what_does_not_fit_is_named(file: Path, tmp_path: Path, change: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        load_brain(rewritten(file, tmp_path / "b.npz", change))


def test_a_file_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"missing\.npz: No such file"):
        load_brain(tmp_path / "missing.npz")
    for name, content in (("text.npz", b"hello"), ("empty.npz", b""), ("half.npz", b"PK\x03\x04half")):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(ValueError, match=f"{name} is no brain"):
            load_brain(tmp_path / name)


def test_saving_replaces_only_what_is_complete(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "brain.npz"
    path.write_bytes(file.read_bytes())

    def break_off(target: Any, **_: Any) -> None:
        target.write(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", break_off)
    with pytest.raises(OSError, match="No space"):
        save_brain(RatSlam(), path)
    assert path.read_bytes() == file.read_bytes()
    assert list(tmp_path.iterdir()) == [path]
