"""Builds the immutable Snapshot of a session. Expensive parts are rebuilt only as often as people can see a change."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, cast

import numpy as np

from app.config import Config, Value
from app.config.presets import PRESETS, pairs_beside, preset_of, without
from app.recordings.recording import About
from app.session import SECOND, Session, is_lost
from app.views.arrays import Slow, camera_image, frozen
from app.views.belief import belief_of, spread_of
from app.views.beside import BesideDrawn
from app.views.history import History, Trails
from app.views.inspection import inspect
from app.views.map_layers import MapLayers, goal_memory_layer, occupancy_layer, pose_cell_layer
from app.views.office import (
    ActorsView,
    DrawnWorld,
    ghost_of,
    goal_view,
    known_places,
    movements_of,
    shown,
    tags_view,
    trip_view,
)
from app.views.tick_stages import Walk
from ratslam_core import Pose2
from ratslam_core.params.additions import ADDITIONS
from web.messages import (
    AdditionsOff,
    BesideView,
    Inspect,
    LessonView,
    OfficeEdition,
    PairChoice,
    Parameter,
    Pose,
    RecordingView,
    Report,
    Senses,
    SituationView,
    Snapshot,
    TimeView,
    Timing,
    TrialView,
    UntilView,
    WorldDrawing,
)

OCCUPANCY_EVERY_S = 2.0  # of wall time
GOAL_MEMORY_EVERY_S = 0.5
PLACES_EVERY_S = 1.0
INSPECT_EVERY_S = 0.25
_PRESETS = tuple(PRESETS)


class Snapshots:
    """Builds snapshots of one session. It changes nothing that the session's future depends on."""

    def __init__(self, session: Session, history: History, run: int, worlds: tuple[tuple[str, str], ...]) -> None:
        self._session, self._history, self._run, self.worlds = session, history, run, worlds
        self.office: OfficeEdition | None = None
        self.trial: TrialView | None = None
        self.lesson: LessonView | None = None
        self.until: UntilView | None = None
        self.time: TimeView | None = None
        self.situation: SituationView | None = None
        self.back = self.stepping = False
        self.pairs: tuple[PairChoice, ...] = ()
        self.additions_off = AdditionsOff()
        self.inspected = Inspect(type="inspect")  # at first nothing
        self.walk: Walk | None = None  # through the stages of the last tick
        self._drawn, self._actors, self._parameters = DrawnWorld(), ActorsView(), _ParameterRows()
        self._floor = TruthFloor()
        self._fitted: tuple[Pose2 | None, Pose | None] = None, None
        self._settled_at: int | None = None
        self._map = MapLayers(
            lambda: session.brain.experience_map, lambda: session.evaluation, lambda: session.pilot.goals
        )
        self._beside = BesideDrawn(session, history)
        self._occupancy = Slow(OCCUPANCY_EVERY_S, lambda: occupancy_layer(session))
        self._inspection = Slow(INSPECT_EVERY_S, self._inspect)
        self._places = Slow(PLACES_EVERY_S, lambda: known_places(session))
        self._goal_memory = Slow(GOAL_MEMORY_EVERY_S, lambda: goal_memory_layer(session))

    def continue_from(self, other: Snapshots) -> None:
        """Show the same run at another moment: what is drawn and inspected stays, and is not drawn anew."""
        self.inspected, self.worlds = other.inspected, other.worlds
        self._drawn, self._actors, self._parameters = other._drawn, other._actors, other._parameters

    def _inspect(self) -> Report | None:
        history = self._history
        try:
            return inspect(self._session, history.visits, history.events.reasons, self.inspected)
        except ValueError:  # at this moment of the past it is not there yet
            return None

    def refresh(self) -> None:
        """Rebuild everything for the next snapshot, since a command has changed something."""
        for part in (self._map, self._beside, self._goal_memory, self._inspection):
            part.refresh()

    def settle(self) -> None:
        """The session stands still: what shows an earlier tick is rebuilt, since no later snapshot would."""
        if self._settled_at != self._session.tick_count:
            self._settled_at = self._session.tick_count
            self.refresh()
            self._occupancy.refresh()
            self._places.refresh()

    def build(self, *, running: bool, speed: float, real_time_factor: float, fault: str | None) -> Snapshot:
        session, history = self._session, self._history
        brain, truth, recorded = session.brain, session.truth, session.recording
        parts = self.parts() | (self.walk.parts if self.walk is not None else {})
        parameters, preset = self._parameters.of(session.config, session.source.foreign)
        return Snapshot(
            run=self._run,
            tick=session.tick_count,
            time_s=session.time_s,
            mode=session.pilot.mode if session.source.driven else "recorded",
            doing=session.pilot.doing if session.source.driven else "as recorded",
            running=running,
            speed=speed,
            real_time_factor=real_time_factor,
            seed=session.seed,
            fault=fault,
            lost=is_lost(session),
            world=self._drawn.look(session.simulator)
            if recorded is None
            else self._floor.look(session, history.trails),
            worlds=self.worlds,
            truth=None if truth is None else Pose(truth.x, truth.y, truth.heading_rad),
            trail=history.trails.robot,
            estimate=parts["estimate"],
            senses=senses_of(session),
            pose_cells=parts["pose_cells"],
            map=parts["map"],
            times=parts["times"],
            goal=goal_view(session),
            trip=trip_view(session),
            tags=tags_view(session),
            belief=belief_of(session),
            views=len(brain.local_view),
            experiences=len(brain.experience_map),
            links=brain.experience_map.link_count,
            relocalisations=brain.relocalisations,
            map_turn_rad=history.series.map_turn_rad,
            coverage=history.series.coverage,
            error_map_m=history.series.error_map_m,
            error_odometry_m=history.series.error_odometry_m,
            revisit_consistency=session.evaluation.revisit_consistency,
            series=history.series.series,
            timings=tuple(
                Timing(part, *ms)
                for part, ms in session.stopwatch.mean_and_worst_ms.items()
                if part != SECOND or session.companion is not None
            ),
            events=history.log.events,
            parameters=parameters,
            occupancy=self._occupancy.part(session.tick_count),
            goal_memory=self._goal_memory.part(session.tick_count),
            movements=movements_of(session),
            living=None if recorded else self._actors.look(session.simulator),
            switches=() if recorded else self._actors.switches(session.simulator.world),
            inspected=self._inspection.part(session.tick_count),
            active_experience=brain.experience_map.active,
            walk=None if self.walk is None else self.walk.view,
            presets=() if recorded else _PRESETS,
            preset=preset,
            office=self.office,
            trial=self.trial,
            lesson=self.lesson,
            until=self.until,
            time=self.time,
            situation=self.situation,
            back=self.back,
            stepping=self.stepping,
            beside=self.beside(),
            pairs=self.pairs,
            additions_off=self.additions_off,
            no_room=session.simulator.fit.refusal if recorded is None else no_room,
            recording=recorded and recording_view(recorded, session.source.over),
            map_in_office=self._fit(),
            ghost=ghost_of(session),
            spread=spread_of(session),
            closures=history.log.closures,
            places=self._places.part(session.tick_count),
        )

    def beside(self) -> BesideView | None:
        """The second brain, and how the two differ; None: there is one brain only."""
        return self._beside.look()

    def _fit(self) -> Pose | None:
        """The same object as long as it is the same fit."""
        fit = self._history.series.map_in_office
        if fit is not self._fitted[0]:
            self._fitted = fit, None if fit is None else shown(fit)
        return self._fitted[1]

    def parts(self) -> dict[str, Any]:
        """The fields of the snapshot that differ between the stages of a tick, as they are now."""
        layer, times = self._map.layers()
        return {
            "pose_cells": pose_cell_layer(self._session, self._history),
            "map": layer,
            "times": times,
            "estimate": shown(self._session.brain.experience_map.robot),
        }


