"""One tick, stage by stage: the effect of each stage is recorded while the tick runs and can be shown afterwards.

The tick is always computed as a whole, in the order of `RatSlam.step`, whether it is recorded or not. The engine
computes an attractor iteration (ACRA 2004 eqs. 10-12) at once and skips cells that inhibition would silence. Here its
stages, excitation, inhibition and normalisation, compute the same sum, slowly, for people to look at.
`test_tick_stages.py::test_the_stages_lead_where_the_engine_went` compares the two.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from app.views.arrays import frozen
from app.views.map_layers import STRONGEST, map_layer
from app.views.office import shown
from ratslam_core import PoseCellParams
from ratslam_core.pose_cells.attractor_kernels import gaussian
from web.messages import PoseCellLayer, TickStage, TickWalk

TITLES = {
    "image": "Image and odometry",
    "view match": "View match",
    "injection": "Injection by the view",
    "path integration": "Path integration",
    "excitation": "Excitation",
    "inhibition": "Inhibition",
    "normalisation": "Normalisation",
    "experience": "Experience choice",
    "correction": "Map correction",
}


@dataclass(frozen=True, slots=True)
class Still:
    """A stage, and the parts of the snapshot that differed at its end from the end of the tick."""

    stage: TickStage
    parts: dict[str, Any]


class Walk:
    """A position among the stills of one tick."""

    def __init__(self, stills: tuple[Still, ...], at: int = 0) -> None:
        self._stills, self._at = stills, at
        self.parts = stills[at].parts
        self.view = TickWalk(tuple(still.stage for still in stills), at)

    def moved(self, by: int) -> Walk | None:
        """The walk `by` stages further; None beyond the last or the first stage."""
        at = self._at + by
        return Walk(self._stills, at) if 0 <= at < len(self._stills) else None


class TickRecorder:
    """Records one tick. It is made before the tick, called by the engine after each stage, and read after the tick."""

    def __init__(self, session: Session, before: dict[str, Any]) -> None:
        """before: the parts `pose_cells`, `map`, `times` and `estimate` of the snapshot before the tick."""
        self._session, self._before = session, before
        self._here = session.brain.experience_map.here
        self._cells: dict[str, Activity] = {"view match": self._activity()}
        self._between = session.brain.beats.due(session.source.dt_ahead) == 0
        self._poses = np.zeros((0, 3))
        self._map: dict[str, Any] = {}
        self._residual = (0.0, 0.0)

    def __call__(self, part: str) -> None:
        """The engine has finished this stage, one of `ratslam_core.slam.STAGES`."""
        if part in ("path integration", "injection", "attractor"):
            self._cells[part] = self._activity()
        elif part == "experience":
            map_ = self._session.brain.experience_map
            self._poses, self._residual = map_.poses.copy(), map_.residual
            self._map = {"map": map_layer(map_, self._session.evaluation), "estimate": shown(map_.robot)}

    def walk(self, after: dict[str, Any]) -> Walk:
        """A walk through the recorded tick. after: the same parts as `before`, at the end of the tick."""
        params, before = self._session.brain.params.pose_cells, self._before
        if self._between:
            words = f"{self._image()} It is not looked at: views, packets and map wait for the next tenth of a second."
            return Walk((Still(TickStage("image", TITLES["image"], words), {}),))
        seen, injected, moved = (self._cells[stage] for stage in ("view match", "injection", "path integration"))
        near = excited(moved, params)
        left = inhibited(near, params)
        chosen = {"times": after["times"], **self._map}

        # The engine finds packets at the end of a tick; here an injected packet is shown as one from its injection on.
        like = replace(before["pose_cells"], packets=after["pose_cells"].packets)

        def cells(activity: Activity) -> dict[str, Any]:
            return before | {"pose_cells": _layer(like, activity)}

        steps: list[tuple[str, str, dict[str, Any]]] = [
            ("image", self._image(), before),
            ("view match", self._view_match(), before),
            ("injection", self._injection(seen, injected), cells(injected)),
            ("path integration", self._path_integration(), cells(moved)),
            ("excitation", _grown(moved, near), cells(near)),
            ("inhibition", _shrunk(near, left, params.inhibit), cells(left)),
            ("normalisation", self._normalisation(left), before | {"pose_cells": after["pose_cells"]}),
            ("experience", self._choice(), chosen | {"pose_cells": after["pose_cells"]}),
            ("correction", self._correction(), {}),
        ]
        return Walk(tuple(Still(TickStage(name, TITLES[name], words), parts) for name, words, parts in steps))

    def _image(self) -> str:
        odometry = self._session.odometry
        way, turn = 100 * odometry.speed * odometry.dt, math.degrees(odometry.yaw_rate * odometry.dt)
        who = "The wheels report" if self._session.source.driven else "The recording tells of"
        return f"{who} {_plain(way, 1)} cm ahead and a turn of {_plain(turn, 1)}°; then the camera takes a picture."

    def _view_match(self) -> str:
        seen = self._session.estimate.recognition
        local_view = self._session.brain.local_view
        limit = local_view.threshold
        if seen.view < 0:
            return "The picture shows nothing that could be told apart from elsewhere: no view is active."
        if not math.isfinite(seen.difference):
            return f"No view is known yet: this one is stored as #{seen.view}."
        nearest = f"The most similar known view is #{seen.best_view}, {seen.difference:.1f} away"
        if seen.recruited:
            return f"{nearest}, farther than the threshold {limit:.1f}: a new one is stored as #{seen.view}."
        if seen.view != seen.best_view:
            return f"{nearest}; a false positive puts #{seen.view} in its place."
        return f"{nearest}, within the threshold {limit:.1f}: it is recognised."

    def _path_integration(self) -> str:
        odometry, params = self._session.odometry, self._session.brain.params.pose_cells
        if odometry.still:
            return "The wheels stand: the activity stays where it is."
        ahead = odometry.speed * odometry.dt / params.cell_m
        turn = (odometry.yaw_rate + params.yaw_bias) * odometry.dt / math.tau * params.n_theta
        way = f"{_plain(ahead, 2)} cells along its own heading"
        return f"All activity moves {way} and turns by {_plain(turn, 2)} layers."

    def _injection(self, before: Activity, after: Activity) -> str:
        seen = self._session.estimate.recognition
        gained = after.total - before.total
        if gained <= 1e-9:
            why = "the view is new" if seen.recruited else "the view still rests"
            why = "there is no view" if seen.view < 0 else why
            return f"Nothing is injected: {why}."
        cells = len(self._session.brain.view_links.of(seen.view)[0])
        return f"View #{seen.view} adds {100 * gained:.1f} % of the activity, over its links to {cells} pose cells."

    def _normalisation(self, left: Activity) -> str:
        packets = self._session.brain.pose_cells.packets
        words = "one packet is left" if len(packets) == 1 else f"{len(packets)} packets compete"
        return f"All is divided by {left.total:.3f}, so that the sum is 1 again; {words}."

    def _choice(self) -> str:
        map_, estimate = self._session.brain.experience_map, self._session.estimate
        if estimate.created:
            return f"Nothing known fits packet and view: experience #{map_.here} is made, linked from #{self._here}."
        energy = map_.energy(map_.here, estimate.packet, estimate.recognition.view)
        if map_.here == self._here:
            return f"Experience #{map_.here} still fits, with energy {energy:.2f}: it stays active."
        link = f"a link from #{self._here} to it is learnt"
        return f"Experience #{map_.here} fits best, with energy {energy:.2f}: {link}."

    def _correction(self) -> str:
        map_ = self._session.brain.experience_map
        if map_.link_count == 0:
            return "There is no link yet: nothing to correct."
        most = float(np.hypot(*(map_.poses[: len(self._poses), :2] - self._poses[:, :2]).T).max(initial=0.0))
        was, now = 1000 * self._residual[0], 1000 * map_.residual[0]
        moved = f"the farthest experience moved {1000 * most:.1f} mm"
        return f"Links and map disagreed by {was:.1f} mm, now by {now:.1f} mm; {moved}."

    def _activity(self) -> Activity:
        cells, values = self._session.brain.pose_cells.active
        order = np.argsort(cells[:, 3], kind="stable")
        return Activity(cells[order, 3].astype(np.int64), values[order].astype(np.float64))


def _plain(value: float, digits: int) -> str:
    """The number with `digits` decimals; a zero has no sign."""
    return f"{round(value, digits) + 0.0:.{digits}f}"


def _grown(before: Activity, after: Activity) -> str:
    return f"Every active cell excites its neighbours: {len(before.flat)} active cells become {len(after.flat)}."


def _shrunk(before: Activity, after: Activity, inhibit: float) -> str:
    silent = len(before.flat) - len(after.flat)
    return f"{inhibit:g} is taken from every cell: {silent} cells fall silent, {len(after.flat)} stay active."


def _layer(like: PoseCellLayer, activity: Activity) -> PoseCellLayer:
    strongest = np.argsort(-activity.values, kind="stable")[:STRONGEST]
    places = np.stack(np.unravel_index(activity.flat[strongest], like.shape), 1).astype(np.int32)
    return replace(
        like,
        cells=frozen(places),
        activity=frozen(activity.values[strongest].astype(np.float32)),
        active_cells=len(activity.flat),
        total=activity.total,
        least=float(activity.values.min(initial=1.0)),
    )


@dataclass(frozen=True)
class Activity:
    """Active pose cells: flat indices (n,), ascending, and their activities (n,)."""

    flat: NDArray[np.int64]
    values: NDArray[np.float64]

    @property
    def total(self) -> float:
        return float(self.values.sum())


def excited(activity: Activity, params: PoseCellParams) -> Activity:
    """Every cell excites its neighbours on the torus: convolution along theta', then y', then x'."""
    weights = gaussian(params.excite_sigma)
    shape = params.n_theta, params.n_y, params.n_x
    reach = np.arange(len(weights)) - len(weights) // 2
    for axis, size in enumerate(shape):
        places = np.stack(np.unravel_index(activity.flat, shape))
        moved = np.repeat(places, len(reach), 1)
        moved[axis] = (moved[axis] + np.tile(reach, len(activity.flat))) % size
        flat, row = np.unique(np.ravel_multi_index(tuple(moved), shape), return_inverse=True)
        parts = (activity.values[:, None] * weights.astype(np.float64)).ravel()
        activity = Activity(flat, np.asarray(np.bincount(row.ravel(), parts, len(flat)), np.float64))
    return activity


def inhibited(activity: Activity, params: PoseCellParams) -> Activity:
    """The same amount is subtracted from every cell. A cell that falls to 0 or below becomes silent."""
    values = activity.values - params.inhibit
    alive = values > 0
    return Activity(activity.flat[alive], values[alive])


def normalised(activity: Activity) -> Activity:
    return Activity(activity.flat, activity.values / activity.total)
