"""Playing a recording that the server has opened."""

from __future__ import annotations

from app.commands.outcome import Outcome
from app.engine.engine import Engine
from app.recordings.playing import Player
from app.views.recorded import recording_view
from web import messages as m


def play_recording(engine: Engine, request: m.PlayRecording) -> Outcome:
    """Begin a run that plays it. If that fails, the old run goes on."""
    try:
        if not isinstance(request.player, Player):
            raise TypeError(f"it is a {type(request.player).__name__}")
        run = engine.begin_recording(request.player)
    except Exception as error:
        return m.Refused("recording", None, f"this recording cannot be played: {error}")
    about = run.session.recording
    assert about is not None
    engine.running = not run.session.over
    return m.Accepted(0, recording_view(about, run.session.over))
