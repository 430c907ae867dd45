"""The viewer on a real viser server, without a browser: what it sends, how often, and how little."""

from __future__ import annotations

import copy
import re
import threading
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from viser import _messages

from tests.fake_snapshots import fake_snapshot
from tests.patience import until
from tests.unit.web.bench import Bench, Engine
from web.latest import Latest
from web.messages import RecordingView, Snapshot
from web.switches import Switches
from web.throttle import Throttle
from web.viewer import Viewer


@pytest.fixture
def bench(shared: Bench) -> Bench:
    shared.show(fake_snapshot(430), 10.0)
    shared.settle()
    return shared


# ---------------------------------------------------------------- life


def test_it_starts_and_stops_without_leaving_threads() -> None:
    before = set(threading.enumerate())
    latest: Latest[Snapshot] = Latest()
    viewer = Viewer(latest, Engine().submit, Switches(), theme="light")
    viewer.start()
    latest.put(fake_snapshot(3))
    viewer.stop()
    viewer.stop()
    until(lambda: not set(threading.enumerate()) - before)


def test_only_the_loopback_and_no_way_to_ask_for_a_tunnel(bench: Bench) -> None:
    server = bench.viewer.server
    assert server.get_host() == "127.0.0.1"
    assert bench.viewer.port == server.get_port() > 0
    handlers = server._websock_server._incoming_handlers
    assert _messages.ShareUrlRequest not in handlers
    assert _messages.ShareUrlDisconnect not in handlers
    assert _messages.GuiUpdateMessage not in handlers  # there is nothing of viser's own to be turned


def test_views_have_names(bench: Bench) -> None:
    with pytest.raises(ValueError, match=re.escape("unknown view 'moon'; expected one of: all, office, pose, map")):
        bench.viewer.fly(None, "moon")
    bench.viewer.fly(3, "map")
    bench.show(None)


# ---------------------------------------------------------------- what is sent


def as_new(snapshot: Snapshot) -> Snapshot:
    """The same content in other objects, as a session publishes it while its robot stands."""
    return replace(copy.deepcopy(snapshot), world=snapshot.world)


def test_nothing_but_the_scene_is_sent(bench: Bench) -> None:
    """No element of viser's own panel, since the page has its own."""
    bench.show(fake_snapshot(470), 10.0)
    bench.settle()
    told = bench.viewer.server._websock_server._broadcast_buffer.message_from_id.values()
    assert not [message for message in told if isinstance(message, _messages._CreateGuiComponentMessage)]


def test_nothing_new_sends_nothing(bench: Bench) -> None:
    snapshot = fake_snapshot(430)
    bench.show(snapshot)
    bench.settle()
    assert bench.show(snapshot) == Counter()


def test_what_looks_the_same_is_not_sent_again(bench: Bench) -> None:
    snapshot = fake_snapshot(430)
    bench.show(snapshot, 5.0)
    bench.settle()
    assert bench.show(as_new(snapshot), 5.0) == Counter()


def test_what_moves_by_less_than_can_be_seen_is_not_sent_again(bench: Bench) -> None:
    snapshot = fake_snapshot(430)
    bench.show(snapshot)
    bench.settle()
    nearly = replace(snapshot.map, xy=snapshot.map.xy + np.float32(1e-7))
    assert bench.show(replace(snapshot, map=nearly), 5.0) == Counter()


def test_a_link_more_sends_the_newest_lines_alone(bench: Bench) -> None:
    snapshot = fake_snapshot(450, nodes=1000)
    bench.show(snapshot)
    bench.settle()
    lines = {name: len(bench.drawn(name)) for name in bench.nodes() if name.startswith("/map/links_")}
    assert len(lines) > 4
    more = replace(snapshot.map, links=np.vstack([snapshot.map.links, [[996, 999]]]).astype(np.int32))
    sent = bench.show(replace(snapshot, map=more), 5.0)
    newest = max((name for name, count in lines.items() if count), key=lambda name: int(name.rpartition("_")[2]))
    assert [name for name in sent if name.startswith("/map/links_")] == [newest]


def test_only_what_has_changed_is_drawn(bench: Bench) -> None:
    snapshot = fake_snapshot(440)
    bench.show(snapshot)
    bench.settle()
    moved = replace(snapshot.estimate, x=snapshot.estimate.x + 0.5)
    assert set(bench.show(replace(snapshot, estimate=moved))) == {"/map/arrow"}


def test_without_an_office_its_plate_goes_and_the_map_stands_in_the_middle(bench: Bench) -> None:
    snapshot, scenery = fake_snapshot(600), bench.viewer._scenery
    played = RecordingView("walk", "MCAP", 3, 0.2, ("camera",), over=False)
    bench.show(replace(snapshot, world=None, truth=None, living=None, movements=None, recording=played))
    assert not scenery.office.frame.visible
    assert scenery.map.frame.position[0] == scenery.map.origin[0] == 0.0
    assert snapshot.world is not None
    none = np.zeros(0, np.float32)
    bare = replace(snapshot.world, walls=none.reshape(0, 4), wall_kind=(), wall_height_m=none, is_office=False)
    bench.show(replace(snapshot, world=bare, living=None, recording=played))
    assert scenery.office.frame.visible
    assert not scenery.office._fan.visible
    bench.show(fake_snapshot(601))
    assert scenery.office._fan.visible
    assert scenery.map.origin[0] > 0


def test_the_newest_wins_and_rates_are_kept(bench: Bench) -> None:
    bench.show(fake_snapshot(500))
    bench.settle()
    before = len(bench.sent)
    for k in range(40):  # two seconds at twenty a second
        bench.show(fake_snapshot(501 + k), 0.05)
    about = Counter(
        (message.name, next(iter(message.updates)))
        for message in bench.sent[before:]
        if isinstance(message, _messages.SceneNodeUpdateMessage)
    )
    assert not [name for name, _ in about if name.startswith("/office/furniture")]
    assert 10 <= about["/pose_cells/voxels", "batched_positions"] <= 13
    assert about["/pose_cells/floor", "_data"] <= 7
    assert 0 < about["/map/nodes_0", "points"] <= 5
    bench.settle()  # what was not due is drawn later, without another snapshot
    assert bench.show(as_new(fake_snapshot(540)), 5.0) == Counter()


@pytest.mark.slow
def test_nodes_and_backlog_stay_the_same_over_two_hundred_snapshots(bench: Bench) -> None:
    backlog = bench.viewer.server._websock_server._broadcast_buffer.message_from_id
    sizes, waiting = set(), []
    for k in range(200):
        bench.show(fake_snapshot(800 + 7 * k, goal=k % 40 < 30), 0.2)
        sizes.add(count(bench))
        waiting.append(len(backlog))
    assert len(sizes) == 1
    assert max(waiting[100:]) <= max(waiting[:100]) + 5
    assert count(bench) < 250


def count(bench: Bench) -> int:
    """The number of nodes without those for the map's links and dots, of which a larger map has more."""
    return sum("/map/links_" not in name and "/map/nodes_" not in name for name in bench.nodes())


def test_unwatched_it_draws_nothing(bench: Bench) -> None:
    before = len(bench.sent)
    bench.viewer.tick(fake_snapshot(460), bench.now_s + 10, watched=False)
    assert len(bench.sent) == before


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
