"""The links at each node against a list of lists."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core.pose_graph.adjacency import Adjacency


class Lists:
    """The same with plain lists."""

    def __init__(self) -> None:
        self.halves: list[list[tuple[int, int]]] = []
        self.ends: dict[int, tuple[int, int]] = {}

    def check(self, adjacency: Adjacency) -> None:
        for node, expected in enumerate(self.halves):
            halves, others = adjacency.at(node)
            assert list(zip(halves.tolist(), others.tolist(), strict=True)) == expected
            assert adjacency.degree(node) == len(expected)


@settings(max_examples=150)
@given(st.data())
@pytest.mark.slow
def test_links_come_and_go_as_in_lists(data: st.DataObject) -> None:
    """Nodes, links, removals, and rows used again, in any order; links from a node to itself and parallel ones, too."""
    adjacency, lists, changes = Adjacency(), Lists(), 0
    for _ in range(data.draw(st.integers(1, 80))):
        changes += 1
        what = data.draw(st.sampled_from(["node", "link", "link", "link", "remove"]))
        n = len(lists.halves)
        if what == "node" or n == 0:
            adjacency.add_node()
            lists.halves.append([])
        elif what == "link":
            i, j = data.draw(st.integers(0, n - 1)), data.draw(st.integers(0, n - 1))
            row = next(k for k in range(len(lists.ends) + 1) if k not in lists.ends)
            adjacency.add_link(i, j, row)
            lists.halves[i].append((2 * row, j))
            lists.halves[j].append((2 * row + 1, i))
            lists.ends[row] = i, j
        elif lists.ends:
            row = data.draw(st.sampled_from(sorted(lists.ends)))
            i, j = lists.ends.pop(row)
            adjacency.remove_link(i, j, row)
            lists.halves[i].remove((2 * row, j))
            lists.halves[j].remove((2 * row + 1, i))
        else:
            changes -= 1  # there was nothing to remove
    lists.check(adjacency)
    assert adjacency.changes == changes


def test_thousands_of_links_grow_the_arena() -> None:
    adjacency, lists = Adjacency(), Lists()
    n = 2500
    for _ in range(n):
        adjacency.add_node()
        lists.halves.append([])
    links = [(k, k + 1) for k in range(n - 1)] + [(k + 2, k) for k in range(n - 2)] + [(7, k) for k in range(300)]
    for row, (i, j) in enumerate(links):
        adjacency.add_link(i, j, row)
        lists.halves[i].append((2 * row, j))
        lists.halves[j].append((2 * row + 1, i))
    lists.check(adjacency)
    assert len(adjacency.half) < 8 * 4 * n


@pytest.mark.parametrize("bad", [(-1, 0), (0, 2), (2, 0)])
def test_a_link_joins_nodes_that_there_are(bad: tuple[int, int]) -> None:
    adjacency = Adjacency()
    adjacency.add_node()
    adjacency.add_node()
    with pytest.raises(ValueError, match="a link must join nodes from 0 to 1, got"):
        adjacency.add_link(*bad, 0)


@pytest.mark.parametrize("bad", [(0, 1, 1), (1, 0, 0), (0, 5, 0), (-1, 1, 0)])
def test_only_a_link_that_is_there_can_be_removed(bad: tuple[int, int, int]) -> None:
    adjacency = Adjacency()
    adjacency.add_node()
    adjacency.add_node()
    adjacency.add_link(0, 1, 0)
    with pytest.raises(ValueError, match=rf"row {bad[2]} must link {bad[0]} to {bad[1]} to be removed"):
        adjacency.remove_link(*bad)
    assert adjacency.at(0)[0].tolist() == [0]
    assert adjacency.at(1)[0].tolist() == [1]


@pytest.mark.parametrize("nodes", [1024, 1025, 1026, 2049])
def test_the_last_node_has_room_in_the_arena(nodes: int) -> None:
    adjacency = Adjacency()
    for _ in range(nodes):
        adjacency.add_node()
    for row in range(4):
        adjacency.add_link(row, nodes - 1, row)
    assert adjacency.at(nodes - 1)[1].tolist() == [0, 1, 2, 3]
