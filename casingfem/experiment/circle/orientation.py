"""Sensors on a circle: which n a shape has, how pure it is, where its antinode lies, and how sure that is.

A shape with n nodal diameters has a cos n theta + b sin n theta at the sensors; sensors may be missing or uneven, so
(a, b) comes by least squares. Two n that look alike at the sensors (n and 24 - n on 24 even ones) cannot be told
apart; the labels end below the first such n. An n whose sine or cosine no sensor sees (12 on 24 even ones) is none.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from casingfem.arrays import FloatArray, frozen

ALIKE = 0.95  # cosine of the angle between the spaces of two n that cannot be told apart
TERMS = 8  # sensors for each n fitted to a shape, at least
BEYOND = 8  # n above the largest label that still may add to a shape
NOTABLE = 20.0  # fall of the sum of squares, in units of the noise, for which another n is fitted
PURE = 0.35  # least share of the energy for a label
SEEN = 0.25  # least ratio of what the sensors see of a sine and a cosine


class Label(NamedTuple):
    """Nodal diameters of a shape (-1: none fits), their share of its energy, its antinode [rad] with its uncertainty.

    `angle` and `sigma` are nan where n < 1.
    """

    n: int
    purity: float
    angle: float
    sigma: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Circle:
    """Sensors at angles theta [rad], and the n that they tell from all smaller ones."""

    theta: FloatArray
    orders: tuple[int, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "theta", frozen(self.theta))

    @classmethod
    def of(cls, theta: FloatArray, n_max: int | None = None) -> Circle:
        """Sensors at these angles [rad]; `n_max` only to set it lower.

        >>> Circle.of(np.arange(24) * np.pi / 12).n_max
        11
        """
        spaces: dict[int, FloatArray] = {}
        for n in range(len(theta) if len(theta) >= 3 else 0):
            basis, sizes, _ = np.linalg.svd(harmonic(theta, n), full_matrices=False)
            if sizes[-1] < SEEN * sizes[0]:
                continue
            if any(np.linalg.norm(basis.T @ other, 2) > ALIKE for other in spaces.values()):
                break
            spaces[n] = basis
        return cls(theta=theta, orders=tuple(n for n in spaces if n_max is None or n <= n_max))

    @property
    def n_max(self) -> int:
        """Largest n, -1 if there is none."""
        return max(self.orders, default=-1)

    def label(self, shape: FloatArray, covariance: FloatArray) -> Label:
        """Which n a shape (sensors,) with this covariance (sensors, sensors) has, and where its antinode lies.

        The n whose sine and cosine take most energy is the label. The next n are fitted beside it while they are
        notable, for on uneven sensors they turn the antinode; all others are taken as random, of the size that
        the rest shows, and so enter the uncertainty.

        >>> theta = np.array([0.0, 0.5, 1.1, 1.5, 2.1, 2.9, 3.3, 4.2, 5.0, 5.7])
        >>> found = Circle.of(theta).label(np.cos(3 * theta - 0.6), 1e-6 * np.eye(10))
        >>> found.n, round(found.purity, 3), round(found.angle, 3)
        (3, 1.0, 0.2)
        """
        if not self.orders:
            return Label(-1, *[float("nan")] * 3)
        chosen = [self._next(shape, [])]
        noise = float(np.trace(covariance)) / len(shape)
        while len(chosen) < min(len(shape) // TERMS, len(self.orders)):
            rest = self._rest(shape, chosen)
            more = [*chosen, self._next(shape, chosen)]
            if rest - self._rest(shape, more) < NOTABLE * noise:
                break
            chosen = more
        return self._read(shape, covariance, self._others(shape, chosen, noise), chosen)

    def _others(self, shape: FloatArray, chosen: list[int], noise: float) -> FloatArray:
        """Covariance (sensors, sensors) of what all other n add, equally large, from what is left."""
        rest = self._columns([n for n in range(self.n_max + BEYOND) if n not in chosen])
        columns = self._columns(chosen)
        across = rest - columns @ np.linalg.lstsq(columns, rest, rcond=None)[0]
        left = max(self._rest(shape, chosen) - noise * (len(shape) - columns.shape[1]), 0.0)
        return np.asarray(left / np.sum(across**2) * rest @ rest.T)

    def _next(self, shape: FloatArray, chosen: list[int]) -> int:
        """The n that takes most from what is left."""
        free = [n for n in self.orders if n not in chosen]
        return min(free, key=lambda n: self._rest(shape, [*chosen, n]))

    def _columns(self, chosen: list[int]) -> FloatArray:
        return np.concatenate([harmonic(self.theta, n) for n in chosen], axis=1)

    def _rest(self, shape: FloatArray, chosen: list[int]) -> float:
        columns = self._columns(chosen)
        rest = shape - columns @ np.linalg.lstsq(columns, shape, rcond=None)[0]
        return float(rest @ rest)

    def _read(self, shape: FloatArray, covariance: FloatArray, others: FloatArray, chosen: list[int]) -> Label:
        """Label by the first n chosen, the others fitted beside it, by least squares weighted by the other n."""
        n, columns = chosen[0], self._columns(chosen)
        even = float(np.trace(covariance + others)) / len(shape) + 1e-24 * float(shape @ shape)
        weighted = np.linalg.solve(others + even * np.eye(len(shape)), columns)
        read = np.linalg.solve(columns.T @ weighted, weighted.T)
        width = harmonic(self.theta, n).shape[1]
        parts = (read @ shape)[:width]
        part = columns[:, :width] @ parts
        purity = min(float(part @ part) / float(shape @ shape), 1.0)
        if purity < PURE or n == 0:
            return Label(n if purity >= PURE else -1, purity, float("nan"), float("nan"))
        return Label(n, purity, *antinode(parts, (read @ (covariance + others) @ read.T)[:width, :width], n))


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
