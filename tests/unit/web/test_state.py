"""A snapshot as JSON: exactly the fields of the contract, finite numbers, and each text made once."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import orjson
import pytest

from tests.fake_snapshots import fake_reports, fake_snapshot, fake_walk
from tests.unit.web.office_moments import living
from web.http.state import StateText, page_fields, places_of, state, to_json
from web.messages import KnownPlace, Snapshot

SNAPSHOT = fake_snapshot(500)


def read(snapshot: Snapshot) -> dict[str, Any]:
    return orjson.loads(to_json(state(snapshot)))


def test_has_the_fields_of_the_contract_and_no_others_with_the_snapshot_s_values() -> None:
    fields = read(SNAPSHOT)
    assert list(fields) == [
        "tick", "time_s", "mode", "running", "speed", "world", "seed", "robot", "estimate", "pose_cells", "views",
        "experiences", "links", "relocalisations", "goal", "error_m", "living", "trial",
        "lesson", "until", "beside",
    ]  # fmt: skip
    assert list(fields["robot"]) == list(fields["estimate"]) == ["x", "y", "heading_rad"]
    assert list(fields["pose_cells"]) == ["shape", "packets"]
    assert list(fields["pose_cells"]["packets"][0]) == ["x", "y", "heading_rad", "mass"]
    assert list(fields["goal"]) == ["experience", "x", "y", "state", "eta_s", "remaining_m"]
    assert list(fields["error_m"]) == ["map", "odometry"]
    assert SNAPSHOT.world is not None
    assert SNAPSHOT.truth is not None
    told = [fields[name] for name in ("tick", "mode", "running", "world")]
    assert told == [SNAPSHOT.tick, SNAPSHOT.mode, SNAPSHOT.running, SNAPSHOT.world.name]
    assert fields["robot"]["x"] == pytest.approx(SNAPSHOT.truth.x)
    assert fields["estimate"]["y"] == pytest.approx(SNAPSHOT.estimate.y)
    assert fields["pose_cells"]["shape"] == list(SNAPSHOT.pose_cells.shape)


def test_what_there_is_not_or_is_not_finite_is_null_and_as_fast_as_possible_is_0_as_in_the_command() -> None:
    fields = read(replace(SNAPSHOT, goal=None, speed=math.inf))
    assert (fields["goal"], fields["speed"]) == (None, 0)
    told = [page_fields(replace(SNAPSHOT, goal=goal))["status"]["goal"] for goal in (None, SNAPSHOT.goal)]
    assert [one is None for one in told] == [True, False]
    for value in (math.nan, math.inf, -math.inf):
        assert read(replace(SNAPSHOT, error_map_m=value))["error_m"]["map"] is None


def test_each_text_is_made_once_per_snapshot_and_the_full_one_has_the_nodes() -> None:
    text = StateText()
    light, full = text.light(SNAPSHOT), orjson.loads(text.full(SNAPSHOT))
    layer = full.pop("map")
    assert full == orjson.loads(light)
    assert layer["ids"] == SNAPSHOT.map.ids.tolist()
    np.testing.assert_allclose(layer["xy"], SNAPSHOT.map.xy, rtol=1e-6)
    assert text.light(SNAPSHOT) is light
    assert text.page(SNAPSHOT) is text.page(SNAPSHOT)
    assert text.light(replace(SNAPSHOT, tick=501)) != light
    assert text.full(SNAPSHOT) == text.full(SNAPSHOT)


def test_the_page_is_told_where_people_are_and_which_boxes() -> None:
    assert page_fields(replace(SNAPSHOT, living=None))["moving"] is None
    moving = orjson.loads(to_json(page_fields(replace(SNAPSHOT, living=living()))))["moving"]
    assert moving == {"walkers": {"ann": [1.0, 1.0, 0.0], "bob": [6.0, 1.0, 1.0]}, "boxes": ["crate"]}


def test_the_page_is_told_of_the_walk_and_of_what_is_inspected() -> None:
    plain = page_fields(SNAPSHOT)
    assert (plain["walk"], plain["inspected"]) == (None, None)
    walking = page_fields(replace(SNAPSHOT, walk=fake_walk(2)))["walk"]
    assert walking == {"at": 3, "of": 3, "title": "Correction", "words": "This is what the correction did."}
    told = {
        kind: page_fields(replace(SNAPSHOT, inspected=report))["inspected"] for kind, report in fake_reports().items()
    }
    assert told == {
        "experience": "experience #12", "view": "view #7", "cell": "pose cells at 31, 22", "why": "snap at 63.2 s",
    }  # fmt: skip


def test_ticks_that_were_asked_for_are_no_pause() -> None:
    words = [
        page_fields(replace(SNAPSHOT, running=False, stepping=stepping))["status"]["robot"]["words"]
        for stepping in (True, False)
    ]
    assert words[0] == "playing up to a moment"
    assert words[1].startswith("paused")


def test_a_place_of_the_office_is_an_experience_near_it_or_there_is_a_reason() -> None:
    """For who does not see the map."""
    x, y = SNAPSHOT.map.xy[3].tolist()
    known, unknown = KnownPlace("kitchen", 9.0, 1.0, (x, y)), KnownPlace("library", 1.0, 7.0, None)
    reason = "it has not been near it yet: explores until it comes there"
    assert places_of(replace(SNAPSHOT, places=(known, unknown)))["named"] == [
        {"name": "kitchen", "experience": int(SNAPSHOT.map.ids[3]), "x": x, "y": y, "why": None},
        {"name": "library", "experience": None, "x": None, "y": None, "why": reason},
    ]
    seconds = [place["seconds"] for place in places_of(SNAPSHOT)["experiences"]]
    assert seconds == [float(s) if np.isfinite(s) else None for s in SNAPSHOT.times.seconds]
