"""Bands and entries of symmetric matrices, packed, combined, factored and solved; the problem packed for the loops."""

import math

import numpy as np
import pytest
from scipy.sparse import csr_array

import contact as ct
from contact.model.bodies.band import (
    Band,
    band,
    combine,
    diagonal,
    factor,
    fill_order,
    lower_form,
    lumped,
    pairs,
    solve,
    sparse_form,
)
from contact.model.bodies.linear_system import linear_system, omega_max

A = np.array([[4.0, -1.0, 0.0, 0.5], [-1.0, 5.0, 2.0, 0.0], [0.0, 2.0, 7.0, -3.0], [0.5, 0.0, -3.0, 9.0]])
ORDER = np.array([2, 0, 3, 1])
TURNED = A[np.ix_(ORDER, ORDER)]


@pytest.mark.parametrize("wide", [False, True])
@pytest.mark.parametrize("given", [A, csr_array(A)], ids=["dense", "sparse"])
def test_a_matrix_packed_in_an_order_is_itself(given, wide):
    packed = band(given, ORDER, wide=wide)
    np.testing.assert_allclose(packed.ground, TURNED.sum(axis=1), rtol=1e-14)
    assert packed.grounded
    assert not packed.lumped
    np.testing.assert_array_equal(sparse_form(packed).toarray(), TURNED)
    np.testing.assert_array_equal(diagonal(packed), np.diag(TURNED))
    rows, columns, values = pairs(packed)
    assert sorted(zip(rows.tolist(), columns.tolist(), values.tolist(), strict=True)) == [
        (0, 2, -3.0), (0, 3, 2.0), (1, 2, 0.5), (1, 3, -1.0),
    ]  # fmt: skip
    if not wide:
        assert packed.off.tolist() == [[0.0, 0.5, 0.0, 0.0], [-3.0, -1.0, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0]]
        assert lower_form(packed).tolist() == [np.diag(TURNED).tolist(), *packed.off.tolist()]
    else:
        assert (packed.off.shape, packed.sparse.start.tolist()) == ((0, 4), [0, 2, 4, 4, 4])


def test_row_sums_of_round_off_are_none():
    springs = np.array([[0.3, -0.1 - 0.2], [-0.3, 0.3]])
    assert band(springs, np.arange(2)).ground.tolist() == [0.0, 0.0]
    assert not band(springs, np.arange(2)).grounded
    assert band(springs + np.diag([0.0, 1e-9]), np.arange(2)).ground[1] == pytest.approx(1e-9, rel=1e-6)
    assert lumped(np.array([3.0, 0.0])).grounded
    assert not lumped(np.zeros(2)).grounded
    assert band(np.diag([3.0, 2.0]), np.arange(2)).lumped
    assert band(np.diag([3.0, 2.0]), np.arange(2), wide=True).lumped


@pytest.mark.parametrize("wide", [False, True])
def test_scaled_bands_add_up(wide):
    other = np.diag([1.0, 2.0, 3.0, 4.0]) + np.diag([0.25, 0.5, 0.75], 1) + np.diag([0.25, 0.5, 0.75], -1)
    parts = band(A, np.arange(4), wide=wide), band(other, np.arange(4), wide=False)
    np.testing.assert_allclose(sparse_form(combine((2.0, parts[0]), (-3.0, parts[1]))).toarray(), 2.0 * A - 3.0 * other)
    left_out = combine((0.0, parts[0]), (2.0, parts[1]))
    np.testing.assert_allclose(sparse_form(left_out).toarray(), 2.0 * other)
    if not wide:
        assert left_out.off.shape[0] == 1
        assert combine((1.0, parts[1]), (-1.0, parts[1])).lumped
        assert not combine((1.0, parts[1]), (-1.0, parts[1])).grounded


@pytest.mark.parametrize("wide", [False, True])
def test_a_factor_is_that_of_the_matrix_and_solves_it(wide):
    found = factor(band(A, np.arange(4), wide=wide), "M")
    right = np.array([[1.0, -2.0], [0.5, 3.0], [-1.0, 4.0], [2.0, 0.25]])
    np.testing.assert_allclose(A @ solve(found, right), right, atol=1e-13)
    L = np.eye(4)
    if wide:
        for i in range(4):
            for k in range(found.sparse.start[i], found.sparse.start[i + 1]):
                L[found.sparse.column[k], i] = found.sparse.value[k]
    else:
        for i in range(4):
            for d in range(1, found.low.shape[1] + 1):
                if i + d < 4:
                    L[i + d, i] = found.low[i, d - 1]
    np.testing.assert_allclose(L @ np.diag(1.0 / found.inverse) @ L.T, A, atol=1e-13)
    alone = factor(lumped(np.array([2.0, 4.0])), "M")
    assert solve(alone, np.array([[1.0], [1.0]])).tolist() == [[0.5], [0.25]]
    assert alone.low.shape == (2, 0)


@pytest.mark.parametrize(
    ("matrix", "wide", "words"),
    [
        (np.diag([1.0, 0.0]), False, "K: found a diagonal entry <= 0 in row 2, expected > 0"),
        (np.array([[1.0, 2.0], [2.0, 1.0]]), False, "K: found a matrix that is not positive definite"),
        (np.array([[1.0, 2.0], [2.0, 1.0]]), True, "K: found a matrix that is not positive definite, pivot -3"),
    ],
)
def test_a_factor_of_what_is_not_positive_definite_is_refused(matrix, wide, words):
    with pytest.raises(ct.InputError, match=words):
        factor(band(matrix, np.arange(2), wide=wide), "K")


