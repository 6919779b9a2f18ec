"""Modes of a perfect casing in a band: those of the lowest ones, each harmonic counted at both ends."""

from itertools import pairwise

import numpy as np
import pytest

import casingfem as cf
from casingfem.modal.fourier import fourier_band, fourier_modes


@pytest.fixture(scope="module")
def casing(frustum):
    return frustum(thickness=2e-2, mesh=cf.ShellMesh(order=4, rows=1, around=7))


@pytest.fixture(scope="module")
def lowest(casing):
    return fourier_modes(casing, 10)


def gaps(freq):
    """Middles between neighbours that are no pair."""
    return [0.5 * (a + b) for a, b in pairwise(freq) if b > 1.001 * a]


@pytest.mark.parametrize("count", [1, 3, 8])
def test_the_lowest_modes_are_the_same_however_many_are_asked_for(casing, lowest, count):
    few = fourier_modes(casing, count)
    assert len(few) == count
    np.testing.assert_allclose(few.freq, lowest.freq[:count], rtol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("first", [None, 0, 1])
@pytest.mark.parametrize("last", [2, 3])
def test_a_band_has_all_modes_between_its_ends(casing, lowest, first, last):
    between = gaps(lowest.freq)
    low, high = 0.0 if first is None else between[first], between[last]
    found = fourier_band(casing, (low, high))
    inside = (lowest.freq > low) & (lowest.freq < high)
    np.testing.assert_allclose(found.freq, lowest.freq[inside], rtol=1e-8)
    assert found.nodal_diameters.tolist() == lowest.nodal_diameters[inside].tolist()
    assert len(found) == found.sturm_count == np.count_nonzero(inside)


def test_a_band_below_all_modes_is_empty(casing, lowest):
    found = fourier_band(casing, (0.0, 0.9 * lowest.freq[0]))
    assert (len(found), found.sturm_count) == (0, 0)


def test_a_band_from_nothing_on_has_the_rigid_motions_of_a_free_casing(frustum):
    free = frustum(thickness=2e-2, mesh=cf.ShellMesh(order=4, rows=1, around=7), supports={})
    elastic = fourier_modes(free, 8).freq[6:]
    found = fourier_band(free, (0.0, 1.05 * elastic[1]))
    assert found.rigid == 6
    np.testing.assert_allclose(found.freq[6:8], elastic, rtol=1e-6)
    assert len(found) == found.sturm_count
