"""The inspectors' pages: what is to be said of one experience, one view, one column of pose cells."""

from __future__ import annotations

import html
import math

from web.messages import CellReport, ExperienceReport, HebbianReport, LinkReport, Report, Times, ViewReport
from web.stage import markup
from web.stage.images import Pixels
from web.stage.memory_panel import clock

LINKS, NUMBERS = 24, 6
BAR = (76, 160, 220)


def report_page(report: Report) -> str:
    match report:
        case ExperienceReport():
            return experience_page(report)
        case ViewReport():
            return view_page(report)
        case CellReport():
            return cell_page(report)


def experience_page(report: ExperienceReport) -> str:
    view = markup.caption("view") + markup.blank("made where there was nothing to see", 1.5)
    if report.picture is not None:
        stored = _picture(report.picture, f"the stored view {report.view}")
        view = markup.caption(f"its view #{report.view}") + markup.choice("view", report.view, stored, "display:block")
    x, y, theta = report.cell
    pose = report.pose
    words = "active now" if report.active else "not active"
    rows = [
        ("in the map", f"{pose.x:.2f}, {pose.y:.2f} m, {_degrees(pose.heading_rad)}"),
        ("in the pose cells", f"x′ {x:.1f}  y′ {y:.1f}  θ′ {theta:.1f}"),
        ("zone of influence", f"{report.zone_xy:g} cells, {report.zone_theta:g} layers"),
        ("energy now", f"{report.energy:.2f} of at most 2"),
    ]
    return markup.page(
        markup.row(_name("experience", f"#{report.id}", words), view),
        markup.table("Where it is", rows),
        markup.table("When", _times(report.times)),
        _links(report),
        _hebbian("Its view's links to pose cells", report.hebbian),
    )


def view_page(report: ViewReport) -> str:
    known = report.difference <= report.threshold
    rows = [
        ("difference", f"{report.difference:.1f}"),
        ("threshold", f"{report.threshold:.1f}: {'the same view' if known else 'another view'}"),
    ]
    stored = markup.caption("as it is stored") + _picture(report.picture, f"the stored view {report.id}")
    now = markup.caption("what is made of it") + _picture(report.now, "what the robot makes of it")
    camera = markup.caption("camera now") + _picture(report.camera, "what the robot's camera sees now")
    return markup.page(
        markup.row(_name("local view cell", f"#{report.id}", "active now" if report.active else "not active"), camera),
        markup.row(stored, now),
        markup.table("Against what is seen now", rows),
        markup.table("When", _times(report.times)),
        _experiences("Experiences made with it", report.experiences),
        _hebbian("Links to pose cells", report.hebbian),
    )


def cell_page(report: CellReport) -> str:
    activity = float(report.by_heading.sum())
    share = "nothing is active here" if activity <= 0 else f"{_percent(activity)} of all activity"
    bars = markup.caption("by heading θ′") + markup.blank("no activity", 1.5)
    if activity > 0:
        bars = markup.caption("by heading θ′") + markup.histogram(
            report.by_heading, BAR, "activity by heading", 1.5, ("0°", "180°", "360°")
        )
    packet = []
    if report.packet is not None:
        p = report.packet
        packet = [
            ("packet", f"{p.id}, with {_percent(p.mass)} of all activity"),
            ("its centre", f"x′ {p.x:.1f}  y′ {p.y:.1f}  θ′ {_degrees(p.heading_rad % math.tau)}"),
        ]
    views = [(view, f"{strength:.3f}") for view, strength in report.views[:NUMBERS]]
    return markup.page(
        markup.row(_name("pose cells at", f"{report.x}, {report.y}", share), bars),
        markup.table("Belongs to", packet, "no packet: nothing is active here"),
        markup.choices(
            "Views linked here, by strength",
            "view",
            views,
            report.view_count - len(views),
            "none: no view has been learnt here",
        ),
        _experiences("Experiences whose zone this is in", report.experiences),
    )


def _name(kind: str, number: str, words: str) -> str:
    big = f'<div style="font-size:24px;font-weight:700;line-height:1.2">{html.escape(number)}</div>'
    return f"{markup.caption(kind)}{big}<div>{html.escape(words)}</div>"


def _picture(pixels: Pixels, words: str) -> str:
    return markup.picture(pixels, words, pixels.shape[1] / pixels.shape[0])


def _times(times: Times) -> markup.Rows:
    if times.first_s is None or times.last_s is None:
        return [("met in this run", "not yet")]
    often = "once" if times.visits == 1 else f"{times.visits} times"
    return [("first", clock(times.first_s)), ("last", clock(times.last_s)), ("became active", often)]


def _experiences(title: str, numbers: tuple[int, ...]) -> str:
    shown = [(number, "") for number in numbers[:NUMBERS]]
    return markup.choices(title, "experience", shown, len(numbers) - len(shown))


def _hebbian(title: str, links: HebbianReport) -> str:
    if links.count == 0:
        return markup.table(title, [], "none")
    rows = [("pose cells linked", str(links.count)), ("strongest link", f"{float(links.strength[0]):.4f}")]
    return markup.table(title, [*rows, ("a link injects at most", f"{links.saturation:g}")])


def _links(report: ExperienceReport) -> str:
    parts = [markup.heading(f"Links to other experiences: {len(report.links)}")]
    parts += [_link(link, report.id) for link in report.links[:LINKS]]
    if len(report.links) > LINKS:
        parts.append(markup.note(f"and {len(report.links) - LINKS} more"))
    return "".join(parts)


def _link(link: LinkReport, here: int) -> str:
    """Two lines: where it leads by odometry, and what the robot knows of going there."""
    word, other = ("to", link.end) if link.start == here else ("from", link.start)
    to = markup.choice("experience", other, f"{word} #{other}", "font-weight:700;text-decoration:underline")
    way = f"{link.distance_m:.2f} m at {_degrees(link.bearing_rad)}, turns {_degrees(link.facing_rad)}"
    often = "once" if link.passages == 1 else f"{link.passages} times"
    trust = f"confidence {_percent(link.confidence)}" if link.trials else "not tried yet"
    known = f"{link.time_s:.1f} s, gone {often}, {link.behaviour}; {trust}"
    row = "display:flex;justify-content:space-between;gap:8px"
    head = f'<div style="{row}">{to}<span>{html.escape(way)}</span></div>'
    return f'<div style="margin:5px 0">{head}<div style="opacity:.75;font-size:12px">{html.escape(known)}</div></div>'


def _degrees(angle_rad: float) -> str:
    return f"{math.degrees(angle_rad):.0f}°".replace("-0°", "0°")


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.095 else f"{100 * share:.1f} %"
