"""Nested dissection by hand: distances, vertices of equal columns, every cut against brute force, and the tree."""

from collections import deque

import numpy as np
import pytest
from scipy.sparse import csc_array

from casingfem.linalg.dissection import Graph, best_cuts, coordinates, dissect, distances, quotient, spans
from casingfem.linalg.entries import accumulate, compact
from casingfem.linalg.fronts import later_neighbours, postorder, runs


def graph(size, edges, weight=None):
    """A graph of edges in both directions, sorted by tail."""
    both = sorted({(a, b) for a, b in edges} | {(b, a) for a, b in edges})
    tail, head = np.ascontiguousarray(np.array(both, dtype=np.int64).reshape(-1, 2).T)
    return Graph(np.ones(size, dtype=np.int64) if weight is None else np.array(weight), tail, head)


def path(size):
    return graph(size, [(k, k + 1) for k in range(size - 1)])


def grid(rows, columns):
    at = np.arange(rows * columns).reshape(rows, columns)
    edges = [
        *zip(at[:, :-1].ravel(), at[:, 1:].ravel(), strict=True),
        *zip(at[:-1].ravel(), at[1:].ravel(), strict=True),
    ]
    return graph(at.size, edges)


def random_graph(seed, size=14, edges=20):
    rng = np.random.default_rng(seed)
    pairs = rng.integers(size, size=(edges, 2))
    return graph(size, [(int(a), int(b)) for a, b in pairs if a != b], rng.integers(1, 5, size=size))


def walked(given, sources):
    """Distances by a queue."""
    away, waiting = dict.fromkeys(sources, 0), deque(sources)
    while waiting:
        here = waiting.popleft()
        for there in given.head[given.tail == here].tolist():
            if there not in away:
                away[there] = away[here] + 1
                waiting.append(there)
    return away


@pytest.mark.parametrize("sources", [[0], [7, 2], [11]])
def test_distances_are_those_to_the_nearest_source(sources):
    given = grid(3, 4)
    found = distances(given, np.array(sources))
    assert found.tolist() == [walked(given, sources)[k] for k in range(12)]


def test_each_piece_of_a_graph_is_walked_from_its_own_source():
    given = graph(7, [(0, 1), (1, 2), (4, 5), (5, 6)])
    assert distances(given, np.array([2, 3, 4])).tolist() == [2, 1, 0, 0, 0, 1, 2]


def test_edges_of_a_vertex_start_where_those_before_end():
    given = graph(5, [(0, 1), (1, 2), (1, 4)])
    assert given.first.tolist() == [0, 1, 4, 5, 5, 6]
    assert given.size == 5


def test_unknowns_of_equal_columns_are_one_vertex():
    """Two nodes of two unknowns, coupled with each other; one that nothing is coupled with; one beside the second."""
    A = np.zeros((6, 6))
    A[:4, :4] = 1.0
    A[2:4, 5] = A[5, 2:4] = 1.0
    A[4, 4] = A[5, 5] = 1.0
    vertex, found = quotient(csc_array(A))
    a, b, c, d = vertex[[0, 2, 4, 5]]
    assert vertex.tolist() == [a, a, b, b, c, d]
    assert len({a, b, c, d}) == found.size == 4
    assert found.weight[[a, b, c, d]].tolist() == [2, 2, 1, 1]
    assert set(zip(found.tail.tolist(), found.head.tolist(), strict=True)) == {(a, b), (b, a), (b, d), (d, b)}
    assert np.all(np.diff(found.tail) >= 0)


def test_spans_follow_each_other_and_empty_ones_are_left_out():
    assert spans(np.array([7, 3, 0]), np.array([2, 0, 3])).tolist() == [7, 8, 0, 1, 2]
    assert spans(np.zeros(0, dtype=int), np.zeros(0, dtype=int)).tolist() == []


