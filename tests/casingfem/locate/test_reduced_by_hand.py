"""A reduced casing of six given motions: its modes, the misfit of a table, and its slopes."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import eigh

import casingfem as cf
from casingfem.locate.misfit import Misfit, widest
from casingfem.modal.affine import AffineModel
from casingfem.modal.harmonics import Rings

SQUARE = (2.0 * np.pi) ** 2
FREQ = np.array([100.0, 101.0, 150.0, 152.0, 170.0, 200.0])
ORDERS = ((3, 0.2), (3, 0.2 + np.pi / 6), (5, 0.1), (5, 0.1 + np.pi / 10), (0, 0.0), (2, 0.3))
RNG = np.random.default_rng(41)
SHIFT = SQUARE * 30.0**2


def symmetric(size, count, times):
    parts = RNG.standard_normal((count, size, size))
    return times * (parts + parts.transpose(0, 2, 1))


STIFFNESS, HALVES = symmetric(6, 3, SQUARE * 60.0), 0.05 * RNG.standard_normal((3, 6, 6))
MASS = HALVES @ HALVES.transpose(0, 2, 1)


def model(**changes):
    amplitudes = np.zeros((7, 2, 3, 6), dtype=complex)
    for mode, (n, psi) in enumerate(ORDERS):
        amplitudes[n, :, 0, mode] = np.array([1.0, 0.4]) * np.exp(-1j * n * psi)
        amplitudes[n, :, 1, mode] = 0.2j * np.exp(-1j * n * psi)
    given = {
        "system": None, "nominal": SimpleNamespace(rigid=0), "motions": np.eye(6),
        "K": np.diag(SQUARE * FREQ**2 + SHIFT), "M": np.eye(6), "shift": SHIFT, "stiffness": STIFFNESS, "mass": MASS,
        "rings": Rings(amplitudes, np.array([0.3, 0.7])),
    }  # fmt: skip
    return AffineModel(**(given | changes))


X = np.array([0.4, 0.0, -0.7])


@pytest.mark.parametrize("count", [4, 6])
def test_modes_after_changes_are_those_of_the_changed_matrices(count):
    found = model().modes(X, count)
    K = np.diag(SQUARE * FREQ**2) + np.tensordot(X, STIFFNESS, 1)
    M = np.eye(6) + np.tensordot(X, MASS, 1)
    values, vectors = eigh(K, M)
    np.testing.assert_allclose(found.freq, np.sqrt(values[:count] / SQUARE), rtol=1e-10)
    np.testing.assert_allclose(np.abs(found.coordinates.T @ M @ vectors[:, :count]), np.eye(count), atol=1e-7)
    assert found.nodal_diameters.tolist() == [3, 3, 5, 5, 0, 2][:count]
    assert found.doublets == ((0, 1), (2, 3))
    assert found.meridional.tolist() == [1] * count
    assert (found.rigid, found.dofs, found.sturm_count) == (0, 6, None)
    np.testing.assert_allclose(found.rings.amplitudes, model().rings.amplitudes @ found.coordinates, atol=1e-12)
    rigid = model(nominal=SimpleNamespace(rigid=1)).modes(X, count)
    assert rigid.nodal_diameters[0] == -1


@pytest.mark.parametrize("parts", [{}, {"mass": None}, {"stiffness": None}])
def test_derivatives_are_those_of_the_changed_matrices(parts):
    given = model(**parts)
    found = given.modes(X, 5)
    G, y = given.derivatives(found), found.coordinates
    for c in range(3):
        for j in range(5):
            for i in range(5):
                k = y[:, i] @ STIFFNESS[c] @ y[:, j] if given.stiffness is not None else 0.0
                m = y[:, i] @ MASS[c] @ y[:, j] if given.mass is not None else 0.0
                assert G[c, i, j] == pytest.approx(k - SQUARE * found.freq[i] ** 2 * m, rel=1e-9, abs=1e-6)
    assert given.changes == 3


TABLE = cf.FrequencyTable.from_arrays(
    freq_hz=[99.0, 101.5, 150.5, 153.0, 169.0], sigma_hz=[0.1, 0.2, 0.1, 0.3, 0.2], n=[3, 3, 5, 5, 0],
    angle_deg=[14.0, np.nan, np.nan, np.nan, np.nan],
)  # fmt: skip


@pytest.mark.parametrize("more", [{}, {"angle_sigma": 0.2}, {"model_error": 2e-3}])
def test_slopes_of_a_misfit_are_those_of_its_residuals(more):
    """All six modes are computed, so that the turning of the measured pair is whole."""
    misfit = Misfit(model=model(), table=TABLE, count=6, **more)
    at = misfit.at(X)
    assert len(at.values) == 3 + 2 + 1
    assert at.chi2 == pytest.approx(float(at.values @ at.values), rel=1e-12)
    assert at.lost == ()
    for c in range(3):
        step = 1e-5 * np.eye(3)[c]
        slope = (misfit.at(X + step).values - misfit.at(X - step).values) / 2e-5
        np.testing.assert_allclose(at.jacobian[:, c], slope, atol=2e-6 * np.abs(slope).max())


def test_a_row_that_pairs_with_nothing_costs_a_tenth_of_itself():
    far = cf.FrequencyTable.from_arrays(freq_hz=[100.0, 900.0], sigma_hz=[0.1, 3.0], n=[3, 4])
    at = Misfit(model=model(), table=far, count=6).at(np.zeros(3))
    assert at.lost == (1,)
    assert len(at.values) == 1
    assert at.chi2 == pytest.approx(at.values[0] ** 2 + 30.0**2, rel=1e-12)
    none = Misfit(model=model(), table=far.without(1), count=6).at(np.zeros(3))
    assert none.chi2 == pytest.approx(900.0)
    assert none.values.shape == (0,)
    assert none.jacobian.shape == (0, 3)
    near = replace(far, freq_hz=np.array([100.0, 259.9]))
    assert Misfit(model=model(), table=near, count=6).at(np.zeros(3)).lost == ()  # 200 Hz and 30 %
    assert Misfit(model=model(), table=replace(far, freq_hz=np.array([100.0, 260.1])), count=6).at(X * 0).lost == (1,)


@pytest.mark.parametrize(("apart", "turned"), [(0.99e-6, True), (1.01e-6, False)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_perfect_pair_is_differentiated_along_the_axes_of_each_change(apart, turned, sign):
    """Eigenvalues of [[4, 2], [2, 1]]: 5 and 0; the lower member takes the larger by size."""
    G = sign * np.array([[[4.0, 2.0, 9.0], [2.0, 1.0, 8.0], [9.0, 8.0, 7.0]]])
    found = SimpleNamespace(freq=np.array([100.0, 100.0 * (1.0 + apart), 200.0]))
    result = widest(found, [(0, 1)], G)
    expected = G.copy()
    if turned:
        expected[0, :2, :2] = sign * np.diag([5.0, 0.0])
    np.testing.assert_allclose(result, expected, atol=1e-12)
    assert G[0, 0, 1] == sign * 2.0
