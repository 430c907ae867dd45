"""The viewer on a real viser server, without a browser: what it sends, how often, and how little."""

from __future__ import annotations

import copy
import re
from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from viser import _messages

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from web.latest import Throttle
from web.messages import RecordingView, Snapshot

PLAIN = fake_snapshot(430)


def backlog(stage: Bench) -> dict[Any, Any]:
    """What a browser that comes now would be sent."""
    return stage.viewer.server._websock_server._broadcast_buffer.message_from_id


def test_only_the_loopback_and_nothing_of_viser_s_own_but_the_scene(stage: Bench) -> None:
    """No way to ask for a tunnel, and no element of viser's panel, since the page has its own."""
    server = stage.viewer.server
    assert server.get_host() == "127.0.0.1"
    assert stage.viewer.port == server.get_port() > 0
    unheard = {_messages.ShareUrlRequest, _messages.ShareUrlDisconnect, _messages.GuiUpdateMessage}
    assert not unheard & server._websock_server._incoming_handlers.keys()
    assert not [told for told in backlog(stage).values() if isinstance(told, _messages._CreateGuiComponentMessage)]


def test_views_have_names(stage: Bench) -> None:
    with pytest.raises(ValueError, match=re.escape("unknown view 'moon'; expected one of: all, office, pose, map")):
        stage.viewer.fly(None, "moon")
    stage.viewer.fly(3, "map")
    stage.show(None)


# ---------------------------------------------------------------- what is sent


def as_new(snapshot: Snapshot) -> Snapshot:
    """The same content in other objects, as a session publishes it while its robot stands."""
    return replace(copy.deepcopy(snapshot), world=snapshot.world)


def test_what_looks_the_same_is_not_sent_again_and_unwatched_nothing_is_drawn(stage: Bench) -> None:
    nearly = replace(PLAIN.map, xy=PLAIN.map.xy + np.float32(1e-7))  # moved by less than can be seen
    for again in (PLAIN, as_new(PLAIN), replace(PLAIN, map=nearly)):
        assert stage.show(again, 5.0) == Counter()
    before = len(stage.sent)
    stage.viewer.tick(fake_snapshot(460), stage.now_s + 10, watched=False)
    assert len(stage.sent) == before


def test_only_what_has_changed_is_drawn(stage: Bench) -> None:
    moved = replace(PLAIN.estimate, x=PLAIN.estimate.x + 0.5)
    assert set(stage.show(replace(PLAIN, estimate=moved))) == {"/map/arrow"}


def test_a_link_more_sends_the_newest_lines_alone(stage: Bench) -> None:
    snapshot = fake_snapshot(450, nodes=1000)
    stage.show(snapshot)
    stage.settle()
    lines = {name: len(stage.drawn(name)) for name in stage.nodes() if name.startswith("/map/links_")}
    assert len(lines) > 4
    more = replace(snapshot.map, links=np.vstack([snapshot.map.links, [[996, 999]]]).astype(np.int32))
    sent = stage.show(replace(snapshot, map=more), 5.0)
    newest = max((name for name, count in lines.items() if count), key=lambda name: int(name.rpartition("_")[2]))
    assert [name for name in sent if name.startswith("/map/links_")] == [newest]


def test_without_an_office_its_plate_goes_and_the_others_take_its_room(stage: Bench) -> None:
    assert PLAIN.world is not None
    played = replace(PLAIN, living=None, recording=RecordingView("walk", "MCAP", 3, 0.2, ("camera",), over=False))
    none = np.zeros(0, np.float32)
    bare = replace(PLAIN.world, walls=none.reshape(0, 4), wall_kind=(), wall_height_m=none, is_office=False)
    for moment, office, view in (
        (replace(played, world=None, truth=None, movements=None), False, False),
        (replace(played, world=bare), True, False),
        (PLAIN, True, True),
    ):
        stage.show(moment)
        assert (stage.visible("/office"), stage.visible("/office/view")) == (office, view)
        assert (stage.at("/map")[0] > 6) == office


def test_the_newest_wins_and_rates_are_kept(stage: Bench) -> None:
    stage.show(fake_snapshot(500))
    stage.settle()
    before = len(stage.sent)
    for k in range(40):  # two seconds at twenty a second
        stage.show(fake_snapshot(501 + k), 0.05)
    about = Counter(
        (message.name, next(iter(message.updates)))
        for message in stage.sent[before:]
        if isinstance(message, _messages.SceneNodeUpdateMessage)
    )
    assert not [name for name, _ in about if name.startswith("/office/furniture")]
    assert 10 <= about["/pose_cells/voxels", "batched_positions"] <= 13
    assert about["/pose_cells/floor", "_data"] <= 7
    assert 0 < about["/map/nodes_0", "points"] <= 5
    stage.settle()  # what was not due is drawn later, without another snapshot
    assert stage.show(as_new(fake_snapshot(540)), 5.0) == Counter()


@pytest.mark.slow
def test_nodes_and_backlog_stay_the_same_over_a_long_run(stage: Bench) -> None:
    """Nodes without those for the map's links and dots, of which a larger map has more."""
    sizes, waiting = set(), []
    for k in range(80):
        stage.show(fake_snapshot(800 + 18 * k, goal=k % 10 < 7), 0.2)
        sizes.add(sum("/map/links_" not in name and "/map/nodes_" not in name for name in stage.nodes()))
        waiting.append(len(backlog(stage)))
    (size,) = sizes
    assert size < 250
    assert max(waiting[40:]) <= max(waiting[:40]) + 5


def test_a_throttle_waits_its_turn_and_forgets_on_request() -> None:
    shown: list[object] = []
    throttle = Throttle(10, shown.append)
    first, second = object(), object()
    assert throttle.offer(0.0, first)
    assert not throttle.offer(1.0, first)
    assert throttle.offer(1.0, second)
    assert not throttle.offer(1.05, first)
    assert throttle.waiting
    throttle.hurry()
    assert not throttle.offer(1.05, second)  # nothing new
    assert throttle.offer(1.05, first)
    throttle.forget()
    assert throttle.offer(1.05, first)
    assert not throttle.waiting
    assert shown == [first, second, first, first]
