"""What a moment has on a plate of the stage, it has in the picture of that plate, and what has no part there has none in it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.fake_snapshots import fake_reports
from tests.unit.web.bench import Bench
from tests.unit.web.crowded import crowded, judged, taught, two_brains
from tests.unit.web.office_moments import living, tried
from web.messages import Belief, Hypothesis, Snapshot, TaggedPlace
from web.switches import NAMES, Name
from web.viewer.vector import PlateName, vector_picture

pytestmark = pytest.mark.slow

ROOTS: dict[PlateName, str] = {"office": "/office", "pose": "/pose_cells", "map": "/map"}
PLAIN = judged(830, nodes=200, movements=tried)  # 3 s after a snap, so that all is there
REPORTS = fake_reports()


def text_of(props: dict[str, Any]) -> str:
    return repr({key: value.tobytes() if isinstance(value, np.ndarray) else value for key, value in props.items()})


def on_stage(bench: Bench, snapshot: Snapshot) -> dict[PlateName, dict[str, str]]:
    bench.show(snapshot, 100.0)
    bench.settle()
    nodes = bench.nodes()
    return {plate: {name: text_of(nodes[name]) for name in bench.shown(f"{root}/")} for plate, root in ROOTS.items()}


def in_pictures(bench: Bench, snapshot: Snapshot) -> dict[PlateName, str]:
    shown = {plate: vector_picture(plate, snapshot, "dark", bench.switches.on) for plate in ROOTS}
    return {plate: svg.replace(f"tick {snapshot.tick}", "") for plate, svg in shown.items()}


def differing(one: dict[PlateName, Any], other: dict[PlateName, Any]) -> set[PlateName]:
    return {plate for plate in ROOTS if one[plate] != other[plate]}


@pytest.mark.parametrize("name", NAMES)
def test_a_switch_changes_the_pictures_of_the_plates_that_it_changes(shared: Bench, name: Name) -> None:
    seen = []
    for on in (False, True):
        shared.switch(name, on)
        seen.append((on_stage(shared, PLAIN), in_pictures(shared, PLAIN)))
    changed, in_picture = (differing(dark, lit) for dark, lit in zip(*seen, strict=True))
    assert in_picture == changed
    assert bool(changed) == (name != "click_inspects")


def moment(**changes: Any) -> Snapshot:
    return replace(PLAIN, **changes)


def doubt(*cells: tuple[float, float, float]) -> Belief:
    return Belief(0.2, (Hypothesis(1.0, 1.0, 0.0, 0.3, *cells),), 0, 0, 0, 0, 0, 0)


CELLS, LIVING, KNOWN = PLAIN.pose_cells, moment(living=living()), crowded()
STILL = replace(CELLS, cells=CELLS.cells[:0], activity=CELLS.activity[:0], packets=())
DEAF = replace(PLAIN.senses, ranges_m=np.full(8, np.inf, np.float32))
DARK_LAMP = living(lamps=np.array([(5.0, 4.0, 3.0, 0.0)], np.float32))
BEFORE = {"daylight": LIVING, "a lamp that is off": LIVING, "no known places": KNOWN}  # PLAIN for all others
MOMENTS: dict[str, tuple[Snapshot, set[PlateName]]] = {
    "an experience": (moment(inspected=REPORTS["experience"]), {"pose", "map"}),
    "a view": (moment(inspected=REPORTS["view"]), {"pose", "map"}),
    "a cell": (moment(inspected=REPORTS["cell"]), {"pose", "map"}),
    "why": (moment(inspected=REPORTS["why"]), {"map"}),
    "no goal": (moment(goal=None, goal_memory=None), {"pose", "map"}),
    "it has arrived": (moment(goal=replace(PLAIN.goal, eta_s=None, state="arrived")), {"map"}),  # type: ignore[type-var]
    "no snap": (moment(pose_cells=replace(CELLS, last_snap=None)), {"pose"}),
    "no activity": (moment(pose_cells=STILL), {"pose"}),
    "no echoes": (moment(senses=DEAF), {"office"}),
    "no trail": (moment(trail=PLAIN.trail[:0]), {"office"}),
    "lamps, doors, boxes, people": (LIVING, {"office"}),
    "daylight": (moment(living=living(daylight=0.4)), {"office"}),
    "a lamp that is off": (moment(living=DARK_LAMP), {"office"}),
    "a tag": (moment(tags=(TaggedPlace("tea", 1, 0.0, 0.0),)), {"map"}),
    "no known places": (replace(KNOWN, places=()), {"map", "office"}),
    "in doubt": (moment(belief=doubt()), {"map"}),
    "in doubt, and the cells have that place": (moment(belief=doubt((9.0, 11.0, 0.5))), {"pose", "map"}),
    "a lesson's marks": (moment(lesson=taught().lesson), {"office", "pose", "map"}),
}


@pytest.mark.parametrize("what", MOMENTS)
def test_what_changes_a_plate_changes_its_picture_and_no_other(shared: Bench, what: str) -> None:
    other, plates = MOMENTS[what]
    for found in (on_stage, in_pictures):
        assert differing(found(shared, BEFORE.get(what, PLAIN)), found(shared, other)) == plates


def test_of_two_brains_neither_has_what_is_laid_over_one(shared: Bench) -> None:
    """And what is inspected is the first one's."""
    two = two_brains()
    bare = replace(two, occupancy=None, goal_memory=None)
    for found in (on_stage, in_pictures):
        assert not differing(found(shared, two), found(shared, bare)) - {"pose"}  # there it may lie below the cells
    told = replace(two, inspected=REPORTS["experience"])
    for plate in ("pose_2", "map_2"):
        assert vector_picture(plate, told, "dark", NAMES) == vector_picture(plate, two, "dark", NAMES)
    assert vector_picture("map", told, "dark", NAMES) != vector_picture("map", two, "dark", NAMES)


def test_the_map_of_a_new_run_lies_the_same_whatever_was_shown_before(shared: Bench) -> None:
    seen = []
    for run, size in enumerate((0.9, 1.1), start=900):
        layer = replace(PLAIN.map, xy=PLAIN.map.xy * np.float32(size))
        on_stage(shared, replace(PLAIN, map=layer, run=run))
        seen.append(on_stage(shared, replace(PLAIN, run=run + 10))["map"]["/map/nodes_0"])
    assert seen[0] == seen[1]
