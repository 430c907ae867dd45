"""What a picture says of its moment."""

from __future__ import annotations

from web.messages import Snapshot


def moment_words(snapshot: Snapshot) -> str:
    """Run and moment: "office, seed 5, 1:00.0, tick 600"."""
    played = snapshot.recording.name if snapshot.recording is not None else snapshot.world and snapshot.world.name
    minutes, seconds = divmod(snapshot.time_s, 60)
    return f"{played or 'run'}, seed {snapshot.seed}, {int(minutes)}:{seconds:04.1f}, tick {snapshot.tick}"
