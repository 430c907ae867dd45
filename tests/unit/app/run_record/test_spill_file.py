"""What memory has no room for: on the disk it is the same, until then it stays in memory, and a full disk loses nothing."""

from __future__ import annotations

import os
import random
import shutil
import threading
from pathlib import Path

import pytest

from app.run_record import spill_file
from app.run_record.chunks import Chunks, KeptState
from app.run_record.spill_file import UNIT, Place, SpillFile
from disk import State
from tests.patience import PATIENCE_S, until
from tests.unit.app.run_record.test_chunks import same, states

PLENTY = 100_000_000


def all_written(spill: SpillFile, count: int) -> None:
    came = list[Place]()
    until(lambda: came.extend(spill.written()) or len(came) == count)


@pytest.fixture(autouse=True)
def _a_disk_with_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spill_file, "LEAVES_FREE", 0)


def test_contents_come_back_and_a_place_that_is_free_is_used_again(tmp_path: Path) -> None:
    spill, rng = SpillFile(tmp_path, PLENTY), random.Random(1)
    held: dict[Place, bytes] = {}
    for _ in range(400):
        content = rng.randbytes(rng.randrange(1, 3000))
        place = spill.put(content)
        assert place is not None
        held[place] = content
        if len(held) > 50:
            gone = rng.choice(list(held))
            spill.give_back(gone)
            del held[gone]
    all_written(spill, 400)
    assert all(place.read() == content for place, content in held.items())
    assert spill.nbytes == sum(-(-len(content) // UNIT) * UNIT for content in held.values())
    assert os.fstat(next(iter(held)).file).st_size < 70 * 3072  # 51 places at most at a time, in six sizes
    assert list(tmp_path.iterdir()) == []  # the file has no name


def test_without_room_it_takes_nothing(tmp_path: Path) -> None:
    spill = SpillFile(tmp_path, 4 * UNIT)
    first, second, third = (spill.put(b"x" * (UNIT + 1)) for _ in range(3))
    assert first is not None
    assert (second is None, third) == (False, None)
    spill.give_back(first)
    assert spill.put(b"y") is not None
    assert SpillFile(tmp_path, 0).put(b"x") is None
    (tmp_path / "file").write_text("")
    nowhere = SpillFile(tmp_path / "file" / "folder", PLENTY)
    assert (nowhere.put(b"x"), nowhere.has_room) == (None, False)


def test_its_file_is_closed_with_it(tmp_path: Path) -> None:
    spill = SpillFile(tmp_path, PLENTY)
    place = spill.put(b"x")
    assert place is not None
    all_written(spill, 1)

    def is_closed() -> bool:
        try:
            os.fstat(place.file)
        except OSError:
            return True
        return False

    assert not is_closed()
    del spill
    until(is_closed)  # its thread has let go of it


def kept_with(spill: SpillFile, seed: int, most_bytes: int) -> tuple[Chunks, list[tuple[State, KeptState]]]:
    """Thirty states, of which some are dropped, with as little as possible in memory."""
    chunks, rng, kept = Chunks(spill), random.Random(seed), list[tuple[State, KeptState]]()
    for state in states(seed, 30):
        kept.append((state, chunks.keep(state)))
        chunks.make_room(most_bytes)
        if len(kept) > 12:
            chunks.drop(kept.pop(rng.randrange(1, len(kept) - 1))[1])
    return chunks, kept


@pytest.mark.parametrize("seed", range(3))
def test_each_state_is_as_it_was_from_memory_or_disk(seed: int, tmp_path: Path) -> None:
    plain, _ = kept_with(SpillFile(tmp_path, 0), seed, 0)
    spill = SpillFile(tmp_path, PLENTY)
    chunks, kept = kept_with(spill, seed, 0)
    until(lambda: chunks.make_room(PLENTY) or chunks.nbytes < 0.7 * plain.nbytes)
    assert chunks.nbytes + spill.nbytes > plain.nbytes > chunks.nbytes
    assert chunks.spilled_nbytes == spill.nbytes > 0
    for state, each in kept:
        assert same(each, state)
    for _, each in kept:
        chunks.drop(each)
    assert (chunks.nbytes, spill.nbytes) == (0, 0)


@pytest.mark.parametrize("why", ["the disk is full", "too little is free", "the disk hangs"])
def test_what_the_disk_does_not_take_stays_in_memory(why: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hangs = threading.Event()

    def write(*_: object) -> int:
        if why == "the disk hangs":
            hangs.wait(PATIENCE_S)
        raise OSError(28, "No space left on device")

    if why == "too little is free":
        monkeypatch.setattr(spill_file, "LEAVES_FREE", 2 * shutil.disk_usage(tmp_path).total)
    else:
        monkeypatch.setattr(os, "pwrite", write)
    chunks, kept = kept_with(SpillFile(tmp_path, PLENTY), 5, 0)
    for state, each in kept:
        assert same(each, state)
    hangs.set()
    plain, _ = kept_with(SpillFile(tmp_path, 0), 5, 0)
    assert chunks.nbytes >= plain.nbytes  # nothing was counted as gone
