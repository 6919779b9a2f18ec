"""Derivatives of a chart against f'(x) = Im f(x + i h) / h, which loses no digits however small h is."""

import numpy as np

STEP = 1e-30


def assert_exact(chart, defect=None, atol=1e-13):
    """First and second derivatives of a chart, with the derivatives of its radius defect, on a grid over its bounds."""
    (a0, a1), (b0, b1) = chart.bounds
    a, b = np.meshgrid(np.linspace(a0, a1, 5), np.linspace(b0, b1, 7))

    def at(a, b):
        return chart.surface(a, b, None if defect is None else defect.derivatives(a, b))

    here, by_a, by_b = at(a, b), at(a + 1j * STEP, b + 0j), at(a + 0j, b + 1j * STEP)
    for exact, derived in [
        (here.x1, by_a.x),
        (here.x2, by_b.x),
        (here.x11, by_a.x1),
        (here.x12, by_b.x1),
        (here.x12, by_a.x2),
        (here.x22, by_b.x2),
    ]:
        np.testing.assert_allclose(exact, derived.imag / STEP, atol=atol)
