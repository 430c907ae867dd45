"""What happened, where it happened: marks on office and map, and among the pose cells. Those on the map move with the
experience that they lie beside."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from app.protocol.lesson import Lesson
from app.session import Session
from app.views.history import History
from ratslam_core import Packet, Pose2
from web.messages import LessonMark
from web.messages import Packet as PacketShown

MOST_MARKS = 12
WORDS = {
    "closure": "loop closed", "snap": "snap", "lost": "lost", "recovered": "recovered", "kidnap": "put down here",
    "arrived": "arrived", "false": "false observation", "packet": "packet put in", "link": "link deleted", "reached": "reached",
}  # fmt: skip

Spot = tuple[float, float, float]  # x and y in cells, heading


@dataclass(frozen=True, slots=True)
class _Mark:
    words: str
    tick: int
    true: Pose2  # office frame
    experience: int
    beside: Pose2  # of the robot, seen from the experience
    cells: tuple[Spot, Spot | None] | None  # among the pose cells, and where it came from


class Marks:
    """Made when the showing begins; call `note` after each tick of it."""

    def __init__(self, lesson: Lesson, session: Session, history: History) -> None:
        self._session, self._history, self._kinds = session, history, lesson.show.marks
        self._began = _spot(session.brain.pose_cells.winner) if lesson.scene.view == "pose" else None
        self._told = history.log.events[-1].number if history.log.events else 0
        self._marks: list[_Mark] = []

    def note(self) -> None:
        events = self._history.log.events
        for event in events[max(0, len(events) - 50) :]:
            if event.number > self._told and event.kind in self._kinds and len(self._marks) < MOST_MARKS:
                self._mark(WORDS[event.kind], self._among_cells(event.kind))
        self._told = events[-1].number if events else 0

    def end(self, words: str) -> None:
        """Where it ended; of a lesson about the pose cells, with the way that the packet went."""
        winner = self._session.brain.pose_cells.winner
        self._mark(words, None if self._began is None else (_spot(winner), self._began))

    def last_event(self, kind: str) -> int | None:
        """The number of the last event of this kind."""
        numbers = [event.number for event in self._history.log.events if event.kind == kind]
        return numbers[-1] if numbers else None

    def view(self) -> tuple[LessonMark, ...]:
        """On both plates, the map's as the map is now."""
        map_ = self._session.brain.experience_map
        seen: list[LessonMark] = []
        for mark in self._marks:
            seen.append(_at("office", mark.true, mark))
            if mark.experience < len(map_):
                seen.append(_at("map", map_.pose(mark.experience).compose(mark.beside), mark))
            if mark.cells is not None:
                (x, y, heading), start = mark.cells
                seen.append(replace(_at("cells", Pose2(x, y, heading), mark), start=start))
        return tuple(seen)

    def _among_cells(self, kind: str) -> tuple[Spot, Spot | None] | None:
        """Where it happened in the box: a snap goes from packet to packet; a packet put in is the youngest that there is."""
        snap, packets = self._history.events.last_snap, self._session.brain.pose_cells.packets
        if kind == "snap" and snap is not None:
            return _spot(snap.end), _spot(snap.start)
        if kind == "packet" and len(packets) > 1:
            return _spot(max(packets, key=lambda packet: packet.id)), None
        return None

    def _mark(self, words: str, cells: tuple[Spot, Spot | None] | None) -> None:
        truth, map_ = self._session.simulator.truth, self._session.brain.experience_map
        self._marks.append(
            _Mark(
                words,
                self._session.tick_count,
                Pose2(truth.x, truth.y, truth.heading_rad),
                map_.active,
                map_.local_pose,
                cells,
            )
        )


def _spot(packet: Packet | PacketShown) -> Spot:
    return round(packet.x, 3), round(packet.y, 3), round(packet.heading_rad, 3)


def _at(plate: Literal["office", "map", "cells"], pose: Pose2, mark: _Mark) -> LessonMark:
    x, y, heading = round(pose.x, 3), round(pose.y, 3), round(pose.heading_rad, 3)
    return LessonMark(plate, x, y, heading, mark.words, mark.tick)
