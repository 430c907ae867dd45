"""The run of a recording keeps itself as every run does; a recording that has moved or changed is a sentence."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from app.cli.beginnings import cut_off_run
from app.cli.command_line import main
from app.commands import carry_out
from app.recordings import opening as prints
from app.recordings.opening import fingerprint, open_recording
from app.recordings.playing import Player
from app.run_record.folder import LINES, STATE, all_runs
from app.run_record.reader import KeptRun, open_run
from app.run_record.resume import ReplayError, replayed, resumed
from app.run_record.states import newest_state
from tests.unit.app.engines import run_for, tell
from tests.unit.app.made_recordings import recorded
from tests.unit.app.sessions import OFFICE
from web import messages as m

from .kept import Keeping

pytestmark = pytest.mark.slow

MOMENTS = 120


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of pictures with a CSV of wheels."""
    folder, rows = tmp_path_factory.mktemp("recordings") / "drive", ["image,time_s,speed,yaw_rate"]
    folder.mkdir()
    for k, moment in enumerate(recorded(MOMENTS).moments()):
        assert moment.image is not None
        Image.fromarray(moment.image).save(folder / f"{k}.png")
        rows.append(f"{k}.png,{k / 10},{moment.speed},{moment.yaw_rate}")
    (folder / "drive.csv").write_text("\n".join(rows))
    return folder


@pytest.fixture
def copy(drive: Path, tmp_path: Path) -> Path:
    """One that a test may change."""
    return Path(shutil.copytree(drive, tmp_path / "drive"))


@pytest.fixture(autouse=True)
def _runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RATSLAM_RUNS", str(tmp_path / "runs"))
    monkeypatch.setattr("app.cli.runs.compile_first", lambda: None)


def playing(path: Path, ticks: int, *, again: bool = True) -> Keeping:
    """again: it can be opened again, where it lies."""
    kept = Keeping(begins=False)
    kept.engine.begin_recording(Player(open_recording(path), 1, path=path if again else None))
    run_for(kept.engine, ticks)
    return kept