class _ParameterRows:
    """The parameters as the page lists them. Made anew only when the config has changed."""

    def __init__(self) -> None:
        self._config: Config | None = None
        self._rows: tuple[Parameter, ...] = ()
        self._preset = ""

    def of(self, config: Config, foreign: tuple[str, ...] = ()) -> tuple[tuple[Parameter, ...], str]:
        """All parameters, and the name of the preset whose values they have, or "".

        foreign: without those of these sections, which a recording does not have.
        """
        if self._config is not config:
            self._config, self._preset = config, preset_of(config)
            self._rows = tuple(
                Parameter(name=name, value=value, default=cast(Value, item.default), **item.metadata)
                for name, item, value in config.items()
                if name.split(".")[0] not in foreign
            )
        return self._rows, self._preset


class PairChoices:
    """The second brains that the page offers: those that would differ from the first, and each with one addition the
    other way. Made anew only when a config has changed."""

    def __init__(self) -> None:
        self._configs: tuple[Config, Config] | None = None
        self._choices: tuple[tuple[PairChoice, ...], AdditionsOff] = (), AdditionsOff()

    def of(self, beginning: Config, now: Config) -> tuple[tuple[PairChoice, ...], AdditionsOff]:
        """beginning: the config with which the run would begin anew; now: that with which it runs."""
        before = self._configs
        if before is None or before[0] is not beginning or before[1] is not now:
            self._configs = beginning, now
            self._choices = tuple(_choices(beginning, now)), AdditionsOff(_off(beginning), _off(now))
        return self._choices


