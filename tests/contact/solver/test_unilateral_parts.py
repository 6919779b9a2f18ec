"""Parts of the frictionless solvers against every set of closed contacts tried, and against numpy's factors."""

from itertools import product

import numpy as np
import pytest

from tests.contact.plain import names

N = names("solver.unilateral.complementarity", "solver.friction.one_contact")
ACTIVE = names("solver.unilateral.active_set")
DENSE = names("solver.dense")
W = np.array([[2.0, -0.6, 0.3], [-0.6, 1.5, -0.4], [0.3, -0.4, 1.1]])


def by_trying(W, g):
    """The set of closed contacts whose forces press and whose gaps, W force + g, are open elsewhere."""
    for closed in product([False, True], repeat=len(g)):
        c, force = np.flatnonzero(closed), np.zeros(len(g))
        force[c] = np.linalg.solve(W[np.ix_(c, c)], -g[c])
        if (force >= 0.0).all() and (W @ force + g >= -1e-12)[~np.array(closed)].all():
            return force
    raise AssertionError("no set")


def law(stiffness=0.0, updates=0, tolerance=0.0):
    return N.LawNumbers(stiffness, updates, tolerance, N.Several(used=True))


def solved(W, g, law, last=0.0):
    n = len(g)
    lam, g = np.full(n, last), np.array(g, dtype=float)
    return N.contact_forces(W[:n, :n], law, g, lam, np.zeros(n), np.zeros((n, n)), np.zeros(n)), lam


@pytest.mark.parametrize("stiffness", [0.0, 4.0])
@pytest.mark.parametrize("last", [0.0, 0.7])
def test_forces_of_several_contacts_are_found_whatever_was_closed_before(stiffness, last):
    rng = np.random.default_rng(2)
    for _ in range(8):
        g = rng.standard_normal(3) - 0.3
        found, lam = solved(W, g, law(stiffness), last)
        assert found
        soft = np.eye(3) / stiffness if stiffness else 0.0
        np.testing.assert_allclose(lam, by_trying(W + soft, g), rtol=1e-12, atol=1e-14)


def test_a_contact_left_out_of_a_step_has_no_force_whatever_it_had():
    found, lam = solved(W, [-1.0, np.inf, -0.5], law(), 3.0)
    assert found
    exact = np.linalg.solve(W[np.ix_([0, 2], [0, 2])], [1.0, 0.5])
    np.testing.assert_allclose(lam, [exact[0], 0.0, exact[1]], rtol=1e-13)
    found, lam = solved(W, [0.0, np.inf, 0.5], law(), 3.0)
    assert found
    assert not lam.any()


def test_a_gap_that_is_no_number_has_no_forces():
    assert not solved(W, [-1.0, np.nan, 1.0], law())[0]
    assert not solved(W, [np.nan], law())[0]
    assert solved(W, [], law())[0]


@pytest.mark.parametrize("stiffness", [0.0, 4.0])
def test_one_contact_is_a_division(stiffness):
    found, lam = solved(W, [-0.6], law(stiffness))
    assert found
    assert lam[0] == pytest.approx(0.6 / (2.0 + (1.0 / stiffness if stiffness else 0.0)), rel=1e-15)
    assert solved(W, [0.0], law(stiffness), 2.0)[1][0] == 0.0
    assert not solved(-W, [-0.6], law())[0]


def test_rows_that_repeat_share_a_contact_and_the_nearer_one_stays_open():
    """Two contacts on one coordinate: the deeper one takes the force, whichever comes first."""
    for g in ([-1.0, -2.0], [-2.0, -1.0], [-1.0, -1.0]):
        found, lam = solved(np.ones((2, 2)) * 0.5, g, law())
        assert found
        assert (np.ones((2, 2)) * 0.5 @ lam + g).min() >= -1e-11
        assert lam.sum() == pytest.approx(-2.0 * min(g), rel=1e-9)
        assert (lam >= 0.0).all()
    g = np.array([-1.0, -2.0, 0.5])
    rows = np.array([[1.0, 0.0], [1.0, 0.0], [-0.5, 1.0]])
    found, lam = solved(rows @ rows.T, g, law())
    assert found
    gaps = rows @ rows.T @ lam + g
    assert gaps.min() >= -1e-10
    assert abs(gaps @ lam) <= 1e-9


