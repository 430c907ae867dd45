"""The moment that is shown as SVG: each plate by itself, and the stage, in the viewer's place until its first frame."""

from __future__ import annotations

import asyncio
from typing import Annotated, Literal

from fastapi import FastAPI, Path, Query, Request
from fastapi.responses import Response

from web.http.asking import ERRORS
from web.http.commands import Malformed, wrong
from web.http.security import Limits, comes_from_class
from web.latest import Latest
from web.messages import Snapshot
from web.switches import Switches
from web.themes import Theme
from web.viewer.picture import picture
from web.viewer.primitives.palette import palette_of
from web.viewer.vector import PlateName, vector_picture

LEAST_ASPECT, MOST_ASPECT = 0.2, 6.0


def add_pictures(app: FastAPI, latest: Latest[Snapshot], switches: Switches) -> None:
    limits = Limits()

    @app.get("/api/picture/{plate}", tags=["state"], responses={200: {"content": {"image/svg+xml": {}}}, **ERRORS})
    async def picture(
        plate: Annotated[PlateName, Path(description="which one")],
        theme: Annotated[Theme, Query(description="whose colours")] = "dark",
    ) -> Response:
        """A plate as SVG: the office from above, the pose cells from above, or the experience map with its route.

        pose_2 and map_2 are those of the second of two brains. What has a switch on the page is drawn while it is on."""
        limits.pass_on("picture")
        _, snapshot = latest.get()
        if snapshot is None:
            reason = "the engine has not finished its first tick yet; try again in a moment"
            raise Malformed([wrong(None, None, reason)])
        try:
            svg = await asyncio.to_thread(vector_picture, plate, snapshot, theme, switches.on)
        except ValueError as error:
            raise Malformed([wrong("plate", plate, str(error))]) from None
        return Response(svg, headers={"Cache-Control": "no-store"}, media_type="image/svg+xml")


def add_stage_picture(app: FastAPI, latest: Latest[Snapshot], switches: Switches) -> None:
    limits, of_class = Limits(), Limits()

    @app.get("/api/stage.svg", include_in_schema=False)
    async def stage_picture(
        request: Request,
        view: Literal["all", "office", "pose", "map"] = "all",
        theme: Literal["dark", "light"] = "dark",
        aspect: float = Query(1.5, ge=LEAST_ASPECT, le=MOST_ASPECT),
    ) -> Response:
        """The stage as it is now; nothing (204) before the first tick."""
        (of_class if comes_from_class(request) else limits).pass_on("picture")
        _, snapshot = latest.get()
        if snapshot is None:
            return Response(status_code=204)
        text = await asyncio.to_thread(picture, snapshot, view, round(aspect, 2), palette_of(theme), switches.on)
        return Response(text, media_type="image/svg+xml", headers={"Cache-Control": "no-store"})
