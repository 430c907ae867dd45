"""Folders as data sets and driving courses come, tables as spreadsheets write them, and archives of any of them."""

from __future__ import annotations

import gc
import io
import json
import math
import tarfile
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.recordings.opening import Checked, check, open_recording
from tests.recordings import BEGAN_NS, HZ, N, drive, png, tub

STEP_NS = 10**9 // HZ
TIMES = [BEGAN_NS + k * STEP_NS for k in range(N)]


def wrote(folder: Path, name: str, *lines: str) -> None:
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text("\n".join(lines) + "\n")


def picture(folder: Path, name: str, image: np.ndarray) -> None:
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(png(image))


def pictures(folder: Path, *names: str) -> None:
    for name, row in zip(names, drive(), strict=False):
        picture(folder, name, row.image)


def checked(path: Path) -> Checked:
    return check(open_recording(path))


def seconds(ns: int) -> str:
    return f"{ns // 10**9}.{ns % 10**9:09d}"


def euroc(folder: Path) -> None:
    """Its body's x is up, and its camera looks along z. The gyro turns about that x."""
    for camera in ("cam0", "cam1"):
        pictures(folder, *(f"mav0/{camera}/data/{time}.png" for time in TIMES))
        lines = [f"{time},{time}.png" for time in TIMES]
        wrote(folder, f"mav0/{camera}/data.csv", "#timestamp [ns],filename", *lines)
    measured = {"w_RS_S": "rad s^-1", "a_RS_S": "m s^-2"}
    imu = ",".join(f"{kind}_{axis} [{unit}]" for kind, unit in measured.items() for axis in "xyz")
    rows = [f"{time},{row.yaw_rate},0,0,9.81,0,0" for time, row in zip(TIMES, drive(), strict=True)]
    wrote(folder, "mav0/imu0/data.csv", f"#timestamp [ns],{imu}", *rows)
    wrote(folder, "mav0/body.yaml", "comment: nothing")


def tum(folder: Path) -> None:
    for kind in ("rgb", "depth"):
        pictures(folder, *(f"{kind}/{seconds(time)}.png" for time in TIMES))
        lines = [f"{seconds(time)} {kind}/{seconds(time)}.png" for time in TIMES]
        wrote(folder, f"{kind}.txt", f"# {kind} images", "# file: 'x.bag'", "# timestamp filename", *lines)
    truth = list[str]()
    for time, row in zip(TIMES, drive(), strict=True):
        x, y, heading = row.pose
        truth.append(f"{seconds(time)} {x} {y} 1.2 0 0 {math.sin(heading / 2)} {math.cos(heading / 2)}")
    wrote(folder, "groundtruth.txt", "# timestamp tx ty tz qx qy qz qw", *truth)


def kitti(folder: Path) -> None:
    """Poses are in the first camera's axes: right, down, forwards."""
    for camera in ("image_0", "image_1"):
        pictures(folder, *(f"{camera}/{k:06d}.png" for k in range(N)))
    wrote(folder, "times.txt", *(f"{k / HZ:e}" for k in range(N)))
    rows = list[str]()
    for row in drive():
        (x, y, heading) = row.pose
        c, s = math.cos(heading), math.sin(heading)
        rows.append(f"{c} 0 {-s} {-y} 0 1 0 0 {s} 0 {c} {x}")
    wrote(folder, "poses/00.txt", *rows)


def udacity(folder: Path, header: bool = False) -> None:
    lines = ["center,left,right,steering,throttle,brake,speed"] if header else []
    for k, row in enumerate(drive()):
        names = [f"{side}_2016_12_01_13_30_00_{k * 100:03d}.png" for side in ("center", "left", "right")]
        for name in names:
            picture(folder, f"IMG/{name}", row.image)
        paths = ", ".join(f"C:\\Users\\a student\\run1\\IMG\\{name}" for name in names)
        lines.append(f"{paths}, 0.05, 0.4, 0, {row.speed / 0.44704}")
    wrote(folder, "driving_log.csv", *lines)