def _choices(beginning: Config, now: Config) -> Iterator[PairChoice]:
    for pair in pairs_beside(beginning):
        yield PairChoice(pair.name, pair.title, pair.about, "beginning")
    live = {dotted for dotted, item, _ in now.items() if item.metadata["live"]}
    for pair in pairs_beside(now):
        if pair.values.keys() <= live:
            yield PairChoice(pair.name, pair.title, pair.about, "now")


def _off(config: Config) -> tuple[str, ...]:
    return tuple(addition.name for addition in ADDITIONS if without(addition, config))


def senses_of(session: Session) -> Senses:
    recognition, local_view = session.estimate.recognition, session.brain.local_view
    best, front_end = recognition.best_view, local_view.front_end
    stored = local_view.stored(best) if best >= 0 else None
    return Senses(
        camera=camera_image(session),
        front_end=local_view.params.front_end,
        seen=frozen(front_end.picture(local_view.features).copy()),
        seen_words=front_end.words(local_view.features),
        best=None if stored is None else frozen(front_end.picture(stored).copy()),
        best_words="" if stored is None else front_end.words(stored),
        best_view=best,
        difference=recognition.difference,
        threshold=local_view.threshold,
        active_view=recognition.view,
        recruited=recognition.recruited,
        false_positive=recognition.false_positive,
        false_positives=local_view.false_positives,
        ranges_m=session.frame.ranges_m,
    )


LEAST_M = 4.0  # half the side of the ground at the beginning
MARGIN = 0.3  # of its size, that the ground grows beyond the path, so that it seldom has to be drawn anew
MARK = 0.014  # the robot's radius as a share of the ground: how large the recorded robot is, nobody says

Bounds = tuple[float, float, float, float]


def recording_view(about: About, over: bool) -> RecordingView:
    return RecordingView(about.name, about.format, about.moments, about.seconds, tuple(sorted(about.has)), over)


def no_room(_x: float, _y: float) -> str:
    """Why a recorded robot cannot be put anywhere."""
    return "a recording plays: its robot cannot be carried away"


class TruthFloor:
    """An empty ground without walls that grows with the true path. None as long as the recording tells no truth."""

    def __init__(self) -> None:
        self._drawn: WorldDrawing | None = None

    def look(self, session: Session, trails: Trails) -> WorldDrawing | None:
        truth = session.truth
        if truth is None:
            return self._drawn
        points = np.vstack([trails.robot, [(truth.x, truth.y)]])
        if self._drawn is None:
            bounds = truth.x - LEAST_M, truth.y - LEAST_M, truth.x + LEAST_M, truth.y + LEAST_M
            self._drawn = _ground(session, bounds)
        elif not _holds(self._drawn.bounds, points):
            self._drawn = _ground(session, _grown(self._drawn.bounds, points))
        return self._drawn


def _holds(bounds: Bounds, points: np.ndarray) -> bool:
    return bool((points.min(0) >= bounds[:2]).all() and (points.max(0) <= bounds[2:]).all())


def _grown(bounds: Bounds, points: np.ndarray) -> Bounds:
    low, high = np.minimum(points.min(0), bounds[:2]), np.maximum(points.max(0), bounds[2:])
    more = MARGIN * (high - low).max()
    low = np.where(low < bounds[:2], low - more, low)
    high = np.where(high > bounds[2:], high + more, high)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _ground(session: Session, bounds: Bounds) -> WorldDrawing:
    name = session.source.name
    none = frozen(np.zeros(0, np.float32))
    return WorldDrawing(
        name=name,
        title=name,
        bounds=bounds,
        walls=frozen(np.zeros((0, 4), np.float32)),
        wall_height_m=none,
        wall_kind=(),
        panels=frozen(np.zeros((0, 6), np.float32)),
        panel_rgb=frozen(np.zeros((0, 3), np.uint8)),
        places=(),
        robot_radius_m=MARK * max(bounds[2] - bounds[0], bounds[3] - bounds[1]),
        camera_fov_rad=session.config.local_view.field_of_view,
        sonar_angles_rad=none,
        is_office=False,
    )
