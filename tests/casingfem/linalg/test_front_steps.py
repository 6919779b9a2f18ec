"""One front, or some of one shape: elimination and substitution against dense matrices, number by number."""

from types import SimpleNamespace

import numpy as np
import pytest

from casingfem.linalg.multifrontal import Kept, add, eliminated, pivots
from casingfem.linalg.substitution import INVERTED, Block, Indefinite, OneFront, Stack, kernels

KINDS = pytest.mark.parametrize("complex_", [False, True])


def numbers(rng, complex_, *shape):
    """Random numbers, with imaginary parts if asked for, by columns in memory."""
    found = rng.standard_normal(shape) + (1j * rng.standard_normal(shape) if complex_ else 0.0)
    return np.asfortranarray(found)


def definite(rng, complex_, size):
    """A definite matrix with eigenvalues of one and more."""
    half = numbers(rng, complex_, size, size)
    return np.asfortranarray(half @ half.conj().T + np.eye(size))


def test_kernels_are_those_of_the_kind_of_numbers():
    assert kernels(np.ones(2)).adjoint == 1
    assert kernels(np.ones(2) * 1j).adjoint == 2


@KINDS
def test_the_inverse_of_a_tridiagonal_d_has_its_lower_entries_beside_and_their_conjugates_above(complex_):
    beside = np.array([0.5 + 2.0j, 0.0, -1.5 + 0.3j])
    beside = beside if complex_ else beside.real
    D = Indefinite(np.arange(4), np.array([2.0, -3.0, 0.7, 1.1]), beside)
    x = numbers(np.random.default_rng(1), complex_, 4, 3)
    dense = np.diag(D.diagonal) + np.diag(beside, -1) + np.diag(beside.conj(), 1)
    np.testing.assert_allclose(D.divided(x), dense @ x, rtol=1e-13)


@KINDS
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("rows", [[], [5, 9, 10]])
def test_a_front_by_itself_goes_forward_and_back_by_its_l(complex_, turned, rows):
    """L has a diagonal of ones, and pivots in another order, where D stands between; nothing above it is used."""
    rng = np.random.default_rng(7)
    L, below = numbers(rng, complex_, 4, 4) + 3.0 * np.eye(4), numbers(rng, complex_, len(rows), 4)
    order, D = np.array([2, 0, 3, 1]), None
    if turned:
        beside = numbers(rng, complex_, 3)
        D = Indefinite(order, rng.uniform(1.0, 2.0, 4), beside)
    step = OneFront(slice(1, 5), np.array(rows, dtype=int), Block(np.asfortranarray(L), below, D))
    assert step.block.L.size + step.block.below.size == 16 + 4 * len(rows)
    lower = np.tril(L, -1) + np.eye(4) if turned else np.tril(L)
    x = np.ascontiguousarray(numbers(rng, complex_, 12, 2))
    forth, back = x.copy(), x.copy()
    step.forward(forth)
    own = np.linalg.solve(lower, x[1:5][order] if turned else x[1:5])
    want = x.copy()
    want[1:5] = own
    want[rows] -= below @ own
    np.testing.assert_allclose(forth, want, rtol=1e-11, atol=1e-13)
    step.back(back)
    own = D.divided(x[1:5]) if turned else x[1:5]
    own = np.linalg.solve(lower.conj().T, own - below.conj().T @ x[rows])
    want = x.copy()
    want[np.arange(1, 5)[order] if turned else np.arange(1, 5)] = own
    np.testing.assert_allclose(back, want, rtol=1e-11, atol=1e-13)


@KINDS
@pytest.mark.parametrize(("k", "cuts"), [(3, [3]), (INVERTED, [64]), (INVERTED + 1, [32, 65]), (130, [43, 86, 130])])
@pytest.mark.parametrize("m", [0, 3])
def test_fronts_of_one_shape_go_the_ways_of_each_by_itself(complex_, k, cuts, m):
    """Blocks of 64 rows at most are inverted; fronts may share rows, and fewer may come than there is room for."""
    rng = np.random.default_rng(k)
    fronts = []
    for start in (1, 1 + k):
        L = np.asfortranarray(np.linalg.cholesky(definite(rng, complex_, k)) + np.triu(np.ones((k, k)), 1))
        rows = 2 * k + 1 + np.array([[0, 2, 3], [1, 2, 4]])[int(start > 1), :m]
        fronts.append((start, rows, Block(L, numbers(rng, complex_, m, k), None)))
    stack = Stack(3, (k, m), complex if complex_ else float)
    for front in fronts:
        stack.add(*front)
    step = stack.step()
    assert [cut.stop for cut in step.cuts] == cuts
    assert [cut.start for cut in step.cuts] == [0, *cuts[:-1]]
    assert step.L.size + step.below.size == 2 * k * (k + m)
    single = [OneFront(slice(start, start + k), rows, block) for start, rows, block in fronts]
    x = np.ascontiguousarray(numbers(rng, complex_, 2 * k + 7, 2))
    for way in ("forward", "back"):
        together, apart = x.copy(), x.copy()
        getattr(step, way)(together)
        for one in single:
            getattr(one, way)(apart)
        np.testing.assert_allclose(together, apart, rtol=1e-8, atol=1e-9 * np.abs(apart).max())
        assert np.abs(together - x)[1 : 2 * k + 1].min() > 0.0
        np.testing.assert_array_equal(together[[0, -1]], x[[0, -1]])


