"""Events, the marks on the timeline, and what is kept beside them for people. Nothing of it is read by the session."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from app.session import Session, is_lost
from app.views.arrays import frozen
from app.views.reasons import Reasons, words_of
from disk import kind
from ratslam_core import Pose2, find_places
from web.messages import Closure, Event, EventKind, GoalState, Packet, Snap, WhyReport
from web.messages.robot_status import goal_meaning, odds_words

MOST_EVENTS = 2000
ELSEWHERE_M = 1.0  # a belief this far from the last one is of another place
NOTHING_NEW = "nothing new is in sight; it visits what it has not seen for longest"


class EventLog:
    """Keeps the newest events, and with them why they happened and what they did to the map."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.events: tuple[Event, ...] = ()
        self.of_tick = False  # whether what is noted belongs to the tick, and not to an order after it
        self.why: dict[int, WhyReport] = {}  # by the numbers of events
        self.closures: tuple[Closure, ...] = ()  # of late, with the map before and after each
        self._number = 0
        self._counted: list[Event] = []  # those in whose place a newer one of their line stands, for the past
        self._of_ticks: set[int] = set()

    def note(self, kind: EventKind, text: str, line: str = "") -> Event:
        """line: a name for what repeats. The event then takes the place of the last one of this line, and counts it."""
        self._number += 1
        event = Event(self._number, self._session.time_s, kind, text, line)
        last = next((other for other in reversed(self.events) if line and other.line == line), None)
        if last is not None:
            event = replace(event, count=last.count + 1, since_s=last.time_s if last.since_s is None else last.since_s)
            self._counted = [*self._counted[-MOST_EVENTS:], last]
        self.events = (*(other for other in self.events[-MOST_EVENTS:] if other is not last), event)
        if self.of_tick:
            self._of_ticks.add(self._number)
        return event

    def until(self, time_s: float, session: Session) -> EventLog:
        """Another log, of this session, with the events up to the end of the tick at this simulated time, without
        those of the orders after it."""
        cut = EventLog(session)
        known = sorted((*self._counted, *self.events), key=lambda event: event.number)
        known = [event for event in known if self._is_before(event, time_s)]
        newest = {event.line or event.number: event for event in known}
        cut.events = tuple(event for event in known if newest[event.line or event.number] is event)
        cut._counted = [event for event in known if newest[event.line or event.number] is not event]
        cut.why = {event.number: self.why[event.number] for event in cut.events if event.number in self.why}
        kept = {event.number for event in cut.events}
        cut.closures = tuple(closure for closure in self.closures if closure.event in kept)
        cut._number, cut._of_ticks = self._number, set(self._of_ticks)  # no number is given twice
        return cut

    def _is_before(self, event: Event, time_s: float) -> bool:
        if abs(event.time_s - time_s) < 1e-9:
            return event.number in self._of_ticks
        return event.time_s < time_s


SETTLES_S = 15.0  # a map is solved every 5 s: after three times, or at the next closure, its correction is over
EVERY_S = 1.0  # how often the map after a closure is taken anew until then
MOST = 12  # closures are kept

_Places = NDArray[np.float32]  # (n, 2), map frame


class Closures:
    """Loop closures with the map before and after each, so that a correction can be marked and played again slowly.

    Call `watch` after each tick, and `closed` when a loop has closed in it.
    """

    def __init__(self, session: Session, log: EventLog) -> None:
        self._session, self._log = session, log
        self._before = self._now = self._places()
        self._until_s = self._due_s = -math.inf

    def watch(self) -> None:
        self._before, self._now = self._now, self._places()
        if self._due_s <= self._session.time_s <= self._until_s and self._log.closures:
            self._due_s = self._session.time_s + EVERY_S
            self._take()

    def closed(self, event: Event, start: int, end: int) -> None:
        """The robot came from experience `start` to `end`, which it had made long before: they are linked."""
        links = self._session.brain.experience_map.links.astype(np.int32)
        known = (links < len(self._before)).all(1)
        closure = Closure(event.number, event.time_s, start, end, frozen(links[known]), self._before, self._before)
        self._log.closures = (*self._log.closures[-MOST + 1 :], closure)
        self._until_s, self._due_s = event.time_s + SETTLES_S, event.time_s
        self._take()

    def _take(self) -> None:
        """Where the experiences are now that were there before the newest closure."""
        closure = self._log.closures[-1]
        before = closure.before_xy[: len(self._now)]
        after = frozen(self._now[: len(before)])
        moved = float(np.hypot(*(after - before).T).max(initial=0.0))
        self._log.closures = (*self._log.closures[:-1], replace(closure, after_xy=after, moved_m=moved))

    def _places(self) -> _Places:
        return frozen(self._session.brain.experience_map.poses[:, :2].astype(np.float32))


FALSE_EVERY_S = 5.0  # false positives are marked no more often
PLACES_EVERY_S = 10.0
NEW_GROUND, LONG_AGO_S = 20, 30.0  # after so many new experiences, one that was made so long before closes a loop
DIVERGED_EVERY_S = 60.0  # a map that diverges again and again is marked no more often


