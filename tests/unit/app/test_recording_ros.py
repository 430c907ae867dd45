"""Recordings of ROS robots: which topic is used for what, clocks, gyros on their side, files that were cut off."""

from __future__ import annotations

import copy
import math
import sqlite3
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zstandard
from mcap.writer import CompressionType
from rosbags.rosbag1 import Writer as Bag1
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from app.recordings.formats import ros_messages as ros
from app.recordings.formats.ros_messages import Packet, decoded
from app.recordings.formats.ros_recording import open_ros
from app.recordings.formats.ros_topics import Choice
from app.recordings.opening import open_recording
from app.recordings.recording import Recording
from tests.recordings import BEAMS, BEGAN_NS, ROS1, ROS2, N, bag1, bag2, db3, drive, mcap, ros_messages

T, S = ROS2.types, 10**9
Told = tuple[str, str, int, Any]
DRIVEN, SHOWN = np.array([(row.speed, row.yaw_rate) for row in drive()[1:]]), np.array([row.image for row in drive()])


def whole() -> list[Told]:
    return list(ros_messages(False))


def pictures(topic: str = "/camera/image") -> list[Told]:
    return [(topic, *message[1:]) for message in whole() if message[0] == "/camera/image"]


def in_order(*parts: Iterable[Told]) -> list[Told]:
    return sorted(chain(*parts), key=lambda message: message[2])


def packets(messages: list[Told]) -> Iterator[Packet]:
    for number, (topic, type_, time_ns, message) in enumerate(messages):
        yield Packet(topic, type_, False, time_ns, bytes(ROS2.serialize_cdr(message, type_)), number)


def opened(messages: list[Told], choice: Choice | None = None) -> Recording:
    return open_ros(Path("made"), "made", lambda _problems: packets(messages), choice)


def motion(recording: Recording) -> np.ndarray:
    """Speed and yaw rate of all moments but the first, which has no pose before it."""
    return np.array([(moment.speed, moment.yaw_rate) for moment in recording.moments()][1:])


def shown(recording: Recording) -> np.ndarray:
    return np.array([moment.image for moment in recording.moments()])


def header(time_ns: int, frame: str = "base", types: Any = T) -> Any:
    stamp = types["builtin_interfaces/msg/Time"](sec=time_ns // S, nanosec=time_ns % S)
    return types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame, **({} if types is T else {"seq": 0}))


def imu(time_ns: int, rate: tuple[float, float, float], force: tuple[float, float, float] = (0.0, 0.0, 9.8)) -> Told:
    still, none, vector = (
        T["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0),
        np.zeros(9),
        T["geometry_msgs/msg/Vector3"],
    )
    message = T["sensor_msgs/msg/Imu"](header(time_ns), still, none, vector(*rate), none, vector(*force), none)
    return "/imu", ros.IMU, time_ns, message


def transform(time_ns: int, parent: str, child: str, pose: tuple[float, float, float], types: Any = T) -> Any:
    x, y, heading = pose
    turn = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2))
    placed = types["geometry_msgs/msg/Transform"](types["geometry_msgs/msg/Vector3"](x, y, 0.0), turn)
    return types[ros.TRANSFORM](header(time_ns, parent, types), child, placed)


# ---------------------------------------------------------------- odometry


