"""The links at each node against a list of lists."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core.pose_graph.transitions import Adjacency


class Lists:
    """The same with plain lists."""

    def __init__(self, nodes: int = 0) -> None:
        self.halves: list[list[tuple[int, int]]] = [[] for _ in range(nodes)]
        self.ends: dict[int, tuple[int, int]] = {}

    def link(self, i: int, j: int, row: int) -> None:
        self.halves[i].append((2 * row, j))
        self.halves[j].append((2 * row + 1, i))
        self.ends[row] = i, j

    def check(self, adjacency: Adjacency) -> None:
        for node, expected in enumerate(self.halves):
            halves, others = adjacency.at(node)
            assert list(zip(halves.tolist(), others.tolist(), strict=True)) == expected
            assert adjacency.degree(node) == len(expected)


@settings(max_examples=100)
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
            lists.link(i, j, row)
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
    n = 2500
    adjacency, lists = Adjacency(), Lists(n)
    for _ in range(n):
        adjacency.add_node()
    links = [(k, k + 1) for k in range(n - 1)] + [(k + 2, k) for k in range(n - 2)] + [(7, k) for k in range(300)]
    for row, (i, j) in enumerate(links):
        adjacency.add_link(i, j, row)
        lists.link(i, j, row)
    lists.check(adjacency)
    assert len(adjacency.half) < 8 * 4 * n


def test_a_link_joins_nodes_that_there_are_and_only_one_that_is_there_can_be_removed() -> None:
    adjacency = Adjacency()
    for _ in range(2):
        adjacency.add_node()
    for ends in ((-1, 0), (0, 2), (2, 0)):
        with pytest.raises(ValueError, match="a link must join nodes from 0 to 1, got"):
            adjacency.add_link(*ends, 0)
    adjacency.add_link(0, 1, 0)
    for i, j, row in ((0, 1, 1), (1, 0, 0), (0, 5, 0), (-1, 1, 0)):
        with pytest.raises(ValueError, match=rf"row {row} must link {i} to {j} to be removed"):
            adjacency.remove_link(i, j, row)
        assert [adjacency.at(node)[0].tolist() for node in (0, 1)] == [[0], [1]]


def test_the_last_node_has_room_in_the_arena() -> None:
    for nodes in (1024, 1025, 1026, 2049):
        adjacency = Adjacency()
        for _ in range(nodes):
            adjacency.add_node()
        for row in range(4):
            adjacency.add_link(row, nodes - 1, row)
        assert adjacency.at(nodes - 1)[1].tolist() == [0, 1, 2, 3]
