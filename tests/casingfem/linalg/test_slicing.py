"""Bands: every mode and no other, ends on modes, doubles across ends, many modes in slices, other factorisations."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csc_array

from casingfem.errors import NumericsError
from casingfem.linalg import slicing
from casingfem.linalg.eigen import solve_band, solve_modes
from casingfem.linalg.factor import factorise
from casingfem.linalg.krylov import nearest


def with_spectrum(values, seed=3, sparse_mass=False):
    """K and M of a given spectrum, in a random basis."""
    rng = np.random.default_rng(seed)
    Q, _ = np.linalg.qr(rng.standard_normal((len(values), len(values))))
    K = (Q * values) @ Q.T
    if not sparse_mass:
        return csc_array(0.5 * (K + K.T)), np.ones(len(values))
    L = np.eye(len(values)) + 0.1 * np.tril(rng.standard_normal(Q.shape), -1) / np.sqrt(len(values))
    K = L @ K @ L.T
    return csc_array(0.5 * (K + K.T)), csc_array(L @ L.T)


def inside(values, low, high):
    return np.sort(values[(values >= low * (1 - 1e-7)) & (values <= high * (1 + 1e-7))])


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**31), st.integers(20, 90), st.integers(1, 7), st.booleans())
@pytest.mark.slow
def test_a_band_holds_every_mode_and_no_other(seed, size, most, sparse_mass):
    """Random spectra with clusters of up to seven equal values; ends now and then on a mode."""
    rng = np.random.default_rng(seed)
    base = np.cumsum(rng.uniform(0.01, 1.0, size))
    values = np.repeat(base, rng.integers(1, most + 1, size))[:size] + 0.5
    ends = np.sort(rng.choice(base, 2, replace=False)) + 0.5
    low, high = ends + rng.choice([0.0, 1e-3], 2) * [-1, 1]
    K, M = with_spectrum(values, seed, sparse_mass)
    found = solve_band(K, M, (low, high), shift=-0.01)
    np.testing.assert_allclose(found.eigenvalues, inside(values, low, high), rtol=1e-9)
    assert found.sturm_count == len(found.eigenvalues)


def test_an_end_between_the_members_of_a_double_keeps_both():
    values = np.r_[np.arange(1.0, 30.0), 10.0 * (1 + 1e-9), 20.0 * (1 + 1e-9)]
    K, M = with_spectrum(values)
    found = solve_band(K, M, (10.0 * (1 + 5e-10), 20.0 * (1 + 5e-10)), shift=-0.01)
    assert len(found.eigenvalues) == 13
    assert found.eigenvalues[[0, -1]] == pytest.approx([10.0, 20.0], rel=1e-8)


def test_many_modes_are_found_in_slices(monkeypatch):
    monkeypatch.setattr(slicing, "MANY", 8)
    values = np.r_[np.arange(1.0, 101.0), np.full(12, 50.0), np.arange(1.0, 30.0) + 1e-12]
    K, M = with_spectrum(values)
    found = solve_band(K, M, (0.0, 80.5), shift=-0.01)
    np.testing.assert_allclose(found.eigenvalues, inside(values, 0.0, 80.5), rtol=1e-9)
    np.testing.assert_allclose(found.vectors.T @ found.vectors, np.eye(len(found.eigenvalues)), atol=1e-8)


def test_an_empty_band_is_empty():
    found = solve_band(*with_spectrum(np.arange(1.0, 40.0)), (3.2, 3.7), shift=-0.01)
    assert found.eigenvalues.shape == (0,)
    assert found.vectors.shape == (39, 0)


def test_a_band_from_zero_holds_the_rigid_motions():
    values = np.r_[np.zeros(6), np.arange(1.0, 40.0)]
    found = solve_band(*with_spectrum(values), (0.0, 2.5), shift=-0.01)
    np.testing.assert_allclose(found.eigenvalues, [0, 0, 0, 0, 0, 0, 1, 2], atol=1e-12)


@pytest.mark.parametrize("band", [(-1.0, 2.0), (3.0, 3.0), (4.0, 2.0), (0.0, np.inf), (np.nan, 2.0)])
def test_refuses_a_band_that_is_none(band):
    with pytest.raises(NumericsError, match="a band runs from 0 or above to a higher end"):
        solve_band(*with_spectrum(np.arange(1.0, 40.0)), band, shift=-0.01)


def test_a_mode_lost_in_a_slice_is_an_error(monkeypatch):
    def losing(*arguments):
        found = nearest(*arguments)
        return type(found)(values=found.values[1:], vectors=found.vectors[:, 1:], products=found.products)

    monkeypatch.setattr(slicing, "nearest", losing)
    with pytest.raises(NumericsError, match="5 modes lie in"):
        solve_band(*with_spectrum(np.arange(1.0, 40.0)), (3.3, 8.3), shift=-0.01)


@pytest.mark.slow
def test_a_slice_with_a_mode_wherever_a_shift_may_stand_is_an_error():
    """With one place free the band is whole."""
    low, high = 10.0 * (1.0 - 1e-7), 20.0 * (1.0 + 1e-7)  # as an end moves to meet a mode on it
    taken = [low + place * (high - low) for place in slicing.PLACES]
    for modes in (taken[:-1], taken):
        spectrum = np.r_[np.arange(1.0, 10.0), 10.5, 19.5, np.arange(21.0, 50.0), modes]
        if modes == taken:
            with pytest.raises(NumericsError, match=r"no shift between 10 and 20 .* lies clear of the modes"):
                solve_band(*with_spectrum(spectrum), (10.0, 20.0), shift=-0.01)
        else:
            found = solve_band(*with_spectrum(spectrum), (10.0, 20.0), shift=-0.01)
            np.testing.assert_allclose(found.eigenvalues, inside(spectrum, 10.0, 20.0), rtol=1e-10)


def test_a_cluster_larger_than_the_block_is_found_whole():
    values = np.r_[np.full(21, 2.0), np.arange(3.0, 60.0)]
    K, M = with_spectrum(values)
    found = solve_modes(K, M, 23, shift=-0.01)
    np.testing.assert_allclose(found.eigenvalues, np.sort(values)[:23], rtol=1e-10)


def test_refuses_a_factorisation_it_does_not_know():
    with pytest.raises(NumericsError, match="direct must be one of multifrontal, superlu, pardiso, found 'cholmod'"):
        factorise(csc_array(np.eye(3)), "cholmod")
