"""Two branches side by side on one clock, and where they differ first."""

from __future__ import annotations

from collections.abc import Generator
from itertools import zip_longest

import numpy as np

from app.run_record.keyframes import Branch, Moment
from app.views.history import History
from web.messages import Packet, Pose, Side

MOST_POINTS = 600  # of a map that is drawn small


def parted_at(a: Branch, b: Branch) -> int:
    """The last tick that two branches share by their making. The same branch: its end."""
    lines = [_line(a), _line(b)]
    parted = [line[len(_shared(*lines)) :] for line in lines]
    return min([line[0].from_tick for line in parted if line] or [a.end_tick])


def first_difference(a: Branch, b: Branch) -> Generator[float, None, str]:
    """Where two branches differ first, in words: the tick, found by their hashes, the order, the view and the link.

    Yields the share of the search that is done, about; it may take seconds.
    """
    shared, last = parted_at(a, b), min(a.end_tick, b.end_tick)
    shared = _same_orders(a, b, shared, last)
    looks, most = 0.0, 2.0 * max(1, last - shared).bit_length() + 2

    def same(tick: int) -> Generator[float, None, bool]:
        nonlocal looks
        hashes: list[str] = []
        for branch in (a, b):
            moment = Moment(branch, tick)
            for share in moment.going(tick):
                yield min(1.0, (looks + share / 2) / most)
            looks += 0.5
            hashes.append(moment.session.state_hash())
            yield min(1.0, looks / most)
        return hashes[0] == hashes[1]

    if shared >= last or (yield from same(last)):
        return f"branches {a.number} and {b.number} are the same up to tick {last}, where one of them ends"
    low, high = shared, shared + 1
    while high < last:  # so that the search stays near its begin, where it mostly ends
        if not (yield from same(high)):
            break
        low, high = high, min(last, high + 2 * (high - shared))
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if (yield from same(middle)) else (low, middle)
    words = [f"first difference at tick {high}", _orders(a, b, high - 1), _view(a.history, b.history), _link(a, b)]
    return "; ".join(filter(None, words))


def side_of(branch: Branch, moment: Moment | None, history: History) -> Side:
    """What is shown of a branch at one moment. moment: None at its end."""
    session = branch.session if moment is None else moment.session
    experiences, packet = session.brain.experience_map, session.estimate.packet
    every = max(1, len(experiences) // MOST_POINTS)
    return Side(
        number=branch.number,
        time_s=session.time_s,
        error_map_m=history.series.error_map_m,
        error_odometry_m=history.series.error_odometry_m,
        views=len(session.brain.local_view),
        experiences=len(experiences),
        links=experiences.link_count,
        packet=Packet(packet.x, packet.y, packet.heading_rad, packet.mass, packet.id),
        xy=experiences.poses[::every, :2].astype(np.float32),
        robot=Pose(experiences.robot.x, experiences.robot.y, experiences.robot.heading_rad),
        turn_rad=history.series.map_turn_rad,
    )


def _line(branch: Branch) -> list[Branch]:
    """A branch and its forebears, the first of them first."""
    line = [branch]
    while line[0].parent is not None:
        line.insert(0, line[0].parent)
    return line


def _shared(a: list[Branch], b: list[Branch]) -> list[Branch]:
    return [one for one, other in zip(a, b, strict=False) if one is other]


def _same_orders(a: Branch, b: Branch, tick: int, last: int) -> int:
    """The first tick from this one on after which the orders differ; at most `last`."""
    ticks = {order.tick for branch in (*_line(a), *_line(b)) for order in branch.orders if tick <= order.tick < last}
    return next((told for told in sorted(ticks) if _given(a, told) != _given(b, told)), max(tick, last))


def _given(branch: Branch, tick: int) -> list[tuple[str, object]]:
    return [(order.name, order.values) for order in branch.orders_after(tick)]


def _orders(a: Branch, b: Branch, tick: int) -> str:
    for one, other in zip_longest(_given(a, tick), _given(b, tick)):
        if one != other:
            names = [
                f"{given[0] if given else 'nothing'} in {branch.number}" for given, branch in ((one, a), (other, b))
            ]
            return f"told before it: {', '.join(names)}"
    return ""


def _view(a: History, b: History) -> str:
    """The first view that was not learnt, or first met, at the same time."""
    n = min(len(a.visits.views.first_s), len(b.visits.views.first_s))
    times = np.stack([a.visits.views.first_s[:n], b.visits.views.first_s[:n]])
    differ = np.flatnonzero(~((times[0] == times[1]) | np.isnan(times).all(0)))
    if len(differ) == 0:
        return "no view differs"
    when = np.nanmin(times[:, differ], axis=0)
    first = int(np.argmin(when))
    return f"first view that differs: #{differ[first]} at {when[first]:.1f} s"


def _link(a: Branch, b: Branch) -> str:
    """The first link that only one of them has, in the order in which they were made."""
    one, other = (branch.session.brain.experience_map.links for branch in (a, b))
    n = min(len(one), len(other))
    differ = np.flatnonzero((one[:n] != other[:n]).any(1))
    if len(differ) == 0 and len(one) == len(other):
        return "no link differs"
    row = int(differ[0]) if len(differ) else n
    has = [f"{links[row][0]} to {links[row][1]}" if row < len(links) else "none" for links in (one, other)]
    return f"first link that differs: {has[0]} in {a.number}, {has[1]} in {b.number}"
