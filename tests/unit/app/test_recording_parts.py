"""What recordings are made of: rates that are held, clocks that jump, columns of tables, names of files, made odometry."""

from __future__ import annotations

import math
import os
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recordings.formats.lying import by_number
from app.recordings.formats.pictures import read_picture, unpacked, within
from app.recordings.formats.sensed import TOLD, Problems, Rates, ns_of
from app.recordings.formats.streamed import BREAK_S, GOES_ON_S, HELD_S, Clock, Held
from app.recordings.motion import OdometryErrors, WithMadeOdometry, parse_errors
from app.recordings.opening import Opening, open_recording
from disk.words import plain
from ratslam_core import Pose2
from tests.recordings import N, airsim, carmen, drive, image_folder, plain_folder, png

S = 10**9


@given(st.lists(st.tuples(st.integers(1, 9 * S // 10), st.floats(-2, 2)), min_size=1, max_size=30), st.integers(1, 5))
def test_what_is_summed_up_between_moments_is_all_that_was_driven(samples: list[tuple[int, float]], every: int) -> None:
    held, now, begin, way, told = Held(), 0, 0, 0.0, 0.0
    for k, (step, value) in enumerate(samples):
        now += step
        way += value * step
        held.add(now, value)
        if k % every == 0 or k == len(samples) - 1:
            mean = held.mean(begin, now)
            assert mean is not None
            told += mean * (now - begin)
            begin = now
    assert math.isclose(told, way, rel_tol=1e-9, abs_tol=1.0)


def test_a_value_is_returned_bit_for_bit_holds_for_a_second_and_counts_by_its_time() -> None:
    held, ends = Held(), S + round(HELD_S * S)
    assert held.mean(0, S) is None
    held.add(S, 0.1)
    spans = ((0, S), (S, S + S // 3), (S + S // 3, ends), (ends, 9 * S))
    assert [held.mean(*span) for span in spans] == [0.1, 0.1, 0.1, None]
    held.add(10 * S, -0.3)
    assert held.mean(9 * S, 10 * S) == -0.3
    held = Held()
    for time, value in ((1, 1.0), (4, 2.0), (6, 5.0)):
        held.add(time * S, value)
    assert held.mean(0, 5 * S) == pytest.approx((1 * 1 + 3 * 2 + 1 * 5) / 5)
    assert held.mean(5 * S, 6 * S) == 5.0


def test_a_clock_that_was_set_goes_on() -> None:
    problems = Problems()
    clock = Clock(problems)
    assert [clock.at(t * S, "a") for t in (1000, 1001, 1002)] == [0, S, 2 * S]
    jumped = clock.at(5_000_000 * S, "message 4")
    assert jumped == 2 * S + round(GOES_ON_S * S)
    assert clock.at(5_000_001 * S, "b") == jumped + S
    back = clock.at(1003 * S, "message 6")
    assert back == jumped + S + round(GOES_ON_S * S)
    assert clock.at(1003 * S - S // 2, "late") == back
    assert clock.at(round((1003 + BREAK_S) * S), "c") == back + BREAK_S * S
    assert [sentence.split(":")[0] for sentence in problems.sentences] == ["message 4", "message 6"]


@given(st.lists(st.integers(-(10**19), 10**19), min_size=1, max_size=50))
def test_time_never_goes_back(times: list[int]) -> None:
    clock = Clock(Problems())
    mended = [clock.at(time, "x") for time in times]
    assert mended == sorted(mended)
    assert mended[-1] <= len(times) * BREAK_S * S


def test_only_the_first_problems_of_a_kind_are_told() -> None:
    problems = Problems()
    for k in range(TOLD + 5):
        problems.add("lines", f"line {k}", "left out")
    problems.add("lines", "line 0", "left out")
    problems.add("others", "x", "a\nb\x1b[31m")
    assert len(problems.sentences) == TOLD + 2
    assert problems.sentences[-1] == "and 5 more: lines"
    assert problems.sentences[-2] == "x: a b?[31m"
    assert len(plain("x" * 10_000)) < 400


def test_rates_from_poses_lead_from_one_to_the_other() -> None:
    for way, turn in ((-0.3, -3.0), (-0.3, -0.4), (0.8, 0.0), (0.8, 0.7)):
        rates, begin = Rates(), Pose2(1.0, 2.0, 3.0)
        end = begin.compose(Pose2(way * math.cos(turn / 2), way * math.sin(turn / 2), turn))
        assert rates.since(0, (begin.x, begin.y, begin.heading_rad)) is None
        assert rates.since(S // 2, (end.x, end.y, end.heading_rad)) == pytest.approx((way / 0.5, turn / 0.5)), turn
        assert rates.since(S // 2, (0.0, 0.0, 0.0)) is None


def test_times_are_read_to_the_nanosecond() -> None:
    assert ns_of("1709732482.594123457") == 1709732482594123457
    assert ns_of("1597175835440", 10**6) == 1597175835440 * 10**6
    for wrong in ("", "nan", "1e30", "x", "9" * 200, "--1"):
        with pytest.raises(ValueError, match="is no time"):
            ns_of(wrong)


def test_pictures_are_rgb_and_their_size_is_checked_first() -> None:
    image = drive()[0].image
    assert np.array_equal(unpacked(png(image)), image)
    with pytest.raises(ValueError, match="10000 x 9000 pixels"):
        unpacked(b"P6\n10000 9000\n255\n")
    with pytest.raises(ValueError, match="broken"):
        unpacked(png(image)[:-40])


def test_files_are_those_of_the_folder(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "secret.png").write_bytes(png(drive()[0].image))
    (tmp_path / "in" / "link.png").symlink_to(tmp_path / "secret.png")
    os.mkfifo(tmp_path / "in" / "pipe.png")
    for name in ("../secret.png", "link.png", "/etc/passwd", "a/../../secret.png", "..\\secret.png"):
        with pytest.raises(ValueError, match="leads out"):
            within(tmp_path / "in", name)
    with pytest.raises(ValueError, match="not a file"):
        read_picture(within(tmp_path / "in", "pipe.png"))
    assert sorted(["b10", "b9", "a1b2", "a1b10"], key=by_number) == ["a1b2", "a1b10", "b9", "b10"]


def test_damaged_lines_and_pictures_are_named_and_left_out(tmp_path: Path) -> None:
    folder = image_folder(tmp_path / "pictures")
    table = folder / "wheels.csv"
    lines = table.read_text().splitlines()
    lines[2] = lines[2].replace("img1.png", "../x.png")
    lines[3] = lines[3].replace(",0.5,", ",nan,")
    table.write_text("\n".join(lines))
    (folder / "img4.png").write_bytes(b"not a picture")
    recording = open_recording(folder)
    moments = list(recording.moments())
    assert [moment.frame for moment in moments] == [0, 3, 5, 6, 7]
    outside, odd, broken = recording.about.problems
    assert "wheels.csv: line 3" in outside
    assert re.search("line 4.*'nan' is not a finite number", odd)
    assert "line 6: left out: not a picture" in broken
    assert moments[1].dt == pytest.approx(0.3)


def test_pictures_without_a_table_have_the_rate_that_is_given(tmp_path: Path) -> None:
    moments = list(open_recording(plain_folder(tmp_path / "p"), Opening(rate_hz=4)).moments())
    assert [moment.time_s for moment in moments[:3]] == [0, 0.25, 0.5]
    with pytest.raises(ValueError, match="--rate must be"):
        Opening(rate_hz=math.nan)


def test_odometry_made_from_truth_has_the_errors_that_are_asked_for(tmp_path: Path) -> None:
    recording = open_recording(airsim(tmp_path / "a"))
    exact = list(WithMadeOdometry(recording, OdometryErrors(0, 0, 0), 1).moments())
    for moment, row in list(zip(exact, drive(), strict=True))[1:]:
        assert (moment.speed, moment.yaw_rate) == pytest.approx((row.speed, row.yaw_rate), rel=1e-6)
    made = WithMadeOdometry(recording, parse_errors("0.1,0.02,0.005"), 1)
    assert made.about.has >= {"speed", "yaw rate", "truth"}
    noisy = [list(made.moments()), list(made.moments())]
    assert [moment.speed for moment in noisy[0]] == [moment.speed for moment in noisy[1]]
    assert noisy[0][3].speed != exact[3].speed
    with pytest.raises(ValueError, match="has no truth"):
        WithMadeOdometry(open_recording(plain_folder(tmp_path / "p")), OdometryErrors(0, 0, 0), 1)
    for wrong in ("", "1,2", "a,b,c", "nan,0,0", "0.1,0.02,1e9"):
        with pytest.raises(ValueError):
            parse_errors(wrong)


def test_a_log_of_carmen_tells_what_was_used_of_it_and_what_was_not(tmp_path: Path) -> None:
    """Scans alone: no odometry is announced. Few lines of another laser do not hide the one that was meant."""
    path = carmen(tmp_path / "a.log", "RAWLASER1")
    lines = [line for line in path.read_text().splitlines() if not line.startswith("ODOM")]
    few = carmen(tmp_path / "few.log").read_text().splitlines()[2]
    path.write_text("\n".join([*lines, few, "SYNC 1 2", lines[-1].rsplit(" ", 9)[0]]))
    recording = open_recording(path)
    assert len(list(recording.moments())) == N
    about = recording.about
    assert (about.uses, len(about.problems)) == (("ranges: RAWLASER1 lines",), 1)
    assert [(count.what, count.read, count.there) for count in about.counts] == [("RAWLASER1 lines", N, N + 1)]
    assert set(about.unused) == {
        "PARAM, 1 lines: the robot's parameters are not needed", "FLASER, 1 lines: ranges come from RAWLASER1 lines",
        "SYNC, 1 lines: not read",
    }  # fmt: skip
