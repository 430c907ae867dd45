"""Graphs of others: the relations of the Intel Research Lab, and g2o files."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.back_end.graph import Graph, between, compose, measured

Edge = tuple[int, int, float, float, float, float]  # from, to, dx, dy, turn, sigma (m)


def intel(folder: Path) -> Graph | None:
    """Places and relations of the Intel Research Lab, measured with the usual noise; None where there is no such file.

    The relations are the reference of the lab's benchmark: two times and the movement between them. They agree with one
    another, so the noise is ours.
    """
    file = folder / "logs" / "intel" / "intel.relations"
    if not file.is_file():
        return None
    raw = np.loadtxt(file)
    times = np.unique(raw[:, :2])
    ends = np.searchsorted(times, raw[:, :2])
    moves = raw[:, [2, 3, 7]]
    truth = _placed(len(times), list(zip(ends.tolist(), moves, strict=True)))
    later = ends[:, 1] > ends[:, 0] + 1
    return measured("Intel", truth, ends[later].astype(np.int64), np.random.default_rng(3))


def _placed(count: int, relations: list[tuple[list[int], np.ndarray]]) -> np.ndarray:
    """Each place from the one before it, or where that is not related, from any place before."""
    to: dict[int, tuple[int, np.ndarray]] = {}
    for (i, j), move in relations:
        if i < j and (j not in to or to[j][0] < i):
            to[j] = i, move
    poses = np.zeros((count, 3))
    for k in range(1, count):
        start, move = to.get(k, (k - 1, np.zeros(3)))
        poses[k] = compose(poses[start], move)
    return poses


def g2o_files(folder: Path, given: list[Path]) -> Iterator[Path]:
    """The files given, and those in the folder."""
    yield from given
    if folder.is_dir():
        yield from sorted(folder.rglob("*.g2o"))


def read_g2o(file: Path) -> Graph:
    """The graph in a g2o file of 2-D poses. ValueError names the file, the line and what is wrong with it."""
    vertices: dict[int, tuple[float, float, float]] = {}
    edges: list[Edge] = []
    for number, line in enumerate(file.read_text(encoding="ascii", errors="replace").splitlines(), 1):
        words = line.split()
        try:
            if words[:1] == ["VERTEX_SE2"]:
                x, y, heading = (float(word) for word in words[2:5])
                vertices[int(words[1])] = x, y, heading
            elif words[:1] == ["EDGE_SE2"]:
                dx, dy, turn, information = (float(word) for word in words[3:7])
                edges.append((int(words[1]), int(words[2]), dx, dy, turn, 1 / math.sqrt(information)))
        except (ValueError, ZeroDivisionError, IndexError) as error:
            raise ValueError(
                f"{file}: line {number}: {error}; expected VERTEX_SE2 or EDGE_SE2 with its numbers"
            ) from None
    if len(vertices) < 2 or not edges:
        raise ValueError(
            f"{file}: {len(vertices)} vertices and {len(edges)} edges of 2-D poses; at least 2 and 1 are needed"
        )
    return _graph(file.stem, vertices, edges)


def _graph(name: str, vertices: dict[int, tuple[float, float, float]], edges: list[Edge]) -> Graph:
    """The edges between one vertex and the next are the backbone, the others closures.

    Where the backbone has a gap, the first guess of the file bridges it and weighs nothing.
    """
    number = {vertex: k for k, vertex in enumerate(sorted(vertices))}
    guess = np.array([vertices[vertex] for vertex in sorted(vertices)])
    backbone = between(guess[:-1], guess[1:])
    sigma = np.full(len(backbone), math.inf)
    ends: list[tuple[int, int]] = []
    moves: list[tuple[float, float, float]] = []
    sigmas: list[float] = []
    for from_, to, dx, dy, turn, edge_sigma in edges:
        i, j = number[from_], number[to]
        if j == i + 1 and math.isinf(sigma[i]):
            backbone[i], sigma[i] = (dx, dy, turn), edge_sigma
        else:
            ends.append((i, j))
            moves.append((dx, dy, turn))
            sigmas.append(edge_sigma)
    return Graph(
        name, backbone, sigma, np.array(ends, np.int64).reshape(-1, 2), np.array(moves).reshape(-1, 3), np.array(sigmas)
    )
