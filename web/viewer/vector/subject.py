"""What a picture is of: a moment, the brain whose plates they are, and what its switches show."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

from web.messages import BesideView, Hypothesis, Snapshot
from web.switches import Name
from web.viewer.fits import Judged, Overlaid, judged, overlaid
from web.viewer.primitives.palette import BRAINS, Palette, Rgb
from web.viewer.vector.sheet import Sheet


@dataclass(frozen=True)
class Subject:
    snapshot: Snapshot
    palette: Palette
    judged: Judged
    overlaid: Overlaid
    brain: tuple[str, Rgb] | None  # one of two; None: there is one only
    others: tuple[Hypothesis, ...]  # hypotheses beside the pose estimate of this brain

    def sheet(self, title: str, words: str, box: tuple[float, float, float, float]) -> Sheet:
        """Of two brains, the name takes the title's place, as on the stage."""
        if self.brain is None:
            return Sheet(self.palette, title, words, box)
        name, colour = self.brain
        return Sheet(self.palette, name, f"{title.lower()}: {words}", box, colour)

    @property
    def moment(self) -> str:
        """Run and moment: "office, seed 5, 1:00.0, tick 600"."""
        snapshot = self.snapshot
        played = snapshot.recording.name if snapshot.recording is not None else snapshot.world and snapshot.world.name
        minutes, seconds = divmod(snapshot.time_s, 60)
        return f"{played or 'run'}, seed {snapshot.seed}, {int(minutes)}:{seconds:04.1f}, tick {snapshot.tick}"


def first_of(snapshot: Snapshot, palette: Palette, on: Collection[Name]) -> Subject:
    """on: the switches that are on."""
    beside, others = snapshot.beside, snapshot.belief.others if snapshot.belief else ()
    brain = None if beside is None else (beside.first.name, BRAINS[palette.dark][0])
    return Subject(snapshot, palette, judged(snapshot, on), overlaid(snapshot, on), brain, others)


def second_of(snapshot: Snapshot, palette: Palette) -> Subject:
    """What is told of the first brain alone is left out, as on the stage. ValueError: there is none."""
    beside = snapshot.beside
    if beside is None:
        raise ValueError("there is one brain only; compare_brains begins a second one")
    brain = beside.second.name, BRAINS[palette.dark][1]
    theirs = snapshot_of_second(snapshot, beside)
    return Subject(theirs, palette, judged(theirs, ()), overlaid(theirs, ()), brain, beside.others)


def snapshot_of_second(snapshot: Snapshot, beside: BesideView) -> Snapshot:
    """The moment, with the second brain in place of the first."""
    return replace(
        snapshot, pose_cells=beside.pose_cells, map=beside.map, times=beside.times, estimate=beside.estimate,
        goal=beside.goal, map_turn_rad=beside.map_turn_rad, map_in_office=None, places=(), trip=None, tags=(), lesson=None,
        inspected=None,
    )  # fmt: skip
