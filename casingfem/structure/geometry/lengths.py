"""Lengths of a chart's lines in metres, by which a mesh is divided, independent of the chart's parameters."""

from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, FloatArray
from casingfem.structure.geometry.chart import Chart, is_axisymmetric

ALONG, ACROSS = 257, 33  # samples of each parameter
EVEN = 1e-9  # of the length: no place of an evenly running parameter is further from its own


class Lengths(NamedTuple):
    """Arc lengths of a chart's lines, by the trapezoidal rule.

    `parts` are values of the first parameter as fractions of its range, and `arc` the length up to them, from 0 to 1,
    averaged over all lines. `along` is that length and `across` that of the line at mid-height [m]. `unevenness` is the
    largest rate of length over the second parameter, relative to its mean.
    """

    parts: FloatArray
    arc: FloatArray
    along: float
    across: float
    unevenness: float

    @property
    def even(self) -> bool:
        """Whether length is proportional to the first parameter."""
        return bool(np.abs(self.arc - self.parts).max() < EVEN)

    def at(self, part: float) -> float:
        """Fraction of the length at a fraction of the first parameter's range."""
        return part if self.even else float(np.interp(part, self.parts, self.arc))

    def part(self, share: Array) -> FloatArray:
        """Fractions of the first parameter's range at fractions of the length."""
        return np.asarray(share if self.even else np.interp(share, self.arc, self.parts))


def chart_lengths(chart: Chart) -> Lengths:
    """Lengths of a chart's lines along both parameters, without imperfections.

    >>> from casingfem.structure.geometry.chart import Frustum
    >>> lengths = chart_lengths(Frustum(r_base=0.5, r_top=0.45, height=0.12))
    >>> round(lengths.along, 9), round(lengths.across / np.pi, 9), round(float(lengths.part(0.5)), 9)
    (0.13, 0.95, 0.5)
    """
    (a0, a1), (b0, b1) = np.real(np.array(chart.bounds, dtype=complex))
    parts = np.linspace(0.0, 1.0, ALONG)
    a, b = a0 + (a1 - a0) * parts, np.linspace(b0, b1, 1 if is_axisymmetric(chart) else ACROSS)
    at, around = np.meshgrid(a, b, indexing="ij")
    surface = chart.surface(at, around, None)
    speeds = (np.linalg.norm(np.real(tangent), axis=0) for tangent in (surface.x1, surface.x2))
    first, second = (speed * span for speed, span in zip(speeds, (a1 - a0, b1 - b0), strict=True))
    mean = first.mean(axis=1)
    arc = np.append(0.0, np.cumsum(0.5 * (mean[1:] + mean[:-1]))) / (ALONG - 1)
    shares = arc / arc[-1]
    middle = second[int(np.abs(shares - 0.5).argmin())]
    across = float(np.mean(0.5 * (middle[1:] + middle[:-1]))) if len(b) > 1 else float(middle[0])
    return Lengths(parts, shares, float(arc[-1]), across, float(middle.max()) / across)