def udacity_real(folder: Path) -> None:
    """One table for three cameras."""
    lines = ["index,timestamp,width,height,frame_id,filename,angle,torque,speed,lat,long,alt"]
    for k, (time, row) in enumerate(zip(TIMES, drive(), strict=True)):
        for side in ("left", "center", "right"):
            name = f"{side}/{time}.png"
            picture(folder, name, row.image)
            lines.append(f"{k},{time},640,480,{side}_camera,{name},0.1,0,{row.speed},37.4,-122.1,12")
    wrote(folder, "interpolated.csv", *lines)


def associations(folder: Path) -> None:
    """ICL-NUIM: the times are the numbers of the pictures."""
    for kind in ("rgb", "depth"):
        pictures(folder, *(f"{kind}/{k}.png" for k in range(N)))
    wrote(folder, "associations.txt", *(f"{k} depth/{k}.png {k} rgb/{k}.png" for k in range(N)))


def seven_scenes(folder: Path) -> None:
    for kind in ("color", "depth"):
        pictures(folder, *(f"frame-{k:06d}.{kind}.png" for k in range(N)))
    for k in range(N):
        wrote(folder, f"frame-{k:06d}.pose.txt", "1 0 0 0", "0 1 0 0", "0 0 1 0", "0 0 0 1")


# Of each: what it has besides pictures, and words that must be told of what is not used.
FOLDERS: dict[str, tuple[Callable[[Path], None], set[str], list[str]]] = {
    "EuRoC": (euroc, {"yaw rate"}, ["8 files .png in mav0/cam1/data", "mav0/cam1/data.csv", "mav0/body.yaml"]),
    "TUM": (tum, {"truth"}, ["8 files .png in depth", "depth.txt"]),
    "KITTI": (kitti, {"truth"}, ["8 files .png in image_1"]),
    "Udacity": (udacity, {"speed", "throttle"}, ["16 files .png in IMG", "'steering'"]),
    "Udacity with a header": (lambda folder: udacity(folder, True), {"speed", "throttle"}, ["16 files .png in IMG"]),
    "Udacity's real car": (udacity_real, {"speed"}, ["8 files .png in left", "8 files .png in right", "'lat'"]),
    "ICL-NUIM": (associations, set(), ["8 files .png in depth"]),
    "7-scenes": (seven_scenes, set(), ["8 files .png: ", "8 files .txt: "]),
}


@pytest.mark.parametrize("name", FOLDERS)
def test_a_folder_of_a_data_set_is_played_and_what_is_not_used_is_told(name: str, tmp_path: Path) -> None:
    write, has, told = FOLDERS[name]
    write(tmp_path / "set")
    recording = open_recording(tmp_path / "set")
    moments, about = list(recording.moments()), recording.about
    assert about.problems == ()
    assert about.has == {"camera", *has}
    assert [moment.time_s for moment in moments] == pytest.approx([k / HZ for k in range(N)])
    for moment, row in zip(moments, drive(), strict=True):
        assert np.array_equal(moment.image, row.image)
        assert "speed" not in has or moment.speed == pytest.approx(row.speed)
        assert "yaw rate" not in has or moment.yaw_rate == pytest.approx(row.yaw_rate)
        assert "truth" not in has or moment.truth == pytest.approx(row.pose, abs=1e-6)
    for words in told:
        assert any(words in sentence for sentence in about.unused), (words, about.unused)
    assert not about.whole


def test_a_data_set_is_opened_at_any_level(tmp_path: Path) -> None:
    euroc(tmp_path)
    for place in ("mav0", "mav0/cam0", "mav0/cam0/data"):
        told = checked(tmp_path / place)
        assert (told.moments, told.seconds) == (N, pytest.approx((N - 1) / HZ)), place


NAMES = {
    "ns": lambda k: f"{TIMES[k]}", "us": lambda k: f"f{TIMES[k] // 1000}", "ms": lambda k: f"{TIMES[k] // 10**6}_cam",
    "s with a point": lambda k: f"{seconds(TIMES[k])}", "since the start": lambda k: f"{k / HZ:.3f}",
    "with a unit": lambda k: f"at_{k * 100}ms", "a date": lambda k: f"20240229_235959_{k * 100:03d}",
}  # fmt: skip


