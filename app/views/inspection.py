"""Everything the brain holds about one experience, one view, or the pose cells of one place. It only reads."""

from __future__ import annotations

import numpy as np

from app.pilot.behaviours import words_of
from app.session import Session
from app.views.arrays import camera_image, frozen, packet_of, present_picture, stored_picture
from app.views.history import VisitLog
from app.views.reasons import Reasons
from ratslam_core import Link, RatSlam
from web.messages import (
    CellReport,
    ExperienceReport,
    HebbianReport,
    Inspect,
    LinkReport,
    Packet,
    Pose,
    Report,
    ViewReport,
)

STRONGEST = 300  # most links of a view that are reported
VIEWS = 24  # most views of a cell that are reported


def inspect(session: Session, visits: VisitLog, reasons: Reasons, command: Inspect) -> Report | None:
    """What the brain holds about what was asked for; None if nothing was. ValueError names the valid range."""
    cell = command.x is not None or command.y is not None
    if sum(asked is not None for asked in (command.experience, command.view, command.event)) + cell > 1:
        raise ValueError("choose an experience, a view, an event, or a pose cell's x and y: one of them")
    if command.event is not None:
        return reasons.of(command.event)
    if command.experience is not None:
        return experience_report(session, visits, command.experience)
    if command.view is not None:
        return view_report(session, visits, command.view)
    if cell:
        return cell_report(session, command.x, command.y)
    return None


def experience_report(session: Session, visits: VisitLog, experience: int) -> ExperienceReport:
    brain, map_ = session.brain, session.brain.experience_map
    x, y, theta, view = map_.cell_state(experience)
    pose, p = map_.pose(experience), map_.params
    packet, now = session.estimate.packet, session.estimate.recognition.view
    return ExperienceReport(
        id=experience,
        cell=(x, y, theta),
        view=view,
        picture=None if view < 0 else stored_picture(brain, view),
        pose=Pose(pose.x, pose.y, pose.heading_rad),
        zone_xy=p.zone_xy,
        zone_theta=p.zone_theta,
        energy=map_.energy(experience, packet, now),
        active=map_.active == experience,
        links=_links(session, experience),
        hebbian=_hebbian(brain, view),
        times=visits.experiences.of(experience),
    )


def view_report(session: Session, visits: VisitLog, view: int) -> ViewReport:
    brain = session.brain
    if not 0 <= view < len(brain.local_view):
        known = (
            f"from 0 to {len(brain.local_view) - 1}" if len(brain.local_view) else "one that exists; there is none yet"
        )
        raise ValueError(f"view must be {known}, got {view}")
    return ViewReport(
        id=view,
        picture=stored_picture(brain, view),
        now=present_picture(brain),
        camera=camera_image(session),
        difference=brain.local_view.difference_to(view),
        threshold=brain.local_view.threshold,
        active=session.estimate.recognition.view == view,
        experiences=tuple(np.flatnonzero(brain.experience_map.views == view).tolist()),
        hebbian=_hebbian(brain, view),
        times=visits.views.of(view),
    )


def cell_report(session: Session, x: int | None, y: int | None) -> CellReport:
    brain = session.brain
    n_theta, n_y, n_x = brain.pose_cells.shape
    if x is None or y is None or not (0 <= x < n_x and 0 <= y < n_y):
        raise ValueError(f"a pose cell needs x from 0 to {n_x - 1} and y from 0 to {n_y - 1}, got {x} and {y}")
    cells, activity = brain.pose_cells.active
    here = (cells[:, 0] == x) & (cells[:, 1] == y)
    by_heading = np.bincount(cells[here, 2], activity[here], n_theta).astype(np.float32)
    views, strength = brain.view_links.views_at(y * n_x + x, n_y * n_x, len(brain.local_view))
    strongest = np.argsort(-strength, kind="stable")[:VIEWS]
    return CellReport(
        x=x,
        y=y,
        by_heading=frozen(by_heading),
        packet=_packet_at(session, x, y) if here.any() else None,
        views=tuple(zip(views[strongest].tolist(), strength[strongest].tolist(), strict=True)),
        view_count=len(views),
        experiences=_zones_at(session, x, y),
    )


def _packet_at(session: Session, x: int, y: int) -> Packet:
    pose_cells = session.brain.pose_cells
    nearest = min(pose_cells.packets, key=lambda p: pose_cells.cells_apart(p.x, p.y, x, y))
    return packet_of(nearest)


def _zones_at(session: Session, x: int, y: int) -> tuple[int, ...]:
    """Experiences whose zone contains this cell, the nearest first."""
    map_ = session.brain.experience_map
    n_y, n_x = map_.shape[1:]
    gaps = np.abs(map_.cell_states[:, :2] - (x, y)) % (n_x, n_y)
    apart = np.hypot(*np.minimum(gaps, np.array((n_x, n_y)) - gaps).T)
    within = np.flatnonzero(apart <= map_.params.zone_xy)
    return tuple(within[np.argsort(apart[within], kind="stable")].tolist())


def _hebbian(brain: RatSlam, view: int) -> HebbianReport:
    cells, strength = brain.view_links.of(view) if view >= 0 else (np.zeros(0, np.int32), np.zeros(0, np.float32))
    strongest = np.argsort(-strength, kind="stable")[:STRONGEST]
    places = np.stack(np.unravel_index(cells[strongest], brain.pose_cells.shape), 1).astype(np.int32)
    return HebbianReport(len(cells), frozen(places), frozen(strength[strongest]), brain.params.local_view.saturation)


def _links(session: Session, experience: int) -> tuple[LinkReport, ...]:
    """The links that begin at this experience, then those that end at it."""
    map_ = session.brain.experience_map
    ends = map_.links
    rows = [*np.flatnonzero(ends[:, 0] == experience), *np.flatnonzero(ends[:, 1] == experience)]
    return tuple(_report(map_.link(int(ends[row, 0]), int(ends[row, 1]))) for row in rows)


def _report(link: Link) -> LinkReport:
    return LinkReport(
        link.from_experience, link.to_experience, link.distance_m, link.bearing_rad, link.facing_rad, link.time_s,
        words_of(link.behaviour), link.passages, link.trials, link.confidence,
    )  # fmt: skip
