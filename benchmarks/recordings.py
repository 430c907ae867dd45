"""The bars for recordings of real robots: `python -m benchmarks.recordings --data ../shared/data [office airsim intel]`.

`variants` and `held-out` play laser logs that nobody tuned on (laser_variants.py); `--without NAME` does without a rule of
`app/recordings/scans.py`, `--only WORDS` plays those alone whose names contain the words.
"""

from __future__ import annotations

import argparse
import csv
import math
from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from app.evaluation.agreement import align, rmse
from app.recordings.motion import OdometryErrors, WithMadeOdometry
from app.recordings.opening import open_recording
from app.recordings.playing import Player
from app.recordings.recording import Recording
from app.recordings.scans import ScanRules
from benchmarks.laser_drives import OF_OURS, OF_OURS_HELD_OUT, driven
from benchmarks.laser_variants import OF_A_LOG, OF_A_LOG_HELD_OUT, Log, Logged, log_of
from ratslam_core import wrap_angles
from sim2d.importers.import_world import open_world

KNOWN_S = 1.0  # a moment so near to a scan has a known pose
NEAR_S, FAR_S = 1.0, 3.0  # a look is right within, and false beyond
SEEDS = 20
PICTURE = 480  # pixels along each of its two halves
SPEED_NOISE, YAW_NOISE, MOST_BIAS = 0.1, 0.02, 0.01
INTEL_BEGAN_S = 976052890.244111  # by the clock of the relations, when the first scan was taken


@dataclass(frozen=True, slots=True)
class Played:
    """One recording, frame by frame."""

    frames: list[int]
    times: NDArray[np.float64]  # (n,) s
    made: NDArray[np.float64]  # (n,) when the active experience was made, s
    path: NDArray[np.float64]  # (n, 3) by the final map
    odometry: NDArray[np.float64]  # (n, 3)


def play(recording: Recording, seed: int = 0, scans: ScanRules | None = None) -> Played:
    """Play it to the end; each frame is where its active experience lies in the final map."""
    frames: list[int] = []
    times: list[float] = []
    active: list[int] = []
    local: list[tuple[float, float, float]] = []
    driven = [(0.0, 0.0, 0.0)]
    born: dict[int, float] = {}
    brain = None
    for step in Player(recording, seed, scans=scans).steps():
        brain, at = step.brain, step.brain.experience_map.local_pose
        if step.estimate.created:
            born[brain.experience_map.here] = step.moment.time_s
        frames.append(step.moment.frame)
        times.append(step.moment.time_s)
        active.append(step.estimate.experience)
        local.append((at.x, at.y, at.heading_rad))
        x, y, heading = driven[-1]
        way, turn = step.motion.speed * step.motion.dt, step.motion.yaw_rate * step.motion.dt
        driven.append((x + way * math.cos(heading + turn / 2), y + way * math.sin(heading + turn / 2), heading + turn))
    if brain is None:
        raise ValueError(f"{recording.about.name}: has no moments")
    pose, beside = brain.experience_map.poses[active], np.array(local)
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    x = pose[:, 0] + c * beside[:, 0] - s * beside[:, 1]
    y = pose[:, 1] + s * beside[:, 0] + c * beside[:, 1]
    path = np.stack([x, y, pose[:, 2] + beside[:, 2]], axis=1)
    return Played(frames, np.array(times), np.array([born[i] for i in active]), path, np.array(driven[1:]))


def laps(played: Played, file: Path) -> tuple[float, float]:
    """(recall, precision) over the pairs of laps.csv."""
    paired: dict[int, list[int]] = {}
    with file.open(encoding="utf-8", newline="") as text:
        for row in csv.DictReader(text):
            paired.setdefault(int(row["frame_later"]), []).append(int(row["frame_earlier"]))
    at = {frame: k for k, frame in enumerate(played.frames)}
    right = false = 0
    for later, earlier in paired.items():
        k = at[later]
        off = min(abs(played.made[k] - played.times[at[e]]) for e in earlier)
        right += len(earlier) * (off <= NEAR_S)
        false += len(earlier) * (off > FAR_S and played.times[k] - played.made[k] > FAR_S)
    return right / sum(map(len, paired.values())), right / max(right + false, 1)


