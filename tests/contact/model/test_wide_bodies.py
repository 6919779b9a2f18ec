"""Linear bodies whose band is wide: matrices kept as entries give what bands give, and refuse what bands refuse."""

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array, eye_array, kron

import contact as ct
from contact.model.bodies import linear_system as packing
from contact.model.bodies.band import band, combine, factor, fill_order, pairs, solve, sparse_form
from reports.verification.schemes.cases import methods

LINE = diags_array([np.full(6, -1.0), np.full(7, 2.0), np.full(6, -1.0)], offsets=[-1, 0, 1])
NET = csr_array(kron(LINE, eye_array(7)) + kron(eye_array(7), LINE))  # 49 masses in a plane
CONSISTENT = csr_array(eye_array(49) + 0.05 * NET)


def thrown(**change):
    Q = csr_array((np.array([1.0, 1.0, -0.5]), ([0, 1, 1], [48, 3, 20])), shape=(2, 49))
    given = {"M": np.linspace(1.0, 2.0, 49), "K": NET, "C": 0.01 * NET, "Q": Q, "gap0": np.array([0.05, 0.02]),
             "velocity": -np.linspace(0.5, 1.5, 49), "load": np.full(49, -0.01),
             "forcing": (ct.bodies.Forcing(shape=np.linspace(0.0, 1.0, 49), amplitude=np.sin),)}  # fmt: skip
    return ct.LinearBody(**(given | change))


def test_entries_of_damping_that_equal_those_of_stiffness_are_seen_beside_them():
    # found by its order: what cancelled would be no entry
    order, wide = packing._ordered(thrown(C=NET))
    np.testing.assert_array_equal(order, packing._ordered(thrown(C=2.0 * NET))[0])
    assert wide == packing._ordered(thrown(C=2.0 * NET))[1]


def kept(monkeypatch, empty, body, method, **more):
    monkeypatch.setattr(packing, "EMPTY", empty)
    return ct.run(
        body,
        law=method.law,
        scheme=method.scheme,
        t_end=8.0,
        dt=0.1,
        record=ct.Record(state_every=1),
        on_limit="flag",
        **more,
    )


@pytest.mark.slow
@pytest.mark.parametrize("method", methods(5.0), ids=lambda method: method.name)
def test_every_scheme_runs_on_entries_as_on_bands(method, monkeypatch):
    lumped = {"C": np.full(49, 0.02), "M": np.ones(49)} if isinstance(method.scheme, ct.scheme.MasslessBoundary) else {}
    bands, lists = (kept(monkeypatch, empty, thrown(**lumped), method) for empty in (10**9, 0))
    assert bands.contact_steps.min() > 3
    np.testing.assert_allclose(lists.state, bands.state, atol=1e-11 * np.abs(bands.state).max())
    np.testing.assert_allclose(lists.force, bands.force, atol=1e-9 * bands.force.max())
    assert abs(lists.energy.unaccounted) <= 1e-12 * lists.energy.scale


@pytest.mark.slow
def test_a_consistent_mass_matrix_too(monkeypatch):
    bands, lists = (
        kept(monkeypatch, empty, thrown(M=CONSISTENT), next(m for m in methods(1.0) if "Moreau" in m.name))
        for empty in (10**9, 0)
    )
    np.testing.assert_allclose(lists.state, bands.state, atol=1e-11 * np.abs(bands.state).max())


def test_narrow_bodies_keep_their_band_and_wide_ones_do_not():
    chain = ct.LinearBody(M=np.ones(7), K=LINE, Q=np.eye(7)[:1], gap0=[0.1])
    assert packing.linear_system(chain).K.sparse.start.size == 0
    points = 24
    line = diags_array([np.full(points - 1, -1.0), np.full(points, 2.0), np.full(points - 1, -1.0)], offsets=[-1, 0, 1])
    K = csr_array(kron(line, eye_array(points)) + kron(eye_array(points), line))
    wide = ct.LinearBody(M=np.ones(points**2), K=K, Q=np.eye(points**2)[:1], gap0=[0.1])
    assert packing.linear_system(wide).K.sparse.value.size == (K.nnz - points**2) // 2


def test_the_highest_frequency_is_not_underestimated(monkeypatch):
    for mass in (np.linspace(1.0, 2.0, 49), CONSISTENT):
        found = []
        for empty in (10**9, 0):
            monkeypatch.setattr(packing, "EMPTY", empty)
            found.append(packing.omega_max(packing.linear_system(thrown(M=mass))))
        assert found[0] <= found[1] <= found[0] * (1.0 + 1e-6)