def test_a_path_is_unrolled_along_its_first_coordinate():
    x = coordinates(path(30))
    assert x.shape == (6, 30)
    steps = np.diff(x[0])
    assert np.all(steps > 0.0) or np.all(steps < 0.0)
    np.testing.assert_allclose(x.mean(axis=1), 0.0, atol=1e-9)
    spread = np.sum(x**2, axis=1)
    assert np.all(np.diff(spread) <= 1e-9 * spread[0])
    np.testing.assert_allclose(x @ x.T, np.diag(spread), atol=1e-8 * spread[0])


def test_pieces_have_a_coordinate_of_their_own():
    given = graph(9, [(0, 1), (1, 2), (3, 4), (4, 5), (5, 6), (6, 7)])  # and vertex 8 by itself
    x = coordinates(given)
    assert x.shape == (7, 9)
    assert x[0].tolist() == [0, 0, 0, 1, 1, 1, 1, 1, 2]
    assert coordinates(graph(1, [])).tolist() == [[0.0]]


def brute_cut(x, part, weight, given, number):
    """The least of all cuts of a part: the separator of either side, dearer the more uneven, below 3/4 on a side."""
    own = np.flatnonzero(part == number)
    total, best = weight[own].sum(), np.inf
    for place in np.unique(x[own])[:-1]:
        low = set(own[x[own] <= place].tolist())
        high = set(own.tolist()) - low
        for kept, other in ((low, high), (high, low)):
            touching = {
                a for a, b in zip(given.tail.tolist(), given.head.tolist(), strict=True) if a in kept and b in other
            }
            separator = sum(weight[list(touching)])
            sides = sum(weight[list(kept)]) - separator, sum(weight[list(other)])
            share = max(sides) / total
            if min(sides) > 0 and share < 0.75:
                best = min(best, separator * (1.0 + 4.0 * max(share - 0.5, 0.0)))
    return best


@pytest.mark.parametrize("seed", range(6))
def test_the_best_cut_of_each_part_is_the_cheapest_of_all(seed):
    rng = np.random.default_rng(100 + seed)
    whole = random_graph(seed)
    part = rng.integers(2, size=whole.size)
    part[:2] = 0, 1
    inside = part[whole.tail] == part[whole.head]
    given = Graph(whole.weight, whole.tail[inside], whole.head[inside])
    x = rng.integers(6, size=whole.size) * 0.5 - 1.0
    found = best_cuts(x, part, given.weight, given.tail, given.head, 2)
    for number in (0, 1):
        cost = brute_cut(x, part, given.weight, given, number)
        assert found.cost[number] == pytest.approx(cost)
        if np.isinf(cost):
            continue
        own = np.flatnonzero(part == number)
        low = own[found.rank[own] <= found.last[number]]
        high = own[found.rank[own] > found.last[number]]
        kept, other = (high, low) if found.above[number] else (low, high)
        touching = [v for v in kept if np.isin(given.head[given.tail == v], other).any()]
        separator, total = given.weight[touching].sum(), given.weight[own].sum()
        share = max(given.weight[kept].sum() - separator, given.weight[other].sum()) / total
        assert separator * (1.0 + 4.0 * max(share - 0.5, 0.0)) == pytest.approx(cost)
    assert np.array_equal(np.unique(found.rank), np.arange(found.rank.max() + 1))


def test_vertices_at_one_place_have_one_rank_within_their_part():
    found = best_cuts(
        np.array([2.0, 1.0, 1.0, 1.0]), np.array([0, 0, 0, 1]), np.ones(4, int), *np.zeros((2, 0), int), 2
    )
    assert found.rank.tolist() == [1, 0, 0, 2]


def test_a_path_is_halved_at_its_middle_again_and_again():
    """Of 7 vertices the middle one is the root, the middles of both halves its children, then single ones."""
    node, parent = dissect(path(7), np.arange(7.0)[None], leaf=1)
    assert parent[0] == -1
    root, halves = node[3], node[[1, 5]]
    assert root == 0
    assert parent[halves].tolist() == [0, 0]
    assert parent[node[[0, 2, 4, 6]]].tolist() == [halves[0], halves[0], halves[1], halves[1]]
    assert len(parent) == 7


