"""The run of a recording keeps itself as every run does; a recording that has moved or changed is a sentence."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from app.cli.command_line import main
from app.cli.earlier import cut_off_run
from app.commands import carry_out
from app.engine.engine import Engine
from app.engine.pace import Pace
from app.engine.watchdog import Watchdog
from app.recordings import fingerprint as prints
from app.recordings.fingerprint import fingerprint
from app.recordings.opening import open_recording
from app.recordings.playing import Player
from app.runs.folder import LINES, STATE, all_runs
from app.runs.keeper import RunKeeper
from app.runs.replay import ReplayError, newest_state, replay, resumed
from app.runs.run_file import KeptRun, open_run
from sim2d import load_world
from tests.unit.app.engines import tell
from tests.unit.app.made_recordings import recorded
from web import messages as m

pytestmark = pytest.mark.slow

OFFICE, MOMENTS = load_world("office"), 120


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


class Kept:
    """An engine whose runs keep themselves."""

    def __init__(self) -> None:
        self.complaints: list[str] = []
        self.keeper = RunKeeper(self.complaints.append)
        self.keeper.start()
        self.engine = Engine(
            OFFICE, Pace(0.0), Watchdog(1e9, lambda: None), running=False, answer=lambda *_: None, keeper=self.keeper
        )

    def play(self, path: Path, ticks: int) -> None:
        self.engine.begin_recording(Player(open_recording(path), 1, path=path))
        self.run_for(ticks)

    def run_for(self, ticks: int) -> None:
        for _ in range(ticks):
            self.engine.tick()

    def stop(self) -> str:
        """The hash at its end."""
        self.keeper.stop()
        return self.engine.run.session.state_hash()


def keep_one(path: Path, ticks: int = 100, told: bool = True) -> tuple[KeptRun, str]:
    kept = Kept()
    kept.play(path, ticks // 2)
    if told:
        tell(kept.engine, type="set_parameter", name="pose_cells.inhibit", value=0.0021)
        tell(kept.engine, type="tag", name="here")
    kept.run_for(ticks - ticks // 2)
    end = kept.stop()
    assert kept.complaints == []
    return open_run("last"), end


def test_it_comes_out_the_same(drive: Path, capsys, monkeypatch: pytest.MonkeyPatch) -> None:
    run, end = keep_one(drive)
    assert (run.last_tick, run.end, run.header.world_name) == (100, "the program ended", "drive")
    assert run.length_s == pytest.approx(10.0)
    assert [(order.tick, order.name) for order in run.orders] == [(50, "set_parameters"), (50, "tag")]
    assert run.hashes
    assert replay(run).state_hash() == end
    monkeypatch.setattr("app.cli.runs.compile_first", lambda: None)
    assert main(["runs", "--json"]) == 0
    row = json.loads(capsys.readouterr().out)
    assert (row["world"], row["ticks"], row["state"]) == ("drive", 100, "complete")
    assert main(["replay", run.name]) == 0
    assert capsys.readouterr().out.startswith("same: 100 ticks, 2 orders")


def test_it_goes_on_from_its_newest_state(drive: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.runs.states.SAVE_EVERY_S", 1.0)
    monkeypatch.setattr("app.runs.states.SAVE_PAUSE_S", 0.0)
    run, end = keep_one(drive)
    state = newest_state(run)
    assert state is not None
    assert state.tick_count in run.hashes
    again = resumed(run)
    assert again.state_hash() == end
    run.hashes[state.tick_count] = "another"
    assert newest_state(run) is None, "a state that the run does not know is not taken up"
    (run.folder / STATE).write_bytes(b"PK")
    assert newest_state(run) is None


def test_cut_off_it_is_offered_and_goes_on_to_the_same_end(drive: Path) -> None:
    straight = Kept()
    straight.play(drive, MOMENTS - 1)
    end = straight.engine.run.session.state_hash()
    straight.keeper.stop()
    run, _ = keep_one(drive, 60, told=False)
    path = run.folder / LINES
    path.write_bytes(path.read_bytes()[:-10])  # as if it had been killed
    cut_off = cut_off_run()
    assert cut_off is not None
    assert (cut_off.name, cut_off.last_tick, cut_off.end) == (run.name, 60, "")
    kept = Kept()
    kept.engine.begin(OFFICE, 1, straight.engine.next_config)
    config = kept.engine.run.session.config
    assert carry_out(kept.engine, m.GoOn(cut_off, resumed(cut_off))) == m.Accepted(60)
    kept.run_for(MOMENTS - 61)
    assert kept.engine.run.session.over
    tell(kept.engine, type="seek", tick=70)
    tell(kept.engine, type="back_to_now")
    assert kept.stop() == end
    whole = open_run(run.folder)
    assert (whole.last_tick, whole.again[0][0]) == (MOMENTS - 1, 60)
    tell(kept.engine, type="reset", world="office")
    assert kept.engine.run.session.config == config


def test_a_branch_is_a_run_of_its_own(drive: Path) -> None:
    kept = Kept()
    kept.play(drive, 80)
    tell(kept.engine, type="seek", tick=30)
    tell(kept.engine, type="go_on_from_here")
    tell(kept.engine, type="set_parameter", name="pose_cells.inhibit", value=0.003)
    kept.run_for(20)
    end = kept.stop()
    assert kept.complaints == []
    assert sorted(open_run(folder).last_tick for folder in all_runs()) == [50, 80]
    branch = next(run for folder in all_runs() if (run := open_run(folder)).last_tick == 50)
    assert replay(branch).state_hash() == end


def test_a_recording_that_has_moved_or_changed_is_a_sentence(copy: Path) -> None:
    run, _ = keep_one(copy, 20)
    elsewhere = copy.with_name("elsewhere")
    copy.rename(elsewhere)
    with pytest.raises(
        ValueError, match=f"the run {run.name} plays the recording .*drive, which is not there any more"
    ):
        resumed(run)
    elsewhere.rename(copy)
    assert replay(run).tick_count == 20
    table = copy / "drive.csv"
    table.write_text(table.read_text().replace("\n5.png,0.5,", "\n5.png,0.51,"))
    with pytest.raises(ValueError, match="which has changed since: the run cannot be played again"):
        resumed(run)


def test_a_run_that_comes_out_differently_says_so(drive: Path) -> None:
    run, _ = keep_one(drive, 40)
    run.orders = []
    with pytest.raises(ReplayError, match="comes out differently from tick 2"):
        replay(run)


def test_what_cannot_be_opened_again_plays_without_being_kept(drive: Path) -> None:
    kept = Kept()
    kept.engine.begin_recording(Player(open_recording(drive), 1))
    kept.run_for(20)
    kept.stop()
    assert kept.complaints == []
    assert all_runs() == []


# ------------------------------------------------------------ exports


def test_it_can_be_had_in_the_formats_that_need_no_office(drive: Path, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("app.cli.export.compile_first", lambda: None)
    run, _ = keep_one(drive, 40)
    for to, files in (
        ("tum", ["out-believed.tum", "out-estimate.tum"]), ("g2o", ["out.g2o"]), ("graphml", ["out.graphml"]),
        ("csv", ["out.csv"]),
    ):  # fmt: skip
        assert main(["export", run.name, "--to", to, "--out", str(tmp_path / f"out.{to}")]) == 0
        assert sorted(path.name for path in tmp_path.glob(f"out*.{to}")) == files
    table = (tmp_path / "out.csv").read_text().splitlines()
    assert len(table) == 1 + 41
    row = dict(zip(table[0].split(","), table[-1].split(","), strict=True))
    assert (row["tick"], row["time_s"], row["true_x"], row["off_m"], row["mode"]) == ("40", "4.0", "", "", "recorded")
    assert 'id="drive"' in (tmp_path / "out.graphml").read_text()
    assert len((tmp_path / "out-estimate.tum").read_text().splitlines()) == 41


@pytest.mark.parametrize("to", ["mcap", "png", "mp4"])
def test_what_shows_an_office_is_refused(to: str, drive: Path, tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.setattr("app.cli.export.compile_first", lambda: None)
    run, _ = keep_one(drive, 20)
    assert main(["export", run.name, "--to", to, "--out", str(tmp_path / f"out.{to}")]) == 2
    assert f"{to} is for runs in an office; the run of a recording can be had as tum, g2o" in capsys.readouterr().err
    assert not list(tmp_path.glob("out*"))


# ------------------------------------------------------------ the digest


def test_it_is_of_names_and_contents(copy: Path) -> None:
    first = fingerprint(copy)
    assert fingerprint(copy) == first
    (copy / "new.txt").write_text("")
    second = fingerprint(copy)
    (copy / "new.txt").rename(copy / "other.txt")
    assert len({first, second, fingerprint(copy)}) == 3


def test_the_table_beside_a_film_counts(tmp_path: Path) -> None:
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
