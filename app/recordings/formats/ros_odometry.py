"""Whether what an odometry says of its speed leads from one of its poses to the next."""

from __future__ import annotations

from dataclasses import dataclass, field

from app.recordings.formats.sensed import Rates
from app.recordings.recording import Pose

_WINDOW_NS = 10**9
_MOVES = (0.05, 0.1)  # m and rad in a window; less is noise
_UNLIKE, _MANY, _LEAST = 0.3, 0.25, 2  # share of the motion; of the windows with motion; windows
_SCALE, _FAR_M = (
    0.1,
    5.0,
)  # share of a way that is at least so long; what wheels and poses of one driver differ by is a tenth of it


@dataclass
class Odometer:
    """What is known of an odometry's messages after all of them have gone by."""

    twisted: bool = False  # it reports speeds
    moved: bool = False  # its poses change
    way_m: list[float] = field(default_factory=lambda: [0.0, 0.0])  # forwards or backwards, by poses and by twists
    _first: Pose | None = None
    _last_ns: int = 0
    _window: int = 0
    _sums: list[float] = field(default_factory=lambda: [0.0] * 4)  # way, turn by poses; way, turn by twists
    _far_m: list[float] = field(
        default_factory=lambda: [0.0, 0.0]
    )  # as way_m, of windows with motion: noise has no part in it
    _moving: int = 0
    _unlike: int = 0
    _rates: Rates = field(default_factory=Rates)

    def note(self, time_ns: int, pose: Pose, twist: tuple[float, float]) -> None:
        """pose: x, y (m), heading (rad); twist: m/s forwards, rad/s, since the message before."""
        self._first = self._first or pose
        self.moved |= pose != self._first
        self.twisted |= twist != (0.0, 0.0)
        rates, dt = self._rates.since(time_ns, pose), (time_ns - self._last_ns) / 1e9
        self._last_ns = time_ns
        if rates is None:
            return
        if time_ns // _WINDOW_NS != self._window:
            self._compare()
            self._window, self._sums = time_ns // _WINDOW_NS, [0.0] * 4
        for at, rate in enumerate((*rates, *twist)):
            self._sums[at] += rate * dt
        self.way_m[0] += abs(rates[0] * dt)
        self.way_m[1] += abs(twist[0] * dt)

    @property
    def by_poses(self) -> bool:
        """[ours] Whether the poses are to be believed rather than the twist.

        Poses are what drivers are tested by: their twists come in wrong frames (the world's), in wrong units, or not at all.
        """
        return self.moved and (not self.twisted or self.unlike)

    @property
    def unlike(self) -> bool:
        """Whether twist and poses contradict each other wherever the robot moves."""
        return self._unlike >= _LEAST and self._unlike > _MANY * self._moving

    @property
    def longer(self) -> float | None:
        """[ours] By which share the way by twists is longer, where both tell the same motion: a wrong radius of the wheels.
        None: they agree, or it hardly moved. test_recording_ros.py::test_a_twist_of_another_scale_is_said."""
        poses, twist = self._far_m
        if self.unlike or not self.twisted or min(poses, twist) < _FAR_M or abs(twist / poses - 1) < _SCALE:
            return None
        return twist / poses - 1

    def _compare(self) -> None:
        moving = unlike = False
        if max(map(abs, self._sums[::2])) > _MOVES[0]:
            self._far_m = [far + abs(way) for far, way in zip(self._far_m, self._sums[::2], strict=True)]
        for poses, twists, least in zip(self._sums[:2], self._sums[2:], _MOVES, strict=True):
            size = max(abs(poses), abs(twists))
            moving |= size > least
            unlike |= size > least and abs(poses - twists) > _UNLIKE * size
        self._moving += moving
        self._unlike += unlike
