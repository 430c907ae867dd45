"""A class votes: the vote itself, and the address at which it votes, also as a QR code."""

from __future__ import annotations

import io
from typing import Annotated, Any

import segno
from fastapi import FastAPI, Request
from fastapi.responses import Response
from pydantic import BaseModel, Field

from web.http.asking import Submit, told
from web.http.bodies import Body, body_of, json_response, takes
from web.http.class_door import Classroom
from web.http.commands import CommandAccepted, Declined, Problem, check, read_object
from web.http.security import MAX_VOTE_BYTES, VOTE_PATH, Limits
from web.http.state import to_json
from web.messages.command import Label

NONE = "no class can reach this program; start it with `ratslam run --class`"


class VoteBody(Body):
    """As the command `vote`: an option by its number, or a point on the plan. voter: a text that each page makes up."""

    lesson: Label
    voter: Annotated[Label, Field(min_length=8)]
    choice: int | None = None
    x: float | None = None
    y: float | None = None


class ClassAddress(BaseModel):
    """Where a class votes, and where it looks on; null: nowhere."""

    vote: str | None
    watch: str | None


def add_classroom(app: FastAPI, classroom: Classroom | None, submit: Submit) -> None:
    limits = Limits()
    errors: dict[int | str, dict[str, Any]] = {status: {"model": Problem} for status in (403, 413, 415, 422, 429, 503)}

    @app.post(
        VOTE_PATH,
        tags=["lessons"],
        openapi_extra=takes(VoteBody),
        responses={200: {"model": CommandAccepted}, **errors},
    )
    async def vote(request: Request) -> Response:
        """One vote of a class on the prediction; the same voter may change it until it is shown."""
        document = read_object(await body_of(request, MAX_VOTE_BYTES))
        limits.pass_on("vote")
        sender = request.client.host if request.client else ""
        answer = await told(submit, check({**document, "type": "vote", "sender": sender}))
        return json_response(to_json({"accepted": True, "tick": answer.tick}))

    @app.get("/api/class", tags=["lessons"], responses={200: {"model": ClassAddress}})
    def address() -> Response:
        """The addresses for a class, if there are any (`ratslam run --class`)."""
        url = None if classroom is None else classroom.url
        return json_response(to_json({"vote": url, "watch": url and f"{url}?watch"}))

    @app.get("/api/class.svg", include_in_schema=False)
    def code() -> Response:
        """The address for votes as a QR code, dark on light in both themes, since readers expect that."""
        if classroom is None:
            raise Declined.of(404, NONE)
        drawn = io.BytesIO()
        segno.make(classroom.url, micro=False).save(
            drawn, kind="svg", xmldecl=False, omitsize=True, dark="#000", light="#fff"
        )
        return Response(drawn.getvalue(), media_type="image/svg+xml", headers={"Cache-Control": "no-cache"})
