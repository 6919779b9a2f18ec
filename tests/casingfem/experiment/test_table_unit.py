"""Tables in rad/s, kHz or 1/min are called so, tables in Hz never."""

import math

import pytest

import casingfem as cf


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
