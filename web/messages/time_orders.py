"""The commands of the timeline: moments of the past, branches, loops."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from disk.words import one_line
from web.messages.command import CommandModel

_Moment = Annotated[float, Field(ge=0, le=1e9)]


class Seek(CommandModel):
    """Pause and show a moment of the run, by simulated time or by tick. From the last one on: the present. Changes nothing."""

    type: Literal["seek"]
    time_s: _Moment | None = None
    tick: Annotated[int, Field(ge=0, le=10**9)] | None = None


class BackToNow(CommandModel):
    """Show the present again, paused."""

    type: Literal["back_to_now"]


class GoOnFromHere(CommandModel):
    """Make the moment of the past that is shown the present of another branch. The run as it was stays as its own branch."""

    type: Literal["go_on_from_here"]


class GoOnWithout(CommandModel):
    """Go back to before what led to this event, and go on in another branch in which the brain has forgotten the views that
    led to it."""

    type: Literal["go_on_without"]
    event: Annotated[int, Field(ge=1)]


class ChangeBranch(CommandModel):
    """Go on with another branch, from its end."""

    type: Literal["change_branch"]
    number: Annotated[int, Field(ge=1, le=1000)]


class CompareBranch(CommandModel):
    """Show another branch beside the live one, at the same time, and say where they differ first. Without a number: none."""

    type: Literal["compare_branch"]
    number: Annotated[int, Field(ge=1, le=1000)] | None = None


class Loop(CommandModel):
    """Play the past between two times (simulated seconds) again and again. Without them: no longer."""

    type: Literal["loop"]
    begin_s: _Moment | None = None
    end_s: _Moment | None = None


class PutBookmark(CommandModel):
    """Name the moment that is shown, to come back to it; with a tick: give the bookmark there another name."""

    type: Literal["put_bookmark"]
    name: Annotated[str, Field(min_length=1, max_length=60), AfterValidator(one_line)]
    tick: Annotated[int, Field(ge=0, le=10**9)] | None = None


class RemoveBookmark(CommandModel):
    type: Literal["remove_bookmark"]
    tick: Annotated[int, Field(ge=0, le=10**9)]


class LeaveSituation(CommandModel):
    """Stop playing a situation that was opened, before it is at its moment. The run that it took the place of goes on, paused."""

    type: Literal["leave_situation"]


TimeOrder = (
    Seek
    | BackToNow
    | GoOnFromHere
    | GoOnWithout
    | ChangeBranch
    | CompareBranch
    | Loop
    | PutBookmark
    | RemoveBookmark
    | LeaveSituation
)
