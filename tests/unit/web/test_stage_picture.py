"""The picture that stands in the viewer's place: drawn from the snapshot, from the view's own camera, in either theme."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.doubles import house
from web.viewer.camera_views import OFFICE_AT, VIEWS, camera_for
from web.viewer.fits.office_fit import OfficeFit
from web.viewer.picture import UNITS, picture
from web.viewer.primitives.palette import DARK, LIGHT


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("aspect", [0.46, 1.63])
def test_it_is_a_whole_picture_of_what_stands_there(view: str, aspect: float) -> None:
    root = ET.fromstring(picture(fake_snapshot(430), view, aspect, DARK))  # type: ignore[arg-type]
    drawn = [part for part in root.iter() if part.tag.endswith(("path", "circle"))]
    assert len(drawn) > 200
    assert all(math.isfinite(float(n)) for part in drawn for n in re.findall(r"-?[\d.]+", part.get("d", "0")))


def test_the_robot_is_where_the_camera_sees_it() -> None:
    """Beside the plain pinhole: the circle in the robot's colour lies where the robot's place is projected to."""
    snapshot, aspect = fake_snapshot(430), 1.63
    camera = camera_for("all", aspect)
    world, truth = snapshot.world, snapshot.truth
    assert world is not None
    assert truth is not None
    at = OfficeFit(world.bounds).to_plate(np.array([[truth.x, truth.y]]))[0] + OFFICE_AT
    offset = np.array([*at, 0.2]) - camera.position
    ahead = camera.look_at - camera.position
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    zoom = UNITS / 2 / math.tan(camera.fov_rad / 2) / (offset @ ahead)
    wanted = offset @ right * zoom, -(offset @ np.cross(right, ahead)) * zoom
    colour = "#" + "".join(f"{part:02x}" for part in DARK.robot)
    root = ET.fromstring(picture(snapshot, "all", aspect, DARK))
    (robot,) = [part for part in root.iter() if part.tag.endswith("circle") and part.get("fill") == colour]
    assert float(robot.get("cx", "nan")) == pytest.approx(wanted[0], abs=0.2)
    assert float(robot.get("cy", "nan")) == pytest.approx(wanted[1], abs=0.2)


def test_without_office_or_map_it_is_there_all_the_same() -> None:
    plain = fake_snapshot(430)
    assert "<circle" in picture(replace(plain, world=None, truth=None), "all", 1.5, LIGHT)
    few = replace(plain.map, ids=plain.map.ids[:0], xy=plain.map.xy[:0], links=plain.map.links[:0])
    assert "<path" in picture(
        replace(plain, map=few, times=replace(plain.times, seconds=plain.times.seconds[:0])), "map", 1.5, DARK
    )


def test_it_is_served_and_before_the_first_tick_there_is_none() -> None:
    with house() as server:
        answer = server.client.get("/api/stage.svg?view=map&theme=light&aspect=0.5")
        assert answer.status_code == 200
        assert answer.headers["content-type"].startswith("image/svg+xml")
        assert answer.text.startswith("<svg")
        for wrong in ("view=moon", "aspect=0", "aspect=nan", "theme=pink"):
            assert server.client.get(f"/api/stage.svg?{wrong}").status_code == 422
    with house(empty=True) as server:
        assert server.client.get("/api/stage.svg").status_code == 204
