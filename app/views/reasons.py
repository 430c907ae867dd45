"""Why a packet snapped, a loop closed, an observation was false, the robot felt lost or believes a place again: the
chain that led there, kept when it happens. ACRA 2004 5.2, ACRA 2005 3.4 and 5.2, ACRA 2006 5.1.
"""

from __future__ import annotations

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from app.views.arrays import camera_image, packet_of, stored_picture
from app.views.belief import HypothesisHistory
from ratslam_core import Packet, Pose2
from ratslam_core.extensions.evidence import Belief
from web import messages as m
from web.messages.robot_status import odds_words

MOST_KEPT = 200
MOST_VIEWS = 4
LOOKS_BACK_S = 10.0  # a lost robot: the views recognised in this time


class Reasons:
    """Call `watch` after each tick, and one of the others when something has happened in it."""

    def __init__(self, session: Session, kept: dict[int, m.WhyReport]) -> None:
        """kept: the chains, by the numbers of their events."""
        self._session, self._kept = session, kept
        self.causes, self._hypotheses = SnapCauses(session), HypothesisHistory()
        self._before = self._now = self._packets()
        self._robot_before = self._robot = session.brain.experience_map.robot
        self._seen: list[tuple[float, int]] = []  # when each of the views of late was recognised first

    def of(self, event: int) -> m.WhyReport:
        """ValueError: nothing is known of this event."""
        if event not in self._kept:
            known = f"; the newest is {max(self._kept)}" if self._kept else ": there has been none yet"
            kinds = "a recent snap, closure, false positive, loss or belief"
            raise ValueError(f"event must be {kinds}, got {event}{known}")
        return self._kept[event]

    def watch(self) -> None:
        session = self._session
        self.causes.watch()
        self._hypotheses.watch(session.time_s, session.brain.experience_map)
        self._before, self._now = self._now, self._packets()
        self._robot_before, self._robot = self._robot, session.brain.experience_map.robot
        view = session.estimate.recognition.view
        if view >= 0 and (not self._seen or self._seen[-1][1] != view):
            self._seen = [*self._seen[-50:], (session.time_s, view)]

    def snap(self, event: m.Event, start: Packet, end: Packet, causes: tuple[m.SnapCause, ...]) -> None:
        """The winner changed from `start` to `end`, the views in `causes` having put activity there."""
        shares = {packet.id: packet.mass for packet in self._before}
        chain = [
            (self.causes.since_s, f"view {c.view}, learnt {c.age_s:.0f} s earlier, is recognised: {_times(c.looks)} injected "
             f"{c.share:.0%} of the activity there, over {c.links} links")
            for c in causes[:MOST_VIEWS]
        ]  # fmt: skip
        if end.id in shares:
            had = f"packet {end.id} had {shares[end.id]:.0%} of the activity"
            words = f"{had}, packet {start.id} {shares.get(start.id, 0):.0%}"
        else:
            words = f"packet {end.id} is new"
        apart = self._session.brain.pose_cells.cells_apart(start.x, start.y, end.x, end.y)
        chain += [
            (event.time_s, words),
            (event.time_s, f"the winner jumps {apart:.0f} cells: relocalised"),
            (event.time_s, f"experience {self._session.estimate.experience} is active"),
        ]
        views = [(c.view, f"{c.share:.0%} of what was injected") for c in causes[:MOST_VIEWS]]
        self._keep(event, chain, views, self.causes.since_s, tuple(c.view for c in causes))

    def closure(self, event: m.Event, start: int, end: int, new: int, *, by_echoes: bool) -> None:
        """After `new` new experiences, one that existed before them is linked: it is active again, or echoes told."""
        seen, map_ = self._session.estimate.recognition, self._session.brain.experience_map
        known = "its view is recognised" if seen.view < 0 else f"view {seen.view} is recognised ({self._differs()})"
        if by_echoes:
            known = "walls sound twice, some way apart, as they did there, from whichever side it comes"
        chain = [
            (event.time_s, f"{new} new experiences on new ground"),
            (event.time_s, f"{known}: experience {end}" if by_echoes else f"{known}, of experience {end}"),
            (event.time_s, f"experiences {start} and {end} are linked: the loop is closed"),
            (event.time_s, f"the pose estimate moves by {_apart(self._robot_before, self._robot):.2f} m"),
            (event.time_s, f"{map_.link_count} links relax the map"),
        ]
        views = [(seen.view, "recognised")] if seen.view >= 0 and not by_echoes else []
        self._keep(event, chain, views, event.time_s, tuple(view for view, _ in views), (start, end))

    def false_look(self, event: m.Event) -> None:
        """Another view than the right one was reported."""
        seen = self._session.estimate.recognition
        rate = self._session.config.local_view.false_positives
        chain = [
            (event.time_s, f"the image shows view {seen.best_view} ({self._differs()})"),
            (event.time_s, f"view {seen.view} is reported instead: `false_positives` is {rate:.0%}"),
            (event.time_s, f"it injects activity where view {seen.view} was learnt"),
        ]
        views = [(seen.view, "reported"), (seen.best_view, "right")]
        self._keep(event, chain, views, event.time_s, (seen.view,))

    def lost(self, event: m.Event) -> None:
        """The robot has declared itself lost, or packets compete."""
        brain = self._session.brain
        chain: list[tuple[float, str]] = []
        if brain.lost:
            change = brain.local_view.image_change
            chain.append((event.time_s, f"the image changed {change:.1f} times as much as driving explains"))
            chain.append((event.time_s, "so it was kidnapped: a submap begins, and hypotheses are weighed"))
        else:
            masses = " and ".join(f"{packet.mass:.0%}" for packet in self._now[:3])
            chain.append((event.time_s, f"{len(self._now)} packets compete, with {masses} of the activity"))
        since = [entry for entry in self._seen if entry[0] >= event.time_s - LOOKS_BACK_S]
        looks = [(at, f"view {view} is recognised") for at, view in since[-MOST_VIEWS:]]
        views = [(view, f"seen {event.time_s - at:.1f} s before") for at, view in reversed(since[-MOST_VIEWS:])]
        self._keep(event, [*looks, *chain], views, since[0][0] if since else event.time_s, tuple(v for v, _ in views))

    def believes(self, event: m.Event, belief: Belief) -> None:
        """A robot that was carried believes a place again."""
        said = self._hypotheses.of(belief.pose)
        since_s = said[0][0] if said else event.time_s
        spoken, against = (sum(sign * nats > 0 for _, nats in said) for sign in (1, -1))
        view = int(self._session.brain.experience_map.views[belief.experience])
        odds = odds_words(math.exp(belief.log_odds))
        chain = [
            (since_s, "a recognised view suggests this place, among others: a hypothesis, with odds against it"),
            (event.time_s, f"of the evidence since, {_parts(spoken)} spoke for it and {_parts(against)} against"),
            (event.time_s, f"likelier than all others together, {odds}: it is believed; the map waits for 1000:1"),
        ]
        self._keep(event, chain, [(view, "expected here")], since_s, (), (belief.experience,), tuple(said))

    def _keep(
        self, event: m.Event, chain: list[tuple[float, str]], views: list[tuple[int, str]], since_s: float,
        without: tuple[int, ...], experiences: tuple[int, ...] = (), said: tuple[tuple[float, float], ...] = (),
    ) -> None:  # fmt: skip
        brain = self._session.brain
        shown = [m.SeenView(view, words, stored_picture(brain, view)) for view, words in views if view >= 0]
        while len(self._kept) >= MOST_KEPT:
            del self._kept[next(iter(self._kept))]
        self._kept[event.number] = m.WhyReport(
            event.number, event.time_s, event.kind, event.text, tuple(sorted(chain, key=lambda entry: entry[0])),
            camera_image(self._session), tuple(shown[:MOST_VIEWS]), brain.pose_cells.shape,
            tuple(map(packet_of, self._before)), tuple(map(packet_of, self._now)),
            experiences or (self._session.estimate.experience,), since_s, without, said,
        )  # fmt: skip

    def _packets(self) -> tuple[Packet, ...]:
        return tuple(self._session.brain.pose_cells.packets)

    def _differs(self) -> str:
        limit = self._session.brain.local_view.threshold
        return f"it differs by {self._session.estimate.recognition.difference:.1f}, the threshold is {limit:.1f}"


