"""Inspect: what the tab says about one experience, one view or one column of pose cells."""

from __future__ import annotations

import math
from typing import Any

from web.messages import (
    CellReport,
    ExperienceReport,
    HebbianReport,
    LinkReport,
    Report,
    Snapshot,
    Times,
    ViewReport,
    WhyReport,
)
from web.panel.part import Content, Rows, clock, degrees, often, percent, table

LINKS, NUMBERS, MOST_PACKETS, MOST_EVENTS = 24, 6, 6, 6
EXPLAINED = ("snap", "closure", "false", "lost", "believes")  # events of which is known why


def active(snapshot: Snapshot) -> Content:
    """What can be inspected just now; -1: nothing. When no view is active, the best one."""
    senses = snapshot.senses
    view = senses.active_view if senses.active_view >= 0 else senses.best_view
    explained = [event for event in snapshot.events if event.kind in EXPLAINED][-MOST_EVENTS:]
    events = [[event.number, event.kind, clock(event.time_s)] for event in reversed(explained)]
    return Content({"experience": snapshot.active_experience, "view": view, "events": events})


def inspected(report: Report | None) -> Content:
    match report:
        case ExperienceReport():
            return _experience(report)
        case ViewReport():
            return _view(report)
        case CellReport():
            return _cell(report)
        case WhyReport():
            return _why(report)
        case None:
            return Content({"kind": None})


def _experience(report: ExperienceReport) -> Content:
    x, y, theta = report.cell
    pose = report.pose
    rows = [
        ("in the map", f"{pose.x:.2f}, {pose.y:.2f} m, {degrees(pose.heading_rad)}"),
        ("in the pose cells", f"x′ {x:.1f}, y′ {y:.1f}, θ′ {theta:.1f}"),
        ("zone of influence", f"{report.zone_xy:g} cells, {report.zone_theta:g} layers"),
        ("energy now", f"{report.energy:.2f} of at most 2"),
    ]
    data = _head("experience", report.id, f"#{report.id}", report.active) | {"view": report.view}
    data["sections"] = [
        {"table": table("Where it is", rows)},
        {"table": table("When", _times(report.times))},
        {"links": _links(report)},
        {"table": _hebbian("Its view's links to pose cells", report.hebbian)},
    ]
    return Content(data, {} if report.picture is None else {"picture": report.picture})


def _view(report: ViewReport) -> Content:
    known = report.difference <= report.threshold
    rows = [
        ("difference", f"{report.difference:.1f}"),
        ("threshold", f"{report.threshold:.1f}: {'the same view' if known else 'another view'}"),
    ]
    data = _head("view", report.id, f"#{report.id}", report.active)
    data["sections"] = [
        {"table": table("Against what is seen now", rows)},
        {"table": table("When", _times(report.times))},
        {"choices": _experiences("Experiences made with it", report.experiences)},
        {"table": _hebbian("Links to pose cells", report.hebbian)},
    ]
    return Content(data, {"picture": report.picture, "now": report.now, "camera": report.camera})


def _cell(report: CellReport) -> Content:
    activity = float(report.by_heading.sum())
    share = "nothing is active here" if activity <= 0 else f"{percent(activity)} of all activity"
    packet = []
    if report.packet is not None:
        p = report.packet
        packet = [
            ("packet", f"{p.id}, with {percent(p.mass)} of all activity"),
            ("its centre", f"x′ {p.x:.1f}, y′ {p.y:.1f}, θ′ {degrees(p.heading_rad % math.tau)}"),
        ]
    shown = [(view, f"{strength:.3f}") for view, strength in report.views[:NUMBERS]]
    linked = _choices(
        "Views linked here, by strength", "view", shown, report.view_count, "none: no view has been learnt here"
    )
    data: dict[str, Any] = {
        "kind": "cell",
        "number": f"{report.x}, {report.y}",
        "words": share,
        "x": report.x,
        "y": report.y,
    }
    data["sections"] = [
        {"table": table("Belongs to", packet, "no packet: nothing is active here")},
        {"choices": linked},
        {"choices": _experiences("Experiences whose zone this is in", report.experiences)},
    ]
    return Content(data, {"by_heading": report.by_heading})


def _why(report: WhyReport) -> Content:
    """The chain, then packets before and after as seen from above, then the views. Pictures are `seen0` and so on."""
    data: dict[str, Any] = {"kind": "why", "id": report.event, "number": clock(report.time_s), "words": report.text}
    data |= {"event": report.kind, "since_s": report.since_s, "without": list(report.without)}
    data["cells"] = list(report.shape[1:])
    data["packets"] = [
        [
            [packet.id, round(packet.x, 1), round(packet.y, 1), round(packet.mass, 3)]
            for packet in packets[:MOST_PACKETS]
        ]
        for packets in (report.before, report.after)
    ]
    data["said"] = [[round(at, 1), round(nats, 2)] for at, nats in report.said]
    data["seen"] = [[seen.view, seen.words] for seen in report.views]
    linked = [(experience, "") for experience in report.experiences]
    data["sections"] = [
        {"chain": [[clock(at), words] for at, words in report.chain]},
        {"choices": _choices("Experiences", "experience", linked, len(linked), "none")},
    ]
    pictures = {f"seen{k}": seen.picture for k, seen in enumerate(report.views)}
    return Content(data, {"camera": report.camera, **pictures})


def _head(kind: str, identity: int, number: str, is_active: bool) -> dict[str, Any]:
    words = "active now" if is_active else "not active"
    return {"kind": kind, "id": identity, "number": number, "words": words}


def _times(times: Times) -> Rows:
    if times.first_s is None or times.last_s is None:
        return [("met in this run", "not yet")]
    return [("first", clock(times.first_s)), ("last", clock(times.last_s)), ("became active", often(times.visits))]


def _experiences(title: str, numbers: tuple[int, ...]) -> dict[str, Any]:
    return _choices(title, "experience", [(number, "") for number in numbers[:NUMBERS]], len(numbers), "none")


def _choices(title: str, kind: str, entries: list[tuple[int, str]], count: int, empty: str) -> dict[str, Any]:
    """Numbers that a click inspects, each with a word, and how many are left out or why there are none."""
    return {"title": title, "kind": kind, "entries": entries, "more": count - len(entries), "empty": empty}


def _hebbian(title: str, links: HebbianReport) -> dict[str, Any]:
    if links.count == 0:
        return table(title, [], "none")
    rows = [("pose cells linked", str(links.count)), ("strongest link", f"{float(links.strength[0]):.4f}")]
    return table(title, [*rows, ("a link injects at most", f"{links.saturation:g}")])


def _links(report: ExperienceReport) -> dict[str, Any]:
    rows = [_link(link, report.id) for link in report.links[:LINKS]]
    more = len(report.links) - len(rows)
    return {"title": f"Links to other experiences: {len(report.links)}", "rows": rows, "more": more}


def _link(link: LinkReport, here: int) -> dict[str, Any]:
    """Where a link leads by odometry, and what the robot knows about going there."""
    word, other = ("to", link.end) if link.start == here else ("from", link.start)
    way = f"{link.distance_m:.2f} m at {degrees(link.bearing_rad)}, turns {degrees(link.facing_rad)}"
    trust = f"confidence {percent(link.confidence)}" if link.trials else "not tried yet"
    known = f"{link.time_s:.1f} s, gone {often(link.passages)}, {link.behaviour}; {trust}"
    return {"word": word, "experience": other, "way": way, "known": known}
