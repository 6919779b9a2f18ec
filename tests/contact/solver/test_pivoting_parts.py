"""Pivoting on polyhedral cones, and what Newton's method does where its path ends, against the laws written out."""

import math
from itertools import product

import numpy as np
import pytest

from tests.contact.plain import names, plain

N = names("solver.friction.newton", "solver.friction.coulomb", "solver.friction.room")


def test_facets_are_unit_vectors_five_of_them_close_together():
    assert N.directions(2, 0.3, 0.1).tolist() == [[1.0], [-1.0]]
    D = N.directions(3, 0.3, 0.1)
    angle = np.arctan2(D[:, 1], D[:, 0])
    np.testing.assert_allclose(angle[:5], 0.3 + 0.1 * np.array([-2, -1, 0, 1, 2]), rtol=1e-12)
    far = [math.remainder(0.3 + math.pi + 1.7 * k, 2.0 * math.pi) for k in (-1, 0, 1)]
    np.testing.assert_allclose(angle[5:], far, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(D, axis=1), 1.0, rtol=1e-15)


def test_covering_vectors_are_ones_or_spread_between_one_and_two():
    assert N.covering(4, 0).tolist() == [1.0] * 4
    other = N.covering(50, 3)
    np.testing.assert_allclose(other, [1.0 + (3 * k * (math.sqrt(5.0) - 1.0) / 2.0) % 1.0 for k in range(1, 51)])


def test_an_exchanged_column_of_a_basis_gives_the_inverse_of_the_new_one():
    rng = np.random.default_rng(3)
    basis, new = rng.standard_normal((5, 5)), rng.standard_normal(5)
    inverse = np.linalg.inv(basis)
    basis[:, 2] = new
    np.testing.assert_allclose(N.exchanged(inverse, inverse @ new, 2), np.linalg.inv(basis), rtol=1e-10)


@pytest.mark.parametrize("draw", [0, 1, 5])
def test_lemke_s_path_ends_at_the_answer_whatever_covers_it(draw):
    rng = np.random.default_rng(7)
    for _ in range(6):
        half, q = rng.standard_normal((4, 4)), rng.standard_normal(4) - 0.4
        M = half @ half.T + 0.3 * np.eye(4) + np.triu(0.4 * rng.standard_normal((4, 4)), 1)
        M = M - 0.2 * (np.triu(M, 1) - np.triu(M, 1).T)
        z = N.lemke(M, q, N.covering(4, draw))
        answers = []
        for closed in product([False, True], repeat=4):
            c, x = np.flatnonzero(closed), np.zeros(4)
            x[c] = np.linalg.solve(M[np.ix_(c, c)], -q[c])
            if (x >= 0.0).all() and ((M @ x + q)[~np.array(closed)] >= 0.0).all():
                answers.append(x)
        assert any(np.allclose(z, x, rtol=1e-9, atol=1e-12) for x in answers)
    assert N.lemke(M, np.array([0.0, 1.0, 0.5, 2.0]), np.ones(4)).tolist() == [0.0] * 4
    assert N.lemke(-np.eye(2), np.array([-1.0, -2.0]), np.ones(2)) is None


def error(W, b, mu, dim, force):
    """Distance from Coulomb's law as a force, of contacts that yield like one."""
    u, worst = W @ force + b, 0.0
    for k in range(len(mu)):
        own = slice(k * dim, (k + 1) * dim)
        f, v = force[own], u[own]
        aim = f[1:] - v[1:]
        held = aim * min(1.0, mu[k] * max(f[0], 0.0) / max(np.linalg.norm(aim), 1e-300))
        worst = max(worst, abs(min(f[0], v[0])), np.abs(f[1:] - held).max())
    return worst


def problem(dim, seed):
    rng, n = np.random.default_rng(seed), 3 * dim
    half = rng.standard_normal((n, n))
    b = rng.standard_normal(n)
    b[::dim] -= 1.0
    return half @ half.T / n + 0.5 * np.eye(n), b, np.array([0.3, 0.5, 0.2])


