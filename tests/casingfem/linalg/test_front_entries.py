"""Plans of fronts against symbolic elimination in dense matrices: structures, entries, places in parents."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csc_array
from test_element_sum import strips
from test_multifrontal import grid

from casingfem.linalg import dissection
from casingfem.linalg import fronts as plans
from casingfem.linalg.dissection import quotient
from casingfem.linalg.element_sum import Elements, ElementSum
from casingfem.linalg.entries import element_graph
from casingfem.linalg.fronts import Fronts, Recent, plan, planned


def edges(graph):
    return sorted(zip(graph.tail.tolist(), graph.head.tolist(), strict=True))


def test_unknowns_that_share_their_elements_are_one_vertex():
    """Unknown 6 is held, 5 belongs to no element."""
    dofs = [np.array([[0, 1, 6], [1, 2, 6]]), np.array([[3, 4, 2]])]
    A = ElementSum.of([Elements(part, np.ones((len(part), 3, 3))) for part in dofs], 6)
    vertex, graph = element_graph(A)
    v = vertex.tolist()
    assert v[3] == v[4]
    assert len(set(v)) == graph.size == 5
    assert [int(graph.weight[k]) for k in v] == [1, 1, 1, 2, 2, 1]
    joined = [(v[0], v[1]), (v[1], v[2]), (v[2], v[3])]
    assert edges(graph) == sorted(joined + [(b, a) for a, b in joined])
    assert np.all(np.diff(graph.tail) >= 0)


@pytest.mark.parametrize("chunk", [1, 4, 10**6])
def test_unknowns_of_one_pattern_are_one_vertex_whatever_is_read_at_once(monkeypatch, chunk):
    """Columns 1 and 4 are alike; 2 and 5 are empty."""
    monkeypatch.setattr(dissection, "CHUNK", chunk)
    A = np.zeros((6, 6))
    for some in ((0, 1, 4), (1, 3, 4)):
        A[np.ix_(some, some)] = 1.0
    vertex, graph = quotient(csc_array(A))
    v = vertex.tolist()
    assert v[1] == v[4]
    assert v[2] == v[5]
    assert len(set(v)) == graph.size == 4
    assert [int(graph.weight[k]) for k in v] == [1, 2, 2, 1, 2, 2]
    joined = [(v[0], v[1]), (v[1], v[3])]
    assert edges(graph) == sorted(joined + [(b, a) for a, b in joined])


def sparse():
    A = grid(24, 16)
    A.data[:] = np.random.default_rng(1).standard_normal(len(A.data))
    A = csc_array(A + A.T)
    return A, A.toarray()


def elements():
    A = strips(4).scaled(np.linspace(0.5, 2.0, strips(4).size)).plus(-3.0)
    return A, A.tocsc().toarray()


@pytest.fixture(scope="module", params=[sparse, elements])
def planned_matrix(request):
    A, dense = request.param()
    fronts = plan(A)
    assert len(fronts.fronts) > 4
    return A, fronts, dense[np.ix_(fronts.order, fronts.order)]


def test_the_rows_of_a_front_are_those_that_elimination_fills(planned_matrix):
    _, fronts, dense = planned_matrix
    filled, start = dense != 0.0, 0
    for front in fronts.fronts:
        assert front.start == start
        start = end = start + front.pivots
        rows = end + np.flatnonzero(filled[end:, front.start : end].any(axis=1))
        np.testing.assert_array_equal(front.rows, rows)
        filled[np.ix_(rows, rows)] = True
        assert front.size == (front.pivots, len(rows))
    assert start == len(dense)
    assert sorted(fronts.order.tolist()) == list(range(len(dense)))


def test_the_parts_of_all_fronts_add_up_to_the_matrix(planned_matrix):
    A, fronts, dense = planned_matrix
    total = np.zeros(dense.shape)
    for front in fronts.fronts:
        p = np.arange(front.start, front.start + front.pivots)
        K_pp, K_rp, K_rr = front.own.parts(A, fronts.order[p], fronts.order[front.rows])
        total[np.ix_(p, p)] += np.tril(K_pp)
        total[np.ix_(front.rows, p)] += K_rp
        total[np.ix_(front.rows, front.rows)] += np.tril(K_rr)
    np.testing.assert_allclose(total, np.tril(dense), atol=1e-12)


def places(where):
    return np.arange(where.start, where.stop) if isinstance(where, slice) else where


def test_a_child_knows_its_rows_in_its_parent(planned_matrix):
    _, fronts, _ = planned_matrix
    heights, parents = [], set()
    for front in fronts.fronts:
        end = front.start + front.pivots
        heights.append(max((heights[child] + 1 for child in front.children), default=0))
        for number in front.children:
            child = fronts.fronts[number]
            head, tail = child.rows[: child.split], child.rows[child.split :]
            assert np.all(head < end)
            assert np.all(tail >= end)
            np.testing.assert_array_equal(places(child.head), head - front.start)
            np.testing.assert_array_equal(front.rows[places(child.tail)], tail)
            for runs, whole in ((child.head_runs, places(child.head)), (child.tail_runs, places(child.tail))):
                pieces = [np.column_stack([places(there), places(here)]) for there, here in runs]
                pairs = np.vstack([np.zeros((0, 2), int), *pieces])
                np.testing.assert_array_equal(pairs, np.column_stack([np.arange(len(whole)), whole]))
            parents.add(number)
    assert len(parents) == len(fronts.fronts) - 1  # the last is nobody's child
    groups = fronts.groups
    assert [int(groups.heights[g]) for g in groups.of] == heights
    keys = [(h, *front.size) for h, front in zip(heights, fronts.fronts, strict=True)]
    assert [int(groups.counts[g]) for g in groups.of] == [keys.count(key) for key in keys]


def test_what_children_passed_on_is_given_back_when_their_parent_has_taken_it():
    """Of 3 and 2 rows, then of 1: the last front stands beside one number, and is the largest."""
    sizes, children = ((2, 3), (1, 2), (3, 1), (5, 0)), ((), (), (0, 1), (2,))
    own = [SimpleNamespace(size=s, rows=range(s[1]), children=c) for s, c in zip(sizes, children, strict=True)]
    assert Fronts((), np.arange(11), tuple(own)).working() == 1 + 25 + 25
    assert Fronts((), np.arange(6), tuple(own[:3])).working() == 9 + 4 + 16 + 12


@pytest.mark.parametrize(("room", "kept"), [(0, True), (-1, False)])
def test_a_plan_that_nobody_holds_is_kept_up_to_a_size_of_its_pattern(monkeypatch, room, kept):
    A = grid(6, 5)
    for name in ("last", "small"):
        monkeypatch.setattr(Recent, name, None)
    monkeypatch.setattr(plans, "SMALL", len(A.indptr) + len(A.indices) + room)
    planned(A)
    assert (Recent.last() is not None) == kept