def together(played: Played, path: NDArray[np.float64], file: Path) -> tuple[float, float]:
    """How far (m) the two frames of a pair of laps.csv lie apart on a path, in the mean, and how long the path's box is."""
    at = {frame: k for k, frame in enumerate(played.frames)}
    with file.open(encoding="utf-8", newline="") as text:
        pairs = [(at[int(row["frame_earlier"])], at[int(row["frame_later"])]) for row in csv.DictReader(text)]
    i, j = np.array(pairs).T
    return float(np.hypot(*(path[i, :2] - path[j, :2]).T).mean()), float(np.ptp(path[:, :2], axis=0).max())


def draw_laps(played: Played, file: Path) -> None:
    """Map and odometry alone side by side; the way up to where the car turns round in blue, after it in orange.

    It turns round where its heading by the gyro, counted on beyond a whole turn, is largest.
    """
    turns = int(np.argmax(played.odometry[:, 2]))
    picture = np.full((PICTURE, 2 * PICTURE, 3), 255, np.uint8)
    for left, path in ((0, played.path), (PICTURE, played.odometry)):
        low, high = path[:, :2].min(axis=0), path[:, :2].max(axis=0)
        scale = 0.9 * PICTURE / float((high - low).max())
        middle = np.array([left + PICTURE / 2, PICTURE / 2])
        at = np.rint((path[:, :2] - (low + high) / 2) * (scale, -scale) + middle).astype(np.int32)
        cv2.polylines(picture, [at[: turns + 1]], False, (180, 90, 0), 1, cv2.LINE_AA)
        cv2.polylines(picture, [at[turns:]], False, (0, 120, 240), 1, cv2.LINE_AA)
    if not cv2.imwrite(str(file), picture):
        raise OSError(f"{file}: cannot be written")


