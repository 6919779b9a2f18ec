"""Tables in another unit, or wrong by another factor, are refused with that factor; tables in Hz never are."""

import math
from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=2e11, nu=0.3, rho=7800.0)
E = [cf.Parameter(name="material.E", lower=1e10, upper=4e12)]


@pytest.fixture(scope="module")
def shell():
    chart = cf.geometry.Cylinder(radius=0.2, height=0.2)
    return cf.Shell(chart=chart, thickness=2e-3, material=STEEL, supports={"base": cf.Clamped()})


@pytest.fixture(scope="module")
def found(shell):
    return cf.modes(shell, 60)


def table_of(found, factor, rows=slice(8), labels=True):
    """Some modes as a table, with their frequencies times a factor."""
    freq = factor * found.freq[rows]
    n = found.nodal_diameters[rows] if labels else -np.ones(len(freq), int)
    return cf.FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=1e-3 * freq, n=n, path="t.csv")


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (2.0 * math.pi, r"as of rad/s; expected Hz; .*freq \[rad/s\]"),
        (60.0, r"as of 1/min; expected Hz; .*freq \[1/min\]"),
        (1e-3, r"as of kHz; expected Hz; .*freq \[kHz\]"),
        (0.5 / math.pi, "as of numbers in Hz that were converted from rad/s; expected Hz"),
        (1.0 / 60.0, "as of numbers in Hz that were converted from 1/min; expected Hz"),
        (1e3, "as of numbers in Hz that were converted from kHz; expected Hz"),
    ],
)
@pytest.mark.slow
def test_an_update_names_the_unit_that_explains_the_factor_between_table_and_model(shell, found, factor, words):
    with pytest.raises(cf.errors.InputError, match=f"t.csv, column 'freq_hz': found .* of 4 ratios.*, {words}"):
        cf.update(shell, table_of(found, 1.03 * factor), E)


@pytest.mark.parametrize(
    ("factor", "labels"), [(1.0 / 3.0, True), (2.0, True), (3.0, True), (4.0, True), (1.0 / 3.0, False), (2.0, False)]
)
@pytest.mark.slow
def test_an_update_refuses_a_table_beyond_the_reach_by_another_factor(shell, found, factor, labels):
    words = f"typically {1.03 * factor:.4g} times what is computed .*; expected frequencies in Hz, within 50% of the"
    with pytest.raises(cf.errors.InputError, match=words):
        cf.update(shell, table_of(found, 1.03 * factor, labels=labels), E)


@pytest.mark.slow
def test_a_wrong_row_does_not_hide_that_all_others_are_three_times_too_high(shell, found):
    table = table_of(found, 3.0, slice(12))
    table = replace(table, freq_hz=table.freq_hz * np.where(np.arange(12) < 2, 0.5, 1.0))
    with pytest.raises(cf.errors.InputError, match="typically 3 times what is computed"):
        cf.update(shell, table, E)


@pytest.mark.parametrize("factor", [0.7, 1.3])
@pytest.mark.slow
def test_a_start_model_that_is_thirty_per_cent_off_is_updated(shell, found, factor):
    fit = cf.update(shell, table_of(found, factor), E)
    assert fit.value[0] == pytest.approx(factor**2 * STEEL.E, rel=1e-6)


@pytest.mark.slow
def test_a_table_of_second_modes_alone_is_updated_although_all_are_three_times_above_the_first(shell, found):
    second = [k for n in (4, 5, 6) for k in np.flatnonzero(found.nodal_diameters == n)[2:4]]
    fit = cf.update(shell, table_of(found, 1.1, second), E)
    assert fit.value[0] == pytest.approx(1.21 * STEEL.E, rel=1e-6)