def _apart(a: Pose2, b: Pose2) -> float:
    return math.hypot(b.x - a.x, b.y - a.y)


def _parts(count: int) -> str:
    return "one part" if count == 1 else f"{count} parts"


TICKS = 600  # how far back it is looked for, a minute at 10 Hz
NEAR_CELLS, NEAR_LAYERS = 3.0, 3.0  # what is injected nearer to a packet than this feeds it
MOST = 8  # causes that are told

_Entry = tuple[float, dict[int, Packet], "tuple[int, NDArray[np.int32], NDArray[np.float32]] | None"]


class SnapCauses:
    """Which views, by their links to the pose cells, made the packet that won a snap. ACRA 2004 5.2, ACRA 2005 3.4.

    Call `watch` after each tick. It keeps references to what was injected, and computes nothing before a snap.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._ticks: deque[_Entry] = deque(maxlen=TICKS)
        self.since_s = session.time_s  # when the first of the causes told last put activity there

    def watch(self) -> None:
        brain = self._session.brain
        injection = brain.association.injection
        injected = None if injection is None else (injection.view, injection.cells, injection.values)
        self._ticks.append((self._session.time_s, {packet.id: packet for packet in brain.pose_cells.packets}, injected))

    def of(self, winner: Packet) -> tuple[m.SnapCause, ...]:
        """The views that injected around this packet since it came into being, those that injected most first.

        A packet moves as the robot drives. So each injection is compared with where the packet was in its tick.
        """
        amounts: dict[int, float] = {}
        looks: dict[int, int] = {}
        at, self.since_s = winner, self._session.time_s
        for time_s, packets, injected in reversed(self._ticks):
            then = packets.get(winner.id)
            if then is None or self._apart(then, at) > NEAR_CELLS:
                break
            at = then
            if injected is None:
                continue
            view, cells, values = injected
            amount = float(values[self._near(cells, at)].sum(dtype=np.float64))
            if amount > 0:
                amounts[view] = amounts.get(view, 0.0) + amount
                looks[view] = looks.get(view, 0) + 1
                self.since_s = time_s
        whole = sum(amounts.values())
        most = sorted(amounts, key=lambda view: -amounts[view])[:MOST]
        return tuple(self._cause(view, looks[view], amounts[view], amounts[view] / whole, winner) for view in most)

    def _cause(self, view: int, looks: int, amount: float, share: float, winner: Packet) -> m.SnapCause:
        association = self._session.brain.association
        cells, strength = association.links.of(view)
        there = strength[self._near(cells, winner)]
        strongest = float(there.max(initial=0.0))
        return m.SnapCause(view, looks, amount, share, len(there), strongest, association.age_s(view))

    def _apart(self, a: Packet, b: Packet) -> float:
        return self._session.brain.pose_cells.cells_apart(a.x, a.y, b.x, b.y)

    def _near(self, cells: NDArray[np.int32], packet: Packet) -> NDArray[np.bool_]:
        """Which of these cells (flat indices) are near a packet, round the network's edges."""
        n_theta, n_y, n_x = self._session.brain.pose_cells.shape
        theta, y, x = np.unravel_index(cells, (n_theta, n_y, n_x))
        across, up = _gap(x, packet.x, n_x), _gap(y, packet.y, n_y)
        turned = _gap(theta, packet.heading_rad * n_theta / math.tau, n_theta)
        return (across**2 + up**2 <= NEAR_CELLS**2) & (turned <= NEAR_LAYERS)


def _gap(cells: NDArray[np.integer], at: float, size: int) -> NDArray[np.float64]:
    away = np.abs(cells - at) % size
    return np.minimum(away, size - away)


def words_of(causes: tuple[m.SnapCause, ...]) -> str:
    """The causes in a few words."""
    if not causes:
        return "by no view"
    first, more = causes[0], len(causes) - 1
    others = f" and {more} more" if more else ""
    about = f"{_times(first.looks)}, {first.share:.0%} of the injection, learnt {first.age_s:.0f} s before"
    return f"by view {first.view} ({about}){others}"


def _times(count: int) -> str:
    return "1 observation" if count == 1 else f"{count} observations"
