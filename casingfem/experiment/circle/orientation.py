"""Sensors on a circle: n of a shape, purity, angle of its antinode, and the uncertainty of the angle.

A shape with n nodal diameters has a cos n theta + b sin n theta at the sensors; sensors may be missing or uneven, so
(a, b) is found by least squares. Two n with equal values at the sensors (n and 24 - n on 24 even ones) cannot be
distinguished; the labels end below the first such n. An n whose sine or cosine vanishes at all sensors (12 on 24 even
ones) is not used.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_triangular
from scipy.special import ndtri, stdtrit

from casingfem.io.arrays import FloatArray, IntArray, freeze

MOST = 64  # largest n: of labels where none is given, and of waves that may add to a shape
ALIKE = 0.95  # cosine of the angle between the spaces of two n that cannot be distinguished
TAIL = 0.025  # beyond either end of an interval
EXACT = 1e-14  # of a shape's energy: a variance that every sensor has, where noise has none
PURE = 0.35  # least share of the energy for a label
SEEN = 0.25  # least ratio of what the sensors see of a sine and a cosine
# nu, by trial on reports.verification.updating.identification_sets:
# less makes intervals narrow, more makes antinodes less sure
FREEDOM = 6.0
ROUNDS = 150
LONGER = 1.8  # steps of ln v_m, in those of expectation and maximisation, which are short ones
SETTLED = 5e-3  # relative change of every v_m in a round that ends it


class Label(NamedTuple):
    """Nodal diameters of a shape (-1: none fits), their share of its energy, its antinode [rad] (nan if n < 1)."""

    n: int
    purity: float
    angle: float


class Others(NamedTuple):
    """Variances v_m of the other waves of a shape, and how many components of each the sensors resolve, (waves,)."""

    variance: FloatArray
    shown: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Circle:
    """Sensors at angles theta [rad], and the n that they distinguish from all smaller ones."""

    theta: FloatArray
    orders: tuple[int, ...]

    def __post_init__(self) -> None:
        freeze(self, "theta")

    @classmethod
    def of(cls, theta: FloatArray, n_max: int | None = None) -> Circle:
        """Sensors at these angles [rad]; labels end at `n_max` (64 if None), or at the resolution of the sensors.

        >>> Circle.of(np.arange(24) * np.pi / 12).n_max
        11
        """
        spaces: dict[int, FloatArray] = {}
        most = MOST if n_max is None else n_max
        for n in range(min(len(theta), max(most, 1) + 1) if len(theta) >= 3 else 0):
            basis, sizes, _ = np.linalg.svd(harmonic(theta, n), full_matrices=False)
            if sizes[-1] < SEEN * sizes[0]:
                continue
            if any(np.linalg.norm(basis.T @ other, 2) > ALIKE for other in spaces.values()):
                break
            spaces[n] = basis
        distinct = spaces if len(spaces) > 1 else ()  # one n alone has no other n from which the sensors separate it
        return cls(theta=theta, orders=tuple(n for n in distinct if n <= most))

    @property
    def n_max(self) -> int:
        """Largest n, -1 if there is none."""
        return max(self.orders, default=-1)

    def alike(self, n: int) -> IntArray:
        """The two waves above all labels that are most similar to n at the sensors, (2,).

        S - n and S + n on S even ones.

        >>> Circle.of(np.arange(16) * np.pi / 8).alike(7).tolist()
        [9, 23]
        """
        own, above = np.linalg.qr(harmonic(self.theta, n))[0], np.arange(self.n_max + 1, MOST + 1)
        turns = np.outer(self.theta, above)
        shares = np.sum((own.T @ np.cos(turns)) ** 2 + (own.T @ np.sin(turns)) ** 2, axis=0)
        return np.sort(above[np.argsort(-np.round(shares, 6), kind="stable")[:2]])

    def label(self, shape: FloatArray) -> Label:
        """The n of a shape (sensors,) whose sine and cosine contain most energy, and the angle of its antinode.

        >>> theta = np.array([0.0, 0.5, 1.1, 1.5, 2.1, 2.9, 3.3, 4.2, 5.0, 5.7])
        >>> found = Circle.of(theta).label(np.cos(3 * theta - 0.6))
        >>> found.n, round(found.purity, 3), round(found.angle, 3)
        (3, 1.0, 0.2)
        """
        if not self.orders:
            return Label(-1, *[float("nan")] * 2)
        n = min(self.orders, key=lambda n: self._rest(shape, n))
        purity = 1.0 - self._rest(shape, n) / float(shape @ shape)
        if purity < PURE or n == 0:
            return Label(n if purity >= PURE else -1, purity, float("nan"))
        parts = np.asarray(np.linalg.lstsq(harmonic(self.theta, n), shape, rcond=None)[0], np.float64)
        return Label(n, purity, antinode(parts, np.zeros((2, 2)), n)[0])

    def orientation(
        self, shape: FloatArray, covariance: FloatArray, n: int, sizes: FloatArray | None = None
    ) -> tuple[float, float]:
        """Antinode [rad] of a shape (sensors,) with this covariance (sensors, sensors), and its uncertainty.

        All waves except n, up to 64, are random, with sizes estimated from the shape itself, times `sizes` (65,) if
        given. They rotate the antinode, and so add to its uncertainty (`others_of`). This includes waves far above the
        largest label: on few sensors they resemble the label and cannot be separated from it. 1.96 sigma is the 95 %
        interval of Student's t. Its degrees of freedom f follow from those of the variances V_m = v_m |sensitivity of
        the antinode to wave m|^2 of the total T (Satterthwaite, Biometrics Bulletin 2, 1946, 110): nu + the number of
        resolved components of the wave; for the common scale, half of the components other than n, minus those of one
        wave,

            T^2/f = sum_m V_m^2/(nu + shown_m) + (sum_m V_m)^2/(sensors/2 - 3).

        >>> theta = np.array([0.0, 0.5, 1.1, 1.5, 2.1, 2.9, 3.3, 4.2, 5.0, 5.7])
        >>> shape = np.cos(3 * theta - 0.6) + 0.02 * np.cos(5 * theta)
        >>> angle, sigma = Circle.of(theta).orientation(shape, 1e-6 * np.eye(10), 3)
        >>> round(angle, 2), 0.001 < sigma < 0.02
        (0.2, True)
        """
        own, waves = harmonic(self.theta, n), np.delete(np.arange(MOST + 1), n)
        rest = [harmonic(self.theta, m) for m in waves.tolist()]
        order = np.repeat(np.arange(len(rest)), [columns.shape[1] for columns in rest])
        columns = np.concatenate(rest, axis=1)
        covariance = covariance + EXACT * float(shape @ shape) * np.eye(len(shape))
        size = np.ones(len(waves)) if sizes is None else sizes[waves]
        found = others_of(shape, own, columns, order, covariance, size, (waves - n) % 2)
        basis = np.linalg.qr(np.concatenate([own, columns], axis=1))[0]
        within, each = basis.T @ columns, found.variance[order]
        even = float(np.trace(covariance)) / len(shape) * np.eye(len(within))  # a partner's share is no weight
        read = reading(basis.T @ own, (within * each) @ within.T + even) @ basis.T
        parts, seen = read @ shape, read @ columns
        angle, sigma = antinode(parts, read @ covariance @ read.T + (seen * each) @ seen.T, n)
        each = np.bincount(order, (slope_of(parts, n) @ seen) ** 2) * found.variance
        scale = float(np.sum(each)) ** 2 / max(0.5 * len(shape) - 3.0, 1.0)
        inverse = (float(np.sum(each**2 / (FREEDOM + found.shown))) + scale) / sigma**4
        return angle, sigma * float(stdtrit(1.0 / max(inverse, 1e-9), TAIL) / ndtri(TAIL))

    def _rest(self, shape: FloatArray, n: int) -> float:
        """Residual sum of squares for one n."""
        columns = harmonic(self.theta, n)
        rest = shape - columns @ np.linalg.lstsq(columns, shape, rcond=None)[0]
        return float(rest @ rest)


def harmonic(theta: FloatArray, n: int) -> FloatArray:
    """Columns cos n theta, sin n theta (sensors, 2); one column of ones for n = 0."""
    return np.column_stack([np.cos(n * theta), np.sin(n * theta)]) if n else np.ones((len(theta), 1))


def antinode(parts: FloatArray, covariance: FloatArray, n: int) -> tuple[float, float]:
    """Angle of an antinode [rad] in [0, pi/n), and its standard deviation, from (cosine, sine) and their covariance.

    psi = atan2(b, a)/n;  d psi = (a db - b da)/(n (a^2 + b^2)).

    >>> antinode(np.array([0.0, 2.0]), 1e-4 * np.eye(2), 1)
    (1.5707963267948966, 0.005)
    """
    a, b = parts.tolist()
    slope = slope_of(parts, n)
    angle = float(np.mod(np.arctan2(b, a) / n, np.pi / n))
    return angle if np.pi / n - angle > 1e-9 else 0.0, float(np.sqrt(slope @ covariance @ slope))


def slope_of(parts: FloatArray, n: int) -> FloatArray:
    """Derivative of the antinode with respect to (cosine, sine), (2,)."""
    a, b = parts.tolist()
    return np.asarray(np.array([-b, a]) / (n * (a * a + b * b)), np.float64)


def quadrature(first: float, second: float, n: int) -> float:
    """Distance of two antinodes [rad], scaled to 1 for a quarter wave and 0 for the same angle."""
    return float(abs(np.sin(n * (first - second))))


def reading(own: FloatArray, covariance: FloatArray) -> FloatArray:
    """Matrix (columns, sensors) that estimates c in shape = own c + error by generalised least squares.

    >>> reading(np.ones((2, 1)), np.diag([1.0, 3.0])).tolist()
    [[0.75, 0.25]]
    """
    weighted = np.linalg.solve(covariance, own)
    return np.asarray(np.linalg.solve(own.T @ weighted, weighted.T))


def others_of(
    shape: FloatArray, own: FloatArray, others: FloatArray, order: IntArray, covariance: FloatArray, sizes: FloatArray,
    odd: IntArray,
) -> Others:  # fmt: skip
    """Variances v_m of the other waves B_m b_m of a shape (sensors,), of covariance sum of v_m B_m B_m^T.

    `own` (sensors, 1 or 2) are the columns A, `others` (sensors, columns) all B_m, `order` (columns,) the m of each,
    counted from 0. On an imperfect casing, a shape of one n contains a little of many others:

        shape = A c + sum_m B_m b_m + e,   b_m ~ N(0, v_m I),   e ~ N(0, S),

    with the covariance S of the measurement. There are more b_m than sensors, but few are large. So b_m has Student's t
    distribution with nu = 6 degrees of freedom and scale s g_m (Lange, Little and Taylor, J. Am. Stat. Assoc. 84, 1989,
    881), which is a normal one whose variance v_m is itself random. g_m are the relative `sizes` (waves,). There are
    two values of s: for waves whose m differs from n by an even number, and by an `odd` (waves,) number, since a wall
    with even harmonics couples only even ones. The estimate alternates expectation and maximisation, with c projected
    out (restricted likelihood: Patterson and Thompson, Biometrika 58, 1971, 545), w_m the columns of B_m:

        C = S + sum_m v_m B_m B_m^T,   P = N (N^T C N)^-1 N^T with orthonormal N, N^T A = 0,
        w_m q_m = E|b_m|^2 = |v_m B_m^T P shape|^2 + w_m v_m - v_m^2 tr(B_m^T P B_m),
        v_m <- (nu s^2 g_m^2 + w_m q_m)/(nu + w_m),   1/s^2 <- mean of g_m^2/v_m.

    The sensors resolve v_m tr(B_m^T P B_m) components of a wave: from none to all of its columns. With more sensors
    than columns, both are multiplied by S^(-1/2) and projected on the span of the columns: the orthogonal part does not
    depend on v_m.

    Equal variances of all others would attribute part of the largest wave to the antinode. Fitting only the largest
    waves ignores that they were selected for their size, and gives intervals that are too narrow.
    """
    if len(shape) > own.shape[1] + others.shape[1]:
        shape, own, others, covariance = _within_columns(shape, own, others, covariance)
    width, g2 = np.bincount(order), sizes**2
    left = shape - own @ np.linalg.lstsq(own, shape, rcond=None)[0]
    scale2 = np.full(2, float(left @ left) / float(np.sum(g2[order] * others**2)) + 1e-300)
    v = scale2[odd] * g2
    count = np.maximum(np.bincount(odd, minlength=2), 1)
    free = np.linalg.qr(own, mode="complete")[0][:, own.shape[1] :]  # orthogonal to A
    shape, others, covariance = free.T @ shape, free.T @ others, free.T @ covariance @ free
    for _ in range(ROUNDS):
        total = covariance + (others * v[order]) @ others.T
        seen = np.linalg.solve(total, others)
        each = v[order]
        shown = each * np.sum(others * seen, axis=0)
        square = (each * (shape @ seen)) ** 2 + each - each * shown
        new = (FREEDOM * scale2[odd] * g2 + np.bincount(order, square)) / (FREEDOM + width)
        change = new / v
        v = v * change**LONGER
        scale2 = count / np.bincount(odd, g2 / v, minlength=2)
        if float(np.abs(change - 1.0).max()) < SETTLED:
            break
    return Others(v, np.asarray(np.bincount(order, shown), np.float64))


def _within_columns(
    shape: FloatArray, own: FloatArray, others: FloatArray, covariance: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Shape, own and other columns in an orthonormal basis of the columns in which the covariance is the identity."""
    white = solve_triangular(np.linalg.cholesky(covariance), np.column_stack([own, others, shape]), lower=True)
    basis = np.linalg.qr(white[:, :-1])[0]
    seen = basis.T @ white
    return seen[:, -1], seen[:, : own.shape[1]], seen[:, own.shape[1] : -1], np.eye(len(seen))
