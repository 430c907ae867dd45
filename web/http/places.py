"""The places that the robot knows, for a list to choose from without seeing the map."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from fastapi import FastAPI
from fastapi.responses import Response

from web.http.asking import json_response
from web.http.commands import Problem, problem
from web.http.state import to_json
from web.latest import Latest
from web.messages import KnownPlace, MapLayer, Snapshot


def add_places(app: FastAPI, latest: Latest[Snapshot]) -> None:
    @app.get("/api/places", tags=["state"], responses={503: {"model": Problem}})
    async def places() -> Response:
        """What a goal can be: places with a name, those of the office, and all experiences. Map frame, metres; `seconds`:
        the quickest way from the robot to there (to the goal, while there is one), null: no way is known; `why`: why a
        place of the office cannot be one, null: it can."""
        _, snapshot = latest.get()
        if snapshot is None:
            return json_response(problem(f"the engine has not finished its first tick yet ({latest.waking})"), 503)
        return json_response(to_json(places_of(snapshot)))


def _named(place: KnownPlace, layer: MapLayer) -> dict[str, Any]:
    """A place of the office by its name. It can be gone to once the map has something there; `why` says why not."""
    if place.map_xy is None or not len(layer.ids):
        why = "the robot has not been near it yet"
        return {"name": place.name, "experience": None, "x": None, "y": None, "why": why}
    x, y = place.map_xy
    nearest = int(np.hypot(*(layer.xy - np.array([x, y])).T).argmin())
    return {"name": place.name, "experience": int(layer.ids[nearest]), "x": x, "y": y, "why": None}


def places_of(snapshot: Snapshot) -> dict[str, Any]:
    layer, times = snapshot.map, snapshot.times
    here = snapshot.estimate
    seconds = times.seconds if len(times.seconds) == len(layer.ids) else [math.inf] * len(layer.ids)
    return {
        "robot": {"x": here.x, "y": here.y, "heading_rad": here.heading_rad},
        "to_goal": times.to_goal,
        "tags": [{"name": tag.name, "experience": tag.experience, "x": tag.x, "y": tag.y} for tag in snapshot.tags],
        "named": [_named(place, layer) for place in snapshot.places],
        "experiences": [
            {"id": int(id_), "x": float(x), "y": float(y), "seconds": float(s) if math.isfinite(s) else None}
            for id_, (x, y), s in zip(layer.ids, layer.xy, seconds, strict=True)
        ],
    }