@pytest.mark.parametrize("soft", [0.0, 0.25])
def test_closed_contacts_are_solved_and_the_smallest_gap_is_told(soft):
    g, lam, closed, A = np.array([-1.0, 0.3, -0.7]), np.full(3, 9.0), np.array([1.0, 0.0, 1.0]), np.zeros((3, 3))
    N.closed_forces(W, soft, g, closed, A, lam)
    exact = np.linalg.solve(W[np.ix_([0, 2], [0, 2])] + soft * np.eye(2), [1.0, 0.7])
    np.testing.assert_allclose(lam, [exact[0], 0.0, exact[1]], rtol=1e-14)
    lam = np.array([0.4, 0.0, 0.2])
    assert N.least_gap(W, soft, g, lam) == pytest.approx(((W + soft * np.eye(3)) @ lam + g).min(), rel=1e-14)


def augmented(g, stiffness, updates, tolerance, last):
    """Updates of multipliers of one contact, lam <- max(lam - r (g + W lam), 0) solved for the new lam."""
    lam = last
    for k in range(updates):
        lam = max(-(g - lam / stiffness), 0.0) / (2.0 + 1.0 / stiffness)
        if abs(min(g + 2.0 * lam, lam / stiffness)) <= tolerance:
            return lam, k + 1
    return lam, updates


@pytest.mark.parametrize(("tolerance", "last"), [(0.0, 0.0), (0.0, 0.2), (0.03, 0.1), (5.0, 0.0)])
def test_multipliers_are_updated_until_no_gap_is_left_or_updates_are_spent(tolerance, last):
    exact, used = augmented(-1.0, 3.0, 4, tolerance, last)
    assert (used < 4) == (tolerance > 0.0)
    found, lam = solved(W, [-1.0], law(3.0, 4, tolerance), last)
    assert found
    assert lam[0] == pytest.approx(exact, rel=1e-14)


def test_updates_of_several_multipliers_end_at_the_rigid_forces():
    g = np.array([-1.0, -0.2, 0.4])
    found, lam = solved(W, g, law(2.0, 200, 1e-13))
    assert found
    np.testing.assert_allclose(lam, by_trying(W, g), rtol=1e-10, atol=1e-12)
    assert not solved(W, [np.nan, 0.0, 0.0], law(2.0, 3, 1e-13))[0]


def test_a_closed_contact_is_jammed_where_no_force_opens_it():
    assert N.scalar_force(4.0, -2.0) == 0.5
    assert N.scalar_force(0.0, -2.0) == N.scalar_force(-1.0, -2.0) == -1.0


def test_of_a_larger_problem_the_first_contacts_and_coordinates_are_solved():
    rng = np.random.default_rng(8)
    for _ in range(8):
        A, b, force = rng.standard_normal((5, 4)), rng.standard_normal(5) - 0.5, np.full(5, 7.0)
        status, changes = ACTIVE.project(A, b, 3, 3, force, ACTIVE.active_space(5, 4))
        assert status == ACTIVE.SOLVED
        np.testing.assert_allclose(force[:3], by_trying(A[:3, :3] @ A[:3, :3].T, b[:3]), rtol=1e-9, atol=1e-12)
        assert force[3:].tolist() == [7.0, 7.0]
        assert changes >= (force[:3] > 0.0).sum()


def test_rows_enter_and_leave_the_factors_and_these_stay_the_rows():
    rng, size = np.random.default_rng(4), 4
    A, w, d = rng.standard_normal((4, size)), ACTIVE.active_space(4, size), np.zeros(size)
    A[1] = [0.0, 0.0, 2.0, 0.0]
    ACTIVE.begin(A, 4, size, np.ones(4), w)
    for k in range(3):
        d[:] = w.J @ A[k]
        ACTIVE.enter(w.J, w.R, k, size, d)
        np.testing.assert_allclose((w.J.T @ w.R)[:, : k + 1], A[: k + 1].T, atol=1e-14)
        np.testing.assert_allclose(w.J @ w.J.T, np.eye(size), atol=1e-14)
    r, right = np.zeros(size), np.array([0.3, -1.0, 2.0, 9.0])
    ACTIVE.back_substitute(w.R, 3, right, r)
    np.testing.assert_allclose(w.R[:3, :3] @ r[:3], right[:3], rtol=1e-13)
    ACTIVE.leave(w.J, w.R, 3, 0, size)
    np.testing.assert_allclose((w.J.T @ w.R)[:, :2], A[1:3].T, atol=1e-14)
    np.testing.assert_allclose(np.tril(w.R[:2, :2], -1), 0.0, atol=1e-14)


