"""Splines along the axis: sums, exact derivatives, what natural means, complex coefficients, the way to a shell."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import casingfem as cf

ENDS = {"z_low": 0.05, "z_high": 0.25}
BASES = [
    cf.field.Spline(**ENDS, intervals=5),
    cf.field.Spline(**ENDS, intervals=5, natural=True),
    cf.field.Spline(**ENDS, intervals=1, degree=2),
]
Z = np.linspace(0.06, 0.24, 23) + 1e-4


def wavy(basis: cf.field.Spline, seed: int = 3) -> cf.FourierField:
    cos, sin = np.random.default_rng(seed).normal(size=(2, 2, basis.size))
    return cf.FourierField(p=[2, 5], cos=cos, sin=sin, spline=basis)


@pytest.mark.parametrize("basis", BASES)
def test_functions_sum_to_one_and_their_means_are_means(basis):
    value, first, _ = basis.evaluate(Z)
    assert value.shape == (23, basis.size)
    np.testing.assert_allclose(value.sum(axis=1), 1.0, rtol=1e-13)
    np.testing.assert_allclose(first.sum(axis=1), 0.0, atol=1e-9)
    x, w = np.polynomial.legendre.leggauss(4)
    breaks = np.linspace(0.05, 0.25, basis.intervals + 1)
    places = (breaks[:-1, None] + np.diff(breaks)[:, None] * (x + 1) / 2).ravel()
    mean = np.tile(w / 2, basis.intervals) @ basis.evaluate(places)[0] / basis.intervals
    np.testing.assert_allclose(basis.means, mean, atol=1e-14)


@pytest.mark.parametrize("basis", BASES)
def test_derivatives_agree_with_central_differences(basis):
    field, h, theta = wavy(basis), 1e-6, 0.4
    at, plus, minus = (field.derivatives(z, theta) for z in (Z, Z + h, Z - h))
    for exact, high, low in ((at.d_z, plus.value, minus.value), (at.d_zz, plus.d_z, minus.d_z),
                             (at.d_z_theta, plus.d_theta, minus.d_theta)):  # fmt: skip
        np.testing.assert_allclose(exact, (high - low) / (2 * h), atol=1e-5 * np.abs(exact).max())
    stepped = field.derivatives(Z + 1e-30j, theta)
    np.testing.assert_allclose(stepped.value.imag / 1e-30, at.d_z, rtol=1e-12)
    np.testing.assert_allclose(stepped.d_z.imag / 1e-30, at.d_zz, rtol=1e-12)


def test_a_natural_spline_is_scipys_and_goes_on_straight():
    basis = cf.field.Spline(**ENDS, intervals=4, natural=True)
    knots = np.linspace(0.05, 0.25, 5)
    heights = np.array([0.3, -0.1, 0.5, 0.2, 0.7])
    coefficients = np.linalg.solve(basis.evaluate(knots)[0], heights)
    inside = np.linspace(0.05, 0.25, 41)
    np.testing.assert_allclose(
        basis.evaluate(inside)[0] @ coefficients, CubicSpline(knots, heights, bc_type="natural")(inside), atol=1e-13
    )
    beyond = basis.evaluate(np.array([0.0, 0.02, 0.04]))
    assert np.ptp(np.diff(beyond[0] @ coefficients)) < 1e-13
    assert not np.any(beyond[2])


def test_the_constant_part_is_the_mean_and_may_be_complex():
    basis = BASES[0]
    field = wavy(basis)
    assert field.coefficients(2)[0] == pytest.approx(basis.means @ field.cos[0], rel=1e-14)
    moved = field.with_harmonic(2, cos=0.7 + 1e-30j)
    assert moved.coefficients(2)[0] == pytest.approx(0.7, rel=1e-13)
    change = moved.derivatives(Z, 0.0).value - field.derivatives(Z, 0.0).value
    assert np.ptp(change.real) < 1e-12  # the shape along z stays
    np.testing.assert_allclose(change.imag, 1e-30, rtol=1e-12)
    added = field.with_harmonic(9, sin=0.2)
    assert added.spline is basis
    np.testing.assert_allclose((added.derivatives(Z, 0.1).value - field.derivatives(Z, 0.1).value), 0.2 * np.sin(0.9))


def test_sums_merge_on_one_spline_only():
    one, two, other = wavy(BASES[0]), wavy(BASES[0], seed=4), wavy(BASES[1])
    assert isinstance(one + two, cf.FourierField)
    for a, b in ((one, two), (one, other), (one, cf.FourierField.of({2: 0.1}))):
        total = (a + b).derivatives(Z, 0.3).value
        np.testing.assert_allclose(total, cf.field.SumField((a, b)).derivatives(Z, 0.3).value, atol=1e-13)
    assert isinstance(one + other, cf.field.SumField)
    with pytest.raises(cf.errors.ModelError, match="found no fields, expected at least one"):
        cf.field.SumField(())
    turned = one.rotated(0.2).derivatives(Z, 0.5).value
    np.testing.assert_allclose(turned, one.derivatives(Z, 0.3).value, atol=1e-13)


@pytest.mark.slow
def test_a_spline_of_the_height_passes_complex_steps_of_the_chart(frustum, coarse):
    """The derivative by the casing's height, for which z itself is complex, against central differences."""
    basis = cf.field.Spline(z_low=0.0, z_high=0.25, intervals=3)
    cos = np.array([[0.001, 0.004, -0.002, 0.003, 0.001, 0.002]])
    shell = frustum(mesh=coarse, radius_defect=cf.FourierField(p=[3], cos=cos, sin=0 * cos, spline=basis))
    found = cf.modes(shell, 6)
    vary = [cf.Parameter(name=name, lower=-1.0, upper=1.0) for name in ("chart.height", "radius.p3.cos")]
    exact = np.einsum("pii->pi", cf.updating.eigen_derivatives(found, vary))
    for k, parameter in enumerate(vary):
        x, h = cf.updating.get_value(shell, parameter.name), 1e-6
        high, low = (cf.modes(cf.updating.with_value(shell, parameter.name, v), 6).omega ** 2 for v in (x + h, x - h))
        pairs = np.array([list(pair) for pair in found.doublets])
        numeric, own = ((high - low) / (2 * h))[pairs].mean(axis=1), exact[k][pairs].mean(axis=1)
        np.testing.assert_allclose(own, numeric, rtol=2e-5, atol=2e-5 * np.abs(numeric).max())


@pytest.mark.parametrize("values", [{"z_high": 0.0}, {"intervals": 0}, {"degree": 1}, {"degree": 4, "natural": True}])
def test_splines_that_are_none_are_refused(values):
    with pytest.raises(cf.errors.ModelError, match="field-spline"):
        cf.field.Spline(**({**ENDS, "intervals": 3} | values))


def test_coefficients_must_fit_the_spline():
    with pytest.raises(cf.errors.ModelError, match=r"shape \(1, 3\), expected \(1, 8\), as the spline has"):
        cf.FourierField(p=[2], cos=np.ones((1, 3)), sin=np.ones((1, 3)), spline=BASES[0])


def test_repr_of_a_splined_field_shows_its_ends():
    assert repr(wavy(BASES[0])).splitlines()[0].endswith(", 8 splines along z from 0.05 to 0.25 m)")
