"""Brains in files: what is damaged or breaks a law is refused by name, and only what is complete replaces a file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from disk import State, archive, state_codec
from ratslam_core import RatSlam, load_brain, save_brain, take_snapshot
from tests.unit.disk.full import full_after
from tests.unit.ratslam_core.drives import driven

pytestmark = pytest.mark.slow


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
    head = {"digest": State(tree, arrays).digest() if signed else digest, **tree}
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
        (lambda tree, _: tree.update(format=4), "format must be 3, got 4"),
        (lambda tree, _: tree.update(format=2), "of format 2, which an unreleased version wrote"),
        (lambda tree, _: tree.update(state={"list": []}), "must hold a RatSlam, got list"),
        (lambda tree, _: tree["state"].update(kind="os:system"), "no class is of the kind 'os:system'"),
        (
            lambda tree, _: tree["state"].update(kind="ratslam/7"),
            "ratslam/7 was made by another version .* has ratslam/5",
        ),
        (lambda tree, _: tree["state"].update(kind=3), "no class is of the kind '3'"),
        (lambda tree, _: tree["state"]["state"]["pose_cells"]["state"].update(more=1), "PoseCells differs in more"),
        (lambda tree, _: tree["state"]["state"]["params"]["state"]["pose_cells"]["state"].update(n_x=7), "n_x must be"),
        (lambda _, arrays: arrays.pop(), "no brain"),
    ],
)
def test_what_does_not_fit_is_named(file: Path, tmp_path: Path, change: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        load_brain(rewritten(file, tmp_path / "b.npz", change))


def at(tree: Any, path: str) -> Any:
    """The place in the tree where an attribute is written, and its name there."""
    *way, last = path.split(".")
    node = tree["state"]
    for name in way:
        node = node["state"][name]
    return node["state"], last


def write(path: str, value: Any) -> Any:
    """A change of what is written there."""

    def change(tree: Any, _arrays: list[np.ndarray]) -> None:
        holder, name = at(tree, path)
        holder[name] = value

    return change


def reshape(path: str, how: Any) -> Any:
    """A change of the array that is written there."""

    def change(tree: Any, arrays: list[np.ndarray]) -> None:
        holder, name = at(tree, path)
        number = holder[name]["array"]
        arrays[number] = how(arrays[number])

    return change


def put(path: str, place: Any, value: Any) -> Any:
    """A change of one number of an array."""

    def changed(array: np.ndarray) -> np.ndarray:
        array[place] = value
        return array

    return reshape(path, changed)


MAP, GRAPH, KNOWN = "experience_map", "experience_map.transitions.graph", "experience_map._experiences"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put("pose_cells._cells", (0, 3), 10**6), "each active cell's index must be that of its place"),
        (put("pose_cells._cells", (0, 0), -1), "column 0 of the active cells must be from 0 to 31"),
        (put("pose_cells._slot", 7, 2**31 - 1), "slot must name"),
        (put("pose_cells._owner", 0, 9), "owner must be from 0 to"),
        (put("pose_cells._values", 0, np.nan), "activity must be from 0 to"),
        (put("pose_cells._rows", (0, 0), np.inf), "a packet's place must be from 0 to 32"),
        (write("pose_cells._n", 10**9), "the number of active cells must be a whole number from 1 to"),
        (write("pose_cells._found", 9), "the number of packets must be a whole number from 1 to"),
        (write("pose_cells._found", 1.0), "_found must be int, got float"),
        (write("pose_cells._slot", None), "_slot must be a ndarray, got a NoneType"),
        (reshape("pose_cells._values", lambda a: a[:9]), "must have shape"),
        (reshape("pose_cells._box_a", lambda a: a[:9]), "must have shape"),
        (reshape("pose_cells._owner", lambda a: a.astype(np.int64)), "must have 1 dimensions of int32"),
        (put("association.links._cells", slice(None), 2**30), "a linked cell must be from 0 to"),
        (put("association.links._blocks", (0, 0), -5), "blocks of links: start must be from 0 to"),
        (put("association.links._blocks", (0, 2), 1), "must"),
        (write("association.links._end", 10**7), "their end must be a whole number"),
        (write("local_view._count", 2000), "the number of views must be a whole number from 0 to 1024"),
        (reshape("local_view.features", lambda a: a[:5]), r"features must have shape \(104\)"),
        (write("local_view._templates", 5), "must be a ndarray, got a int"),
        (write("local_view.recognition.view", 800), "the recognised view must be a whole number from -1 to"),
        (put(f"{KNOWN}.pose", (0, 0), np.nan), "a place in the map must be from"),
        (
            write(f"{MAP}.ground.let_go", {"number": 10**6, "dict": [["sights", "?"]]}),
            "what was let go must be counted by its kinds",
        ),
        (put(f"{KNOWN}.view", 0, 500), "an experience's view must be from -1 to"),
        (put(f"{GRAPH}.other", 0, 2**32 - 1), "an other end must be from 0 to"),
        (put(f"{GRAPH}.half", 0, 2**31), "each transition must have its two half-edges"),
        (put(f"{GRAPH}.start", 1, 0), "blocks of half-edges must not overlap"),
        (put(f"{GRAPH}._room", 0, 0), "a block of half-edges must have room"),
        (put(f"{MAP}.transitions.ends", (0, 1), -3), "an end must be from 0 to"),
        (put(f"{MAP}.transitions.behaviour", 0, 77), "behaviour must be from 0 to 15"),
        (write(f"{MAP}.here", -1), "the active experience must be a whole number from 0 to"),
        (write(f"{MAP}._temporal_map", {"same": 0}), "must be a TemporalMap, got a RatSlam"),
        (put("goal_memory._place", 3, 1), "the plane must be empty"),
        (reshape("goal_memory._keys", lambda a: a[:-1]), "times must have shape"),
        (write(f"{MAP}.evidence._count", 33), "hypotheses must be a whole number from 0 to 32"),
        (write("goal_memory._used", 4096), "the number of links must be a whole number from 0 to 2048"),
        (reshape("map_grid._scans", lambda a: a[:, :2]), "scans must have shape"),
        (put("map_grid._count", 255, 1), "may have scans"),
        (reshape("scans._recent", lambda a: a[:, :2]), "scans of the way here must have shape"),
        (put("scans._since", 0, 10**6), "the count at which an experience was made must be from 0 to"),
        (write("echo_closures.count", -1), "ties by echoes must be a whole number from 0 to"),
        (put("occupancy._log_odds", (0, 0), np.inf), "log odds must be from -5 to 5"),
        (reshape("kidnap_detector._scans._last", lambda _: np.ones(900)), "the last scan must have shape"),
        (write("association._learnt_s", {"list": []}), "each of .* views must have a time, got 0"),
        (write("association.learning_rate", {"float": "nan"}), "learning_rate must be a number, got nan"),
        (
            lambda tree, _: at(tree, "local_view")[0].update(local_view={"same": 0}),
            "must be a LocalView, got a RatSlam",
        ),
        (write("pose_cells._spare_owner", {"same": 26}), "an array is in two places at once"),
        (lambda tree, _: tree["state"].update(kind="os"), "no class is of the kind 'os'"),
    ],
)
def test_no_brain_breaks_a_law_of_its_parts(file: Path, tmp_path: Path, change: Any, message: str) -> None:
    """Compiled code checks no index. Each of these crashed the process, ran for ever, or was accepted."""
    with pytest.raises(ValueError, match=f"no brain that can be taken back: .*{message}"):
        load_brain(rewritten(file, tmp_path / "b.npz", change))


def test_a_file_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"missing\.npz: No such file"):
        load_brain(tmp_path / "missing.npz")
    for name, content in (("text.npz", b"hello"), ("empty.npz", b""), ("half.npz", b"PK\x03\x04half")):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(ValueError, match=f"{name} is no brain"):
            load_brain(tmp_path / name)


def test_saving_replaces_only_what_is_complete(file: Path, tmp_path: Path) -> None:
    path = tmp_path / "brain.npz"
    path.write_bytes(file.read_bytes())
    with full_after(10_000), pytest.raises(OSError, match="File too large") as caught:
        save_brain(RatSlam(), path)
    assert caught.value.filename == str(path)
    assert path.read_bytes() == file.read_bytes()
    assert list(tmp_path.iterdir()) == [path]


def test_what_could_not_be_read_again_is_not_written(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "brain.npz"
    path.write_bytes(file.read_bytes())
    brain = load_brain(file)
    snapshot = take_snapshot(brain)
    size = archive.room_of(snapshot.arrays)
    assert snapshot.outgrowing is None
    for limit in ("MOST_BYTES", "MOST_JSON_BYTES"):
        with monkeypatch.context() as small:
            small.setattr(archive, limit, 1000)
            with pytest.raises(
                ValueError, match=r"too large for a file: \d+ MiB of (arrays|JSON), at most 0 can be read"
            ):
                save_brain(brain, path)
    assert path.read_bytes() == file.read_bytes()
    for most in (size + 200_000, 2 * size - 2):
        for module in (archive, state_codec):
            monkeypatch.setattr(module, "MOST_BYTES", most)
        save_brain(brain, path)
        assert load_brain(path).digest() == brain.digest()
        assert "fills more than half of the" in (snapshot.outgrowing or "")