@kind("event_watch/8")
class EventWatch:
    """Call `watch` after each tick."""

    CACHES = ("_session", "_log", "reasons", "closures", "last_snap")

    def __init__(self, session: Session, log: EventLog) -> None:
        self._session, self._log = session, log
        self.reasons, self.closures = Reasons(session, log.why), Closures(session, log)
        self._here = session.brain.experience_map.here
        self._tied = session.brain.echo_closures.count  # how often echoes have tied experiences
        self._new = 0  # experiences since the robot was last at one that it made long before
        self.last_snap: Snap | None = None
        self.lost = False
        self._at_a_loss = False  # lost, or its submap not yet merged although a hypothesis is accepted
        self._lost_s: float | None = None  # when it noticed that it was carried, until its map is one again
        self._believed: Pose2 | None = None  # where it believed to be last since then
        self._joined = 0  # submaps that were joined before
        self._corrected = session.brain.experience_map.corrected  # how often it proved to be elsewhere
        self._before = session.brain.pose_cells.winner
        self._goal_state: tuple[int | None, str] = None, ""  # the goal, and what was last true of it
        self._false_marked, self._false_due_s = 0, 0.0
        self._explored = False
        self._recovered = self._multiple = self._collisions = 0
        self._dropped = len(session.brain.experience_map.dropped_links)
        self._places_due_s = session.time_s + PLACES_EVERY_S
        self._diverged, self._diverged_due_s = False, 0.0

    def settle(self, session: Session, log: EventLog, last_snap: Snap | None) -> None:
        """Go on in a history that was restored. What made a snap is known from here on."""
        self._session, self._log, self.last_snap = session, log, last_snap
        self.reasons, self.closures = Reasons(session, log.why), Closures(session, log)

    def watch(self) -> None:
        self.reasons.watch()
        self.closures.watch()
        self._watch_snaps()
        self._watch_closures()
        self._watch_packets()
        self._watch_goal()
        self._watch_exploring()
        self._watch_kidnaps()
        self._watch_false_positives()
        self._watch_links()
        self._watch_places()
        self._watch_correction()

    def _watch_snaps(self) -> None:
        session = self._session
        packet = session.estimate.packet
        if session.estimate.relocalised:
            start, end = (Packet(p.x, p.y, p.heading_rad, p.mass, p.id) for p in (self._before, packet))
            causes = self.reasons.causes.of(packet)
            self.last_snap = Snap(session.time_s, start, end, causes)
            ends = f"({start.x:.0f}, {start.y:.0f}) to ({end.x:.0f}, {end.y:.0f})"
            event = self._log.note("snap", f"relocalised {words_of(causes)}: {ends}")
            self.reasons.snap(event, self._before, packet, causes)
        self._before = packet

    def _watch_closures(self) -> None:
        """Marks that the robot comes back from new ground to an experience that it made long before, or beside it.

        Who does not look recognises nothing: where it believes to be back by odometry alone, no loop is closed.
        """
        session, map_, before = self._session, self._session.brain.experience_map, self._here
        echoes, tied = session.brain.echo_closures, self._tied
        self._here, self._tied = map_.here, echoes.count
        self._new += session.estimate.created
        if echoes.count > tied:
            old, new = echoes.last
            self._watch_closure(new, old, "beside", by_echoes=True)
        elif not session.estimate.created and self._here != before and session.brain.params.local_view.enabled:
            self._watch_closure(before, self._here, "back at", by_echoes=False)

    def _watch_closure(self, start: int, end: int, words: str, *, by_echoes: bool) -> None:
        session, map_ = self._session, self._session.brain.experience_map
        if session.time_s - session.evaluation.births(len(map_))[end, 3] < LONG_AGO_S:
            return
        new, self._new = self._new, 0
        linked = by_echoes or (start, end) in map_.transitions.row_of
        if new >= NEW_GROUND and linked and not session.brain.lost:
            event = self._log.note("closure", f"{words} experience {end} after {new} new ones")
            self.reasons.closure(event, start, end, new, by_echoes=by_echoes)
            self.closures.closed(event, start, end)

    def _watch_packets(self) -> None:
        session, brain = self._session, self._session.brain
        suspects = brain.experience_map.suspects_kidnap
        carried = brain.carried or suspects
        lost = carried or is_lost(session)
        if lost and not self._at_a_loss:
            jumped = "image and sonars jumped" if suspects else "the image jumped"
            why = f"{jumped}: kidnapped?" if carried else f"{len(brain.pose_cells.packets)} packets compete"
            self.reasons.lost(self._log.note("lost", why))
        self._at_a_loss, self.lost = lost, is_lost(session)
        self._watch_belief(carried)
        self._watch_error()

    def _watch_belief(self, carried: bool) -> None:
        """Marks each place that is believed after a kidnap, and that the submaps are merged."""
        session, map_ = self._session, self._session.brain.experience_map
        belief, joined = map_.belief, map_.submaps.merged
        if carried and self._lost_s is None:
            self._lost_s, self._believed, self._joined = session.time_s, None, joined
        if self._lost_s is None:
            return
        after = f"{session.time_s - self._lost_s:.1f} s after the kidnap was noticed"
        if carried and belief is not None:
            last, self._believed = self._believed, belief.pose
            if last is None or math.hypot(last.x - belief.pose.x, last.y - belief.pose.y) > ELSEWHERE_M:
                which = "a place" if last is None else "another place"
                event = self._log.note("believes", f"{which} {after}, {odds_words(math.exp(belief.log_odds))}")
                self.reasons.believes(event, belief)
        if not carried:
            self._lost_s = None
            if joined > self._joined:
                self._log.note("joined", f"submaps merged {after}")

    def _watch_error(self) -> None:
        """Marks that a robot that did not know of being lost proved to be elsewhere: its map, or a merge, was wrong."""
        map_ = self._session.brain.experience_map
        if map_.corrected > self._corrected:
            self._log.note("corrected", "the pose estimate was wrong: the map follows the evidence")
        self._corrected = map_.corrected

    def _watch_goal(self) -> None:
        """Marks what is true of the goal. While the robot is lost this waits until a place is accepted."""
        told = self._session.pilot.goal_state
        if told is None or told[0] != self._goal_state[0]:
            self._goal_state = (None if told is None else told[0], "")
        if told is None:
            return
        goal, state = told
        meaning = goal_meaning(state, lost=self.lost, followed=self._session.pilot.mode == "goal")
        if meaning not in get_args(GoalState) or meaning == self._goal_state[1]:
            return
        self._goal_state = goal, meaning
        if meaning == "arrived":
            self._log.note("arrived", f"at experience {goal}")
        elif meaning == "unreachable":
            self._log.note(
                "unreachable", f"no route to experience {goal}, {self._session.pilot.why_no_route}: exploring for one"
            )

    def _watch_exploring(self) -> None:
        """Marks that there is nothing new in sight."""
        before, self._explored = self._explored, self._session.pilot.explored
        if self._explored and not before:
            self._log.note("explored", NOTHING_NEW, NOTHING_NEW)

    def _watch_kidnaps(self) -> None:
        kidnaps = self._session.evaluation.kidnaps
        while self._recovered < len(kidnaps) and kidnaps[self._recovered].after_s is not None:
            kidnap = kidnaps[self._recovered]
            self._log.note(
                "recovered", f"right again {kidnap.after_s:.1f} s and {kidnap.after_m:.1f} m after the kidnap"
            )
            self._recovered += 1
        if self._recovered < len(kidnaps) - 1:
            self._recovered = len(kidnaps) - 1  # kidnapped again before it recovered

    def _watch_false_positives(self) -> None:
        """Every false positive is counted, few are marked. A mark says how many there were since the last one."""
        seen, count = self._session.estimate.recognition, self._session.brain.local_view.false_positives
        if not seen.false_positive or self._session.time_s < self._false_due_s:
            return
        more = count - self._false_marked - 1
        words = f"view {seen.view} reported instead of {seen.best_view}"
        words += f", and {more} more since the last mark" if more else ""
        self.reasons.false_look(self._log.note("false", words))
        self._false_marked, self._false_due_s = count, self._session.time_s + FALSE_EVERY_S

    def _watch_links(self) -> None:
        """Marks links that were deleted."""
        dropped = self._session.brain.experience_map.dropped_links[self._dropped :]
        if dropped:
            i, j = dropped[0]
            more = f" and {len(dropped) - 1} more" if len(dropped) > 1 else ""
            self._log.note("link", f"deleted: {i} to {j}{more}, failed too often", "deleted links")
            self._dropped += len(dropped)

    def _watch_places(self) -> None:
        """Marks, now and then, places with several states of the pose cells and states of several places."""
        if self._session.time_s < self._places_due_s:
            return
        self._places_due_s = self._session.time_s + PLACES_EVERY_S
        found = find_places(self._session.brain.experience_map)
        multiple, collisions = len(found.multiple_representations), len(found.hash_collisions)
        if multiple > self._multiple:
            self._log.note(
                "place",
                f"multiple representations in the pose cells: {multiple} {'place' if multiple == 1 else 'places'}",
                "places held twice",
            )
        if collisions > self._collisions:
            self._log.note(
                "place",
                f"hash collisions in the pose cells: {collisions} {'state' if collisions == 1 else 'states'}",
                "states in common",
            )
        self._multiple, self._collisions = max(multiple, self._multiple), max(collisions, self._collisions)

    def _watch_correction(self) -> None:
        """Marks that the papers' literal correction has thrown the map apart."""
        session, was, self._diverged = self._session, self._diverged, self._session.brain.experience_map.diverged
        if self._diverged and not was and session.time_s >= self._diverged_due_s:
            rate = session.config.experience_map.correction
            self._log.note(
                "warning",
                f"the map diverged: correction rate {rate:g} is too high for all links at once",
                "diverged",
            )
            self._diverged_due_s = session.time_s + DIVERGED_EVERY_S
