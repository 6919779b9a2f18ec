"""Curvature of a surface along its first parameter that polynomials on an interval do not follow."""

from __future__ import annotations

from functools import cache

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.structure.geometry.chart import Chart

POINTS = 96  # of the quadrature on an interval, for curvatures with several kinks


@cache
def rule() -> tuple[FloatArray, FloatArray]:
    """Points and weights of Gauss quadrature on -1 .. 1."""
    x, weight = np.polynomial.legendre.leggauss(POINTS)
    return x, weight


def unresolved_bend(chart: Chart, low: float, high: float, degree: int) -> float:
    """Root mean square [1/m] of the curvature that remains beside its best polynomial of a degree.

    The curvature is that along the first parameter, from `low` to `high` on the line b = 0. Displacements of order
    degree + 1 follow the polynomial without stretching the wall; the remainder stretches it.

    >>> from casingfem.structure.geometry.revolved import Arc, Revolved
    >>> arc = Revolved(profile=Arc(radius=0.5, start=-0.4, end=0.4))
    >>> round(unresolved_bend(arc, 0.0, 0.4, 0), 12)  # a constant curvature
    0.0
    """
    x, weight = rule()
    surface = chart.surface(low + 0.5 * (high - low) * (x + 1.0), np.zeros(POINTS), None)
    along, across, bent = (np.real(part) for part in (surface.x1, surface.x2, surface.x11))
    normal = np.cross(along, across, axis=0)
    curvature = np.sum(normal * bent, axis=0) / np.linalg.norm(normal, axis=0) / np.sum(along * along, axis=0)
    basis: FloatArray = np.polynomial.legendre.legvander(x, degree) * np.sqrt(np.arange(degree + 1) + 0.5)
    left = curvature - basis @ (basis.T @ (weight * curvature))
    return float(np.sqrt(0.5 * np.sum(weight * left**2)))
