"""What happened so far, for people to look at: events, trails, error series. Watches a session; never changes it."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from app.session import Session, is_lost
from app.visits import Visits
from ratslam_core import find_places
from web.messages import Event, Packet, Series, Snap

TRAIL_S = 120.0
SERIES_POINTS = 600
MOST_EVENTS = 500
ERROR_POINTS = 1000
FALSE_EVERY_S = 5.0  # false positives are marked no more often
PLACES_EVERY_S = 10.0


class Chronicle:
    """Call `watch` after each tick."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.events: tuple[Event, ...] = ()
        self._number = 0
        ticks = int(TRAIL_S / session.frame.dt)
        self._trail: deque[tuple[float, float]] = deque(maxlen=ticks // 2)
        self._path: deque[tuple[float, float, float]] = deque(maxlen=ticks // 2)
        self._samples: list[tuple[float, ...]] = []
        self._sample_every_s = 1.0
        self.last_snap: Snap | None = None
        self.lost = False
        self._goal_state: tuple[int, str] | None = None
        self._false_marked, self._false_due_s = 0, 0.0
        self._recovered = self._multiple = self._collisions = 0
        self._dropped = len(session.brain.experience_map.dropped_links)
        self._places_due_s = session.time_s + PLACES_EVERY_S
        self._before = session.brain.pose_cells.winner
        self.experiences, self.views = Visits(), Visits()
        self._visit()
        self.error_map_m = self.error_odometry_m = 0.0
        self.series = Series(*(np.zeros(0) for _ in range(7)))
        self._sample()

    @property
    def trail(self) -> NDArray[np.float32]:
        """True path of the last two minutes, (t, 2), office frame."""
        return np.array(self._trail, np.float32).reshape(-1, 2)

    @property
    def path(self) -> NDArray[np.float32]:
        """The winning packet's path of the last two minutes, (p, 3): x', y' (cells), heading (rad)."""
        return np.array(self._path, np.float32).reshape(-1, 3)

    def note(self, kind: str, text: str) -> None:
        """Put a mark on the timeline."""
        self._number += 1
        self.events = (*self.events[-MOST_EVENTS:], Event(self._number, self._session.time_s, kind, text))

    def watch(self) -> None:
        session = self._session
        packet = session.estimate.packet
        if session.tick_count % 2 == 0:
            truth = session.simulator.truth
            self._trail.append((truth.x, truth.y))
            self._path.append((packet.x, packet.y, packet.heading_rad))
        if session.estimate.relocalised:
            start, end = (Packet(p.x, p.y, p.heading_rad, p.mass, p.id) for p in (self._before, packet))
            self.last_snap = Snap(session.time_s, start, end)
            view = session.estimate.recognition.view
            self.note(
                "snap", f"relocalised by view {view}: ({start.x:.0f}, {start.y:.0f}) to ({end.x:.0f}, {end.y:.0f})"
            )
        self._before = packet
        self._visit()
        lost = is_lost(session)
        if lost and not self.lost:
            packets = len(session.brain.pose_cells.packets)
            self.note("lost", "the image jumped: carried away?" if session.brain.lost else f"{packets} packets compete")
        self.lost = lost
        self._watch_goal()
        self._watch_kidnaps()
        self._watch_false_positives()
        self._watch_map()
        if session.time_s >= len(self._samples) * self._sample_every_s:
            self._sample()

    def _visit(self) -> None:
        session = self._session
        self.experiences.note(session.brain.experience_map.active, session.time_s)
        self.views.note(session.estimate.recognition.view, session.time_s)

    def _watch_goal(self) -> None:
        follower_state = self._session.pilot.goal_state
        if follower_state == self._goal_state:
            return
        self._goal_state = follower_state
        if follower_state is None:
            return
        goal, state = follower_state
        if state == "arrived":
            self.note("arrived", f"at experience {goal}")
        elif state == "unreachable":
            self.note("unreachable", f"no way to experience {goal} is known; exploring for one")

    def _watch_kidnaps(self) -> None:
        kidnaps = self._session.evaluation.kidnaps
        while self._recovered < len(kidnaps) and kidnaps[self._recovered].after_s is not None:
            kidnap = kidnaps[self._recovered]
            self.note(
                "recovered", f"knows where it is {kidnap.after_s:.1f} s and {kidnap.after_m:.1f} m after the kidnap"
            )
            self._recovered += 1
        if self._recovered < len(kidnaps) - 1:
            self._recovered = len(kidnaps) - 1  # kidnapped again before it recovered

    def _watch_false_positives(self) -> None:
        """Each is counted, few are marked: the mark tells how many there were since the one before."""
        seen, count = self._session.estimate.recognition, self._session.brain.local_view.false_positives
        if not seen.false_positive or self._session.time_s < self._false_due_s:
            return
        more = count - self._false_marked - 1
        words = f"view {seen.view} instead of {seen.best_view}"
        self.note("false", words + (f", and {more} more since the last mark" if more else ""))
        self._false_marked, self._false_due_s = count, self._session.time_s + FALSE_EVERY_S

    def _watch_map(self) -> None:
        """Links that went, in each tick; places that pose cells hold twice or in common, now and then."""
        map_ = self._session.brain.experience_map
        dropped = map_.dropped_links[self._dropped :]
        if dropped:
            i, j = dropped[0]
            more = f" and {len(dropped) - 1} more" if len(dropped) > 1 else ""
            self.note("link", f"deleted: from experience {i} to {j}{more}, tried too often in vain")
            self._dropped += len(dropped)
        if self._session.time_s < self._places_due_s:
            return
        self._places_due_s = self._session.time_s + PLACES_EVERY_S
        found = find_places(map_)
        multiple, collisions = len(found.multiple_representations), len(found.hash_collisions)
        if multiple > self._multiple:
            self.note("place", f"places with several representations in the pose cells: {multiple}")
        if collisions > self._collisions:
            self.note("place", f"states of the pose cells that stand for several places: {collisions}")
        self._multiple, self._collisions = max(multiple, self._multiple), max(collisions, self._collisions)

    def _sample(self) -> None:
        """One point of the series; when they are too many, every other one goes."""
        session = self._session
        every = max(1, session.tick_count // ERROR_POINTS)
        self.error_map_m, self.error_odometry_m = session.evaluation.errors(session.brain.experience_map, every)
        views, experiences = len(session.brain.local_view), len(session.brain.experience_map)
        metres, radians = session.brain.experience_map.residual
        residual = 1000 * metres, 1000 * radians
        self._samples.append((session.time_s, self.error_map_m, self.error_odometry_m, views, experiences, *residual))
        if len(self._samples) > SERIES_POINTS:
            self._samples = self._samples[::2]
            self._sample_every_s *= 2
        columns = np.array(self._samples, np.float64).T.copy()
        columns.setflags(write=False)
        self.series = Series(*columns)
