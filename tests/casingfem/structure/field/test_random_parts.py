"""Spectra between their points, random fields by their own random numbers, and fields split into their parts."""

import numpy as np
import pytest
from scipy.stats import lognorm

import casingfem as cf

SPECTRUM = cf.field.Spectrum(p=[2, 5], median=[0.2, 0.1], high=[0.6, 0.15])


def test_amplitudes_are_lognormal_by_median_and_ninetieth_percentile():
    """Quantiles of the distribution whose logarithm has the standard deviation ln(high/median)/1.2816."""
    for at in (0.1, 0.5, 0.9, 0.97):
        exact = [lognorm.ppf(at, np.log(h / m) / 1.2815515655446004, scale=m) for m, h in ((0.2, 0.6), (0.1, 0.15))]
        np.testing.assert_allclose(SPECTRUM.amplitudes([at, at]), exact, rtol=1e-12)
    np.testing.assert_allclose(SPECTRUM.amplitudes([0.5, 0.9]), [0.2, 0.15], rtol=1e-14)


def test_a_spectrum_between_its_points_and_beyond():
    """Both halve from 2 to 8 as p^(-1/2): the median goes on so, its ratio to the high one stays as it was at 8."""
    found = cf.field.Spectrum.between({2: 0.4, 8: 0.2}, {2: 1.2, 8: 0.3}, p_max=32)
    assert found.p.tolist() == list(range(2, 33))
    np.testing.assert_allclose(found.median, 0.4 * (found.p / 2.0) ** -0.5, rtol=1e-12)
    np.testing.assert_allclose(found.high / found.median, 3.0 * (np.minimum(found.p, 8) / 2.0) ** -0.5, rtol=1e-12)


def test_scaled_spectra_keep_their_ratio():
    twice = SPECTRUM.scaled(2.0)
    np.testing.assert_allclose([twice.median, twice.high], [[0.4, 0.2], [1.2, 0.3]], rtol=1e-15)
    one = cf.field.Spectrum.between({3: 0.2}, {3: 0.5}, p_max=6)
    np.testing.assert_allclose([one.median, one.high], [[0.2] * 4, [0.5] * 4], rtol=1e-14)
    assert cf.field.Spectrum.between({3: 0.2, 5: 0.1}, {3: 0.5}).p.tolist() == [3, 4, 5]


@pytest.mark.parametrize(("draw", "stream"), [(0, 0), (4, 0), (0, 2), (4, 2)])
def test_a_draw_is_that_of_its_own_numbers(draw, stream):
    """A row of two for each harmonic: probability of the amplitude, part of a turn of the phase."""
    field = cf.field.RandomField(spectrum=SPECTRUM, seed=3, draw=draw, stream=stream)
    rows = np.random.default_rng([3, stream, draw]).random((2, 2))
    size, phase = SPECTRUM.amplitudes(rows[:, 0]), 2.0 * np.pi * rows[:, 1]
    np.testing.assert_allclose(field.fit.cos[:, 0], size * np.cos(phase), rtol=1e-12)
    np.testing.assert_allclose(field.fit.sin[:, 0], size * np.sin(phase), rtol=1e-12)
    again = field.redrawn(7)
    assert (again.draw, again.stream, again.seed, again.spectrum) == (7, stream, 3, SPECTRUM)
    assert field.amplitude(5) == pytest.approx(size[1], rel=1e-12)
    if not draw and not stream:
        np.testing.assert_array_equal(cf.field.RandomField(spectrum=SPECTRUM, seed=3).fit.cos, field.fit.cos)


def test_the_example_is_reported_in_walls():
    """Medians 0.24 t at n = 2 and 0.019 t at n = 12, twice as large by a scale of 2; t/R = 0.01."""
    field = cf.field.RandomField.example(thickness=5e-3, radius=0.5, seed=1, scale=2.0, stream=5)
    median = dict(zip(field.spectrum.p.tolist(), field.spectrum.median, strict=True))
    assert (median[2], median[12]) == (pytest.approx(0.0048, rel=1e-12), pytest.approx(0.00038, rel=1e-12))
    assert (max(median), field.stream, field.seed) == (32, 5, 1)
    plain = cf.field.RandomField.example(thickness=5e-3, radius=0.5, seed=1)
    assert (plain.stream, plain.spectrum.median[0]) == (0, pytest.approx(0.0024, rel=1e-12))


