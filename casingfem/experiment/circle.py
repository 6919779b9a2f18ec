"""Sensors on a circle: which n a shape has, how pure it is, where its antinode lies, and how sure that is.

A shape with n nodal diameters has a cos n theta + b sin n theta at the sensors; sensors may be missing or uneven, so
(a, b) comes by least squares. Two n that look alike at the sensors (n and 24 - n on 24 even ones) cannot be told
apart; the labels end below the first such n.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from casingfem.arrays import FloatArray, frozen

ALIKE = 0.9  # cosine of the angle between the spaces of two n that cannot be told apart
SEEN = 0.25  # least ratio of what the sensors see of a sine and a cosine


class Label(NamedTuple):
    """Nodal diameters of a shape (-1: none fits) and their share of its energy."""

    n: int
    purity: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Circle:
    """Sensors at angles theta [rad], and the largest n that they tell from all smaller ones."""

    theta: FloatArray
    n_max: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "theta", frozen(self.theta))

    @classmethod
    def of(cls, theta: FloatArray, n_max: int | None = None) -> Circle:
        """Sensors at these angles [rad]; `n_max` only to set it lower.

        >>> Circle.of(np.arange(24) * np.pi / 12).n_max
        11
        """
        spaces: list[FloatArray] = []
        for n in range(len(theta)):
            columns = harmonic(theta, n)
            basis, sizes, _ = np.linalg.svd(columns, full_matrices=False)
            if sizes[-1] < SEEN * sizes[0] or len(theta) < 3:
                break
            if any(np.linalg.norm(basis.T @ other, 2) > ALIKE for other in spaces):
                break
            spaces.append(basis)
        told = len(spaces) - 1
        return cls(theta=theta, n_max=told if n_max is None else min(n_max, told))

    def label(self, shape: FloatArray) -> Label:
        """The n whose sine and cosine take most of a shape's energy.

        >>> theta = np.array([0.0, 0.5, 1.1, 1.5, 2.1, 2.9, 3.3, 4.2, 5.0, 5.7])
        >>> Circle.of(theta).label(np.cos(3 * theta - 0.4))
        Label(n=3, purity=1.0)
        """
        total = float(shape @ shape)
        shares = []
        for n in range(self.n_max + 1):
            columns = harmonic(self.theta, n)
            part = columns @ np.linalg.lstsq(columns, shape, rcond=None)[0]
            shares.append(float(part @ part) / total)
        n = int(np.argmax(shares)) if shares else -1
        return Label(n, round(shares[n], 12) if n >= 0 else float("nan"))


def harmonic(theta: FloatArray, n: int) -> FloatArray:
    """Columns cos n theta, sin n theta (sensors, 2); one column of ones for n = 0."""
    if n == 0:
        return np.ones((len(theta), 1))
    return np.column_stack([np.cos(n * theta), np.sin(n * theta)])


def antinode(parts: FloatArray, covariance: FloatArray, n: int) -> tuple[float, float]:
    """Angle of an antinode [rad] in [0, pi/n), and its standard deviation, from (cosine, sine) and their covariance.

    psi = atan2(b, a)/n;  d psi = (a db - b da)/(n (a^2 + b^2)).

    >>> antinode(np.array([0.0, 2.0]), 1e-4 * np.eye(2), 1)
    (1.5707963267948966, 0.005)
    """
    a, b = parts.tolist()
    slope = np.array([-b, a]) / (n * (a * a + b * b))
    angle = float(np.mod(np.arctan2(b, a) / n, np.pi / n))
    return angle if np.pi / n - angle > 1e-9 else 0.0, float(np.sqrt(slope @ covariance @ slope))


def quadrature(first: float, second: float, n: int) -> float:
    """How far two antinodes [rad] are apart, 1 for a quarter wave, 0 for the same place."""
    return float(abs(np.sin(n * (first - second))))
