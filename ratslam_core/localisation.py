"""Where the robot is, by its pose cells: what is seen puts activity there, the wheels move it, and the packets compete."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from disk import kind
from ratslam_core.beats import Tick
from ratslam_core.local_view.view_links import VisualAssociation
from ratslam_core.params import PoseCellParams
from ratslam_core.parts import PoseCellsPart
from ratslam_core.types import Odometry, Packet, Recognition

SNAP_CELLS = 3.0  # a longer jump of the winning packet is a relocalisation


@kind("localisation/1")
class Localisation:
    """Moves the packets, lets views put activity there, and lets the packets compete."""

    def __init__(self, pose_cells: PoseCellsPart, association: VisualAssociation, params: PoseCellParams) -> None:
        self.pose_cells, self.association, self.params = pose_cells, association, params

    def step(
        self, seen: Recognition, strength: float, tick: Tick, lost: bool, watch: Callable[[str], None]
    ) -> tuple[Packet, bool]:
        """The winning packet at the end of the tick, and whether it has jumped.

        strength: how sure the recognition is, 0 to 1; lost: the robot knows that it was carried away; watch: called
        with the name of each stage after it.

        Several beats in one tick: what is seen at its end is seen in the last of them. The way up to there is driven beat
        by beat, then the image is associated once for each; the attractor follows every such part of a stage.
        """
        jumped = False
        for _ in range(tick.beats - 1):
            self._integrate(tick.moved)
            jumped |= self._attract()[1]
        for beat in range(tick.beats):
            if beat:
                jumped |= self._attract()[1]
            self.association.step(again(seen) if beat else seen, strength, tick.moved.dt, self.pose_cells, lost)
        watch("injection")
        self._integrate(tick.moved)
        watch("path integration")
        packet, jumps = self._attract()
        watch("attractor")
        return packet, jumped or jumps

    def _integrate(self, moved: Odometry) -> None:
        """With `yaw_bias`, the cells turn too far and the map does not: ACRA 2005 5.2, figures 8 to 10. test_biased_loop.py."""
        yaw_rate = moved.yaw_rate + (0.0 if moved.still else self.params.yaw_bias)
        self.pose_cells.integrate(moved.speed * moved.dt, yaw_rate * moved.dt)

    def _attract(self) -> tuple[Packet, bool]:
        """One step of the attractor. Returns the winner, and whether it has jumped from where it was."""
        expected, packet = self.pose_cells.winner, self.pose_cells.attract()
        jump = self.pose_cells.cells_apart(expected.x, expected.y, packet.x, packet.y)
        return packet, jump > SNAP_CELLS


def again(seen: Recognition) -> Recognition:
    """The same observation a beat later. A view that was just recruited is known by then, and equal to itself."""
    return replace(seen, recruited=False, best_view=seen.view, difference=0.0) if seen.recruited else seen
