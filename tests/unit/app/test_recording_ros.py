"""Recordings of ROS robots: which topic is used for what, clocks, gyros on their side, files that were cut off."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import CompressionType

from app.recordings.formats import ros_messages as ros
from app.recordings.formats.ros_packets import Packet
from app.recordings.formats.ros_recording import open_ros
from app.recordings.formats.ros_topics import Choice
from app.recordings.opening import open_recording
from app.recordings.recording import Recording
from tests.recordings import BEAMS, BEGAN_NS, ROS2, N, bag1, bag2, drive, mcap, ros_messages

T = ROS2.types
S = 10**9


def packets(messages: list[tuple[str, str, int, Any]]) -> Iterator[Packet]:
    for number, (topic, type_, time_ns, message) in enumerate(messages):
        yield Packet(topic, type_, False, time_ns, bytes(ROS2.serialize_cdr(message, type_)), number)


def opened(messages: list[tuple[str, str, int, Any]], choice: Choice | None = None) -> Recording:
    return open_ros(Path("made"), "made", lambda _problems: packets(messages), choice)


def header(time_ns: int, frame: str = "base") -> Any:
    stamp = T["builtin_interfaces/msg/Time"](sec=time_ns // S, nanosec=time_ns % S)
    return T["std_msgs/msg/Header"](stamp=stamp, frame_id=frame)


def vector(x: float, y: float, z: float) -> Any:
    return T["geometry_msgs/msg/Vector3"](x, y, z)


def imu(time_ns: int, rate: Any, force: Any) -> tuple[str, str, int, Any]:
    still = T["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    none = np.zeros(9)
    message = T["sensor_msgs/msg/Imu"](header(time_ns), still, none, rate, none, force, none)
    return "/imu", ros.IMU, time_ns, message


def camera_only() -> list[tuple[str, str, int, Any]]:
    return [message for message in ros_messages(False) if message[0] == "/camera/image"]


def test_a_gyro_on_its_side_turns_about_what_is_up() -> None:
    """A camera's gyro: x to the right, y down, z forwards. Turning left is a turn about -y."""
    messages = camera_only()
    messages += [imu(BEGAN_NS + k * S // 20, vector(0.1, -0.7, 0.2), vector(0.0, -9.8, 0.0)) for k in range(2 * N)]
    recording = opened(sorted(messages, key=lambda message: message[2]))
    assert recording.about.has == {"camera", "yaw rate"}
    assert [moment.yaw_rate for moment in recording.moments()][1:] == pytest.approx([0.7] * (N - 1))


def test_wheels_come_before_the_gyro_unless_it_is_asked_for() -> None:
    messages = list(ros_messages(False))
    messages += [imu(BEGAN_NS + k * S // 10, vector(0.0, 0.0, -0.9), vector(0.0, 0.0, 9.8)) for k in range(N)]
    assert list(opened(messages).moments())[3].yaw_rate == drive()[3].yaw_rate
    asked = list(opened(messages, Choice(gyro="/imu")).moments())[3]
    assert (asked.speed, asked.yaw_rate) == (drive()[3].speed, -0.9)


def test_transforms_are_odometry_where_there_is_no_other() -> None:
    messages = camera_only()
    for row in drive():
        x, y, heading = row.pose
        turn = T["geometry_msgs/msg/Quaternion"](0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2))
        parts = [
            T[ros.TRANSFORM](
                header(row.time_ns, parent), child, T["geometry_msgs/msg/Transform"](vector(x_, y, 0.0), turn)
            )
            for parent, child, x_ in (("map", "odom", 5.0), ("/odom", "base_footprint", x))
        ]
        messages.append(("/tf", ros.TF, row.time_ns, T[ros.TF](parts)))
    moments = list(opened(sorted(messages, key=lambda message: message[2])).moments())
    for moment, row in list(zip(moments, drive(), strict=True))[1:]:
        assert (moment.speed, moment.yaw_rate) == pytest.approx((row.speed, row.yaw_rate), rel=1e-6)


def test_times_are_those_of_the_headers_so_that_the_speed_of_recording_does_not_matter() -> None:
    messages = [
        (topic, type_, BEGAN_NS + k * 1000, told) for k, (topic, type_, _, told) in enumerate(ros_messages(False))
    ]
    moments = list(opened(messages).moments())
    assert [moment.time_s for moment in moments] == [k / 10 for k in range(N)]


def test_messages_out_of_order_are_put_in_order() -> None:
    messages = list(ros_messages(False))
    late = messages[:]
    for at in range(0, len(late) - 9, 7):
        late[at], late[at + 6] = late[at + 6], late[at]
    for one, other in zip(opened(messages).moments(), opened(late).moments(), strict=True):
        assert (one.time_s, one.speed, one.truth) == (other.time_s, other.speed, other.truth)
        assert np.array_equal(one.image, other.image)


def test_topics_are_chosen_by_what_they_are_and_can_be_named() -> None:
    messages = list(ros_messages(False))
    depth = [("/camera/depth/image", *message[1:]) for message in camera_only()] * 2
    rear = [("/rear/image", *message[1:]) for message in camera_only()[:3]]
    recording = opened(sorted([*messages, *depth, *rear], key=lambda message: message[2]))
    assert any(use.startswith("camera: /camera/image,") for use in recording.about.uses)
    assert any(use.startswith("truth: /truth,") for use in recording.about.uses)
    named = opened(sorted([*messages, *rear], key=lambda message: message[2]), Choice(camera="/rear/image"))
    assert named.about.moments == 3
    with pytest.raises(ValueError, match=r"topic '/nowhere': not in the recording.*there are: /camera/image"):
        opened(messages, Choice(camera="/nowhere"))


@pytest.mark.parametrize("encoding", ["rgb8", "bgr8", "rgba8", "bgra8", "mono8"])
def test_red_is_red(encoding: str) -> None:
    image = drive()[0].image
    height, width = image.shape[:2]
    order = {"rgb8": [0, 1, 2], "bgr8": [2, 1, 0], "rgba8": [0, 1, 2, 0], "bgra8": [2, 1, 0, 0], "mono8": [1]}[encoding]
    padded = np.zeros((height, width * len(order) + 5), np.uint8)  # rows may be longer than their pixels
    padded[:, :-5] = image[:, :, order].reshape(height, -1)
    told = T[ros.IMAGE](header(S), height, width, encoding, 0, padded.shape[1], padded.reshape(-1))
    seen = ros.picture(Packet("/c", ros.IMAGE, False, 0, bytes(ROS2.serialize_cdr(told, ros.IMAGE)), 0))
    assert np.array_equal(seen, image if encoding != "mono8" else np.repeat(image[:, :, 1:2], 3, axis=2))


def test_a_run_of_ours_brings_its_sonars_and_movements_exactly() -> None:
    messages, exact = list(ros_messages(False)), [0.1 + k / 3 for k in range(BEAMS)]
    layout = T["std_msgs/msg/MultiArrayLayout"]([], 0)
    for k, row in enumerate(drive()):
        messages.append(("/sonars", ros.FLOATS, row.time_ns, T[ros.FLOATS](layout, np.array(exact) + k)))
        messages.append(("/behaviour", ros.NUMBER, row.time_ns, T[ros.NUMBER](k)))
    moments = list(opened(sorted(messages, key=lambda message: message[2])).moments())
    assert [moment.behaviour for moment in moments] == list(range(N))
    assert moments[2].ranges_m is not None
    assert moments[2].ranges_m.tolist() == (np.array(exact) + 2).tolist()


@pytest.mark.parametrize("kind", ["mcap", "bag"])
def test_a_file_that_was_cut_off_is_read_up_to_its_last_whole_chunk(kind: str, tmp_path: Path) -> None:
    path = mcap(tmp_path / "a.mcap") if kind == "mcap" else bag1(tmp_path / "a.bag", "")
    whole = path.read_bytes()
    counts = set[int]()
    for share in (0.4, 0.6, 0.8):
        path.write_bytes(whole[: int(len(whole) * share)])
        recording = open_recording(path)
        moments = list(recording.moments())
        counts.add(len(moments))
        assert "cut off or broken" in recording.about.problems[0]
        for moment, row in zip(moments, drive(), strict=False):
            assert np.array_equal(moment.image, row.image)
    assert 0 not in counts


def test_a_damaged_chunk_is_named_and_the_rest_is_played(tmp_path: Path) -> None:
    path = mcap(tmp_path / "a.mcap", packing=CompressionType.NONE)
    data = bytearray(path.read_bytes())
    at = data.find(b"hello", len(data) // 3)
    data[at] ^= 1
    path.write_bytes(bytes(data))
    recording = open_recording(path)
    assert 0 < len(list(recording.moments())) < N
    assert "chunk" in recording.about.problems[0]
    assert "checksum" in recording.about.problems[0]


def test_a_file_without_anything_to_play_is_refused_with_what_is_in_it(tmp_path: Path) -> None:
    words = [message for message in ros_messages(False) if message[0] == "/words"]
    with pytest.raises(ValueError, match=r"no picture and no scan could be read.*/words \(std_msgs/msg/String\)"):
        opened(words)
    (bag2(tmp_path / "b") / "b.db3").unlink()
    with pytest.raises(ValueError, match=r"without a .db3 or .mcap file"):
        open_recording(tmp_path / "b")


def test_odd_values_in_messages_are_named_and_left_out() -> None:
    messages = list(ros_messages(False))
    for at, (topic, _type, _time, told) in enumerate(messages):
        if topic == "/odom" and at > 10:
            told.twist.twist.linear.x = math.nan
    recording = opened(messages)
    moments = list(recording.moments())
    assert len(moments) == N
    assert moments[-1].speed is not None
    assert math.isfinite(moments[-1].speed)
    assert "(/odom): left out: its twist is not finite" in recording.about.problems[0]