def test_times_in_names_count(tmp_path: Path, subtests: pytest.Subtests) -> None:
    some = [k for k in range(N) if k != 4]  # one was lost
    for how, name in NAMES.items():
        with subtests.test(msg=how):
            pictures(tmp_path / how, *(f"{name(k)}.png" for k in some))
            times = [moment.time_s for moment in open_recording(tmp_path / how).moments()]
            assert times == pytest.approx([k / HZ for k in some], abs=1e-3)


def test_times_of_a_table_are_compared_with_those_of_the_names(tmp_path: Path) -> None:
    slow, other = tmp_path / "slow", tmp_path / "other"
    for folder in (slow, other):
        pictures(folder, *(f"{time}.png" for time in TIMES))
    wrote(slow, "a.csv", "time_s,image", *(f"{k / HZ * 30},{time}.png" for k, time in enumerate(TIMES)))
    assert "its times span 21 s, those in the names of its pictures 0.7 s" in checked(slow).about.problems[0]
    wrote(other, "imu.csv", "time_s,yaw_rate", *(f"{k / 100},1" for k in range(50)))
    about = checked(other).about
    assert about.has == {"camera"}
    assert "imu.csv: its times are not those of the pictures" in about.unused


ROWS = [("image", "time_s", "speed", "yaw_rate")]
ROWS += [(f"bild {k}.png", f"{k / HZ:.2f}", f"{row.speed:.3f}", f"{row.yaw_rate}") for k, row in enumerate(drive())]


def table(by: str, comma: bool = False, end: str = "\n", quote: bool = False, before: str = "", after: str = "") -> str:
    def cell(text: str) -> str:
        text = text.replace(".", ",") if comma and not text.endswith("png") else text
        return f'"{text}"' if quote else text

    return before + "".join(by.join(map(cell, row)) + after + end for row in ROWS)


TABLES: dict[str, bytes] = {
    "UTF-16": b"\xff\xfe" + table("\t").encode("utf-16-le"),
    "UTF-16, the other way": b"\xfe\xff" + table(";").encode("utf-16-be"),
    "UTF-16 without a mark": table(";").encode("utf-16-le"),
    "UTF-8 with a mark": b"\xef\xbb\xbf" + table(",").encode(),
    "sep=": table("|", before="sep=|\n").encode(),
    "sep=;": table(";", before='"sep=;"\r\n', end="\r\n").encode(),
    "decimal comma": table(";", comma=True).encode(),
    "thousands": "\n".join([
        "image;time_ms;speed;yaw_rate",
        *(f"bild {k}.png;{1 + k // 10}.{k % 10}00;" + f"{row.speed};{row.yaw_rate}".replace(".", ",")
          for k, row in enumerate(drive())), "",
    ]).encode(),
    "decimal comma, tabs": table("\t", comma=True).encode(),
    "decimal comma in quotes": table(",", comma=True, quote=True).encode(),
    "quotes": table(",", quote=True).encode(),
    "empty columns at the end": table(",", after=",,,").encode(),
    "CR LF": table(",", end="\r\n").encode(),
    "CR": table(",", end="\r").encode(),
    "a title": table(";", before="Messung vom 3. Mai\n\n").encode(),
    "Latin-1": table(";", before="# Gr\u00f6\u00dfe\n").encode("latin-1"),
    "comments": table(",", before="# made by hand\n# in a hurry\n").encode(),
}  # fmt: skip


def test_a_table_is_read_as_spreadsheets_write_it(tmp_path: Path, subtests: pytest.Subtests) -> None:
    pictures(tmp_path, *(f"bild {k}.png" for k in range(N)))
    for how, content in TABLES.items():
        with subtests.test(msg=how):
            (tmp_path / "werte.csv").write_bytes(content)
            told = checked(tmp_path)
            assert told.about.whole, (told.about.problems, told.about.unused)
            assert told.about.has == {"camera", "speed", "yaw rate"}
            for moment, row in zip(open_recording(tmp_path).moments(), drive(), strict=True):
                assert (moment.speed, moment.yaw_rate) == pytest.approx((row.speed, row.yaw_rate))


