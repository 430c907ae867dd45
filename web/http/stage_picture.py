"""The picture that stands in the viewer's place until its first frame: `/api/stage.svg`."""

from __future__ import annotations

import asyncio
from typing import Literal

from fastapi import FastAPI, Query, Request
from starlette.responses import Response

from web.http.security import Limits
from web.http.watching import comes_from_class
from web.latest import Latest
from web.messages import Snapshot
from web.switches import Switches
from web.viewer.picture import picture
from web.viewer.primitives.palette import palette_of

LEAST_ASPECT, MOST_ASPECT = 0.2, 6.0


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
