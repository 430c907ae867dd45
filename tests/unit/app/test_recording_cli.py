"""`ratslam recording check` and `ratslam headless --recording`: what is printed, written and refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from app.cli import command_line as cli
from app.headless.recorded import HEADER, run_recording
from app.recordings.motion import lengths
from app.recordings.opening import Opening, open_recording
from app.recordings.playing import Player
from tests.recordings import N, airsim, drive, image_folder, tub

pytestmark = pytest.mark.slow

SHARED = Path(__file__).parents[4] / "shared" / "data"


def test_check_tells_what_is_in_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = image_folder(tmp_path / "pictures")
    assert cli.main(["recording", "check", str(folder)]) == 0
    told = capsys.readouterr()
    assert "pictures: folder of images with CSV; 8 moments in 0.7 s, 10 a second" in told.out
    assert "speed: column 'linear.x' of wheels.csv" in told.out
    assert "not in it: ranges" in told.out
    assert told.err == ""
    assert cli.main(["recording", "check", str(folder), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert (report["moments"], report["image_shape"], report["lengths"]) == (N, [12, 16], "metres")


def test_who_has_no_wheels_is_told_that_lengths_are_no_metres(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pictures = image_folder(tmp_path / "pictures")
    for table in pictures.glob("*.csv"):
        table.unlink()
    cli.main(["recording", "check", str(pictures), "--rate", "10"])
    assert "lengths are no metres: by pictures alone" in capsys.readouterr().out
    about = open_recording(pictures, Opening(rate_hz=10.0)).about
    assert "2 m/s" in (lengths(replace(about, has=frozenset({"camera", "throttle"}))) or "")


def test_check_names_the_line_and_counts_what_is_left(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tub(tmp_path / "tub")
    catalog = folder / "catalog_1.catalog"
    catalog.write_text(catalog.read_text().replace('"_index": 6', '"_index": 6,,'))
    (folder / "images" / "3_cam_image_array_.png").unlink()
    assert cli.main(["recording", "check", str(folder)]) == 1
    told = capsys.readouterr()
    assert "6 moments" in told.out
    assert "catalog_1.catalog: line 2: left out" in told.err
    assert "catalog_0.catalog: line 4: left out: cannot be read: No such file" in told.err
    for picture in (folder / "images").iterdir():
        picture.write_bytes(b"")
    assert cli.main(["recording", "check", str(folder)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_a_deleted_record_is_left_out_and_the_others_keep_their_numbers(tmp_path: Path) -> None:
    folder = tub(tmp_path / "tub")
    manifest = folder / "manifest.json"
    manifest.write_text(manifest.read_text().replace('"deleted_indexes": []', '"deleted_indexes": [1, 5]'))
    recording = open_recording(folder)
    assert [moment.frame for moment in recording.moments()] == [0, 2, 3, 4, 6, 7]
    assert recording.about.problems == ()


def test_what_cannot_be_played_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "a.mcap").write_bytes(b"no")
    for path in ("nowhere", "empty", "a.mcap"):
        assert cli.main(["recording", "check", str(tmp_path / path)]) == 2
        assert cli.main(["headless", "--recording", str(tmp_path / path)]) == 2
        assert capsys.readouterr().err.count("\n") == 2
    folder = str(image_folder(tmp_path / "pictures"))
    for wrong in (
        ["--recording", folder, "--minutes", "3"], ["--recording", folder, "--kidnaps", "1"], ["--trace", "t.csv"],
        ["--recording", folder, "--world", "loop"], ["--rate", "10"], ["--recording", folder, "--rate", "0"],
        ["--recording", folder, "--set", "nothing=1"], ["--recording", folder, "--odometry-from-truth", "1"],
        ["--recording", folder, "--trace", str(tmp_path / "no" / "t.csv")],
    ):  # fmt: skip
        assert cli.main(["headless", *wrong]) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_headless_writes_a_row_a_frame_and_the_same_again(tmp_path: Path) -> None:
    folder, traces = airsim(tmp_path / "a"), list[bytes]()
    for name in ("one", "two"):
        trace, report = tmp_path / f"{name}.csv", tmp_path / f"{name}.json"
        errors = ["--odometry-from-truth", "0.1,0.02,0.005", "--seed", "3"]
        command = ["headless", "--recording", str(folder), *errors, "--trace", str(trace), "--report", str(report)]
        assert cli.main(command) == 0
        traces.append(trace.read_bytes())
    assert traces[0] == traces[1]
    header, *rows = traces[0].decode().splitlines()
    assert header == HEADER == "frame,time_s,view,experience,x,y,heading_rad,made_at_frame"
    assert [int(row.split(",")[0]) for row in rows] == list(range(N))
    assert all(int(row.split(",")[7]) <= int(row.split(",")[0]) for row in rows)
    told = json.loads(report.read_text())
    assert (told["frames"], told["format"], told["seed"]) == (N, "AirSim", 3)
    assert set(told["error_m"]) == {"map", "odometry"}
    assert "world" not in told


def test_without_a_truth_there_is_no_error(tmp_path: Path) -> None:
    report, trace, brain = run_recording(Player(open_recording(tub(tmp_path / "tub")), 1))
    assert ("error_m" in report, report["metres"] > 0) == (False, True)
    assert len(trace) == report["frames"] == len(drive())
    robot = brain.experience_map.robot
    assert trace.poses(brain.experience_map)[-1] == pytest.approx((robot.x, robot.y, robot.heading_rad), abs=1e-9)


@pytest.mark.parametrize(
    ("path", "moments", "has"),
    [
        ("recordings/office-car", 2391, {"camera", "throttle", "yaw rate"}),
        ("recordings/airsim-track", 1697, {"camera", "truth"}),
        ("logs/intel/intel_gfs.gz", 910, {"ranges", "speed", "yaw rate"}),
    ],
)
def test_recordings_of_others_are_read_whole(path: str, moments: int, has: set[str]) -> None:
    if not (SHARED / path).exists():
        pytest.skip(f"{SHARED / path} is not there")
    recording = open_recording(SHARED / path)
    times, about = [moment.time_s for moment in recording.moments(lambda number: number % 8 == 0)], recording.about
    assert times == sorted(set(times))
    assert times[-1] == pytest.approx(about.seconds)
    assert (len(times), about.moments, about.has, about.problems) == (moments, moments, has, ())
