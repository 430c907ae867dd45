"""The plates as vector pictures, of the moment that is shown."""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import FastAPI, Path, Query
from fastapi.responses import Response

from web.http.bodies import ERRORS
from web.http.commands import Malformed, wrong
from web.http.security import Limits
from web.latest import Latest
from web.messages import Snapshot
from web.switches import Switches
from web.themes import Theme
from web.viewer.vector import PlateName, vector_picture


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
            raise Malformed(
                [wrong(None, None, "the engine has not finished its first tick yet; try again in a moment")]
            )
        try:
            svg = await asyncio.to_thread(vector_picture, plate, snapshot, theme, switches.on)
        except ValueError as error:
            raise Malformed([wrong("plate", plate, str(error))]) from None
        return Response(svg, headers={"Cache-Control": "no-store"}, media_type="image/svg+xml")
