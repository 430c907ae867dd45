"""A snapshot as JSON: exactly the fields of the contract, finite numbers, and each text made once."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import orjson
import pytest

from tests.fake_snapshots import fake_reports, fake_snapshot, fake_walk
from tests.unit.web.test_office_plate import living
from web.http.state import StateText, page_fields, state, to_json


@pytest.fixture
def snapshot():
    return fake_snapshot(500)


def test_has_the_fields_of_the_contract_and_no_others(snapshot):
    fields = orjson.loads(to_json(state(snapshot)))
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


def test_holds_the_snapshot_s_values(snapshot):
    fields = orjson.loads(to_json(state(snapshot)))
    assert (fields["tick"], fields["mode"], fields["running"]) == (snapshot.tick, snapshot.mode, snapshot.running)
    assert fields["robot"]["x"] == pytest.approx(snapshot.truth.x)
    assert fields["estimate"]["y"] == pytest.approx(snapshot.estimate.y)
    assert fields["world"] == snapshot.world.name
    assert fields["pose_cells"]["shape"] == list(snapshot.pose_cells.shape)


def test_without_a_goal_it_is_null(snapshot):
    assert state(replace(snapshot, goal=None))["goal"] is None


def test_as_fast_as_possible_is_speed_0_as_in_the_command(snapshot):
    assert state(replace(snapshot, speed=math.inf))["speed"] == 0


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_null(snapshot, value):
    fields = orjson.loads(to_json(state(replace(snapshot, error_map_m=value))))
    assert fields["error_m"]["map"] is None


def test_map_is_the_whole_state_and_the_nodes(snapshot):
    text = StateText()
    full = orjson.loads(text.full(snapshot))
    layer = full.pop("map")
    assert layer["ids"] == snapshot.map.ids.tolist()
    np.testing.assert_allclose(layer["xy"], snapshot.map.xy, rtol=1e-6)
    assert full == orjson.loads(text.light(snapshot))


def test_each_text_is_made_once_per_snapshot(snapshot):
    text = StateText()
    assert text.light(snapshot) is text.light(snapshot)
    assert text.page(snapshot) is text.page(snapshot)
    before = text.light(snapshot)
    assert text.light(replace(snapshot, tick=501)) != before
    assert text.full(snapshot) == text.full(snapshot)


def test_the_page_is_told_where_people_are_and_which_boxes(snapshot):
    assert page_fields(replace(snapshot, living=None))["moving"] is None
    moving = orjson.loads(to_json(page_fields(replace(snapshot, living=living()))))["moving"]
    assert moving == {"walkers": {"ann": [1.0, 1.0, 0.0], "bob": [6.0, 1.0, 1.0]}, "boxes": ["crate"]}


def test_the_page_is_told_of_the_walk_and_of_what_is_inspected(snapshot):
    plain = page_fields(snapshot)
    assert plain["walk"] is None
    assert plain["inspected"] is None
    walking = page_fields(replace(snapshot, walk=fake_walk(2)))["walk"]
    assert walking == {"at": 3, "of": 3, "title": "Correction", "words": "This is what the correction did."}
    names = {
        kind: page_fields(replace(snapshot, inspected=report))["inspected"] for kind, report in fake_reports().items()
    }
    assert names == {
        "experience": "experience #12",
        "view": "view #7",
        "cell": "pose cells at 31, 22",
        "why": "snap at 63.2 s",
    }