def test_an_order_of_little_fill_eliminates_a_hub_last():
    star = np.eye(6)
    star[0, :] = star[:, 0] = 1.0
    order = fill_order(csr_array(star))
    assert sorted(order.tolist()) == list(range(6))
    assert order.tolist().index(0) >= 4  # the hub, or the last of its neighbours, ends it


def structure(**more):
    K = np.array([[9.0, -2.0, 0.0], [-2.0, 7.0, -1.0], [0.0, -1.0, 5.0]])
    Q = np.array([[0.0, 1.5, -0.5], [2.0, 0.0, 0.0]])
    given = {"M": np.array([1.0, 2.0, 4.0]), "K": K, "Q": Q, "gap0": [0.1, 0.2], "load": [1.0, 2.0, 3.0]}
    return ct.LinearBody(**given | more)


def test_a_problem_packed_for_the_loops_is_itself():
    forcing = (
        ct.bodies.Forcing(shape=np.array([1.0, 0.0, 5.0]), amplitude=np.cos),
        ct.bodies.Forcing(shape=np.ones(3), amplitude=np.sin),
    )
    body = structure(forcing=forcing)
    system = linear_system(body)
    order = system.order
    assert sorted(order.tolist()) == [0, 1, 2]
    assert order[system.place].tolist() == [0, 1, 2]
    np.testing.assert_array_equal(sparse_form(system.K).toarray(), body.K[np.ix_(order, order)])
    np.testing.assert_array_equal(sparse_form(system.M).toarray(), np.diag([1.0, 2.0, 4.0])[np.ix_(order, order)])
    np.testing.assert_array_equal(system.rows(), body.Q[:, order])
    np.testing.assert_array_equal(system.load, body.load[order])
    np.testing.assert_array_equal(system.shapes, np.array([[1.0, 0.0, 5.0], [1.0, 1.0, 1.0]])[:, order])
    assert (system.size, system.damped, system.gap0.tolist()) == (3, False, [0.1, 0.2])
    assert system.columns.shape == system.value.shape == (2, 2)
    assert np.count_nonzero(system.value[1]) == 1
    at = 0.25 * np.array([3.0, 4.0, 5.0])
    np.testing.assert_allclose(system.amplitudes(3, 2, 0.25), np.stack([np.cos(at), np.sin(at)], axis=1), rtol=1e-14)
    assert linear_system(structure(C=np.array([0.0, 0.1, 0.0]))).damped
    coupled = np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    assert linear_system(structure(C=coupled)).damped


def highest(K, M):
    return math.sqrt(np.linalg.eigvals(np.linalg.solve(M, K)).real.max())


def test_the_highest_frequency_of_lumped_and_consistent_masses_and_closed_contacts():
    body = structure()
    system, M = linear_system(body), np.diag([1.0, 2.0, 4.0])
    assert omega_max(system) == pytest.approx(highest(body.K, M), rel=1e-12)
    closed = body.K + 3.0 * body.Q.T @ body.Q
    assert omega_max(system, contact_stiffness=3.0) == pytest.approx(highest(closed, M), rel=1e-12)
    free = np.array([False, True, True])
    part = highest(body.K[1:, 1:], M[1:, 1:])
    assert omega_max(system, free=free[system.order]) == pytest.approx(part, rel=1e-12)
    consistent = M + np.diag([0.25, 0.5], 1) + np.diag([0.25, 0.5], -1)
    assert omega_max(linear_system(structure(M=consistent))) == pytest.approx(highest(body.K, consistent), rel=1e-12)
    springs = np.diag([16.0, 2.0, 4.0])
    assert omega_max(linear_system(structure(K=springs))) == 4.0
    assert omega_max(linear_system(structure(K=np.zeros((3, 3))))) == 0.0


def test_a_wide_structure_is_kept_as_entries_and_has_the_same_highest_frequency():
    """A hub with springs to 40 others: the band is as wide as the matrix."""
    n = 41
    K = np.diag(np.r_[200.0, 10.0 + np.arange(n - 1)])
    K[0, 1:] = K[1:, 0] = -2.0
    mass, Q = 1.0 + 0.1 * np.arange(n), np.zeros((1, n))
    Q[0, 3] = 1.0
    system = linear_system(ct.LinearBody(M=mass, K=csr_array(K), Q=Q, gap0=[0.1]))
    assert system.K.sparse.start.size == n + 1
    np.testing.assert_array_equal(sparse_form(system.K).toarray(), K[np.ix_(system.order, system.order)])
    top = highest(K, np.diag(mass))
    assert omega_max(system) == pytest.approx(top * math.sqrt(1.0 + 1e-7), rel=2e-8)
    free = np.ones(n, dtype=bool)
    free[0] = False
    assert omega_max(system, free=free[system.order]) == pytest.approx(
        highest(K[1:, 1:], np.diag(mass[1:])) * math.sqrt(1.0 + 1e-7), rel=2e-8
    )
    thick = np.diag(mass)
    thick[0, 1:] = thick[1:, 0] = 0.05
    wide = linear_system(ct.LinearBody(M=csr_array(thick), K=csr_array(K), Q=Q, gap0=[0.1]))
    assert omega_max(wide) == pytest.approx(highest(K, thick) * math.sqrt(1.0 + 1e-7), rel=2e-8)
    narrow = np.diag(np.full(n, 2.0)) - np.eye(n, k=1) - np.eye(n, k=-1)
    kept = linear_system(ct.LinearBody(M=mass, K=csr_array(narrow), Q=Q, gap0=[0.1])).K
    assert isinstance(kept, Band)
    assert (kept.sparse.start.size, kept.off.shape[0]) == (0, 1)
