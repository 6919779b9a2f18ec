"""What the fits of bands hand on to each other."""

from dataclasses import replace

import numpy as np
import pytest

from casingfem.experiment.identify.band_fits import Responses, _modes, _of_band, _together, _window
from casingfem.experiment.identify.poles.bands import Band
from casingfem.experiment.identify.poles.pole_fit import fit_poles

LINES = np.arange(90.0, 112.0, 0.05)
BAND = Band((0, len(LINES)), (0, len(LINES)), 2)


def responses(residues):
    """Accelerances of two modes in three channels, noise of 1e-9, (channels, lines)."""
    freq, zeta = np.array([98.0, 103.0]), np.array([3e-3, 4e-3])
    each = freq**2 / (freq**2 - LINES[:, None] ** 2 + 2j * zeta * freq * LINES[:, None])
    H = (1j * LINES[:, None]) ** 2 * (each @ residues)
    return Responses(LINES, H.T, np.full(residues.shape[1], 1e-9), 2, np.ones(len(LINES)))


@pytest.mark.parametrize("lag", [0.0, 0.2])
def test_modes_of_a_fit_respond_as_the_data_do(lag):
    residues = np.array([[1.0, -0.5, 0.3], [0.2, 0.8, -0.6]]) * np.exp(1j * lag * np.array([[1.0, -2.0, 3.0]]))
    data = responses(residues)
    window = _window(data, BAND, [])
    assert window.columns == 1
    fitted = replace(window, residues="complex" if lag else "real")
    fit = fit_poles(fitted, np.array([98.0, 103.0]), np.array([3e-3, 4e-3]))
    modes = _modes(data, [BAND], [fit])
    found = _together(modes)
    np.testing.assert_allclose(found.residues, residues, atol=1e-6)
    np.testing.assert_allclose(found.response(window, [np.arange(3)]), window.as_complex, atol=1e-6 * window.Y.max())


def test_a_band_by_its_own_lines_has_the_same_window():
    data = responses(np.array([[1.0, -0.5, 0.3], [0.2, 0.8, -0.6]]))
    band = Band((120, 300), (80, 360), 1)
    there, own = _of_band(data, band)
    assert (own.core, own.window, own.peaks) == ((40, 220), (0, 280), 1)
    whole, part = _window(data, band, []), _window(there, own, [])
    np.testing.assert_array_equal(part.Y, whole.Y)
    np.testing.assert_array_equal(part.freq[slice(*own.core)], LINES[slice(*band.core)])