def parts(A, k):
    """Pivots, rows by pivots and rows by rows of a matrix, in its lower triangle: nan above."""
    A = np.where(np.tril(np.ones(A.shape)) > 0.0, A, np.nan)
    return (np.asfortranarray(part) for part in (A[:k, :k], A[k:, :k], A[k:, k:]))


@KINDS
@pytest.mark.parametrize("rows", [0, 3])
@pytest.mark.parametrize("kind", ["definite", "indefinite", "hollow", "negative"])
def test_elimination_leaves_the_schur_complement_and_tells_negative_pivots(complex_, rows, kind):
    """A hollow matrix has no pivot of one: each of two has one negative eigenvalue."""
    rng, k = np.random.default_rng(3), 6
    A = definite(rng, complex_, k + rows)
    pivot = A[:k, :k]
    if kind == "indefinite":
        A[:k, :k] = pivot - np.median(np.linalg.eigvalsh(pivot)) * np.eye(k)
    elif kind == "negative":
        A[:k, :k] = -pivot
    elif kind == "hollow":
        A[:k, :k] = pivot - np.diag(np.diag(pivot))
    whole = np.tril(A) + np.tril(A, -1).conj().T
    block, negative = eliminated(*(given := list(parts(whole, k))))
    K, below = whole[:k, :k], whole[k:, :k]
    assert negative == np.count_nonzero(np.linalg.eigvalsh(K) < 0.0)
    assert (block.D is None) == (kind == "definite")
    if rows:
        schur = whole[k:, k:] - below @ np.linalg.solve(K, below.conj().T)
        lower = np.tril_indices(rows)
        np.testing.assert_allclose(given[2][lower], schur[lower], rtol=1e-9, atol=1e-10)
    step = OneFront(slice(0, k), np.arange(k, k + rows), block)
    b = np.ascontiguousarray(numbers(rng, complex_, k, 2))
    x = np.vstack([b, np.zeros((rows, 2))])
    step.forward(x)
    x[k:] = 0.0
    step.back(x)
    np.testing.assert_allclose(x[:k], np.linalg.solve(K, b), rtol=1e-8, atol=1e-9)


def test_pivots_of_one_and_two_are_inverted_and_put_in_order():
    """The first row stays, then rows 2 and 3 are one pivot, the second of it exchanged with row 5, then 4 with 5."""
    swaps = np.array([1, -5, -5, 5, 5])
    D, negative = pivots(np.array([-2.0, 3.0, 1.0, 4.0, -0.5]), np.array([0.0, 1.0 + 2.0j, 0.0, 0.0]), swaps)
    assert D.order.tolist() == [0, 1, 4, 2, 3]
    np.testing.assert_allclose(D.diagonal, [-0.5, 1.0 / -2.0, 3.0 / -2.0, 0.25, -2.0], rtol=1e-15)
    np.testing.assert_allclose(D.beside, [0.0, (1.0 + 2.0j) / 2.0, 0.0, 0.0], rtol=1e-15)
    assert negative == 3


@pytest.mark.parametrize("below", [True, False])
@pytest.mark.parametrize("columns", [np.array([0, 2, 3]), slice(1, 4)])
def test_a_childs_update_is_added_where_its_rows_are(below, columns):
    """Of each run of rows the columns up to its last row, or all where columns are other unknowns."""
    K, update = np.zeros((6, 5), order="F"), np.asfortranarray(np.arange(1.0, 10.0).reshape(3, 3))
    runs = ((slice(0, 2), slice(2, 4)), (slice(2, 3), slice(5, 6)))
    add(K, runs, columns, update, below)
    add(K, runs, columns, update, below)
    want, where = np.zeros((6, 5)), [0, 2, 3] if isinstance(columns, np.ndarray) else [1, 2, 3]
    for row, (to, last) in enumerate(((2, 2), (3, 2), (5, 3))):
        kept = where[: last if below else 3]
        want[to, kept] = 2.0 * update[row, : len(kept)]
    np.testing.assert_array_equal(K, want)


class Planned:
    """Two fronts of one shape at the leaves, one by itself higher up, and one above all."""

    class groups:  # noqa: N801
        of, heights, counts = np.array([1, 0, 1, 2]), np.array([3, 0, 5]), np.array([1, 2, 1])


def test_fronts_of_a_shape_are_stacked_from_two_on_and_the_lowest_come_first():
    """Not those that Cholesky could not factor, nor those without pivots."""
    turned = Block(np.eye(2, order="F"), np.ones((1, 2), order="F"), Indefinite(np.arange(2), np.ones(2), np.zeros(1)))
    plain, kept = turned._replace(D=None), Kept(Planned, np.dtype(float))
    for number, start, row, block in ((3, 6, 9, plain), (0, 0, 8, plain), (2, 4, 8, turned), (1, 2, 7, plain)):
        front = SimpleNamespace(start=start, pivots=2, rows=np.array([row]), size=(2, 1))
        kept.take(number, front, block)
    steps = kept.steps()
    assert [type(step).__name__ for step in steps] == ["AlikeFronts", "OneFront", "OneFront", "OneFront"]
    assert steps[0].pivots.tolist() == [[0, 1]]
    assert steps[0].rows.tolist() == [[8]]
    assert [step.pivots for step in steps[1:]] == [slice(4, 6), slice(2, 4), slice(6, 8)]
    empty = SimpleNamespace(start=4, pivots=0, rows=np.array([8]), size=(0, 1))
    kept.take(2, empty, Block(np.zeros((0, 0)), np.zeros((1, 0)), None))
    assert kept.single[2].pivots == slice(4, 4)
