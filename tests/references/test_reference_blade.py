"""The fan blade of Olson and Lindberg (data/reference/olson_lindberg_fan_blade.csv)."""

import numpy as np
import pytest

import casingfem as cf


def blade(**changes):
    return cf.Shell(
        chart=cf.Panel(radius=0.6096, length=0.3048, angle=0.5),
        thickness=3.048e-3,
        material=cf.Material(E=206.85e9, nu=0.3, rho=7857.2),
        supports={"root": cf.Clamped()},
        **changes,
    )


@pytest.fixture(scope="module")
def table(reference):
    return reference("olson_lindberg_fan_blade.csv")


def test_model_as_it_comes_is_within_03_percent_of_the_seven_converged_values(table):
    """Default mesh: all seven 0.05 to 0.26 % below thin-shell theory.

    A fully converged first-order shear model lies up to 0.42 % below (sixth to twelfth mode: 0.45 %), because thin
    shells have no shear layer at the free edges; see the Kirchhoff limit below.
    """
    error = cf.modes(blade(), 12).freq[:7] / table.computed_love_ritz_hz[:7].to_numpy() - 1
    assert np.abs(error).max() < 3e-3
    assert np.all(error < 0.0)


@pytest.mark.slow
def test_kirchhoff_limit_meets_all_twelve_thin_shell_values(table):
    """Transverse shear made stiff: within 0.09 % on order 10, 3 x 3 elements, on every mode."""
    thin = cf.modes(blade(shear_correction=100.0, mesh=cf.ShellMesh(order=10, rows=3, around=3)), 12)
    np.testing.assert_allclose(thin.freq, table.computed_love_ritz_hz, rtol=1e-3)


@pytest.mark.slow
def test_converged_shear_model_lies_below_thin_shell_theory_by_its_edge_layers(table):
    fine = cf.modes(blade(mesh=cf.ShellMesh(order=8, rows=(0.0, 0.02, 0.5, 0.98, 1.0), around=4)), 12)
    error = fine.freq / table.computed_love_ritz_hz.to_numpy() - 1
    assert np.all(error < 0.0)
    assert np.abs(error[:7]).max() < 4.5e-3


@pytest.mark.slow
def test_distance_to_the_measurement_before_updating(table):
    """RMS 2.3 to 2.5 % over seven modes: what updating has to explain."""
    error = cf.modes(blade(), 7).freq / table.measured_AFFDL_hz[:7].to_numpy() - 1
    assert 0.022 < np.sqrt(np.mean(error**2)) < 0.026
    assert cf.modes(blade(), 7).nodal_diameters.max() == -1
