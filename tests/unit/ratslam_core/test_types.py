from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from disk.parameter import check_ranges, param
from ratslam_core import ExperienceMapParams, LocalViewParams, Odometry, Pose2, PoseCellParams, wrap_angle, wrap_angles

places = st.floats(-50, 50)
poses = st.builds(Pose2, places, places, st.floats(-math.pi, math.pi).map(wrap_angle))


def same(a: Pose2, b: Pose2) -> bool:
    turn = math.remainder(a.heading_rad - b.heading_rad, 2 * math.pi)
    return math.hypot(a.x - b.x, a.y - b.y) < 1e-9 and abs(turn) < 1e-9


@given(st.floats(-1000, 1000))
def test_wrapping_keeps_the_direction_in_half_open_range(angle: float) -> None:
    assert -math.pi < wrap_angle(angle) <= math.pi
    assert math.cos(wrap_angle(angle) - angle) == pytest.approx(1.0, abs=1e-9)
    assert wrap_angle(-math.pi) == math.pi == wrap_angle(math.pi) == wrap_angle(3 * math.pi)
    many = wrap_angles(np.array([angle, -math.pi, math.pi]))
    assert np.all(np.abs(many) <= math.pi)
    assert math.cos(many[0] - angle) == pytest.approx(1.0, abs=1e-9)


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


def test_odometry_is_checked() -> None:
    for bad in (math.nan, math.inf):
        for speed, yaw_rate, dt, message in (
            (bad, 0.0, 0.1, r"odometry\.speed must be a finite number"),
            (0.0, bad, 0.1, r"odometry\.yaw_rate must be a finite number"),
            *((0.0, 0.0, dt, r"odometry\.dt must be a positive number of seconds") for dt in (bad, 0.0, -1.0)),
        ):
            with pytest.raises(ValueError, match=message):
                Odometry(speed, yaw_rate, dt)


@dataclass(frozen=True)
class Mixed:
    size: int = param(5, "a size", 1, 9)
    way: str = param("left", "a way", choices=("left", "right"))
    note: str = "free text"

    def __post_init__(self) -> None:
        check_ranges(self)


@pytest.mark.parametrize(
    ("of", "values", "message"),
    [
        (PoseCellParams, {"n_x": 7}, r"n_x must be between 8 and 1000 cells, got 7"),
        (PoseCellParams, {"n_x": 20.0}, r"n_x must be a whole number, got 20\.0"),
        (PoseCellParams, {"n_x": True}, r"n_x must be a number, got True"),
        (PoseCellParams, {"n_x": 1000, "n_y": 1000, "n_theta": 68}, r"at most 67108864 cells together, got 68000000"),
        (PoseCellParams, {"inhibit": math.nan}, r"inhibit must be between 0 and 0\.02, got nan"),
        (ExperienceMapParams, {"pace_floor": 1}, r"pace_floor must be true or false, got 1"),
        (
            ExperienceMapParams,
            {"pace_floor": np.zeros((60, 60))},
            r"^pace_floor must be true or false, got array\(\[\[.*\]\], shape=\(60, 60\)\)$",
        ),
        (LocalViewParams, {"shift": 6}, r"shift must be between 0 and 5 columns, got 6"),
        (LocalViewParams, {"match_threshold": "8"}, r"match_threshold must be a number, got '8'"),
        (ExperienceMapParams, {"correction": -0.1}, r"correction must be between 0 and 0\.95, got -0\.1"),
        (ExperienceMapParams, {"zone_xy": math.inf}, r"zone_xy must be between 0\.5 and 20 cells, got inf"),
        (Mixed, {"size": 10}, "size must be between 1 and 9, got 10"),
        (Mixed, {"way": "up"}, "way must be one of 'left', 'right', got 'up'"),
    ],
)
def test_a_parameter_out_of_range_is_named_with_its_range(of: Any, values: dict[str, Any], message: str) -> None:
    """In one line, whatever a wrong value is; only declared parameters are checked, and a whole number serves as a float."""
    with pytest.raises(ValueError, match=message):
        of(**values)
    assert Mixed(way="right", note="").note == ""
    assert PoseCellParams(excite_sigma=1).excite_sigma == 1
