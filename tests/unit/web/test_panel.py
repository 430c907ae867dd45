"""The side panel as data: arrays arrive as they were, and no page is sent what it has or does not show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.frames import read_frame, read_message
from tests.unit.web.panel_page import Page
from web.messages import TimeView
from web.panel import panel as module
from web.panel.panel import framed, packed

SNAPSHOT = fake_snapshot(430)
KINDS = st.sampled_from([np.uint8, np.uint16, np.uint32, np.float32])
ARRAYS = hnp.arrays(KINDS, hnp.array_shapes(max_dims=2, max_side=9))


@pytest.mark.slow
@settings(max_examples=50)
@given(st.dictionaries(st.text("abc", min_size=1, max_size=3), ARRAYS, max_size=4))
def test_arrays_arrive_as_they_were(arrays: dict[str, np.ndarray]) -> None:
    head, read = read_frame(framed({"type": "panel"}, {name: packed(array) for name, array in arrays.items()}))
    assert (head, read.keys()) == ({"type": "panel"}, arrays.keys())
    for name, array in arrays.items():
        np.testing.assert_array_equal(read[name], array)


def test_a_camera_s_image_travels_small_and_true() -> None:
    camera = SNAPSHOT.senses.camera
    image = packed(camera)
    assert image.kind == "jpeg"
    assert len(image.body) < camera.nbytes / 3
    _, read = read_frame(framed({}, {"camera": image}))
    assert np.abs(read["camera"].astype(int) - camera).mean() < 3


def test_what_has_not_changed_is_not_sent_and_a_picture_that_is_gone_is_told() -> None:
    page, senses = Page("Senses", "Truth", "Tune"), SNAPSHOT.senses
    page.told(SNAPSHOT)
    assert page.told(SNAPSHOT) == page.told(replace(SNAPSHOT, tick=431)) == {}
    again = page.told(replace(SNAPSHOT, senses=replace(senses, camera=255 - senses.camera)))
    assert {part: set(arrays) for part, (_, arrays) in again.items()} == {"views": {"camera"}}
    lost = replace(SNAPSHOT, senses=replace(senses, camera=255 - senses.camera, best=None))
    head, arrays = read_message(page.reader.news(lost, page.now_s + 1)[0])
    assert (head["has"], arrays) == (["camera", "seen"], {})


def test_tabs_that_are_not_open_are_told_nothing_and_told_all_when_they_open() -> None:
    page = Page("Senses")
    assert set(page.told(SNAPSHOT)) == {"views", "cells"}
    page.reader.tabs = ("Tune", "Truth")
    assert set(page.told(SNAPSHOT)) == {"tune", "switches", "numbers", "series"}
    page.reader.tabs = ()
    assert page.told(fake_snapshot(431)) == {}
    assert set(Page().told(SNAPSHOT)) == {part.name for part in module.PARTS}


def test_what_comes_too_early_is_told_when_it_is_due() -> None:
    page, later = Page("Memory"), replace(SNAPSHOT, views=1234)
    page.told(SNAPSHOT)
    assert page.reader.soon_s is None
    assert page.told(later, 0.01) == {}
    assert page.reader.soon_s is not None
    assert "1\\xa0234" in str(page.told(later, 1.0)["memory"])
    assert page.reader.soon_s is None


def test_each_content_is_made_once_for_all_who_look(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[int] = []
    monkeypatch.setattr(module, "packed", lambda array: (made.append(1), packed(array))[1])
    one = Page("Senses")
    first, second = one.told(SNAPSHOT), Page("Senses", panel=one.panel).told(SNAPSHOT)
    assert len(made) == sum(len(arrays) for _, arrays in first.values())
    assert {name: data for name, (data, _) in first.items()} == {name: data for name, (data, _) in second.items()}


def test_a_moment_that_was_sought_is_told_at_once_and_the_playing_past_in_turn() -> None:
    page = Page()
    past = TimeView(past=True, end_tick=600, end_s=60.0, begin_s=0.0, branch=1, branches=(), loop=None)
    page.told(replace(SNAPSHOT, running=False, time=past))

    def soon(tick: int, *, running: bool) -> set[str]:
        moment = replace(fake_snapshot(tick), running=running, time=past)
        return {read_message(message)[0]["part"] for message in page.reader.news(moment, page.now_s + 0.01)}

    assert "series" in soon(300, running=False)
    assert "series" in soon(200, running=False)
    assert soon(201, running=True) == set()
