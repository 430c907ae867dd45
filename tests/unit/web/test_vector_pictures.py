"""Plates as SVG: whole documents, drawn from the data, in the theme's colours, whose words lie apart; and the route."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.crowded import crowded, judged, taught, two_brains
from tests.unit.web.doubles import house
from tests.unit.web.pictures import REPORTS, SVG, Picture, boxes, drawn, ink, words
from web.messages import KnownPlace, Snapshot, TaggedPlace
from web.themes import THEMES, Theme
from web.viewer.primitives.palette import DARK, palette_of
from web.viewer.vector import PlateName, vector_picture
from web.viewer.vector.sheet import EDGE, WIDTH, Label, laid_out

SNAPSHOT = fake_snapshot(900)
LONG = "the place where the coffee machine was before they moved it"


def dots(picture: Picture) -> np.ndarray:
    """The middles of the map's experiences."""
    found = [circle for circle in picture.iter(f"{SVG}circle") if circle.get("r") == "4"]
    return np.array([(float(dot.get("cx", 0)), float(dot.get("cy", 0))) for dot in found])


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize("plate", ["office", "pose", "map"])
def test_each_plate_in_each_theme(plate: PlateName, theme: Theme) -> None:
    picture = drawn(plate, SNAPSHOT, theme=theme)
    assert picture.find(f"{SVG}rect").get("fill") == ink(palette_of(theme).sheet)  # type: ignore[union-attr]
    width, height = (float(size) for size in picture.get("viewBox", "").split()[2:])
    numbers = [float(n) for path in picture.iter(f"{SVG}path") for n in re.findall(r"-?\d+\.\d+", path.get("d", ""))]
    assert np.isfinite(numbers).all()
    assert -0.05 * width <= min(numbers)
    assert max(numbers) <= 1.05 * max(width, height)
    assert any(f"seed {SNAPSHOT.seed}" in text and f"tick {SNAPSHOT.tick}" in text for text in words(picture))


def test_the_map_has_every_experience_and_link_and_lies_as_on_the_plate() -> None:
    """A place farther to the right is farther to the right in the picture, and one farther up is higher."""
    picture = drawn("map", replace(SNAPSHOT, map_turn_rad=0.0, goal=None))
    places = dots(picture)
    assert len(places) == len(SNAPSHOT.map.xy)
    assert max(path.get("d", "").count("M") for path in picture.iter(f"{SVG}path")) == len(SNAPSHOT.map.links)
    for axis, sign in ((0, 1), (1, -1)):
        order = np.argsort(SNAPSHOT.map.xy[:, axis])
        assert (np.diff(sign * places[order, axis]) >= -0.11).all()  # a tenth of a pixel is left out


def test_an_empty_map_and_no_office() -> None:
    nothing = np.zeros(0, np.float32)
    layer = replace(
        SNAPSHOT.map, ids=nothing.astype(np.int32), xy=np.zeros((0, 2), np.float32), heading_rad=nothing,
        links=np.zeros((0, 2), np.int32),
    )  # fmt: skip
    empty = replace(SNAPSHOT, map=layer, times=replace(SNAPSHOT.times, seconds=nothing), goal=None)
    assert "0 experiences, 0 links" in words(drawn("map", empty))
    with pytest.raises(ValueError, match="no office to be drawn"):
        drawn("office", replace(SNAPSHOT, world=None))
    with pytest.raises(ValueError, match="there is one brain only"):
        drawn("map_2", SNAPSHOT)


def test_the_route() -> None:
    with house(empty=True) as server:
        get, latest, switches = server.client.get, server.latest, server.switches
        assert get("/api/picture/map").status_code == 422  # before the first tick
        latest.put(SNAPSHOT)
        answer = get("/api/picture/map", params={"theme": "light"})
        assert answer.headers["content-type"].startswith("image/svg+xml")
        assert answer.text == vector_picture("map", SNAPSHOT, "light", switches.on)
        for wrong in ("moon", "map?theme=pink"):
            assert get(f"/api/picture/{wrong}").status_code == 422
        assert "there is one brain only" in get("/api/picture/map_2").text
        latest.put(judged())
        switches.turn("ghost", False)
        assert get("/api/picture/map").text == vector_picture("map", judged(), "dark", switches.on)
        assert get("/api/picture/map", headers={"Sec-Fetch-Site": "cross-site"}).status_code == 403


# ---------------------------------------------------------------- words


def full_of_words() -> Iterator[tuple[PlateName, Snapshot]]:
    for plate in ("office", "pose", "map"):
        yield from ((plate, made) for made in (judged(), judged(off_m=40.0), crowded(), taught()))
    for plate in ("pose", "map", "pose_2", "map_2"):
        yield plate, two_brains()
    yield "map", replace(judged(), inspected=replace(REPORTS["why"], text=f"{LONG}, {LONG}, {LONG}"))  # type: ignore[type-var]
    yield "map", replace(crowded(), tags=tuple(TaggedPlace(f"{LONG} {k}", 1, 0.1 * k, 0.0) for k in range(5)))


@pytest.mark.parametrize(("plate", "snapshot"), list(full_of_words()))
def test_no_words_cover_others_or_are_cut_off(plate: PlateName, snapshot: Snapshot) -> None:
    picture = drawn(plate, snapshot)
    left, top, right, bottom = np.transpose(boxes(picture))
    assert (left.min() >= EDGE - 0.5, right.max() <= WIDTH - EDGE + 0.5) == (True, True)
    assert (top.min() >= 0, bottom.max() <= float(picture.get("height", 0))) == (True, True)
    for a, b in combinations(range(len(left)), 2):
        beside = min(right[a], right[b]) <= max(left[a], left[b]) + 0.5
        assert beside or min(bottom[a], bottom[b]) <= max(top[a], top[b]) + 0.5


@settings(max_examples=40)
@given(st.lists(st.tuples(st.floats(0, 1000), st.floats(0, 700), st.text(max_size=20)), max_size=10))
def test_labels_lie_apart_wherever_their_places_are(made: list[tuple[float, float, str]]) -> None:
    labels = [Label((x, y), 20.0, name, DARK.text, 15, DARK.goal) for x, y, name in made]
    places = laid_out(labels, [], np.array([(0.0, 0.0), (1000.0, 700.0)]))
    for (a, first), (b, second) in combinations(list(zip(places, labels, strict=True)), 2):
        assert (np.abs(np.subtract(a, b)) >= (first.bar + second.bar) / 2 - 1e-6).any()
    for (x, y), label in zip(places, labels, strict=True):
        wide, high = label.bar
        assert wide / 2 - 1e-6 <= x <= 1000 - wide / 2 + 1e-6
        assert high / 2 - 1e-6 <= y <= 700 - high / 2 + 1e-6


def test_names_are_text_and_nothing_else_and_a_label_that_went_aside_has_a_line() -> None:
    tags = TaggedPlace('<script>&"', 1, 0.0, 0.0), TaggedPlace("a\x00b\x1b", 2, 0.5, 0.0)
    places = KnownPlace("kitchen", 2, 2, (0.5, 0.5)), KnownPlace("attic", 2, 2, None)
    told = words(drawn("map", replace(judged(), tags=tags, places=places)))
    assert {'<script>&"', "ab", "kitchen"} <= set(told)
    assert "attic" not in told
    assert any(path.tag == f"{SVG}path" for path in drawn("map", crowded()))
