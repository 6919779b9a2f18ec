"""What sensors do not see has no likeness: limits are relative, whatever the unit."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.correlation.correlate import seen_mac


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_modes_that_sensors_do_not_see_are_left_out_in_any_unit(unit):
    """The third mode is 1e-6 of the others, 1e-12 in mass, then 1e-10: below the limit of 1e-9 in both."""
    measured = np.array([[1.0, 0.2], [0.1, 1.0], [0.3, -0.4]])
    computed = np.array([[1.0, 0.0, 1e-6], [0.0, 1.0, 1e-6], [0.3, -0.5, 0.0]])
    mass = np.diag([2.0, 1.0, 3.0])
    nco = seen_mac(measured, computed, unit * mass)
    assert np.all(nco[:, 2] == 0.0)
    assert nco[:, :2] == pytest.approx(cf.correlation.mac(measured, computed[:, :2], mass))
    computed[:, 2] *= 1e-4
    found = seen_mac(measured, unit * computed)
    assert np.all(found[:, 2] == 0.0)
    assert found[:, :2] == pytest.approx(cf.correlation.mac(measured, computed[:, :2]))
