"""The list of places for who does not see the map: those of the office are in it, also those that the robot does not know."""

from __future__ import annotations

from dataclasses import replace

from tests.fake_snapshots import fake_snapshot
from web.http.places import places_of
from web.messages import KnownPlace


def test_a_place_of_the_office_is_an_experience_near_it_or_there_is_a_reason() -> None:
    snapshot = fake_snapshot(430)
    x, y = snapshot.map.xy[3].tolist()
    known, unknown = KnownPlace("kitchen", 9.0, 1.0, (x, y)), KnownPlace("library", 1.0, 7.0, None)
    told = places_of(replace(snapshot, places=(known, unknown)))["named"]
    assert told[0] == {"name": "kitchen", "experience": int(snapshot.map.ids[3]), "x": x, "y": y, "why": None}
    reason = "the robot has not been near it yet"
    assert told[1] == {"name": "library", "experience": None, "x": None, "y": None, "why": reason}
