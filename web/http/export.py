"""The run as a file for other programs. How it is made comes from Exports, which the program hands over."""

from __future__ import annotations

import asyncio
import contextlib
import re
import tempfile
import zipfile
from collections.abc import Coroutine
from pathlib import Path
from typing import Annotated, Literal, Protocol

from fastapi import FastAPI, Query, Request
from fastapi.responses import FileResponse, Response
from pydantic import BaseModel
from starlette.background import BackgroundTask

from web.http.asking import ERRORS, NoAnswer, Submit, json_response
from web.http.commands import Malformed, wrong
from web.http.security import Limits
from web.http.state import to_json
from web.latest import Latest
from web.messages import Snapshot

Second = Annotated[float | None, Query(ge=0, le=1e9, allow_inf_nan=False, description="simulated seconds")]
LOOK_S = 0.5  # between two looks whether anybody still waits for the file


class Offer(BaseModel):
    """A format. `refusal` says why it cannot be had now."""

    format: str
    words: str
    refusal: str | None


class ExportRequest(BaseModel):
    """What is wanted of the run: a stretch in simulated seconds, None: from its beginning, up to now. pictures: in MCAP."""

    from_s: float | None = None
    until_s: float | None = None
    pictures: Literal["png", "jpeg", "none"] = "png"

    @property
    def whole(self) -> bool:
        return self.from_s is None and self.until_s is None


class Exports(Protocol):
    @property
    def done(self) -> float:
        """The share, 0 to 1, of the file that is being written."""
        ...

    def offers(self) -> list[Offer]: ...

    async def write(self, to: str, submit: Submit, out: Path, wanted: ExportRequest) -> list[Path]:
        """Write the run as it is now to `out`, or to several files beside it. ValueError says why it cannot be.

        When it is cancelled, it ends what it has begun.
        """
        ...


def add_exports(app: FastAPI, exports: Exports | None, latest: Latest[Snapshot], submit: Submit) -> None:
    limits, one_at_a_time = Limits(), asyncio.Lock()

    @app.get("/api/exports", tags=["export"], responses={200: {"model": list[Offer]}})
    async def offers() -> Response:
        """The formats in which the run can be had."""
        there = [] if exports is None else exports.offers()
        return json_response(to_json([offer.model_dump() for offer in there]))

    @app.get("/api/exports/done", tags=["export"], responses={200: {"model": float | None}})
    async def done() -> Response:
        """The share, 0 to 1, of the file that is being written; null when none is."""
        return json_response(to_json(exports.done if exports is not None and one_at_a_time.locked() else None))

    @app.get("/api/export", tags=["export"], responses={200: {"content": {"application/octet-stream": {}}}, **ERRORS})
    async def export(
        request: Request,
        to: str = Query(max_length=20, description="a format of /api/exports"),
        from_s: Second = None,
        until_s: Second = None,
        pictures: Literal["png", "jpeg", "none"] = "png",
    ) -> Response:
        """The run, or from `from_s` to `until_s` of it, in one format; a .zip if that needs several files. One is written at
        a time. `pictures`: of the camera in an mcap; png is exact."""
        limits.pass_on("export")
        wanted = ExportRequest(from_s=from_s, until_s=until_s, pictures=pictures)
        if from_s is not None and until_s is not None and until_s <= from_s:
            raise Malformed([wrong("until_s", until_s, f"must be after from_s, {from_s:g}")])
        offer = next((offer for offer in exports.offers() if offer.format == to), None) if exports is not None else None
        if exports is None or offer is None or offer.refusal is not None:
            reason = (
                offer.refusal if offer is not None and offer.refusal else "there is no such format; see /api/exports"
            )
            raise Malformed([wrong("to", to, reason)])
        if one_at_a_time.locked():
            raise NoAnswer.of(429, "another file is being written; wait until it is there and ask again")
        async with one_at_a_time:
            folder = tempfile.TemporaryDirectory(prefix="ratslam-export-")
            try:
                out = Path(folder.name) / f"{_name(latest, wanted)}.{to}"
                file = await _written(exports.write(to, submit, out, wanted), request, out)
            except BaseException as error:
                folder.cleanup()
                if isinstance(error, ValueError | OSError) and not isinstance(error, Malformed):
                    raise Malformed([wrong("to", to, f"it could not be written: {error}")]) from None
                raise
        headers = {"Cache-Control": "no-store"}
        return FileResponse(
            file, headers=headers, media_type="application/octet-stream", filename=file.name,
            background=BackgroundTask(folder.cleanup),
        )  # fmt: skip


async def _written(writing: Coroutine[None, None, list[Path]], request: Request, out: Path) -> Path:
    """The one file to be sent. Ends the writing when nobody waits for it any more."""
    task = asyncio.create_task(writing)
    try:
        while not (await asyncio.wait({task}, timeout=LOOK_S))[0]:
            if await request.is_disconnected():
                raise NoAnswer.of(503, "nobody waits for this file any more")
        files = task.result()
    finally:
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError, Exception):
            await task
    return files[0] if len(files) == 1 else await asyncio.to_thread(_zipped, files, out.with_suffix(".zip"))


def _zipped(files: list[Path], out: Path) -> Path:
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in files:
            archive.write(file, file.name)
    return out


def _name(latest: Latest[Snapshot], wanted: ExportRequest) -> str:
    _, snapshot = latest.get()
    if snapshot is None:
        return "run"
    played = "recording" if snapshot.world is None else snapshot.world.name
    from_s, until_s = wanted.from_s or 0.0, snapshot.time_s if wanted.until_s is None else wanted.until_s
    stretch = "" if wanted.whole else f"-{from_s:g}s-to-{until_s:g}s"
    return f"run-{re.sub(r'[^A-Za-z0-9]+', '-', played)}-seed{snapshot.seed}{stretch}"
