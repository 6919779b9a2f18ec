"""Candidate poles of a band far above zero."""

import sys

import numpy as np
import pytest

from casingfem.errors import MissingExtraError
from casingfem.experiment.identify.poles.stabilisation import lscf_poles

FREQ = np.arange(290.0, 310.0, 0.125)
POLES = 2.0 * np.pi * np.array([296.0, 303.0]) * (np.array([-0.004, -0.006]) + 1j)


def test_poles_of_growing_orders_are_those_of_the_responses():
    shapes = np.array([[1.0, -0.5, 0.8], [0.4, 0.9, -0.7]])
    H = shapes.T @ (np.abs(POLES.real)[:, None] / (2j * np.pi * FREQ - POLES[:, None]))
    swept = lscf_poles(FREQ, H, 12)
    assert len(swept) == 12
    for found in swept[7:]:
        nearest = found[np.abs(found[:, None] - POLES).argmin(axis=0)]
        np.testing.assert_allclose(nearest, POLES, rtol=1e-5)
    every = np.concatenate(swept)
    assert every.real.max() < 0.0
    assert every.imag.min() > 2.0 * np.pi * 290.0
    assert np.isfinite(every).all()


def test_without_the_extra_it_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "sdypy.EMA", None)
    monkeypatch.setitem(sys.modules, "sdypy", None)
    with pytest.raises(MissingExtraError, match="modes are identified with sdypy-EMA, which is not installed"):
        lscf_poles(FREQ, np.ones((1, len(FREQ))) + 0j, 2)
