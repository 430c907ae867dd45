"""A viewer for each look: built when first needed, with the same switches on, idle when nobody looks."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any, NamedTuple

import pytest
from viser import _messages
from websockets.sync.client import ClientConnection, connect

from tests.fake_snapshots import fake_snapshot
from tests.patience import until
from tests.unit.web.doubles import StubEngine
from tests.unit.web.test_viser_server import PROTOCOL, camera
from web.latest import Latest
from web.messages import Snapshot
from web.themes import Look, Themes
from web.viewer import Viewer, Viewers
from web.viewer.plates.plate import MOST_LARGE
from web.viewer.primitives.palette import LARGE, USUAL
from web.viewer.viser_server import SECRET_HEADER

pytestmark = pytest.mark.slow


class Both(NamedTuple):
    """A dark and a light viewer that run."""

    latest: Latest[Snapshot]
    viewers: Viewers
    dark: Viewer
    light: Viewer


@pytest.fixture(scope="module")
def both() -> Iterator[Both]:
    latest: Latest[Snapshot] = Latest()
    viewers = Viewers(latest, StubEngine().submit)
    viewers.start()
    yield Both(latest, viewers, viewers.of("dark"), viewers.of("light"))
    viewers.stop()


def look(viewer: Viewer) -> ClientConnection:
    """A browser connected to a viewer; it must be read from or closed."""
    url, secret = f"ws://127.0.0.1:{viewer.port}/", {SECRET_HEADER: viewer.secret}
    browser = connect(url, subprotocols=[PROTOCOL], additional_headers=secret, max_size=None, max_queue=None)
    browser.send(camera())
    until(viewer.server.get_clients)
    return browser


def told(viewer: Viewer, kind: type[Any], name: str = "") -> list[Any]:
    """The messages of this kind, about one node or all, that a browser receives when it connects now."""
    kept = list(viewer.server._websock_server._broadcast_buffer.message_from_id.values())
    return [one for one in kept if isinstance(one, kind) and name in ("", getattr(one, "name", ""))]


def test_each_is_built_when_it_is_asked_for_stays_and_shows_its_own_theme(both: Both) -> None:
    assert (both.viewers.of("dark"), both.viewers.of("light")) == (both.dark, both.light)
    for viewer, dark in ((both.dark, True), (both.light, False)):
        (theme,) = told(viewer, _messages.ThemeConfigurationMessage)
        assert theme.dark_mode is dark
    skies = [told(viewer, _messages.BackgroundImageMessage)[0].rgb_data for viewer in (both.dark, both.light)]
    assert skies[0] != skies[1]


def test_who_presents_is_shown_larger_words_in_a_viewer_of_their_own(both: Both) -> None:
    large = both.viewers.of("dark", True)
    assert large is both.viewers.of("dark", True) is not both.dark
    assert told(large, _messages.ThemeConfigurationMessage)[0].dark_mode is True

    def heights(viewer: Viewer) -> dict[str, float]:
        """How high the words are on plates, axes, bars and pills, by node."""
        pictures = {one.name: one.props.render_height for one in told(viewer, _messages.ImageMessage)}
        ends = ("/title", "/subtitle", "/tick_x0", "/bar_0", "/words")
        return {name: height for name, height in pictures.items() if name.endswith(ends)}

    usual, larger = heights(both.dark), heights(large)
    assert sum(name.endswith("/words") for name in usual) >= 10
    subtitle = min(LARGE, MOST_LARGE) / min(USUAL, MOST_LARGE)
    for name, height in usual.items():
        times = 1.0 if name.endswith("/title") else subtitle if name.endswith("/subtitle") else LARGE / USUAL
        assert larger[name] == pytest.approx(times * height), name


def test_a_page_that_presents_wants_another_look_and_keeps_its_theme() -> None:
    themes = Themes()
    themes.choose("page", "light")
    with themes.shown("page") as (look, turned):
        assert look == Look("light", large=False)
        themes.enlarge("page", False)
        assert not turned.is_set()
        themes.enlarge("page", True)
        assert turned.is_set()
    assert themes.of("page") == Look("light", large=True)
    assert themes.of("another") == Look()


def test_what_is_switched_off_is_off_at_both(both: Both) -> None:
    def shown(viewer: Viewer) -> bool:
        return told(viewer, _messages.SetSceneNodeVisibilityMessage, "/map/occupancy")[-1].visible

    both.latest.put(fake_snapshot(430))
    with look(both.dark), look(both.light):
        for on in (False, True):
            both.viewers.switches.turn("occupancy", on)
            until(lambda on=on: shown(both.dark) is shown(both.light) is on)
    until(lambda: not both.dark.server.get_clients() and not both.light.server.get_clients())


def test_only_the_one_that_is_looked_at_draws(both: Both) -> None:
    def arrow(viewer: Viewer) -> list[Any]:
        return [message.position for message in told(viewer, _messages.SetPositionMessage, "/map/arrow")]

    before = arrow(both.dark)
    with look(both.light):
        for tick in range(530, 534):
            was = arrow(both.light)
            both.latest.put(fake_snapshot(tick))
            until(lambda was=was: arrow(both.light) != was)
    assert arrow(both.dark) == before
    until(lambda: not both.light.server.get_clients())


def test_after_the_end_there_is_none_and_no_thread_is_left() -> None:
    before = set(threading.enumerate())
    latest: Latest[Snapshot] = Latest()
    viewers = Viewers(latest, StubEngine().submit)
    viewers.of("light")
    viewers.start()
    latest.put(fake_snapshot(3))
    viewers.stop()
    viewers.stop()
    with pytest.raises(ConnectionError):
        viewers.of("light")
    until(lambda: not set(threading.enumerate()) - before)