def test_the_deepest_gap_over_the_length_of_its_row_is_taken_next():
    A, w = np.array([[1.0, 0.0], [0.0, 4.0], [3.0, 4.0], [0.0, 0.0]]), ACTIVE.active_space(4, 2)
    ACTIVE.begin(A, 4, 2, np.ones(4), w)
    assert w.lengths.tolist() == [1.0, 4.0, 5.0, 0.0]

    def next_of(*b):
        return ACTIVE.most_violated(A, np.array(b), 4, 2, w)

    assert next_of(-1.0, -3.9, -4.9, 0.0) == 0
    assert next_of(-1.0, -4.1, -4.9, 0.0) == 1
    assert next_of(0.0, 0.0, -1e-3, 0.1) == 2
    assert next_of(-1.0, -3.0, 0.0, -0.1) == 3  # no motion opens it
    assert next_of(0.0, 1.0, 2.0, 0.0) == -1
    w.settled[0] = 1
    assert next_of(-1.0, -3.0, 0.0, 0.0) == 1
    w.y[:] = [1.0, -1.0]
    assert next_of(-1.0, 4.0, 1.0, 0.0) == -1
    assert next_of(-1.0, 3.9, 1.1, 0.0) == 1


def test_contacts_wedged_between_walls_have_no_motion():
    A, b, force = np.array([[1.0], [-1.0]]), np.array([-1.0, 0.5]), np.zeros(2)
    status, _ = ACTIVE.project(A, b, 2, 1, force, ACTIVE.active_space(2, 1))
    assert status == ACTIVE.NO_MOTION == 1


@pytest.mark.parametrize("n", [1, 7, 8, 9, 21])
def test_sums_and_rows_are_those_of_numpy_in_blocks_of_eight_and_beyond(n):
    rng = np.random.default_rng(n)
    a, b, A = rng.standard_normal(30), rng.standard_normal(30), rng.standard_normal((30, 30))
    assert DENSE.dot(a, b, n) == pytest.approx(a[:n] @ b[:n], abs=1e-14)
    for first in (0, min(3, n)):
        left, exact = a.copy(), a.copy()
        exact[first:n] -= 0.7 * b[first:n]
        DENSE.subtract(left, 0.7, b, first, n)
        np.testing.assert_allclose(left, exact, rtol=0.0, atol=1e-15)
    out = np.full(30, 5.0)
    DENSE.affine(A, a, b, out, n)
    np.testing.assert_allclose(out[:n], A[:n, :n] @ a[:n] + b[:n], atol=1e-13)
    assert (out[n:] == 5.0).all()
    x, exact = b.copy(), np.linalg.solve(A[:n, :n], b[:n])
    assert DENSE.solve_in_place(A.copy(), x, n, None)
    np.testing.assert_allclose(x[:n], exact, rtol=1e-10)
    assert (x[n:] == b[n:]).all()
    square, low = A[:n, :n] @ A[:n, :n].T + np.eye(n), np.ones((n, n))
    DENSE.cholesky(square, low, n)
    np.testing.assert_allclose(low, np.linalg.cholesky(square), rtol=1e-10, atol=1e-12)


def test_a_singular_matrix_is_not_solved_and_a_zero_on_its_diagonal_is_no_matter():
    x = np.array([1.0, 2.0, 3.0])
    assert not DENSE.solve_in_place(np.array([[1.0, 2.0, 0.0], [2.0, 4.0, 0.0], [0.0, 0.0, 1.0]]), x, 3, None)
    x = np.array([1.0, 2.0, 3.0])
    assert DENSE.solve_in_place(np.array([[0.0, 2.0, 0.0], [-4.0, 0.0, 0.0], [0.0, 1.0, -2.0]]), x, 3, None)
    assert x.tolist() == [-0.5, 0.5, -1.25]
    low = np.zeros((2, 2))
    with np.errstate(invalid="ignore"):
        try:
            DENSE.cholesky(np.array([[1.0, 2.0], [2.0, 1.0]]), low, 2)
        except ValueError:
            low[1, 1] = np.nan  # as compiled code has it
    assert np.isnan(low[1, 1])
