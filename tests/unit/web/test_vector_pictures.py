"""Plates as SVG: whole documents, drawn from the data, in the theme's colours, under the stage's switches; and the route."""

from __future__ import annotations

import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from starlette.testclient import TestClient

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.crowded import judged
from tests.unit.web.doubles import ORIGIN, PORT, StubEngine, StubViewers
from web.http.api import create_app
from web.latest import Latest
from web.messages import Snapshot, TaggedPlace
from web.switches import NAMES
from web.themes import THEMES
from web.viewer.primitives.palette import palette_of
from web.viewer.vector import PlateName, vector_picture

SVG = "{http://www.w3.org/2000/svg}"
SNAPSHOT = fake_snapshot(900)


def drawn(plate: PlateName, snapshot: Snapshot = SNAPSHOT, theme="dark", on=NAMES) -> ElementTree.Element:
    return ElementTree.fromstring(vector_picture(plate, snapshot, theme, on))


def words(picture: ElementTree.Element) -> list[str]:
    return [text.text or "" for text in picture.iter(f"{SVG}text")]


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize("plate", ["office", "pose", "map"])
def test_each_plate_in_each_theme(plate: PlateName, theme) -> None:
    picture = drawn(plate, theme=theme)
    paper = "#" + "".join(f"{part:02x}" for part in palette_of(theme).sheet)
    assert picture.find(f"{SVG}rect").get("fill") == paper  # type: ignore[union-attr]
    width, height = (float(size) for size in picture.get("viewBox", "").split()[2:])
    numbers = [float(n) for path in picture.iter(f"{SVG}path") for n in re.findall(r"-?\d+\.\d+", path.get("d", ""))]
    assert all(np.isfinite(numbers))
    assert -0.05 * width <= min(numbers)
    assert max(numbers) <= 1.05 * max(width, height)
    assert any(f"seed {SNAPSHOT.seed}" in text and f"tick {SNAPSHOT.tick}" in text for text in words(picture))


def test_the_map_has_every_experience_and_every_link() -> None:
    picture = drawn("map")
    dots = [circle for circle in picture.iter(f"{SVG}circle") if circle.get("r") == "4"]
    assert len(dots) == len(SNAPSHOT.map.xy)
    links = max((path.get("d", "") for path in picture.iter(f"{SVG}path")), key=lambda d: d.count("M"))
    assert links.count("M") == len(SNAPSHOT.map.links)


def test_it_lies_as_on_the_plate() -> None:
    """A place farther to the right is farther to the right in the picture, and one farther up is higher."""
    straight = replace(SNAPSHOT, map_turn_rad=0.0, goal=None)
    dots = [circle for circle in drawn("map", straight).iter(f"{SVG}circle") if circle.get("r") == "4"]
    places = np.array([(float(dot.get("cx", 0)), float(dot.get("cy", 0))) for dot in dots])
    for axis, sign in ((0, 1), (1, -1)):
        order = np.argsort(SNAPSHOT.map.xy[:, axis])
        assert (np.diff(sign * places[order, axis]) >= -0.11).all()  # a tenth of a pixel is left out


def test_names_are_text_and_nothing_else() -> None:
    odd = replace(SNAPSHOT, tags=(TaggedPlace('<script>&"', 1, 0.0, 0.0), TaggedPlace("a\x00b\x1b", 2, 0.5, 0.0)))
    told = words(drawn("map", odd))
    assert '<script>&"' in told
    assert "ab" in told


def test_an_empty_map_and_no_office() -> None:
    nothing = np.zeros(0, np.float32)
    layer = replace(
        SNAPSHOT.map, ids=nothing.astype(np.int32), xy=np.zeros((0, 2), np.float32), heading_rad=nothing,
        links=np.zeros((0, 2), np.int32),
    )  # fmt: skip
    empty = replace(SNAPSHOT, map=layer, times=replace(SNAPSHOT.times, seconds=nothing), goal=None)
    assert "0 experiences, 0 links" in words(drawn("map", empty))
    with pytest.raises(ValueError, match="no office to be drawn"):
        vector_picture("office", replace(SNAPSHOT, world=None), "dark", NAMES)


def test_the_route() -> None:
    latest, viewers = Latest[Snapshot](), StubViewers()
    with TestClient(create_app(latest, StubEngine().submit, viewers, PORT), base_url=ORIGIN) as client:
        assert client.get("/api/picture/map").status_code == 422  # before the first tick
        latest.put(SNAPSHOT)
        answer = client.get("/api/picture/map", params={"theme": "light"})
        assert answer.headers["content-type"].startswith("image/svg+xml")
        assert answer.text == vector_picture("map", SNAPSHOT, "light", viewers.switches.on)
        assert client.get("/api/picture/moon").status_code == 422
        assert client.get("/api/picture/map", params={"theme": "pink"}).status_code == 422
        assert "there is one brain only" in client.get("/api/picture/map_2").text
        latest.put(judged())
        viewers.switches.turn("ghost", False)
        assert client.get("/api/picture/map").text == vector_picture("map", judged(), "dark", viewers.switches.on)
        elsewhere = {"Sec-Fetch-Site": "cross-site"}
        assert client.get("/api/picture/map", headers=elsewhere).status_code == 403