def test_what_two_tables_tell_is_taken_from_one_and_told(tmp_path: Path) -> None:
    """Of two drives in one folder, that of the pictures that are played."""
    for number in ("00", "01"):
        kitti(tmp_path / "sequences" / number)
    about = checked(tmp_path).about
    assert about.moments == N
    assert "sequences/01/poses/00.txt: sequences/00/poses/00.txt tells the truth" in about.unused
    pictures(tmp_path / "b", *(f"{time}.png" for time in TIMES))
    wrote(tmp_path / "b", "odom.csv", "timestamp,speed,yaw_rate", *(f"{time},1,1" for time in TIMES))
    wrote(tmp_path / "b", "wheel.csv", "timestamp,yaw_rate,throttle", *(f"{time},2,0.5" for time in TIMES))
    recording = open_recording(tmp_path / "b")
    assert {(moment.yaw_rate, moment.throttle) for moment in recording.moments()} == {(1.0, 0.5)}
    assert "column 'yaw_rate' of wheel.csv: no use for it is known" in recording.about.unused


def test_why_a_table_is_not_used_is_the_reason(tmp_path: Path) -> None:
    pictures(tmp_path / "a", *(f"{time}.png" for time in TIMES))
    wrote(tmp_path / "a", "accelerometer.txt", "# timestamp ax ay az", *(f"{seconds(time)} 0 0 9.8" for time in TIMES))
    assert checked(tmp_path / "a").about.unused == ("accelerometer.txt: no use is known for its columns (ax, ay, az)",)
    pictures(tmp_path / "b", *(f"{k}.png" for k in range(N)))
    wrote(tmp_path / "b", "short.csv", "time_s,speed", *(f"{1000 + k / HZ},1" for k in range(N - 3)))
    told = checked(tmp_path / "b")
    assert (told.moments, told.about.problems) == (N - 3, ())
    assert told.about.unused == (f"short.csv: it has {N - 3} rows, but there are {N} pictures",)


def test_a_number_after_a_picture_is_no_time(tmp_path: Path) -> None:
    """Steering, in a list that has no header."""
    pictures(tmp_path, *(f"{k}.png" for k in range(N)))
    wrote(tmp_path, "data.txt", *(f"{k}.png {k * 0.37:.3f}" for k in range(N)))
    told = checked(tmp_path)
    assert (told.seconds, told.about.problems) == (pytest.approx((N - 1) / HZ), ())


def test_what_is_not_understood_is_told_of(tmp_path: Path) -> None:
    drive, room = tmp_path / "drive", tmp_path / "room"
    pictures(drive, *(f"{k}.png" for k in range(N)))
    wrote(drive, "werte.csv", "Zeit,Tempo", "0,1", "1,1")
    wrote(drive, "log.json", "{}")
    assert checked(drive).about.unused == (
        "log.json: nothing that is known here reads it",
        "werte.csv: none of its columns is known (Zeit, Tempo)",
    )
    for picture in drive.glob("*.png"):
        picture.unlink()
    with pytest.raises(ValueError, match=r"no pictures in it. Found: .*log.json.*none of its columns is known \(Zeit"):
        open_recording(drive)
    pictures(room, "room.png")
    wrote(room, "room.yaml", "image: room.png")
    with pytest.raises(ValueError, match=r"one picture and room.yaml: a map, and no recording; open the two files"):
        open_recording(room)


def test_a_tub_without_its_manifest_is_read_by_its_catalogs(tmp_path: Path) -> None:
    folder = tub(tmp_path / "tub")
    (folder / "manifest.json").unlink()
    (folder / "laps.csv").write_text("lap\n1\n")
    told = checked(folder)
    assert told.moments == N
    assert told.about.has == {"camera", "throttle", "speed", "yaw rate"}
    assert "manifest.json: it is not there; all catalogs are read" in told.about.problems[0]
    assert told.about.unused == ("laps.csv: nothing that is known here reads it",)


