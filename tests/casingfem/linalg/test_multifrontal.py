"""Dense fronts: solutions and inertia against dense arithmetic, ordering against SuperLU's, memory foreseen."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csc_array, diags_array, eye_array, kron
from test_eigen import consistent_mass

import casingfem as cf
from casingfem.linalg import factor as factors
from casingfem.linalg import fronts as plans
from casingfem.linalg.dissection import LEAF
from casingfem.linalg.factor import factorise
from casingfem.linalg.fronts import Fronts, longest, plan, planned
from casingfem.linalg.memory import MemoryNeedError, free_memory
from casingfem.linalg.multifrontal import factored
from casingfem.linalg.substitution import AlikeFronts, OneFront


def random_matrix(size, density, shift, seed, turned=False):
    """Symmetric, or Hermitian by random phases: about `density` entries anywhere, and a diagonal of some size."""
    rng = np.random.default_rng(seed)
    A = np.where(rng.random((size, size)) < density, rng.standard_normal((size, size)), 0.0)
    if turned:
        A = A * np.exp(2j * np.pi * rng.random((size, size)))
    return A + A.conj().T + np.diag(rng.standard_normal(size) + shift)


def grid(*counts):
    """Consistent mass of bilinear (trilinear) elements on a grid of nodes, two coupled unknowns each."""
    A = csc_array(np.array([[2.0, -1.0], [-1.0, 2.0]]))
    for count in counts:
        A = kron(A, consistent_mass(count))
    return csc_array(A)


@pytest.mark.slow
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("size", "density", "shift"), [
    (1, 1.0, 0.0), (2, 1.0, 0.0), (7, 0.5, 0.0), (60, 0.1, 3.0), (500, 0.01, 0.0), (700, 0.003, 3.0),
    (700, 0.0003, 0.5),
])  # fmt: skip
def test_solutions_and_inertia_are_the_dense_ones(size, density, shift, turned):
    dense = random_matrix(size, density, shift, size + 11, turned)
    A = csc_array(dense)
    factor = factorise(A)
    b = np.random.default_rng(5).standard_normal((size, 3))
    x = factor.solve(b)
    np.testing.assert_allclose(x, np.linalg.solve(dense, b), rtol=1e-6, atol=1e-8 * np.abs(x).max())
    np.testing.assert_allclose(factor.solve(b[:, 1]), x[:, 1], rtol=1e-7, atol=1e-9 * np.abs(x).max())
    negative = int(np.count_nonzero(np.linalg.eigvalsh(dense) < 0.0))
    assert factor.negative() == factorise(A, keep=False).negative() == factorise(A, "superlu").negative() == negative


def test_complex_right_hand_sides_of_a_real_matrix():
    dense = random_matrix(60, 0.1, 3.0, seed=4)
    b = np.random.default_rng(5).standard_normal((60, 2, 2)) @ [1.0, 2.0j]
    np.testing.assert_allclose(factorise(csc_array(dense)).solve(b), np.linalg.solve(dense, b), rtol=1e-9)


def test_entries_may_are_in_any_order_and_twice():
    A = csc_array(random_matrix(300, 0.02, 3.0, seed=8))
    mixed = [np.concatenate([np.arange(a, b)[::-1], [a]]) for a, b in pairwise(A.indptr.tolist())]
    entries = np.concatenate(mixed)
    halves = np.where(entries == np.repeat(A.indptr[:-1], np.diff(A.indptr) + 1), 0.5, 1.0) * A.data[entries]
    disordered = csc_array((halves, A.indices[entries], A.indptr + np.arange(301)), shape=A.shape)
    b = np.arange(300.0)
    np.testing.assert_allclose(factorise(disordered).solve(b), factorise(A).solve(b), rtol=1e-10)


def test_pivots_of_two():
    """No pivot of one exists in [[0, 1], [1, 0]]: one eigenvalue is negative in each block."""
    A = csc_array(kron(eye_array(200), csc_array([[0.0, 1.0], [1.0, 0.0]])))
    factor = factorise(A)
    b = np.arange(400.0)
    np.testing.assert_array_equal(factor.solve(b), b.reshape(-1, 2)[:, ::-1].ravel())
    assert factor.negative() == 200


def test_the_same_matrix_twice_gives_the_same_bits():
    A, b = grid(9, 8, 7), np.ones((1008, 4))
    first, second = (factored(A, plan(A)).solve(b) for _ in range(2))
    np.testing.assert_array_equal(first, second)
    np.testing.assert_allclose(A @ first, b, atol=1e-11)


@pytest.mark.parametrize("counts", [(60, 60), (16, 16, 16), (10, 10, 30)])
@pytest.mark.slow
def test_the_dissection_does_not_fill_more_than_dense_leaves_explain(counts):
    """Against SuperLU's minimum degree: what is beyond its L are leaves, taken as dense matrices of `LEAF` or fewer."""
    A = grid(*counts)
    fronts = plan(A)
    assert sorted(fronts.order.tolist()) == list(range(A.shape[0]))
    inner = sum(k * (k + 1) // 2 + k * m for k, m in (f.size for f in fronts.fronts if f.children))
    assert inner < 1.1 * factorise(A, "superlu").lu.L.nnz
    assert max(f.pivots for f in fronts.fronts if not f.children) <= LEAF


@pytest.mark.slow
def test_a_casing_is_cut_along_lines_of_elements(frustum):
    """No front sees more nodes beside its own than lie on the free sides of an element; L is as short as SuperLU's.

    The distances unroll the ring; cuts through elements would keep their whole interior in a separator.
    """
    system = cf.shell.assemble(frustum(mesh=cf.ShellMesh(order=6, rows=1, around=21)))
    fronts = plan(system.K)
    assert max(len(front.rows) for front in fronts.fronts) <= 5 * (3 * 7 - 2 + 5)
    entries = sum(k * (k + 1) // 2 + k * m for k, m in (front.size for front in fronts.fronts))
    assert entries < 1.01 * factorise(system.K, "superlu").lu.L.nnz


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("shift", [0.0, 20.0])
def test_fronts_of_one_shape_are_solved_together_or_where_indefinite_alone(shift, turned):
    """A strip of equal elements has dozens of equal fronts; a shift at one of its ends makes some indefinite."""
    A = kron(grid(60, 5), csc_array(random_matrix(5, 1.0, 9.0, seed=2, turned=turned))).tocsc()
    A = csc_array(A - shift * diags_array(1.0 * (np.arange(A.shape[0]) < A.shape[0] // 3)))
    factor = factored(A, plan(A))
    kinds = {type(step) for step in factor.steps}
    assert kinds == {AlikeFronts, OneFront}
    assert any(len(step.cuts) > 1 for step in factor.steps if isinstance(step, AlikeFronts))
    b = np.random.default_rng(5).standard_normal((A.shape[0], 3))
    x = factor.solve(b)
    np.testing.assert_allclose(A @ x, b, atol=1e-9 * np.abs(x).max())
    np.testing.assert_allclose(factor.solve(b[:, 1]), x[:, 1], rtol=1e-7, atol=1e-9 * np.abs(x).max())
    assert (factor.negative() > 0) == (shift > 0.0)
    assert any(step.block.D is not None for step in factor.steps if isinstance(step, OneFront)) == (shift > 0.0)


def test_a_plan_serves_all_matrices_of_its_pattern(monkeypatch):
    A = grid(20, 20)
    first = planned(A)
    assert planned(csc_array(2.0 * A)) is first
    assert planned(grid(20, 21)) is not first
    monkeypatch.setattr(plans, "SMALL", 100)
    kept = planned(A)
    assert planned(A) is kept
    del kept
    assert plans.Recent.last() is None  # too large to be kept for nobody


@pytest.mark.slow
@pytest.mark.parametrize("keep", [True, False])
def test_what_does_not_fit_is_refused_before(monkeypatch, keep):
    A = grid(12, 12, 12)
    needed = plan(A).bytes(keep)
    monkeypatch.setattr(factors, "free_memory", lambda: 1.2 * needed)
    assert factorise(A, keep=keep).negative() == 0
    monkeypatch.setattr(factors, "free_memory", lambda: 1.05 * needed)
    monkeypatch.setattr(factors, "factored", None)  # never reached
    with pytest.raises(
        MemoryNeedError, match=r"the factor of 3456 unknowns takes .* GB, .* GB are free; .*\[modes-mem"
    ):
        factorise(A, keep=keep)


def test_the_estimate_is_what_is_kept():
    """The factor's arrays have as many numbers as the plan says."""
    A = grid(15, 15)
    factor = factorise(A)
    blocks = [step.block if isinstance(step, OneFront) else step for step in factor.steps]
    assert sum(block.L.size + block.below.size for block in blocks) == factor.fronts.entries


@pytest.mark.parametrize("direct", ["multifrontal", "superlu"])
def test_a_lack_of_memory_that_was_not_foreseen_is_reported(monkeypatch, direct):
    def greedy(*args, **options):
        raise MemoryError

    monkeypatch.setattr(factors, "factored", greedy)
    monkeypatch.setattr(factors, "splu", greedy)
    with pytest.raises(MemoryNeedError, match="no memory to factor 2 unknowns"):
        factorise(csc_array(np.eye(2)), direct)


def test_free_memory_is_some():
    assert 1e6 < free_memory()


@pytest.mark.parametrize(("A", "words"), [
    (np.zeros((3, 3)), "the matrix is singular: the structure is not supported"),
    (np.ones((2, 2)), "the matrix is singular: the structure is not supported"),
    (np.diag([1.0, np.nan]), "the matrix contains values that are not finite"),
])  # fmt: skip
def test_refuses_singular_matrices_and_what_is_no_number(A, words):
    with pytest.raises(cf.errors.NumericsError, match=words):
        factorise(csc_array(A))


def test_what_fronts_cost_by_hand():
    """Two children that pass on three unknowns each, their parent, and a front that is alone."""
    sizes, children = ((2, 3), (1, 3), (3, 0), (4, 0)), ((), (), (0, 1), ())
    own = [SimpleNamespace(size=s, rows=range(s[1]), children=c) for s, c in zip(sizes, children, strict=True)]
    fronts = Fronts((), np.arange(10), tuple(own))
    assert fronts.entries == 10 + 4 + 9 + 16
    assert fronts.operations == pytest.approx(73.0 / 3.0 + 51.0)
    assert fronts.working() == 9 + 9 + 9 + 9  # the parent, what both children passed on, and its columns
    assert fronts.bytes(keep=False) == 8 * 36
    assert fronts.bytes(keep=True, number=16) == 16 * (36 + 39)
    groups = fronts.groups
    assert [groups[1][k] for k in groups[0]] == [0, 0, 1, 0]


def test_a_front_is_put_in_order_along_its_longest_side():
    axes = np.array([[0.0, 1.0, 2.0, 50.0, 50.0, 50.1], [0.0, 0.1, 0.2, 7.0, 8.0, 9.0]])
    assert longest(axes, np.array([0, 0, 0, 1, 1, 1]), 2).tolist() == [0.0, 1.0, 2.0, 7.0, 8.0, 9.0]
