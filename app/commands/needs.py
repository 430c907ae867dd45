"""What a command needs of the source of the session. A recording has no office, and its robot cannot be told anything."""

from __future__ import annotations

from app.session import Session
from web import messages as m

DRIVEN = "a recording plays: its robot goes where it went, and cannot be sent, driven or carried"
OFFICE = "a recording plays: it has no office"
LINK = "a recording plays: a link or a file of it would have to hold the recording; share that instead"
NEEDS: dict[type, str] = {
    **dict.fromkeys((m.SetGoal, m.GoToTag, m.CancelGoal, m.SetMode, m.Drive, m.Kidnap), DRIVEN),
    **dict.fromkeys((m.SetDoor, m.SetLamp, m.PutBox, m.RemoveBox, m.EditWorld, m.UndoEdit, m.RedoEdit), OFFICE),
    **dict.fromkeys((m.ReadWorld, m.WorldSaved), OFFICE),
    m.ReadSituation: LINK,
    m.RunUntil: DRIVEN,
}


def lacking(session: Session, command: object) -> m.Refused | None:
    """Why this session cannot carry out such a command; None: it can."""
    if session.recording is None or type(command) not in NEEDS:
        return None
    kind = getattr(command, "type", type(command).__name__)
    return m.Refused("type", kind, NEEDS[type(command)])
