"""What a result says, on a fit of a blade whose numbers are replaced; the way down to it, step by step."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.updating.test_update_judged import blade, table, vary


@pytest.fixture(scope="module")
def fit():
    return cf.update(blade(), table(1e-3, rows=6), vary("material.E", "shell.thickness"), outliers="keep")


def test_the_floor_of_a_model_is_what_brings_chi_square_to_its_freedom(fit):
    """All sigma 1e-3 of their frequencies, four degrees of freedom: chi^2/(1 + s^2/1e-6) = 4."""
    far = replace(fit, values=np.array([3.0, -4.0, 5.0, 1.0, -2.0, 3.0]))
    assert far.chi2 == pytest.approx(64.0)
    assert far.model_floor == pytest.approx(1e-3 * np.sqrt(64.0 / 4.0 - 1.0), rel=1e-6)
    assert replace(fit, values=np.full(6, 0.8)).model_floor == 0.0
    assert replace(fit, values=np.full(6, 0.8165)).model_floor > 0.0
    assert far.free == 4
    assert far.residuals == 6
    assert far.misfit == pytest.approx(4.0)
    assert far.inflation == pytest.approx(4.0)
    np.testing.assert_allclose(far.sigma, 4.0 * fit.stated_sigma, rtol=1e-12)


@pytest.mark.parametrize(
    ("rms", "stopped", "arrived"),
    [(1.999, "converged: so", True), (2.001, "converged: so", False), (0.1, "stuck: so", False)],
)
def test_a_fit_has_arrived_where_it_converged_within_two_sigma(fit, rms, stopped, arrived):
    assert replace(fit, values=rms * np.array([1.0, -1.0] * 3), stopped=stopped).arrived is arrived


def test_parameters_that_correlate_beyond_95_per_cent_are_reported(fit):
    for r, told in ((0.951, True), (-0.951, True), (0.949, False)):
        C = np.array([[4.0, 2.0 * 3.0 * r], [2.0 * 3.0 * r, 9.0]])
        found = replace(fit, covariance=C)
        np.testing.assert_allclose(found.correlation, [[1.0, r], [r, 1.0]], rtol=1e-12)
        pairs = found.indistinct()
        assert pairs == ([("shell.thickness", "material.E", pytest.approx(r))] if told else [])
    blind = replace(fit, covariance=np.diag([4.0, 0.0]))
    np.testing.assert_array_equal(blind.correlation, [[1.0, 0.0], [0.0, 0.0]])


def test_rows_that_are_lost_or_unpaired_are_reported_by_their_numbers(fit):
    assert replace(fit, lost=(2, 4)).to_json()["lost"] == [3, 5]
    assert "because mode 3, 5 of the table could not be followed" in repr(replace(fit, lost=(2, 4)))
    assert replace(fit, pairing=replace(fit.pairing, unpaired_rows=(0, 3))).unpaired == (1, 4)