def test_packed_entries_are_the_matrix_and_its_factor_solves():
    order = fill_order(NET)
    A = band(NET, order, wide=True)
    np.testing.assert_array_equal(sparse_form(A).toarray(), NET.toarray()[np.ix_(order, order)])
    both = combine((2.0, A), (3.0, band(eye_array(49), order, wide=True)))
    dense = 2.0 * NET.toarray()[np.ix_(order, order)] + 3.0 * np.eye(49)
    np.testing.assert_allclose(sparse_form(both).toarray(), dense, atol=1e-14)
    right = np.random.default_rng(3).standard_normal((49, 3))
    np.testing.assert_allclose(solve(factor(both, "A"), right), np.linalg.solve(dense, right), atol=1e-13)
    assert all(np.all(column > row) for row, column, _ in [pairs(both)])


def test_an_indefinite_matrix_is_refused(monkeypatch):
    monkeypatch.setattr(packing, "EMPTY", 0)
    bad = csr_array(eye_array(49) - 0.3 * NET + 1.2 * eye_array(49))
    with pytest.raises(ct.InputError, match="M: found"):
        ct.run(thrown(M=bad), scheme=ct.MoreauJean(), t_end=1.0, dt=0.1)


@pytest.mark.parametrize("wide", [False, True])
@pytest.mark.parametrize(
    ("entries", "band_says", "entries_say"),
    [
        ([[2.0, 1.0], [1.0, 0.25]], "not positive definite", "not positive definite, pivot -0.25"),
        ([[2.0, 1.0], [1.0, 0.0]], *["a diagonal entry <= 0 in row 2, expected > 0"] * 2),
        ([[-1e-300, 1.0], [1.0, 2.0]], *["a diagonal entry <= 0 in row 1, expected > 0"] * 2),
        ([[2.0, 0.0], [0.0, np.nan]], *["a diagonal entry <= 0 in row 2, expected > 0"] * 2),
        (
            [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]],  # the second pivot is nothing
            "not positive definite",
            "pivots away from the diagonal, expected a positive definite matrix",
        ),
    ],
)
def test_a_factor_says_what_is_not_positive(entries, band_says, entries_say, wide):
    A = band(np.array(entries), np.arange(len(entries)), wide=wide)
    with pytest.raises(ct.InputError, match=f"^M: found .*{entries_say if wide else band_says}"):
        factor(A, "M")


def test_a_consistent_mass_matrix_has_its_highest_frequency_up_to_a_size(monkeypatch):
    """Linear elements of a bar held at both ends: omega^2 = 6 (1 - cos a)/(2 + cos a), a = pi n/(n + 1)."""
    monkeypatch.setattr(packing, "DENSE", 40)

    def highest(n):
        K, M = (diags_array([np.full(n - 1, off), np.full(n, on), np.full(n - 1, off)], offsets=[-1, 0, 1])
                for on, off in ((2.0, -1.0), (2.0 / 3.0, 1.0 / 6.0)))  # fmt: skip
        body = ct.LinearBody(M=M, K=K, Q=csr_array(([1.0], ([0], [0])), shape=(1, n)), gap0=[0.1])
        return packing.omega_max(packing.linear_system(body))

    cos = np.cos(np.pi * 40 / 41)
    assert highest(40) == pytest.approx(np.sqrt(6.0 * (1.0 - cos) / (2.0 + cos)), rel=1e-12)
    words = "M: found a consistent mass matrix of 41 coordinates, expected at most 40, or lumped"
    with pytest.raises(ct.InputError, match=words):
        highest(41)


@pytest.mark.parametrize("wide", [False, True])
def test_a_singular_matrix_is_refused(wide):
    with pytest.raises(ct.InputError, match="M: found a matrix that is not positive definite"):
        factor(band(csr_array(np.ones((2, 2))), np.arange(2), wide=wide), "M")


def test_springs_between_masses_alone_hold_nothing_to_the_ground_whatever_round_off_leaves():
    """Rows of a free chain sum to zero but for the last digits of their entries, 1e7 times those of another."""
    k = np.array([0.1, 0.7, 1e6 / 3.0, 0.3])
    chain = diags_array([np.append(k, 0.0) + np.append(0.0, k), -k, -k], offsets=[0, 1, -1]).toarray()
    assert np.any(chain.sum(axis=1) != 0.0)
    found = band(chain, np.arange(5))
    assert found.ground.tolist() == [0.0] * 5
    chain[4, 4] += 1e-3
    assert np.count_nonzero(band(chain, np.arange(5)).ground) == 1
