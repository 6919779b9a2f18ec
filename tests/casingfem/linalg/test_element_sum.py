"""Matrices kept element by element: products, bounds, factors and inertia are those of the sum."""

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.linalg.element_sum import Elements, ElementSum
from casingfem.linalg.factor import factorise
from casingfem.linalg.fronts import plan, planned
from casingfem.linalg.pencil import make_pencil, most_round_off, round_off

CELLS, ORDER = 14, 4


def strips(rows, seed=3):
    """Rows of square elements of 25 unknowns on a strip whose left end is held, and springs between its far corners."""
    rng = np.random.default_rng(seed)
    across, along = rows * ORDER + 1, CELLS * ORDER + 1
    number = np.arange(across * along).reshape(along, across) - across
    size = int(number[-1, -1]) + 1
    number[number < 0] = size
    dofs = np.array([
        number[ORDER * i : ORDER * i + ORDER + 1, ORDER * j : ORDER * j + ORDER + 1].ravel()
        for i in range(CELLS) for j in range(rows)
    ])  # fmt: skip
    halves = rng.standard_normal((len(dofs), dofs.shape[1], dofs.shape[1]))
    ends = np.array([[number[-1, 0], number[-1, -1]]])
    springs = Elements(ends, np.array([[[2.0, -2.0], [-2.0, 2.0]]]))
    return ElementSum.of([Elements(dofs, halves @ halves.swapaxes(1, 2)), springs], size)


@pytest.mark.slow
@pytest.mark.parametrize("rows", [1, 5])
def test_solutions_and_inertia_are_those_of_the_sum(rows):
    A = strips(rows)
    A = A.scaled(np.linspace(0.5, 2.0, A.size)).plus(-9.0)
    dense, b = A @ np.eye(A.size), np.random.default_rng(5).standard_normal((A.size, 3))
    np.testing.assert_allclose(dense, A.tocsc().toarray(), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(A @ b[:, 0], dense @ b[:, 0], rtol=1e-10, atol=1e-10)
    factor, other = factorise(A), factorise(A, "superlu")
    np.testing.assert_allclose(factor.solve(b), np.linalg.solve(dense, b), rtol=1e-8, atol=1e-9)
    negative = int(np.count_nonzero(np.linalg.eigvalsh(dense) < 0.0))
    assert 0 < negative == factor.negative() == factorise(A, keep=False).negative() == other.negative()


def test_the_plan_is_no_worse_than_that_of_the_sum_and_serves_other_matrices():
    A = strips(5)
    mine, sparse = plan(A), plan(A.tocsc())
    assert mine.entries <= 1.02 * sparse.entries
    assert sorted(mine.order.tolist()) == list(range(A.size))
    kept = planned(A)
    assert planned(strips(5, seed=4).plus(2.0)) is kept
    assert planned(strips(4)) is not kept


def test_round_off_is_bounded_by_that_of_the_elements():
    A = strips(1)
    pencil = make_pencil(A, np.linspace(1.0, 2.0, A.size))
    x = np.random.default_rng(6).standard_normal((A.size, 2))
    sparse = pencil.A.tocsc()
    assert np.all(round_off(pencil.A, x) >= round_off(sparse, x))
    assert np.all(round_off(pencil.A, x) <= most_round_off(pencil.A, x))


def test_refuses_what_is_no_number():
    A = strips(1)
    A.groups[0].matrices[3, 2, 1] = np.nan
    with pytest.raises(cf.errors.NumericsError, match="not finite"):
        factorise(A)


def test_a_change_of_groups_of_unknowns_is_made_within_the_elements():
    """T^T A T where some groups lie within an element, some in two, and some bring unknowns of elsewhere."""
    A, rng = strips(2), np.random.default_rng(8)
    T = np.eye(A.size)
    for group in ([3, 4, 5], [ORDER * 9 + 8, ORDER * 9 + 9, A.size - 1], [60, 200]):
        T[np.ix_(group, group)] = rng.standard_normal((len(group), len(group)))
    changed = A.changed(csc_array(T))
    expected = T.T @ A.tocsc().toarray() @ T
    np.testing.assert_allclose(changed @ np.eye(A.size), expected, atol=1e-11 * np.abs(expected).max())
    np.testing.assert_allclose(changed.tocsc().toarray(), expected, atol=1e-11 * np.abs(expected).max())
    b = rng.standard_normal(A.size)
    np.testing.assert_allclose(expected @ factorise(changed).solve(b), b, atol=1e-6 * np.abs(b).max())
    assert changed.groups[0].matrices is A.groups[0].matrices
