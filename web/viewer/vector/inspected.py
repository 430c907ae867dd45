"""What is inspected, on a sheet: always in the colour of text, as on the stage."""

from __future__ import annotations

from textwrap import shorten

import numpy as np

from web.messages import CellReport, ExperienceReport, ViewReport, WhyReport
from web.viewer.fits.map_fit import MapFit
from web.viewer.marks.inspected import linked_cells, links_of, spots_of
from web.viewer.primitives import meshes
from web.viewer.vector.sheet import Entry, Sheet
from web.viewer.vector.subject import Subject

RING, SPOT = 16.0, 10.0  # pixels
MOST_LETTERS = 72  # in the legend
Points = np.ndarray


def mark_on_map(sheet: Sheet, subject: Subject, fit: MapFit, places: Points) -> list[Entry]:
    """A ring and a name at the experience, with its links bright; small rings at all that belong to a view or a cell.

    places: (n, 2) of all experiences on the sheet."""
    report, palette = subject.overlaid.inspected, subject.palette
    if report is None:
        return []
    if isinstance(report, ExperienceReport):
        at = fit.to_plate(np.array([[report.pose.x, report.pose.y]]))[0].tolist()
        sheet.lines(places[links_of(report, len(places))], palette.text, 3)
        sheet.dot(at, RING, None, palette.casing, edge=9)
        sheet.dot(at, RING, None, palette.text, edge=4.5)
        sheet.avoid(at, RING)
        sheet.label(at, f"#{report.id}", palette.sheet, up=34, fill=palette.text)
        return [("ring", palette.text, f"experience {report.id} and its links")]
    spots = places[spots_of(report, len(places))].tolist()
    for place in spots:
        sheet.dot(place, SPOT, None, palette.text, edge=3)
        sheet.avoid(place, SPOT)
    return [("ring", palette.text, _words(report))] if spots else []


def _words(report: ViewReport | CellReport | WhyReport) -> str:
    match report:
        case ViewReport():
            return f"made with view {report.id}"
        case CellReport():
            return f"their zones hold the cells at {report.x}, {report.y}"
        case WhyReport():
            return shorten(f"why: {report.text}", MOST_LETTERS, placeholder=" ...")


def mark_among_cells(sheet: Sheet, subject: Subject) -> list[Entry]:
    """An experience's zone of influence, or a column of cells; and the cells that the view is linked to."""
    report, palette, legend = subject.overlaid.inspected, subject.palette, list[Entry]()
    if isinstance(report, ExperienceReport):
        _draw_zone(sheet, subject, report)
        legend.append(("ring", palette.text, f"zone of experience {report.id}"))
    elif isinstance(report, CellReport):
        corners = _square(report.x, report.y, 1.0)
        sheet.line(np.vstack([corners, corners[:1]]), palette.text, 3)
        legend.append(("ring", palette.text, f"the cells at {report.x}, {report.y}"))
    if isinstance(report, ExperienceReport | ViewReport):
        cells, sizes = linked_cells(report)
        for (_, y, x), size in zip(cells[::-1].tolist(), sizes[::-1].tolist(), strict=True):
            sheet.polygon(_square(x, y, size), palette.text)
        view = report.view if isinstance(report, ExperienceReport) else report.id
        if len(cells):
            legend.append(("area", palette.text, f"cells that view {view} is linked to"))
    return legend


def _draw_zone(sheet: Sheet, subject: Subject, report: ExperienceReport) -> None:
    """A disc; where it leaves the sheet, it goes on at the other side."""
    _, n_y, n_x = subject.snapshot.pose_cells.shape
    for across in (-n_x, 0, n_x):
        for up in (-n_y, 0, n_y):
            middle = report.cell[0] + across, report.cell[1] + up
            around = meshes.circle(report.zone_xy, middle, corners=48)
            if sheet.inside(around).any():
                sheet.polygon(around, subject.palette.text, opacity=0.3)
                sheet.line(np.vstack([around, around[:1]]), subject.palette.text, 2.5)


def _square(x: float, y: float, size: float) -> Points:
    return np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * size / 2 + (x, y)
