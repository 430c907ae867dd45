from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ratslam_core import ExperienceMapParams, LocalViewParams, Odometry, Pose2, PoseCellParams, wrap_angle
from ratslam_core.params.parameter import check_ranges, param

places = st.floats(-50, 50)
poses = st.builds(Pose2, places, places, st.floats(-math.pi, math.pi).map(wrap_angle))


def same(a: Pose2, b: Pose2) -> bool:
    turn = math.remainder(a.heading_rad - b.heading_rad, 2 * math.pi)
    return math.hypot(a.x - b.x, a.y - b.y) < 1e-9 and abs(turn) < 1e-9


@given(st.floats(-1000, 1000))
def test_wrapping_keeps_the_direction_in_half_open_range(angle: float) -> None:
    wrapped = wrap_angle(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped - angle) == pytest.approx(1.0, abs=1e-9)


def test_half_a_turn_has_one_name() -> None:
    assert wrap_angle(-math.pi) == math.pi == wrap_angle(math.pi) == wrap_angle(3 * math.pi)


@given(poses, poses, poses)
def test_poses_are_a_group(a: Pose2, b: Pose2, c: Pose2) -> None:
    identity = Pose2(0, 0, 0)
    assert same(a.compose(b).compose(c), a.compose(b.compose(c)))
    assert same(a.compose(identity), a)
    assert same(identity.compose(a), a)
    assert same(a.compose(a.inverse()), identity)
    assert same(a.inverse().compose(a), identity)


def test_composing_goes_along_the_own_heading() -> None:
    assert same(Pose2(1, 2, math.pi / 2).compose(Pose2(3, 1, 0.1)), Pose2(0, 5, math.pi / 2 + 0.1))


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_odometry_is_checked(bad: float) -> None:
    with pytest.raises(ValueError, match=r"odometry\.speed must be a finite number"):
        Odometry(bad, 0.0, 0.1)
    with pytest.raises(ValueError, match=r"odometry\.yaw_rate must be a finite number"):
        Odometry(0.0, bad, 0.1)
    for dt in (bad, 0.0, -1.0):
        with pytest.raises(ValueError, match=r"odometry\.dt must be a positive number of seconds"):
            Odometry(0.0, 0.0, dt)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: PoseCellParams(n_x=7), r"n_x must be between 8 and 1000 cells, got 7"),
        (lambda: PoseCellParams(n_x=20.0), r"n_x must be int, got 20\.0"),  # type: ignore[arg-type]
        (lambda: PoseCellParams(n_x=True), r"n_x must be int, got True"),
        (lambda: PoseCellParams(n_x=1000, n_y=1000, n_theta=68), r"at most 67108864 cells together, got 68000000"),
        (lambda: PoseCellParams(inhibit=math.nan), r"inhibit must be between 0\.0 and 0\.02, got nan"),
        (lambda: PoseCellParams(carry=1), r"carry must be bool, got 1"),  # type: ignore[arg-type]
        (lambda: LocalViewParams(shift=6), r"shift must be between 0 and 5 columns, got 6"),
        (lambda: LocalViewParams(match_threshold="8"), r"match_threshold must be float, got '8'"),  # type: ignore[arg-type]
        (lambda: ExperienceMapParams(correction=-0.1), r"correction must be between 0\.0 and 0\.95, got -0\.1"),
        (lambda: ExperienceMapParams(zone_xy=math.inf), r"zone_xy must be between 0\.5 and 20\.0 cells, got inf"),
    ],
)
def test_a_parameter_out_of_range_is_named_with_its_range(make, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_a_whole_number_serves_as_a_float() -> None:
    assert PoseCellParams(excite_sigma=1).excite_sigma == 1


def test_only_declared_numbers_are_checked() -> None:
    @dataclass(frozen=True)
    class Mixed:
        size: int = param(5, low=1, high=9, meaning="a size", source="test")
        note: str = "free text"

    check_ranges(Mixed(note=""))
    with pytest.raises(ValueError, match="size must be between 1 and 9, got 10"):
        check_ranges(Mixed(size=10))


def test_text_is_one_of_its_choices() -> None:
    @dataclass(frozen=True)
    class Chosen:
        way: str = param("left", choices=("left", "right"), meaning="a way", source="test")

    check_ranges(Chosen(way="right"))
    with pytest.raises(ValueError, match="way must be one of 'left', 'right', got 'up'"):
        check_ranges(Chosen(way="up"))


def test_whatever_a_wrong_value_is_the_error_is_one_line() -> None:
    with pytest.raises(ValueError, match=r"^carry must be bool, got array\(\[\[.*\]\], shape=\(60, 60\)\)$"):
        PoseCellParams(carry=np.zeros((60, 60)))  # type: ignore[arg-type]