def relations(path: NDArray[np.float64], times: NDArray[np.float64], raw: NDArray[np.float64]) -> tuple[float, float]:
    """Mean error (m, degrees) against the relations, each between two times; poses between two scans are interpolated."""
    heading = np.unwrap(path[:, 2])

    def at(time: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.stack([np.interp(time, times, column) for column in (path[:, 0], path[:, 1], heading)], axis=1)

    a, b = at(raw[:, 0]), at(raw[:, 1])
    c, s, d = np.cos(a[:, 2]), np.sin(a[:, 2]), b - a
    off = np.hypot(c * d[:, 0] + s * d[:, 1] - raw[:, 2], -s * d[:, 0] + c * d[:, 1] - raw[:, 3])
    turn = wrap_angles(d[:, 2] - raw[:, 7])
    return float(off.mean()), math.degrees(float(np.abs(turn).mean()))


def of_known(log: Log, path: NDArray[np.float64], file: Path) -> float:
    """Mean error (m) against the relations between moments within a second of one of its scans."""
    order = np.argsort(log.was)
    was, path = log.was[order] + INTEL_BEGAN_S, path[order] * ((1, -1, -1) if log.mirrored else 1)
    raw = np.loadtxt(file)

    def known(time: NDArray[np.float64]) -> NDArray[np.bool_]:
        after = np.clip(np.searchsorted(was, time), 1, len(was) - 1)
        near = np.minimum(np.abs(time - was[after - 1]), np.abs(time - was[after])) <= KNOWN_S
        return near & (time > was[0] - 0.01) & (time < was[-1] + 0.01)

    return relations(path, was, raw[known(raw[:, 0]) & known(raw[:, 1])])[0]


def of_truth(path: NDArray[np.float64], truth: NDArray[np.float64]) -> float:
    """Mean distance (m) from the truth, once both lie on one another as well as they can."""
    return float(np.hypot(*(align(path[:, :2], truth[:, :2]) - truth[:, :2]).T).mean())


def variants(args: argparse.Namespace, held_out: bool) -> None:
    """Map, scans alone and wheels alone of logs that nobody tuned on."""
    folder, rules = args.data / "logs" / "intel", replace(ScanRules(), **dict.fromkeys(args.without, False))
    rows: list[tuple[float, float, float]] = []

    def row(name: str, log: Log) -> None:
        played = play(Logged(log, name), scans=rules)
        paths = (played.path, played.odometry, log.wheels)
        if log.truth is None:
            errors = [of_known(log, path, folder / "intel.relations") for path in paths]
        else:
            errors = [of_truth(path, log.truth) for path in paths]
        rows.append((errors[0], errors[1], errors[2]))
        print(f"  {name}: map {errors[0]:.3f} m, scans alone {errors[1]:.3f} m, wheels {errors[2]:.3f} m", flush=True)

    whole = log_of(open_recording(folder / "intel_gfs.gz"))
    for name, change in (OF_A_LOG_HELD_OUT if held_out else OF_A_LOG).items():
        if args.only in f"intel, {name}":
            row(f"intel, {name}", change(whole))
    for drive in OF_OURS_HELD_OUT if held_out else OF_OURS:
        if args.only in drive.world:
            world = args.data / "worlds" / drive.world if "/" in drive.world else drive.world
            row(drive.world, driven(open_world(world), drive))
    of_map, scans, wheels = np.array(rows).reshape(-1, 3).T
    if len(of_map):
        worse = (
            f"worse than scans alone in {int((of_map > scans).sum())}, than wheels in {int((of_map > wheels).sum())}"
        )
        print(f"map {np.median(of_map):.3f} m median, {of_map.max():.3f} m at worst; {worse} of {len(of_map)}")


def office(data: Path, picture: Path | None) -> None:
    folder = data / "recordings" / "office-car"
    played, file = play(open_recording(folder)), folder / "laps.csv"
    recall, precision = laps(played, file)
    print(f"office-car: recall {recall:.3f} (bar 0.7), precision {precision:.3f} (bar 0.95)")
    for name, path in (("map", played.path), ("odometry", played.odometry)):
        apart, size = together(played, path, file)
        print(f"  {name}: paired frames {apart:.2f} m apart, {apart / size:.1%} of its length of {size:.2f} m")
    if picture is not None:
        draw_laps(played, picture)


def airsim(data: Path, _picture: Path | None) -> None:
    recording = open_recording(data / "recordings" / "airsim-track")
    truth = np.array([m.truth for m in recording.moments()])[:, :2]
    errors: list[tuple[float, float]] = []
    for seed in range(SEEDS):
        bias = float(np.random.default_rng(seed).uniform(-MOST_BIAS, MOST_BIAS))
        played = play(WithMadeOdometry(recording, OdometryErrors(SPEED_NOISE, YAW_NOISE, bias), seed), seed)
        errors.append((rmse(played.path[:, :2], truth), rmse(played.odometry[:, :2], truth)))
        print(f"  seed {seed}: map {errors[-1][0]:.1f} m, odometry {errors[-1][1]:.1f} m", flush=True)
    of_map, alone = np.array(errors).T
    print(
        f"airsim-track: map {np.median(of_map):.1f} m median (bar 10), {of_map.max():.1f} m at worst; odometry "
        f"{np.median(alone):.1f} m; worse than odometry in {int((of_map > alone).sum())} of {SEEDS}"
    )


def intel(data: Path, _picture: Path | None) -> None:
    folder = data / "logs" / "intel"
    recording = open_recording(folder / "intel_gfs.gz")
    played = play(recording)
    for name, path in (("map", played.path), ("odometry", played.odometry)):
        metres, degrees = relations(path, played.times + INTEL_BEGAN_S, np.loadtxt(folder / "intel.relations"))
        print(f"intel: {name} {metres:.3f} m, {degrees:.1f} degrees (bar 0.5 m)")


RECORDINGS = {"office": office, "airsim": airsim, "intel": intel}
WHICH = (*RECORDINGS, "variants", "held-out")


def main(words: Iterable[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--picture", type=Path, help="a PNG of the car's laps in the map and by odometry alone")
    parser.add_argument("--without", action="append", default=[], choices=[f.name for f in fields(ScanRules)])
    parser.add_argument("--only", default="", help="recordings and variants whose names contain this")
    parser.add_argument("which", nargs="*", default=list(RECORDINGS), metavar="WHICH", help=f"of: {', '.join(WHICH)}")
    args = parser.parse_args(None if words is None else list(words))
    for name in args.which:
        if name not in WHICH:
            parser.error(f"there is no {name!r}; expected some of: {', '.join(WHICH)}")
    for name in args.which:
        if name in ("variants", "held-out"):
            variants(args, name == "held-out")
        elif args.only in name:
            RECORDINGS[name](args.data, args.picture)


if __name__ == "__main__":
    main()
