"""The side panel as data: arrays arrive as they were, and no page is sent what it has or does not show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.frames import read_frame, read_message
from tests.unit.web.panel_page import Page, words_of
from web.messages import TimeView
from web.panel import panel as module
from web.panel.packing import framed, packed
from web.panel.panel import Panel
from web.switches import Switches

A_PAST = TimeView(past=True, end_tick=600, end_s=60.0, begin_s=0.0, branch=1, branches=(), loop=None)


@pytest.fixture
def page() -> Page:
    return Page(Panel(Switches()))


@pytest.mark.slow
@given(
    st.dictionaries(
        st.text("abc", min_size=1, max_size=3),
        hnp.arrays(
            st.sampled_from([np.uint8, np.uint16, np.uint32, np.float32]), hnp.array_shapes(max_dims=2, max_side=9)
        ),
        max_size=4,
    )
)
def test_arrays_arrive_as_they_were(arrays: dict[str, np.ndarray]) -> None:
    head, read = read_frame(framed({"type": "panel"}, {name: packed(array) for name, array in arrays.items()}))
    assert head == {"type": "panel"}
    assert read.keys() == arrays.keys()
    for name, array in arrays.items():
        np.testing.assert_array_equal(read[name], array)


def test_a_camera_s_image_travels_small_and_true() -> None:
    camera = fake_snapshot(430).senses.camera
    image = packed(camera)
    assert image.kind == "jpeg"
    assert len(image.body) < camera.nbytes / 3
    _, read = read_frame(framed({}, {"camera": image}))
    assert np.abs(read["camera"].astype(int) - camera).mean() < 3


def test_what_has_not_changed_is_not_sent(page: Page) -> None:
    snapshot = fake_snapshot(430)
    first = page.told(snapshot)
    assert set(first) == {part.name for part in module.PARTS}
    assert page.told(snapshot) == {}
    assert page.told(replace(snapshot, tick=431)) == {}  # another snapshot with the same content
    brighter = replace(snapshot.senses, camera=255 - snapshot.senses.camera)
    again = page.told(replace(snapshot, senses=brighter))
    assert set(again) == {"views"}
    assert set(again["views"][1]) == {"camera"}  # the other pictures are there


def test_a_part_that_has_lost_a_picture_says_so(page: Page) -> None:
    snapshot = fake_snapshot(430)
    page.reader.tabs = ("Senses",)
    page.told(snapshot)
    (message,) = page.reader.news(replace(snapshot, senses=replace(snapshot.senses, best=None)), page.now_s + 1)[:1]
    head, arrays = read_message(message)
    assert head["has"] == ["camera", "seen"]
    assert not arrays


def test_tabs_that_are_not_open_are_told_nothing_and_told_all_when_they_open(page: Page) -> None:
    snapshot = fake_snapshot(430)
    page.reader.tabs = ("Senses",)
    assert set(page.told(snapshot)) == {"views", "cells"}
    page.reader.tabs = ("Tune", "Truth")
    assert set(page.told(snapshot)) == {"tune", "switches", "numbers", "series"}
    page.reader.tabs = ()
    assert page.told(fake_snapshot(431)) == {}


def test_what_comes_too_early_is_told_when_it_is_due(page: Page) -> None:
    page.reader.tabs = ("Memory",)
    page.told(fake_snapshot(430))
    assert page.reader.soon_s is None
    later = replace(fake_snapshot(430), views=1234)
    assert page.told(later, 0.01) == {}
    assert page.reader.soon_s is not None
    assert "1 234" in words_of(page.told(later, 1.0)["memory"][0]["tables"]).replace("\\xa0", " ")
    assert page.reader.soon_s is None


def test_each_content_is_made_once_for_all_who_look(monkeypatch: pytest.MonkeyPatch) -> None:
    panel, made = Panel(Switches()), []
    monkeypatch.setattr(module, "packed", lambda array: (made.append(1), packed(array))[1])
    one, two = Page(panel, ("Senses",)), Page(panel, ("Senses",))
    snapshot = fake_snapshot(430)
    first, second = one.told(snapshot), two.told(snapshot)
    assert len(made) == sum(len(arrays) for _, arrays in first.values())
    assert {name: data for name, (data, _) in first.items()} == {name: data for name, (data, _) in second.items()}


def test_a_moment_that_was_sought_is_told_at_once_and_the_playing_past_in_turn(page: Page) -> None:
    snapshot = replace(fake_snapshot(430), running=False, time=A_PAST)
    page.told(snapshot)

    def soon(tick: int, *, running: bool) -> set[str]:
        moment = replace(fake_snapshot(tick), running=running, time=A_PAST)
        return {read_message(message)[0]["part"] for message in page.reader.news(moment, page.now_s + 0.01)}

    assert "series" in soon(300, running=False)
    assert "series" in soon(200, running=False)
    assert soon(201, running=True) == set()