def test_a_gyro_on_its_side_turns_about_what_is_up() -> None:
    """A camera's gyro: x to the right, y down, z forwards. Turning left is a turn about -y."""
    gyro = [imu(BEGAN_NS + k * S // 20, (0.1, -0.7, 0.2), (0.0, -9.8, 0.0)) for k in range(2 * N)]
    recording = opened(in_order(pictures(), gyro))
    assert recording.about.has == {"camera", "yaw rate"}
    assert [moment.yaw_rate for moment in recording.moments()][1:] == pytest.approx([0.7] * (N - 1))


def test_wheels_come_before_the_gyro_unless_it_is_asked_for() -> None:
    messages = whole() + [imu(BEGAN_NS + k * S // 10, (0.0, 0.0, -0.9)) for k in range(N)]
    assert motion(opened(messages))[2].tolist() == DRIVEN[2].tolist()
    assert motion(opened(messages, Choice(gyro="/imu")))[2].tolist() == [DRIVEN[2][0], -0.9]


def test_the_transform_that_moves_the_robot_is_odometry_whatever_its_names(subtests: pytest.Subtests) -> None:
    for parent, child, over in (
        ("/odom", "base_footprint", False), ("odom_combined", "base_footprint", False),
        ("/robot1/odom", "robot1/base_link", False), ("odom_frame", "lidar", False), ("base_link", "odom_lidar", True),
        ("world", "chassis", False), ("base_link", "wheel_left", None), ("map", "person", None),
    ):  # fmt: skip
        messages = pictures()
        for row in drive():
            x, y, heading = row.pose
            cos, sin = math.cos(heading), math.sin(heading)
            pose = (-(x * cos + y * sin), x * sin - y * cos, -heading) if over else row.pose
            parts = [transform(row.time_ns, parent, child, pose)]
            if parent == "/odom":
                parts.insert(0, transform(row.time_ns, "map", "odom", (5.0, y, heading)))
            messages.append(("/tf", ros.TF, row.time_ns, T[ros.TF](parts)))
        recording = opened(in_order(messages))
        with subtests.test(f"{parent} -> {child}"):
            if over is not None:
                assert motion(recording) == pytest.approx(DRIVEN, rel=1e-6)
                continue
            list(recording.moments())
            assert recording.about.has == {"camera"}
            assert not any("/tf" in use for use in recording.about.uses)
            told = f"/tf, {N} messages: no transform odom -> base_link among: {parent} -> {child}"
            assert recording.about.unused == (told,)


def test_types_are_as_the_bag_defines_them(tmp_path: Path, subtests: pytest.Subtests) -> None:
    """rosbags' table of ROS 1 has neither type, and none with a field that somebody added."""
    for k, type_ in enumerate((ros.TF, ros.TF_OLD)):
        types, path = get_typestore(Stores.ROS1_NOETIC), tmp_path / f"{k}.bag"
        types.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms\nuint8 more", type_))
        with Bag1(path) as bag:
            camera = bag.add_connection("/camera/image", ros.IMAGE, typestore=ROS1)
            tf = bag.add_connection("/tf", type_, typestore=types)
            images = [told for topic, _, _, told in ros_messages(True) if topic == "/camera/image"]
            for row, image in zip(drive(), images, strict=True):
                told = types.types[type_]([transform(row.time_ns, "odom", "base_link", row.pose, types.types)], 7)
                bag.write(camera, row.time_ns, ROS1.serialize_ros1(image, ros.IMAGE))
                bag.write(tf, row.time_ns, types.serialize_ros1(told, type_))
        with subtests.test(type_):
            recording = open_recording(path)
            assert motion(recording) == pytest.approx(DRIVEN, rel=1e-6)
            assert recording.about.whole


def round_a_circle(
    twist_of: Callable[[float], float], gyro: float | None = None, ticks: int = 100, pauses: bool = False
) -> Recording:
    """At 1 m/s and 1 rad/s, by poses. twist_of: what the odometry says of its speed at a heading; gyro: rad/s, with
    pauses of two seconds in five, or none."""
    messages, picture = list[Told](), pictures()[0][3]
    plain = next(told for topic, _, _, told in whole() if topic == "/odom")
    for k in range(ticks + 1):
        time, heading = BEGAN_NS + k * S // 10, k / 10
        told, image = copy.deepcopy(plain), copy.deepcopy(picture)
        told.header.stamp = image.header.stamp = header(time).stamp
        place, turn, twist = told.pose.pose.position, told.pose.pose.orientation, told.twist.twist
        place.x, place.y = math.sin(heading), -math.cos(heading)
        turn.z, turn.w = math.sin(heading / 2), math.cos(heading / 2)
        twist.linear.x, twist.angular.z = twist_of(heading), 1.0
        messages += [("/odom", ros.ODOMETRY, time, told), ("/camera/image", ros.IMAGE, time, image)]
        if gyro is not None and not (pauses and k % 50 < 20):
            messages.append(imu(time + S // 10, (0.0, 0.0, gyro)))
    return opened(messages)


def test_a_twist_of_another_scale_is_said(subtests: pytest.Subtests) -> None:
    """One that does not lead from pose to pose at all is not believed: in the world's frame, or in km/h."""
    twists: list[tuple[str, Callable[[float], float], float, str | None]] = [
        (
            "a fifth more",
            lambda _: 1.2,
            1.2,
            "way by its twist is 20% longer than that by its poses; the twist is used",
        ),
        (
            "a fifth less",
            lambda _: 0.8,
            0.8,
            "way by its twist is 20% shorter than that by its poses; the twist is used",
        ),
        ("nearly", lambda _: 1.05, 1.05, None),
        ("the world's frame", math.cos, 1.0, "its twist does not lead from one pose to the next"),
        ("km/h", lambda _: 3.6, 1.0, "its twist does not lead from one pose to the next"),
    ]
    for kind, twist, speed, words in twists:
        with subtests.test(kind):
            recording = round_a_circle(twist)
            assert motion(recording)[:, 0] == pytest.approx(np.full(100, speed), rel=1e-3 if speed == 1.0 else 1e-6)
            said = [problem for problem in recording.about.problems if "twist" in problem]
            assert [str(words) in problem for problem in said] == [True] * (words is not None)


def test_a_gyro_that_turns_otherwise_than_the_wheels(subtests: pytest.Subtests) -> None:
    """Late by a tenth of a second, as drivers are; another sign, degrees, and one that is dead."""
    for gyro, contradicts in ((1.0, False), (1.2, False), (-1.0, True), (57.3, True), (0.0, True)):
        with subtests.test(f"{gyro} rad/s"):
            problems = round_a_circle(lambda _: 1.0, gyro, ticks=300).about.problems
            said = [words for words in problems if "it turns otherwise than /odom" in words]
            assert [words[:6] for words in said] == ["/imu: "] * contradicts
            assert all("the wheels are used; --gyro-topic takes the gyro" in words for words in said)
            paused = round_a_circle(lambda _: 1.0, gyro, ticks=300, pauses=True)
            assert "otherwise" not in str(paused.about.problems)


# ---------------------------------------------------------------- times, topics, and what is left out


def test_times_are_those_of_the_headers_so_that_the_speed_of_recording_does_not_matter() -> None:
    messages = [(topic, type_, BEGAN_NS + k * 1000, told) for k, (topic, type_, _, told) in enumerate(whole())]
    assert [moment.time_s for moment in opened(messages).moments()] == [k / 10 for k in range(N)]


def test_headers_of_different_clocks_are_not_believed() -> None:
    messages = whole()
    for topic, _, time_ns, told in messages:
        if topic == "/camera/image":
            told.header = header(time_ns - 1_699_999_400 * S)
    about = opened(messages).about
    assert "the clocks of /camera/image and /odom are 1.7e+09 s apart" in about.problems[0]
    assert about.seconds == pytest.approx((N - 1) / 10)
    assert not any("headers" in use and "since" not in use for use in about.uses)


def test_messages_out_of_order_are_put_in_order() -> None:
    late = whole()
    for at in range(0, len(late) - 9, 7):
        late[at], late[at + 6] = late[at + 6], late[at]
    for one, other in zip(opened(whole()).moments(), opened(late).moments(), strict=True):
        assert (one.time_s, one.speed, one.truth) == (other.time_s, other.speed, other.truth)
    assert np.array_equal(shown(opened(late)), SHOWN)


def test_topics_are_chosen_by_what_they_are_and_can_be_named() -> None:
    rear = pictures("/rear/image")[:3]
    recording = opened(in_order(whole(), pictures("/camera/depth/image") * 2, rear))
    assert any(use.startswith("camera: /camera/image,") for use in recording.about.uses)
    assert any(use.startswith("truth: /truth,") for use in recording.about.uses)
    assert recording.about.range_limit_m == 30.0
    assert opened(in_order(whole(), rear), Choice(camera="/rear/image")).about.moments == 3
    with pytest.raises(ValueError, match=r"topic '/nowhere': not in the recording.*there are: /camera/image"):
        opened(whole(), Choice(camera="/nowhere"))


def test_a_run_of_ours_brings_its_sonars_and_movements_exactly() -> None:
    messages, exact = whole(), np.array([0.1 + k / 3 for k in range(BEAMS)])
    layout = T["std_msgs/msg/MultiArrayLayout"]([], 0)
    for k, row in enumerate(drive()):
        messages.append(("/sonars", ros.FLOATS, row.time_ns, T[ros.FLOATS](layout, exact + k)))
        messages.append(("/behaviour", ros.NUMBER, row.time_ns, T[ros.NUMBER](k)))
    moments = list(opened(in_order(messages)).moments())
    assert [moment.behaviour for moment in moments] == list(range(N))
    assert np.array_equal(moments[2].ranges_m, exact + 2)  # type: ignore[arg-type]


def test_scans_whose_rays_vary_are_laid_on_one_another_by_angle() -> None:
    messages = list[Told]()
    for k, count in enumerate((20, 100, 101, 99, 100, 98, 0, 30)):
        step = math.tau / max(count, 1) if k < 7 else 0.01  # the last one looks at a part of it
        ranges = (3 + np.cos(-math.pi + step * np.arange(count))).astype(np.float32)
        ranges[count // 2 : count // 2 + 1] = np.nan
        told = T[ros.SCAN](header(BEGAN_NS + k * S), -math.pi, math.pi, step, 0.0, 1.0, 0.1, 30.0, ranges, ranges[:0])
        messages.append(("/scan", ros.SCAN, BEGAN_NS + k * S, told))
    recording = opened(messages)
    angles, moments = np.array(recording.about.beam_angles_rad), list(recording.moments())
    assert (len(angles), len(moments)) == (99, 6)
    for moment in moments:
        assert moment.ranges_m is not None
        seen = np.isfinite(moment.ranges_m)
        assert seen.mean() > 0.9
        assert np.abs(moment.ranges_m - (3 + np.cos(angles)))[seen].max() < 0.17
    assert [(count.read, count.there) for count in recording.about.counts] == [(6, 8)]
    assert "it has no ranges" in recording.about.problems[0]


def test_every_message_is_read_left_out_with_a_word_or_told_of_as_unused() -> None:
    once = ("/tf", ros.TF, BEGAN_NS, T[ros.TF]([transform(BEGAN_NS, "map", "odom", (1.0, 0.0, 0.0))]))
    gyro = [imu(BEGAN_NS + k * S // 10, (0.0, 0.0, 1.0)) for k in range(3)]
    messages = in_order(whole(), gyro, pictures("/depth/image"), pictures("/rear/image")[:3], [once])
    images = [told for topic, _, _, told in messages if topic == "/camera/image"]
    images[2].encoding = "secret"
    images[5].data = images[5].data[:-30]
    wheels = [at for at, message in enumerate(messages) if message[0] == "/odom"]
    messages[wheels[-1]][3].twist.twist.linear.x = math.nan
    sent = list(packets(messages))
    sent[wheels[0]] = replace(sent[wheels[0]], data=sent[wheels[0]].data[:99])
    recording = open_ros(Path("made"), "made", lambda _problems: iter(sent), None)
    moments = list(recording.moments())  # all of it is read, as by `ratslam recording check`
    assert len(moments) == N - 2
    assert math.isfinite(moments[-1].speed)  # type: ignore[arg-type]
    about = recording.about
    assert sum("(/odom): left out: its twist is not finite" in problem for problem in about.problems) == 1
    left = sum(int(sentence.split(", ")[1].split(" ")[0]) for sentence in about.unused)
    assert sum(count.there for count in about.counts) + left == len(messages)
    assert sum(count.there - count.read for count in about.counts) == len(about.problems) == 4
    assert not about.whole
    assert set(about.unused) >= {
        "/imu, 3 messages: yaw rate comes from /odom; --gyro-topic takes this one",
        f"/depth/image, {N} messages: not a camera by its name; --camera-topic takes it",
        "/rear/image, 3 messages: camera comes from /camera/image; --camera-topic takes this one",
        "/tf, 1 messages: odometry comes from /odom",
        f"/words, {N} messages: type std_msgs/msg/String is not read",
    }


# ---------------------------------------------------------------- files


def test_a_file_that_was_cut_off_is_read_up_to_its_last_whole_chunk(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for path in (mcap(tmp_path / "a.mcap"), bag1(tmp_path / "a.bag", "")):
        data = path.read_bytes()
        for share in (0.4, 0.6, 0.8):
            path.write_bytes(data[: int(len(data) * share)])
            with subtests.test(f"{share} of {path.name}"):
                recording = open_recording(path)
                seen = shown(recording)
                assert "cut off or broken" in recording.about.problems[0]
                assert np.array_equal(seen, SHOWN[: len(seen) or 1])


def test_a_damaged_chunk_is_named_and_the_rest_is_played(tmp_path: Path) -> None:
    path = mcap(tmp_path / "a.mcap", packing=CompressionType.NONE)
    data = bytearray(path.read_bytes())
    data[data.find(b"hello", len(data) // 3)] ^= 1
    path.write_bytes(bytes(data))
    recording = open_recording(path)
    assert 0 < len(list(recording.moments())) < N
    assert "chunk" in recording.about.problems[0]
    assert "checksum" in recording.about.problems[0]


def test_a_file_without_anything_to_play_is_refused_with_what_is_in_it(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no picture and no scan could be read.*/words \(std_msgs/msg/String\)"):
        opened([message for message in whole() if message[0] == "/words"])
    (bag2(tmp_path / "b") / "b.db3").unlink()
    with pytest.raises(ValueError, match=r"without a .db3 or .mcap file"):
        open_recording(tmp_path / "b")


def test_what_a_killed_recorder_left_beside_its_file_is_read_and_nothing_is_written_there(tmp_path: Path) -> None:
    path, home = db3(tmp_path / "a.db3"), tmp_path / "killed"
    home.mkdir()
    base = sqlite3.connect(path)
    base.execute("PRAGMA journal_mode=WAL")
    base.execute("CREATE TABLE late AS SELECT * FROM messages WHERE id > 20")
    base.execute("DELETE FROM messages WHERE id > 20")
    base.commit()
    base.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    base.execute("INSERT INTO messages SELECT * FROM late")
    base.commit()
    for end in ("", "-wal", "-shm"):
        (home / f"a.db3{end}").write_bytes(Path(f"{path}{end}").read_bytes())
    base.close()
    before = {file.name: file.read_bytes() for file in home.iterdir()}
    assert len(list(open_recording(home).moments())) == len(list(open_recording(home / "a.db3").moments())) == N
    assert {file.name: file.read_bytes() for file in home.iterdir()} == before


def test_what_rosbag2_packed_is_unpacked(tmp_path: Path) -> None:
    path, packed = db3(tmp_path / "a.db3"), tmp_path / "whole" / "a.db3.zstd"
    packed.parent.mkdir()
    packed.write_bytes(zstandard.compress(path.read_bytes()))
    base = sqlite3.connect(path)
    for id_, data in base.execute("SELECT id, data FROM messages").fetchall():
        base.execute("UPDATE messages SET data = ? WHERE id = ?", (zstandard.compress(data), id_))
    base.commit()
    base.close()
    for made in (path, packed, packed.parent):
        recording = open_recording(made)
        assert np.array_equal(shown(recording), SHOWN)
        assert recording.about.problems == ()


def test_messages_that_the_recorder_counted_are_missed(tmp_path: Path) -> None:
    folder = bag2(tmp_path / "b")
    base = sqlite3.connect(next(folder.glob("*.db3")))
    base.execute("DELETE FROM messages WHERE id % 3 = 0")
    base.commit()
    base.close()
    assert "metadata.yaml: tells of 40 messages, but there are 27" in open_recording(folder).about.problems


# ---------------------------------------------------------------- pictures


def test_the_usual_picture_is_the_rule_and_not_the_first() -> None:
    messages = pictures()
    for at, (height, width) in ((0, (6, 8)), (4, (12, 8))):
        told = messages[at][3]
        told.height, told.width, told.step = height, width, width * 3
        told.data = np.zeros(height * width * 3, np.uint8)
    recording = opened(messages)
    assert [moment.frame for moment in recording.moments()] == [0, 1, 2, 3, 5, 6, 7]
    assert recording.about.image_shape == (12, 16)
    assert "8 x 6 pixels, but most pictures have 16 x 12" in recording.about.problems[0]


def test_red_is_red(subtests: pytest.Subtests) -> None:
    image = drive()[0].image
    height, width = image.shape[:2]
    for encoding, order in (
        ("rgb8", [0, 1, 2]), ("bgr8", [2, 1, 0]), ("rgba8", [0, 1, 2, 0]), ("bgra8", [2, 1, 0, 0]), ("mono8", [1]),
    ):  # fmt: skip
        padded = np.zeros((height, width * len(order) + 5), np.uint8)  # rows may be longer than their pixels
        padded[:, :-5] = image[:, :, order].reshape(height, -1)
        told = T[ros.IMAGE](header(S), height, width, encoding, 0, padded.shape[1], padded.reshape(-1))
        seen = ros.picture(next(packets([("/c", ros.IMAGE, 0, told)])))
        with subtests.test(encoding):
            assert np.array_equal(seen, image if encoding != "mono8" else np.repeat(image[:, :, 1:2], 3, axis=2))


def test_pictures_in_the_colours_of_video(subtests: pytest.Subtests) -> None:
    """One colour: Y, U, V of orange."""
    h, w, (y, u, v) = 4, 6, (170, 40, 190)
    packed, light = [u, y, v, y] * (h * w // 2), [y] * h * w
    for encoding, pixels in {
        "uyvy": packed, "yuv422": packed, "yuv422_yuy2": [y, u, y, v] * (h * w // 2),
        "NV12": light + [u, v] * (h * w // 4), "nv21": light + [v, u] * (h * w // 4),
        "i420": light + [u] * (h * w // 4) + [v] * (h * w // 4), "nv24": light + [u, v] * h * w,
    }.items():  # fmt: skip
        data = np.array(pixels, np.uint8)
        step = len(data) // h if encoding.startswith(("u", "y")) else w
        with subtests.test(encoding):
            seen = decoded(encoding, w, h, step, data)
            assert seen.shape == (h, w, 3)
            assert (np.ptp(seen, axis=(0, 1)) <= 1).all()
            red, green, blue = seen[0, 0].tolist()
            assert red > 240 > 180 > green > 110 > 60 > blue
            with pytest.raises(ValueError, match="bytes are too few"):
                decoded(encoding, w, h, step, data[:-1])


def test_pictures_of_bare_sensors(subtests: pytest.Subtests) -> None:
    colours = {"r": 200, "g": 100, "b": 50}
    for pattern in ("rggb", "bggr", "gbrg", "grbg"):
        raw = np.tile(np.array([colours[c] for c in pattern], np.uint16).reshape(2, 2), (4, 4))
        for depth, data in ((8, raw.astype(np.uint8)), (16, (raw << 8).astype(">u2").view(np.uint8))):
            with subtests.test(f"{pattern}{depth}"):
                seen = decoded(f"bayer_{pattern}{depth}", 8, 8, depth, data.reshape(-1), True)
                assert np.abs(seen[2:6, 2:6].astype(int) - [200, 100, 50]).max() <= 1


def test_a_video_in_pieces_is_named() -> None:
    told = T[ros.COMPRESSED](header(S), "h264", np.frombuffer(b"\0\0\0\1abc", np.uint8))
    with pytest.raises(ValueError, match=r"a piece of a video, said to be 'h264'"):
        ros.picture(next(packets([("/c", ros.COMPRESSED, 0, told)])))