@pytest.mark.parametrize(("leaf", "nodes"), [(7, 1), (6, 3), (3, 3), (2, 7)])
def test_parts_up_to_a_leaf_are_not_cut(leaf, nodes):
    _, parent = dissect(path(7), np.arange(7.0)[None], leaf=leaf)
    assert len(parent) == nodes


def test_a_cut_follows_the_coordinate_of_least_separator():
    """Three by seven: across the short way, three vertices at the middle of the long one."""
    rows, columns = np.divmod(np.arange(21), 7)
    node, _ = dissect(grid(3, 7), np.array([rows, columns], dtype=float), leaf=9)
    assert np.flatnonzero(node == 0).tolist() == [3, 10, 17]


def test_what_is_as_dear_to_part_as_to_keep_stays_whole():
    """All coupled with all: any separator takes more than half."""
    pairs = [(a, b) for a in range(8) for b in range(a)]
    node, parent = dissect(graph(8, pairs), np.arange(8.0)[None], leaf=2)
    assert node.tolist() == [0] * 8
    assert len(parent) == 1


@pytest.mark.parametrize("seed", range(4))
def test_neighbours_stand_above_each_other_in_the_tree(seed):
    given = random_graph(seed, 40, 60)
    node, parent = dissect(given, coordinates(given), leaf=6)

    def line(v):
        found = [int(node[v])]
        while parent[found[-1]] >= 0:
            found.append(int(parent[found[-1]]))
        return found

    for a, b in zip(given.tail, given.head, strict=True):
        assert node[a] in line(b) or node[b] in line(a)
    assert np.all(parent[1:] < np.arange(1, len(parent)))


def test_children_come_before_their_parents_and_next_to_them():
    parent = np.array([-1, 0, 0, 1, 1, 2])
    number = postorder(parent)
    assert number[0] == 5
    assert sorted(number.tolist()) == list(range(6))
    for subtree in ((1, 3, 4), (2, 5)):
        own = sorted(number[list(subtree)].tolist())
        assert own[-1] - own[0] == len(own) - 1
        assert number[subtree[0]] == own[-1]


def test_later_neighbours_of_a_front_stand_after_its_own_vertices():
    """Fronts of places 0-1, 2, 3-4; the edges by place: 0-2, 1-4, 2-3, 3-4."""
    place = np.array([1, 3, 0, 4, 2])
    at = np.argsort(place)
    edges = [(int(at[a]), int(at[b])) for a, b in ((0, 2), (1, 4), (2, 3), (3, 4), (0, 1), (1, 2))]
    given = graph(5, edges)
    found = later_neighbours(given.tail, given.head, place, np.array([0, 2, 3, 5]))
    assert [part.tolist() for part in found] == [[2, 4], [3], []]


def test_places_that_follow_each_other_are_a_slice():
    assert compact(np.array([4, 5, 6])) == slice(4, 7)
    assert compact(np.array([3])) == slice(3, 4)
    for places in ([4, 6], [5, 4], [4, 6, 5, 7], []):
        assert np.array_equal(compact(np.array(places, dtype=int)), places)
    assert runs(np.zeros(0, dtype=int)) == ()
    assert runs(np.array([2, 3, 5])) == ((slice(0, 2), slice(2, 4)), (slice(2, 3), slice(5, 6)))


@pytest.mark.parametrize("empty", [True, False])
@pytest.mark.parametrize("rows", [slice(1, 3), np.array([3, 0])])
@pytest.mark.parametrize("columns", [slice(0, 2), np.array([2, 0])])
def test_a_part_is_added_scaled(rows, columns, empty):
    left, right, part = np.array([1.0, 2.0, 3.0, 5.0]), np.array([7.0, 0.5, 4.0]), np.array([[1.0, 2.0], [3.0, 4.0]])
    K = np.zeros((4, 3)) if empty else np.arange(12.0).reshape(4, 3)
    expected = K.copy()
    for i, row in enumerate(np.arange(4)[rows]):
        for j, column in enumerate(np.arange(3)[columns]):
            expected[row, column] += left[row] * part[i, j] * right[column]
    accumulate(K, rows, columns, part, left, right, empty)
    np.testing.assert_allclose(K, expected, rtol=1e-15)
