"""The parts of a multigrid cycle by matrix polynomials: smoothing, one cycle of two levels, static solutions."""

import numpy as np
import pytest
from scipy.linalg import cho_factor, eigvalsh
from scipy.sparse import csc_array, csr_array

from casingfem.linalg.krylov import ConvergenceError
from casingfem.linalg.multigrid import (
    Hierarchy,
    Level,
    count_that_fits,
    make_hierarchy,
    make_level,
    search,
    static_by_cycles,
)
from casingfem.linalg.pencil import make_pencil

RNG = np.random.default_rng(17)
SIZE, COARSE = 12, 4
HALF = RNG.standard_normal((SIZE, SIZE))
A = HALF @ HALF.T + np.diag(np.linspace(1.0, 5.0, SIZE))
P = np.kron(np.eye(COARSE), np.ones((3, 1))) + 0.1 * RNG.standard_normal((SIZE, COARSE))
ALIKE = np.tile(np.eye(3), (COARSE, 1))  # three unknowns a node, moved alike
RADIUS = float(eigvalsh(A, np.diag(np.diag(A)))[-1])


def level(radius=RADIUS):
    return Level(A=csr_array(A), inverse=1.0 / np.diag(A)[:, None], radius=radius, P=csr_array(P))


def left_by_smoothing():
    """What is left of an error: T_3((m - X)/h)/T_3(m/h) of X = D^-1 A, damped from a fifteenth of 1.1 rho upwards."""
    high = 1.1 * RADIUS
    m, h = 0.5 * (high + high / 15.0), 0.5 * (high - high / 15.0)
    t = (m * np.eye(SIZE) - A / np.diag(A)[:, None]) / h
    return (4.0 * t @ t @ t - 3.0 * t) / (4.0 * (m / h) ** 3 - 3.0 * m / h)


@pytest.mark.parametrize("begun", [False, True])
def test_smoothing_leaves_a_chebyshev_polynomial_of_an_error(begun):
    exact = RNG.standard_normal((SIZE, 2))
    x = RNG.standard_normal((SIZE, 2)) if begun else np.zeros((SIZE, 2))
    found = level().smoothed(A @ exact, x if begun else None)
    np.testing.assert_allclose(found - exact, left_by_smoothing() @ (x - exact), atol=1e-11)


def test_a_cycle_smooths_before_and_after_its_coarse_correction():
    hierarchy = Hierarchy((level(),), cho_factor(P.T @ A @ P))
    S = left_by_smoothing()
    left = S @ (np.eye(SIZE) - P @ np.linalg.solve(P.T @ A @ P, P.T @ A)) @ S
    exact = RNG.standard_normal((SIZE, 3))
    np.testing.assert_allclose(hierarchy.cycle(A @ exact) - exact, -left @ exact, atol=1e-11)
    operator = hierarchy.operator
    assert operator.shape == (SIZE, SIZE)
    b = RNG.standard_normal(SIZE)
    np.testing.assert_allclose(operator @ b, hierarchy.cycle(b[:, None])[:, 0], rtol=1e-12)
    flat = Hierarchy((), cho_factor(A))
    assert flat.operator.shape == (SIZE, SIZE)
    np.testing.assert_allclose(flat.operator @ b, np.linalg.solve(A, b), rtol=1e-9)


def test_the_memory_of_a_hierarchy_is_that_of_its_arrays():
    one = level()
    hierarchy = Hierarchy((one, one), cho_factor(np.eye(COARSE)))
    matrices = [one.A, one.P]
    own = sum(part.nbytes for M in matrices for part in (M.data, M.indices, M.indptr)) + 8 * SIZE
    assert hierarchy.bytes == 2 * own + 8 * COARSE**2


def test_a_level_knows_its_diagonal_and_its_radius():
    made = make_level(csr_array(A), csr_array(P))
    np.testing.assert_allclose(made.inverse[:, 0], 1.0 / np.diag(A), rtol=1e-14)
    assert made.radius == pytest.approx(RADIUS, rel=2e-2)


def test_small_matrices_are_solved_directly():
    pytest.importorskip("pyamg")
    hierarchy = make_hierarchy(csr_array(A), ALIKE)
    assert hierarchy.levels == ()
    b = RNG.standard_normal((SIZE, 2))
    np.testing.assert_allclose(hierarchy.cycle(b), np.linalg.solve(A, b), rtol=1e-9)
    odd = make_hierarchy(csr_array(A[:11, :11]), np.ones((11, 1)))  # no three unknowns a node
    np.testing.assert_allclose(odd.cycle(b[:11]), np.linalg.solve(A[:11, :11], b[:11]), rtol=1e-9)


def test_static_solutions_of_several_loads_one_of_which_is_none():
    pytest.importorskip("pyamg")
    loads = np.column_stack([RNG.standard_normal(SIZE), np.zeros(SIZE), 1e6 * RNG.standard_normal(SIZE)])
    found = static_by_cycles(csc_array(A), ALIKE, loads)
    np.testing.assert_allclose(found, np.linalg.solve(A, loads), rtol=1e-8, atol=1e-12)
    assert not found[:, 1].any()
    with pytest.raises(ConvergenceError, match="the coarsest matrix is not positive definite"):
        static_by_cycles(csc_array(A - 100.0 * np.eye(SIZE)), ALIKE, loads)


@pytest.mark.parametrize("missed", [0, 1])
def test_a_search_beside_what_was_found_sees_what_was_missed(missed):
    pytest.importorskip("pyamg")
    K = np.diag(np.linspace(1.0, 40.0, 40))
    pencil = make_pencil(csc_array(K), np.ones(40))
    levels = make_hierarchy(csr_array(K + np.eye(40)), np.ones((40, 1)))
    found = np.eye(40)[:, [k for k in range(4) if k != 2 or not missed]]
    assert count_that_fits(pencil, 4.5) == 4
    if missed:
        with pytest.raises(ConvergenceError, match="1 modes missed at first"):
            search(pencil, levels, found, 4.5, -1.0)
    else:
        assert search(pencil, levels, found, 4.5, -1.0) >= 6