def keep_one(path: Path, ticks: int = 100, told: bool = True) -> tuple[KeptRun, str]:
    kept = playing(path, ticks // 2)
    if told:
        tell(kept.engine, type="set_parameter", name="pose_cells.inhibit", value=0.0021)
        tell(kept.engine, type="tag", name="here")
    run_for(kept.engine, ticks - ticks // 2)
    end = kept.stop()
    return open_run("last"), end


@pytest.fixture(scope="module")
def whole(drive: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A folder of runs with one that saved its state each second, and how that ended."""
    folder = tmp_path_factory.mktemp("runs")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("RATSLAM_RUNS", str(folder))
        patch.setattr("app.run_record.states.SAVE_EVERY_S", 1.0)
        patch.setattr("app.run_record.states.SAVE_PAUSE_S", 0.0)
        return folder, keep_one(drive)[1]


@pytest.fixture
def run(whole: tuple[Path, str], tmp_path: Path) -> KeptRun:
    """That run, in a copy that a test may change."""
    shutil.copytree(whole[0], tmp_path / "runs")
    return open_run("last")


def test_it_comes_out_the_same_and_says_so_if_not(
    run: KeptRun, whole: tuple[Path, str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert (run.tick, run.end, run.header.world_name) == (100, "the program ended", "drive")
    assert run.length_s == pytest.approx(10.0)
    assert [(order.tick, order.name) for order in run.orders] == [(50, "set_parameters"), (50, "tag")]
    assert run.hashes
    assert replayed(run).state_hash() == whole[1]
    assert main(["runs", "--json"]) == 0
    row = json.loads(capsys.readouterr().out)
    assert (row["world"], row["ticks"], row["state"]) == ("drive", 100, "complete")
    assert main(["replay", run.name]) == 0
    assert capsys.readouterr().out.startswith("same: 100 ticks, 2 orders")
    run.orders = []
    with pytest.raises(ReplayError, match="comes out differently from tick 5"):
        replayed(run)


def test_it_goes_on_from_its_newest_state(run: KeptRun, whole: tuple[Path, str]) -> None:
    state = newest_state(run)
    assert state is not None
    assert state.tick_count in run.hashes
    assert resumed(run).state_hash() == whole[1]
    run.hashes[state.tick_count] = "another"
    assert newest_state(run) is None, "a state that the run does not know is not taken up"
    (run.folder / STATE).write_bytes(b"PK")
    assert newest_state(run) is None


def test_cut_off_it_is_offered_and_goes_on_to_the_same_end(drive: Path) -> None:
    straight = playing(drive, MOMENTS - 1, again=False)
    end = straight.stop()
    assert all_runs() == [], "what cannot be opened again plays without being kept"
    first, _ = keep_one(drive, 60, told=False)
    path = first.folder / LINES
    path.write_bytes(path.read_bytes()[:-10])  # as if it had been killed
    cut_off = cut_off_run()
    assert cut_off is not None
    assert (cut_off.name, cut_off.tick, cut_off.end) == (first.name, 60, "")
    kept = Keeping(begins=False)
    engine = kept.engine
    engine.begin(OFFICE, 1, straight.engine.next_config)
    config = engine.run.session.config
    assert carry_out(engine, m.GoOn(cut_off, resumed(cut_off))) == m.Accepted(60)
    run_for(engine, MOMENTS - 61)
    assert engine.run.session.source.over
    tell(engine, type="seek", tick=70)
    tell(engine, type="back_to_now")
    assert kept.stop() == end
    whole = open_run(first.folder)
    assert (whole.tick, whole.again[0][0]) == (MOMENTS - 1, 60)
    tell(engine, type="reset", world="office")
    assert engine.run.session.config == config


def test_a_recording_that_has_moved_or_changed_is_a_sentence(copy: Path) -> None:
    run, _ = keep_one(copy, 20)
    elsewhere = copy.with_name("elsewhere")
    copy.rename(elsewhere)
    moved = f"the run {run.name} plays the recording .*drive, which is not there any more"
    with pytest.raises(ValueError, match=moved):
        resumed(run)
    elsewhere.rename(copy)
    assert replayed(run).tick_count == 20
    table = copy / "drive.csv"
    table.write_text(table.read_text().replace("\n5.png,0.5,", "\n5.png,0.51,"))
    with pytest.raises(ValueError, match="which has changed since: the run cannot be played again"):
        resumed(run)


def test_it_can_be_had_in_the_formats_that_need_no_office(
    run: KeptRun, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def export(to: str) -> tuple[int, list[str]]:
        answer = main(["export", run.name, "--to", to, "--out", str(tmp_path / f"out.{to}")])
        return answer, sorted(path.name for path in tmp_path.glob(f"out*.{to}"))

    assert export("tum") == (0, ["out-believed.tum", "out-estimate.tum"])
    for to in ("g2o", "graphml", "csv"):
        assert export(to) == (0, [f"out.{to}"])
    table = (tmp_path / "out.csv").read_text().splitlines()
    row = dict(zip(table[0].split(","), table[-1].split(","), strict=True))
    assert (row["tick"], row["time_s"], row["true_x"], row["off_m"], row["mode"]) == ("100", "10.0", "", "", "recorded")
    assert 'id="drive"' in (tmp_path / "out.graphml").read_text()
    assert len((tmp_path / "out-estimate.tum").read_text().splitlines()) == len(table) - 1 == 101
    for to in ("mcap", "png", "mp4"):
        assert export(to) == (2, [])
        words = f"{to} is for runs in an office; the run of a recording can be had as tum, g2o"
        assert words in capsys.readouterr().err


def test_its_digest_is_of_names_and_contents_also_of_the_table_beside_a_film(copy: Path, tmp_path: Path) -> None:
    first = fingerprint(copy)
    assert fingerprint(copy) == first
    (copy / "new.txt").write_text("")
    second = fingerprint(copy)
    (copy / "new.txt").rename(copy / "other.txt")
    assert len({first, second, fingerprint(copy)}) == 3
    film = tmp_path / "walk.avi"
    film.write_bytes(b"RIFF")
    first = fingerprint(film)
    (tmp_path / "walk.csv").write_text("time_s,speed\n")
    assert fingerprint(film) != first


def test_of_a_large_file_both_ends_and_pieces_between_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(prints, "WHOLE_BYTES", 1000)
    monkeypatch.setattr(prints, "PIECE_BYTES", 100)
    data, path = np.random.default_rng(3).bytes(10_000), tmp_path / "large.bag"
    seen = set[str]()
    for at in (None, 0, 9_999, 5_150):
        path.write_bytes(data if at is None else data[:at] + bytes([data[at] ^ 1]) + data[at + 1 :])
        seen.add(fingerprint(path))
    assert len(seen) == 4