def test_a_series_by_hand_with_all_its_derivatives():
    """f = (0.3 + 0.2 zeta - 0.1 zeta^2) cos 3 theta + (0.5 zeta) sin 3 theta, zeta = (z - 0.2)/0.4."""
    field = cf.FourierField(p=[3], cos=[[0.3, 0.2, -0.1]], sin=[[0.0, 0.5, 0.0]], z_mid=0.2, z_half=0.4)
    z, theta = 0.5, 0.7
    zeta, c, s = 0.75, np.cos(2.1), np.sin(2.1)
    a, a1, a2 = 0.3 + 0.2 * zeta - 0.1 * zeta**2, (0.2 - 0.2 * zeta) / 0.4, -0.2 / 0.16
    b, b1 = 0.5 * zeta, 0.5 / 0.4
    exact = [
        a * c + b * s, a1 * c + b1 * s, 3 * (b * c - a * s), a2 * c, 3 * (b1 * c - a1 * s), -9 * (a * c + b * s),
    ]  # fmt: skip
    np.testing.assert_allclose([float(part) for part in field.derivatives(z, theta)], exact, rtol=1e-13)
    turned = field.rotated(0.4)
    assert float(turned.derivatives(z, theta + 0.4).value) == pytest.approx(exact[0], rel=1e-13)
    assert (turned.z_mid, turned.z_half) == (0.2, 0.4)


def test_harmonics_are_replaced_one_coefficient_at_a_time():
    field = cf.FourierField(p=[3, 5], cos=[[0.3, 0.2], [0.1, 0.0]], sin=[[0.0, 0.5], [0.4, 0.7]], z_mid=0.2, z_half=0.4)
    changed = field.with_harmonic(5, sin=0.9)
    assert (changed.cos.tolist(), changed.sin.tolist()) == ([[0.3, 0.2], [0.1, 0.0]], [[0.0, 0.5], [0.9, 0.7]])
    more = field.with_harmonic(2, cos=0.8)
    assert (more.harmonics, more.coefficients(2), more.cos[2].tolist()) == ((3, 5, 2), (0.8, 0.0), [0.8, 0.0])
    assert (more.z_mid, more.z_half, field.coefficients(9), field.amplitude(9)) == (0.2, 0.4, (0.0, 0.0), 0.0)
    spline = cf.field.Spline(z_low=0.0, z_high=0.4, intervals=2)
    splined = cf.FourierField(p=[3], cos=np.ones((1, 5)), sin=np.zeros((1, 5)), spline=spline)
    assert splined.coefficients(3) == (pytest.approx(1.0, rel=1e-14), 0.0)
    moved = splined.with_harmonic(3, cos=0.25).with_harmonic(6, sin=0.5)
    np.testing.assert_allclose(moved.cos[0], 0.25, rtol=1e-13)
    np.testing.assert_allclose(moved.sin[1], 0.5, rtol=1e-13)


@pytest.mark.parametrize(
    ("intervals", "degree", "natural", "size"), [(4, 3, False, 7), (4, 3, True, 5), (1, 2, False, 3)]
)
def test_the_number_of_splines_and_their_means(intervals, degree, natural, size):
    """Means by the integral of each function over 0.3 m, Gauss in each interval."""
    basis = cf.field.Spline(z_low=0.1, z_high=0.4, intervals=intervals, degree=degree, natural=natural)
    x, w = np.polynomial.legendre.leggauss(6)
    ends = np.linspace(0.1, 0.4, intervals + 1)
    z = (0.5 * (ends[:-1] + ends[1:])[:, None] + 0.5 * np.diff(ends)[:, None] * x).ravel()
    weights = (0.5 * np.diff(ends)[:, None] * w).ravel() / 0.3
    assert basis.size == size == len(basis.means)
    np.testing.assert_allclose(basis.means, weights @ basis.evaluate(z)[0], rtol=1e-12, atol=1e-15)


def test_the_mesh_of_all_draws_is_that_of_the_median_amplitudes(frustum):
    """A known harmonic of rising amplitude is resolved from the same one on, beside random ones or their medians."""
    spectrum = cf.field.Spectrum(p=[2, 5], median=[2e-4, 1e-4], high=[6e-4, 1.5e-4])
    drawn, medians = cf.field.RandomField(spectrum=spectrum, seed=3), cf.FourierField.of({2: 2e-4, 5: 1e-4})
    meshes = []
    for amplitude in np.geomspace(2e-8, 2e-4, 60).tolist():
        known = cf.FourierField.of({47: amplitude})
        random, fixed = (
            frustum(radius_defect=cf.field.SumField((one, known)), mesh=None).mesh for one in (drawn, medians)
        )
        assert random == fixed
        meshes.append(random.around)
    assert len(set(meshes)) > 1
