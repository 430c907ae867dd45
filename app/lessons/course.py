"""A session taken through the steps of a lesson: those of trials, a packet put in by hand, and a click on the map."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from app.lessons.schema import Click, LessonStep, Packet
from app.session import Session
from app.trials.course import Course
from app.trials.steps import place_of


class LessonCourse(Course):
    """Take `ticks_of(steps)` one by one, and run one tick of the session after each."""

    def __init__(self, session: Session, steps: Sequence[LessonStep]) -> None:
        """steps: all that will be asked for. ValueError names a place, door or parameter that does not exist."""
        super().__init__(session, [step for step in steps if not isinstance(step, (Packet, Click))])
        for step in steps:
            if isinstance(step, Click):
                place_of(session.world, step.place)

    def ticks_of(self, steps: Sequence[LessonStep]) -> Iterator[str]:
        """What is being done, before each tick."""
        for step in steps:
            if isinstance(step, Packet):
                self._put(step)
            elif isinstance(step, Click):
                yield from self._click(step)
            else:
                yield from self._carry_out(step)

    def _put(self, step: Packet) -> None:
        cells = self.session.brain.pose_cells
        n_theta, n_y, n_x = cells.shape
        x, y = round(cells.winner.x + step.away[0]) % n_x, round(cells.winner.y + step.away[1]) % n_y
        heading = cells.winner.heading_rad + step.layers * math.tau / n_theta
        self.mark(self.session.put_packet(x, y, math.remainder(heading, math.tau), step.share), kind="packet")

    def _click(self, step: Click) -> Iterator[str]:
        """The click is as exact as the map: it falls where the map has what the robot experienced nearest to the place."""
        session, map_ = self.session, self.session.brain.experience_map
        place = place_of(session.world, step.place)
        births = session.evaluation.births(len(map_))
        away = np.hypot(births[:, 0] - place[0], births[:, 1] - place[1])
        nearest = int(np.nanargmin(away))
        place = float(births[nearest, 0]), float(births[nearest, 1])
        name = step.place if isinstance(step.place, str) else "the place that was clicked"
        experience = session.set_goal(float(map_.poses[nearest, 0]), float(map_.poses[nearest, 1]))
        self.mark(f"{name} is clicked on the map: to experience {experience}")
        beginning = session.time_s, session.evaluation.path_m
        while not self._arrived:
            if session.time_s - beginning[0] >= step.timeout_s - 1e-9:
                self._visited(name, experience, place, f"not reached in {step.timeout_s:g} s", beginning)
                return
            yield from self._tick(f"on the way to {name}")
        miss_m = math.dist(self._here, place)
        why = "" if miss_m <= step.near_m else f"arrived {miss_m:.2f} m away"
        self._visited(name, experience, place, why, beginning)

    @property
    def _arrived(self) -> bool:
        state = self.session.pilot.goal_state
        return state is not None and state[1] == "arrived"