# ------------------------------------------------------------ archives


def packed(folder: Path, path: Path) -> Path:
    """Of what the name says, with the folder two deep in it."""
    files = [file for file in sorted(folder.rglob("*")) if file.is_file()]
    if path.suffix == ".zip":
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            for file in files:
                archive.write(file, f"a/b/{file.relative_to(folder)}")
            archive.writestr("__MACOSX/a/._x", b"junk")
    else:
        modes = {".gz": "w:gz", ".tgz": "w:gz", ".bz2": "w:bz2", ".xz": "w:xz", ".tar": "w:"}
        with tarfile.open(path, modes[path.suffix]) as archive:  # pyright: ignore
            for file in files:
                archive.add(file, f"a/b/{file.relative_to(folder)}")
    return path


def unpacked_folders() -> set[Path]:
    return set(Path(tempfile.gettempdir()).glob("ratslam-unpacked-*"))


@pytest.fixture(autouse=True)
def _own_temporary_folder(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path_factory.mktemp("tmp")))


@pytest.mark.parametrize("what", [udacity, tub])
def test_an_archive_plays_as_its_folder_does_and_leaves_nothing(
    what: Callable[[Path], object], tmp_path: Path, subtests: pytest.Subtests
) -> None:
    what(tmp_path / "folder")
    for name in ("a.zip", "a.tar.gz", "a.tgz", "a.tar.bz2", "a.tar.xz", "a.tar"):
        with subtests.test(msg=name):
            recording = open_recording(packed(tmp_path / "folder", tmp_path / name))
            assert (recording.about.name, recording.about.moments) == (name, N)
            for one, other in zip(recording.moments(), open_recording(tmp_path / "folder").moments(), strict=True):
                assert (one.time_s, one.speed, one.throttle) == (other.time_s, other.speed, other.throttle)
                assert np.array_equal(one.image, other.image)
            assert len(unpacked_folders()) == 1
            del recording
            gc.collect()
            assert unpacked_folders() == set()


def zipped(path: Path, files: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return path


def test_an_archive_is_bounded_and_leads_nowhere_else(tmp_path: Path) -> None:
    for name in ("../x.png", "/etc/x.png", "a/../../x.png", "C:\\x.png", "..\\x.png"):
        with pytest.raises(ValueError, match="would lead out of its folder; nothing was unpacked"):
            open_recording(zipped(tmp_path / "a.zip", {name: b"x"}))
    with pytest.raises(ValueError, match="unpacks to more than"):
        open_recording(zipped(tmp_path / "a.zip", {"x.png": bytes(30_000_000)}))
    (tmp_path / "a.7z").write_bytes(b"7z\xbc\xaf'\x1c" + bytes(100))
    with pytest.raises(ValueError, match=r"7z archives are not read; pack it as .zip"):
        open_recording(tmp_path / "a.7z")
    whole = zipped(tmp_path / "a.zip", {f"{k}.png": png(row.image) for k, row in enumerate(drive())}).read_bytes()
    (tmp_path / "a.zip").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match=r"^a.zip: "):
        open_recording(tmp_path / "a.zip")
    with pytest.raises(ValueError, match=r"^n.zip: nothing in this folder can be played.*notes.md"):
        open_recording(zipped(tmp_path / "n.zip", {"notes.md": json.dumps({}).encode()}))
    assert unpacked_folders() == set()


def test_links_in_an_archive_are_left_out_and_told_of(tmp_path: Path) -> None:
    with tarfile.open(tmp_path / "a.tar.gz", "w:gz") as archive:
        for k, row in enumerate(drive()):
            info = tarfile.TarInfo(f"p{k}.png")
            info.size = len(png(row.image))
            archive.addfile(info, io.BytesIO(png(row.image)))
        link = tarfile.TarInfo("p99.png")
        link.type, link.linkname = tarfile.SYMTYPE, "/etc/passwd"
        archive.addfile(link)
    told = checked(tmp_path / "a.tar.gz")
    assert told.moments == N
    assert told.about.unused == ("p99.png: a link or a device, which is not unpacked",)
