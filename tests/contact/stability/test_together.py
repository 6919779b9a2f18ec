"""Roots and maxima of many functions at once: against scipy's of each alone, and how often they are evaluated."""

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from contact.stability.together import maxima_between, roots

RNG = np.random.default_rng(5)
SHIFT, POWER = RNG.uniform(0.1, 0.9, 40), RNG.integers(2, 7, 40)


def crossing(x, which):
    """Straight, cubic, steep and flat functions that change their sign at SHIFT."""
    u = x - SHIFT[which]
    return np.where(which % 2, np.sinh(8.0 * u), np.sign(u) * np.abs(u) ** (0.5 * POWER[which]) + 0.3 * u)


def test_roots_of_many_functions_are_those_of_each_alone():
    every, calls = np.arange(40), []

    def counted(x, which):
        calls.append(which.size)
        return crossing(x, which)

    low, high = np.zeros(40), np.ones(40)
    found = roots(counted, (low, high), (crossing(low, every), crossing(high, every)), 1e-10)
    exact = [
        brentq(lambda x, k=k: float(crossing(np.array([x]), np.array([k]))[0]), 0.0, 1.0, xtol=1e-14) for k in every
    ]
    assert np.abs(crossing(found, every)).max() <= 1e-10
    np.testing.assert_allclose(found, exact, atol=1e-7)
    assert calls[0] == 40  # all at once, and fewer once some are found
    assert sorted(calls, reverse=True) == calls
    assert sum(calls) < 40 * 20
    assert low.tolist() == [0.0] * 40  # what is given stays


@pytest.mark.parametrize("within", [1e-2, 1e-6])
def test_a_root_ends_where_its_value_is_small_enough(within):
    calls = []

    def cube(x, _):
        calls.append(x)
        return x**3 - 0.2

    (found,) = roots(cube, (np.zeros(1), np.ones(1)), (np.array([-0.2]), np.array([0.8])), within)
    assert abs(found**3 - 0.2) <= within
    assert abs(calls[-2] ** 3 - 0.2) > within


def test_a_function_without_a_value_has_no_root_and_the_others_do():
    def partly(x, which):
        return np.where(which == 1, np.nan, x - 0.25)

    ends = np.zeros(3), np.ones(3)
    found = roots(partly, ends, (np.full(3, -0.25), np.full(3, 0.75)), 1e-12)
    np.testing.assert_allclose(found, [0.25, np.nan, 0.25], atol=1e-12)
    assert roots(partly, (np.zeros(0), np.zeros(0)), (np.zeros(0), np.zeros(0)), 1e-12).size == 0


def test_maxima_of_many_functions_are_those_of_each_alone():
    middle, width = np.linspace(0.32, 0.68, 30), np.linspace(0.2, 0.8, 30)

    def bells(x):
        return 1.0 / (1.0 + ((x - middle) / width) ** 2) + 0.05 * x

    x = middle + np.array([[-0.15], [0.05], [0.2]])
    found = maxima_between(bells, x, np.array([bells(one) for one in x]))
    exact = [
        minimize_scalar(lambda v, m=m, w=w: -(1.0 / (1.0 + ((v - m) / w) ** 2) + 0.05 * v), bounds=(0.0, 1.0),
                        method="bounded", options={"xatol": 1e-12}).x
        for m, w in zip(middle, width, strict=True)
    ]  # fmt: skip
    value, most = bells(found), bells(np.array(exact))
    assert (most - value).max() < 1e-5
    np.testing.assert_allclose(found, exact, atol=0.02)


@pytest.mark.parametrize("x", [[0.0, 0.2, 1.0], [0.0, 0.8, 1.0]])
def test_a_maximum_is_at_least_the_largest_value_given(x):
    """A kink, which no parabola has, and a value at an end."""

    def roof(x):
        return -np.abs(x - 0.6)

    places = np.array(x)[:, None]
    (found,) = maxima_between(roof, places, roof(places))
    assert roof(found) >= roof(places).max()
    assert found == pytest.approx(0.6, abs=0.05)
    (end,) = maxima_between(lambda x: x, places, places)
    assert end == 1.0
