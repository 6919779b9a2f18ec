"""Tables in rad/s, kHz or 1/min are called so, tables in Hz never."""

import math

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.correlation.matches import other_unit

N = np.array([8, 8, 7, 7, 9, 9, 6, 6, 8, 8])
FREQ = np.array([343.0, 345.0, 351.0, 353.0, 366.0, 367.0, 395.0, 396.0, 510.0, 512.0])
FACTORS = {"rad/s": 2.0 * math.pi, "kHz": 1e-3, "1/min": 60.0, "": 1.0}


@pytest.mark.parametrize("unit", FACTORS)
@pytest.mark.parametrize("labels", [N, -1])
def test_the_unit_is_seen_through_the_error_of_a_model(unit, labels):
    """Also where one of two rows was measured, and modes come in another order."""
    off = 1.0 + np.random.default_rng(5).uniform(-0.08, 0.08, N.size)
    rows = slice(None, None, 2) if np.ndim(labels) else slice(None)
    freq, n = (FREQ * off * FACTORS[unit])[rows], labels[rows] if np.ndim(labels) else labels
    table = cf.FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=1e-3 * freq, n=n)
    assert other_unit(table, FREQ, N) == unit
    assert np.ndim(labels) or other_unit(table, FREQ, None) == unit


def test_a_table_of_high_modes_alone_is_in_hz():
    table = cf.FrequencyTable.from_arrays(freq_hz=2.0 * math.pi * FREQ[:4] * [1.0, 1.5, 1.0, 1.0], sigma_hz=1.0)
    assert other_unit(table, FREQ, N) == ""


@pytest.mark.parametrize(("unit", "factor"), [("rad/s", 2.0 * math.pi), ("kHz", 1e-3)])
@pytest.mark.slow
def test_an_update_refuses_them_before_it_computes_all_modes_below(unit, factor):
    chart = cf.geometry.Cylinder(radius=0.2, height=0.2)
    steel = cf.Material(E=2e11, nu=0.3, rho=7800.0)
    shell = cf.Shell(chart=chart, thickness=2e-3, material=steel, supports={"base": cf.Clamped()})
    found = cf.modes(shell, 8)
    freq = 1.03 * factor * found.freq
    table = cf.FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=1e-3 * freq, n=found.nodal_diameters, path="t.csv")
    with pytest.raises(cf.errors.InputError, match=f"t.csv, column 'freq_hz': found .* as of {unit}; expected Hz"):
        cf.update(shell, table, [cf.Parameter(name="material.E", lower=1e11, upper=3e11)])


def test_an_update_takes_two_of_the_lowest_few_modes_that_are_as_two_pi_to_one_with_the_first():
    """A slender cantilever bends at 1, 6.267, 17.55 and 34.39."""
    steel = cf.Material(E=2e11, nu=0.0, rho=7800.0)
    strip = cf.Shell(
        chart=cf.geometry.Plate(length=0.4, width=0.03), thickness=2e-3, material=steel,
        supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=6, rows=3, around=1),
    )  # fmt: skip
    freq = cf.modes(strip, 6).freq
    table = cf.FrequencyTable.from_arrays(freq_hz=freq[[1, 5]], sigma_hz=0.1)
    assert other_unit(table, freq, None) == "rad/s"
    fit = cf.update(strip, table, [cf.Parameter(name="material.E", lower=1e11, upper=3e11)])
    assert fit.value == (pytest.approx(2e11, rel=1e-6),)
