"""Growth rates of closed contact through public calls."""

import numpy as np

import contact as ct


def growth(contact, speeds):
    """Largest real part of the poles at each speed [1/s]."""
    return np.array([every.real.max() for every in ct.stability.poles(contact, np.atleast_1d(speeds))])


def floquet_growth(split, hz, mu=0.0):
    """Growth [1/s] of a rim with a split casing at one speed."""
    return ct.stability.floquet_growth(split, np.array([hz]), mu=mu)[0]
