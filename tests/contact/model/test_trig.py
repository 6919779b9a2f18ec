"""Waves of many angles from powers of e^(i phi)."""

import numpy as np
import pytest

from contact.model.trig import harmonics, harmonics_by_powers


@pytest.mark.parametrize("n_max", [0, 1, 2, 3, 8, 41, 200])
def test_powers_give_the_waves_of_the_cosine_and_sine_of_each_multiple(n_max):
    phi = np.random.default_rng(n_max).uniform(-np.pi, np.pi, 300)
    found = harmonics_by_powers(n_max, phi)
    assert found.shape == (300, 2 * n_max + 1)
    np.testing.assert_allclose(found, harmonics(n_max, phi), rtol=0.0, atol=1e-13)


def test_waves_of_powers_have_the_period_of_the_angle_however_large_it_is():
    phi = np.random.default_rng(5).uniform(-1e6, 1e6, 300)
    reduced = np.arctan2(np.sin(phi), np.cos(phi))
    np.testing.assert_allclose(harmonics_by_powers(80, phi), harmonics_by_powers(80, reduced), rtol=0.0, atol=1e-13)