def test_in_two_dimensions_facets_are_the_cone():
    for seed in range(6):
        W, b, mu = problem(2, seed)
        force = N.polyhedral_cone(W, b, mu, 2, np.zeros(3), 0.5, seed)
        assert error(W, b, mu, 2, force) <= 1e-12


def test_in_three_dimensions_facets_close_in_on_the_cone():
    """Exact where a facet slips as the contact does, else as the square of their spread about that."""
    W, b, mu = problem(3, 2)
    exact = N.coulomb(W, b.reshape(3, 3), mu).force.ravel()
    turn = N.against_slip(W @ exact + b, 3, np.zeros(3))
    spreads = np.array([0.5, 0.05, 5e-3])
    for part, of_spread in ((0.0, [0.0, 0.0, 0.0]), (0.5, 0.042 * spreads**2)):
        misses = [np.abs(N.polyhedral_cone(W, b, mu, 3, turn + part * s, s, 0) - exact).max() for s in spreads]
        np.testing.assert_allclose(misses, of_spread, rtol=0.02, atol=1e-12)


@pytest.mark.parametrize("dim", [2, 3])
def test_pivoting_finds_forces_from_nowhere(dim):
    for seed in range(3):
        W, b, mu = problem(dim, seed)
        scale = np.repeat([1.0, 3.0, 0.2], dim)
        W = W * scale * scale[:, None]
        force, residual = N.pivoted(W, b, mu, dim, np.zeros(3 * dim))
        assert residual <= 1e-12
        unit = 1.0 / scale**2
        u = W @ force + b
        assert error(np.eye(3 * dim), u * unit - force, mu, dim, force) <= 1e-10 * max(1.0, np.abs(force).max())
    kept = np.ones(3 * dim)
    found, residual = N.pivoted(W, np.full(3 * dim, np.nan), mu, dim, kept)
    assert found is kept
    assert math.isnan(residual)


@pytest.mark.parametrize("sweeps", [0, 5])
def test_what_helps_newton_s_method_leaves_the_problem_as_it_is(sweeps):
    W, b, mu = problem(2, 4)
    room, force, kept = N.solver_room(3, 2), np.zeros(6), (W.copy(), b.copy(), mu.copy())
    with plain():  # sweeps are imported when they are needed
        residual = N.otherwise(W, b, mu, 2, 3, force, room, sweeps)
    for before, after in zip(kept, (W, b, mu), strict=True):
        np.testing.assert_array_equal(after, before)
    if sweeps:
        assert residual == 0.0
        assert error(W, b, mu, 2, force) <= 0.1
    else:
        assert residual <= 1e-12
        assert error(W, b, mu, 2, force) <= 1e-11
    assert math.isnan(N.otherwise(W, b, mu, 2, 3, force, N.friction_room(3, 2), 0))  # without pivoting


@pytest.mark.parametrize("dim", [2, 3])
def test_closely_coupled_contacts_need_sweeps_and_are_solved(dim):
    rng, most = np.random.default_rng(7), 0
    for _ in range(12):
        A = rng.standard_normal((3 * dim, 3))
        W = A @ A.T / (3 * dim) + 1e-5 * np.eye(3 * dim)
        b = rng.standard_normal((3, dim)) - np.eye(dim)[0]
        with plain():
            found = N.coulomb(W, b, 0.3)
        most = max(most, found.iterations)
        u = found.motion.ravel()
        unit = 1.0 / np.diag(W).max()
        assert error(np.eye(3 * dim), u * unit - found.force.ravel(), np.full(3, 0.3), dim, found.force.ravel()) <= (
            1e-9 * np.abs(found.force).max()
        )
        assert found.residual <= 1e-12
    assert most > 8  # beyond a kink


def test_columns_of_large_matrices_are_staggered_and_small_ones_are_not():
    assert N.friction_room(13, 3).matrices.shape == (3, 39, 39)
    large = N.friction_room(14, 3)
    assert large.matrices.shape == (3, 42, 56)
    assert (large.panels.used, N.friction_room(13, 3).panels.used) == (True, False)
    assert large.vectors.shape == (15, 42)
    assert large.pairs.shape == (14, 2)
    assert N.staggered(40) == 40 or N.staggered(40) % 16 == 8
