"""A run of ours that was exported and is played as a recording: the same views, experiences and links."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from app.config import Config
from app.export.mcap_file import write_mcap
from app.recordings.opening import open_recording
from app.recordings.playing import Player
from app.session import Session
from sim2d import load_world


def played(session: Session, ticks: int) -> Iterator[Session]:
    yield session
    for k in range(ticks):
        session.tick()
        yield session
        if k == 150:
            session.kidnap()


@pytest.mark.slow
@pytest.mark.parametrize("world", ["office", "living"])
def test_it_comes_out_the_same(world: str, tmp_path: Path) -> None:
    config = Config().with_values({"local_view.match_threshold": 1.2, "robot.odometry_noise": 0.1})
    session = Session(load_world(world), 11, config)
    with (tmp_path / "run.mcap").open("wb") as file:
        write_mcap(played(session, 300), file)
    recording = open_recording(tmp_path / "run.mcap")
    assert recording.about.config == config
    assert recording.about.problems == ()
    *_, last = Player(recording, 99).steps()
    assert last.brain.digest() == session.brain.digest()
    assert len(last.brain.local_view) == len(session.brain.local_view)
    assert last.brain.experience_map.link_count == session.brain.experience_map.link_count
