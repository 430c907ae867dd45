"""The words in pictures of plates: none covers another, and none is cut off."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.unit.web.crowded import crowded, judged, taught, two_brains
from tests.unit.web.read_pictures import REPORTS, SVG, boxes, drawn, words
from web.messages import KnownPlace, Snapshot, TaggedPlace
from web.viewer.primitives.palette import DARK
from web.viewer.vector import PlateName
from web.viewer.vector.labels import Label, laid_out
from web.viewer.vector.sheet import EDGE, WIDTH

LONG = "the place where the coffee machine was before they moved it"


@pytest.mark.parametrize(
    ("plate", "snapshot"),
    [
        (plate, made)
        for plate in ("office", "pose", "map")
        for made in (judged(), judged(off_m=40.0), crowded(), taught())
    ]
    + [(plate, two_brains()) for plate in ("pose", "map", "pose_2", "map_2")]
    + [("map", replace(judged(), inspected=replace(REPORTS["why"], text=f"{LONG}, {LONG}, {LONG}")))]  # type: ignore[type-var]
    + [("map", replace(crowded(), tags=tuple(TaggedPlace(f"{LONG} {k}", 1, 0.1 * k, 0.0) for k in range(5))))],
)
def test_no_words_cover_others_or_are_cut_off(plate: PlateName, snapshot: Snapshot) -> None:
    picture = drawn(plate, snapshot)
    height = float(picture.get("height", 0))
    found = boxes(picture)
    for left, top, right, bottom in found:
        assert left >= EDGE - 0.5
        assert right <= WIDTH - EDGE + 0.5
        assert top >= 0
        assert bottom <= height
    for (l1, t1, r1, b1), (l2, t2, r2, b2) in itertools.combinations(found, 2):
        assert r1 <= l2 + 0.5 or r2 <= l1 + 0.5 or b1 <= t2 + 0.5 or b2 <= t1 + 0.5


@settings(max_examples=60)
@given(st.lists(st.tuples(st.floats(0, 1000), st.floats(0, 700), st.text(max_size=20)), max_size=10))
def test_labels_lie_apart_wherever_their_places_are(made: list[tuple[float, float, str]]) -> None:
    labels = [Label((x, y), 20.0, name, DARK.text, 15, DARK.goal) for x, y, name in made]
    places = laid_out(labels, [], np.array([(0.0, 0.0), (1000.0, 700.0)]))
    for (a, first), (b, second) in itertools.combinations(list(zip(places, labels, strict=True)), 2):
        assert (np.abs(np.subtract(a, b)) >= (first.bar + second.bar) / 2 - 1e-6).any()
    for (x, y), label in zip(places, labels, strict=True):
        wide, high = label.bar
        assert wide / 2 - 1e-6 <= x <= 1000 - wide / 2 + 1e-6
        assert high / 2 - 1e-6 <= y <= 700 - high / 2 + 1e-6


def test_a_known_place_has_its_name_on_the_map_and_a_label_that_went_aside_a_line() -> None:
    snapshot = replace(judged(), places=(KnownPlace("kitchen", 2, 2, (0.5, 0.5)), KnownPlace("attic", 2, 2, None)))
    told = words(drawn("map", snapshot))
    assert "kitchen" in told
    assert "attic" not in told
    lines = [path for path in drawn("map", crowded()) if path.tag == f"{SVG}path"]
    assert lines
