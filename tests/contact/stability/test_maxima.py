"""Maxima of a curve and their prominence are those of scipy, flat tops included."""

import numpy as np
import pytest
from scipy.signal import find_peaks

from contact.stability.maxima import maxima, prominence


@pytest.mark.parametrize("levels", [2, 3, 5, 50])
@pytest.mark.parametrize("size", [1, 2, 3, 4, 7, 40])
def test_places_and_prominences_are_those_of_scipy(levels, size):
    draws = np.random.default_rng(levels * 100 + size)
    for _ in range(100):
        values = draws.integers(0, levels, size).astype(float)
        expected, properties = find_peaks(values, prominence=0.0)
        np.testing.assert_array_equal(maxima(values), expected)
        np.testing.assert_array_equal(prominence(values, expected), properties["prominences"])


def test_flat_tops_and_ends_that_rise():
    values = np.array([3.0, 1.0, 2.0, 2.0, 1.0, 4.0, 4.0, 4.0, 0.0, 5.0, 5.0])
    assert maxima(values).tolist() == [2, 6]
    assert prominence(values, np.array([2, 6])).tolist() == [1.0, 3.0]
