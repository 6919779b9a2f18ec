"""What other n add to a shape on a circle of sensors: as many sizes as there are n, learnt from one shape.

Sensors on an imperfect casing see a shape of one n with a little of many others, each of its own size:

    shape = A c + sum_m B_m b_m + e,   b_m ~ N(0, v_m I),   e ~ N(0, S),

A, B_m the cosine and sine of the n and of the others at the sensors, S the covariance of the measurement. There are
more b_m than sensors; what is known of them is that few are large: b_m has Student's t distribution of nu = 6 degrees
of freedom and a common scale s (Lange, Little and Taylor, J. Am. Stat. Assoc. 84, 1989, 881), which is a normal one
whose variance v_m is itself random. Expectation and maximisation in turn, c projected out (restricted likelihood:
Patterson and Thompson, Biometrika 58, 1971, 545), w_m the columns of B_m:

    C = S + sum_m v_m B_m B_m^T,   P = C^-1 - C^-1 A (A^T C^-1 A)^-1 A^T C^-1,
    w_m q_m = E|b_m|^2 = |v_m B_m^T P shape|^2 + w_m v_m - v_m^2 tr(B_m^T P B_m),
    v_m <- (nu s^2 + w_m q_m)/(nu + w_m),   1/s^2 <- mean of 1/v_m.

Taking all others as alike would give the largest of them to the antinode; fitting only the notable ones leaves out
that they were chosen for being large, and gives intervals that hold too seldom.
"""

from __future__ import annotations

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray

# nu, by trial on reports.updating.identification_sets: less makes intervals narrow, more antinodes less sure
FREEDOM = 6.0
ROUNDS = 150
LONGER = 1.8  # steps of ln v_m, in those of expectation and maximisation, which are short ones
SETTLED = 5e-3  # relative change of every v_m in a round that ends it


def reading(own: FloatArray, covariance: FloatArray) -> FloatArray:
    """What gives the parts c (columns,) of a shape = own c + error by generalised least squares, (columns, sensors).

    >>> reading(np.ones((2, 1)), np.diag([1.0, 3.0])).tolist()
    [[0.75, 0.25]]
    """
    weighted = np.linalg.solve(covariance, own)
    return np.asarray(np.linalg.solve(own.T @ weighted, weighted.T))


def spread_of_others(
    shape: FloatArray, own: FloatArray, others: FloatArray, order: IntArray, covariance: FloatArray
) -> FloatArray:
    """Sum of v_m B_m B_m^T: the covariance (sensors, sensors) of what the other n add to a shape (sensors,).

    `own` (sensors, 1 or 2) are the columns A, `others` (sensors, columns) all B_m, `order` (columns,) the m of each,
    counted from 0.
    """
    width = np.bincount(order)
    left = shape - own @ np.linalg.lstsq(own, shape, rcond=None)[0]
    even = float(left @ left) / float(np.sum(others**2)) + 1e-300
    v, scale2 = np.full(len(width), even), even
    for _ in range(ROUNDS):
        total = covariance + (others * v[order]) @ others.T
        inverse = np.linalg.inv(total)
        weighted = inverse @ own
        P = inverse - weighted @ np.linalg.solve(own.T @ weighted, weighted.T)
        seen = P @ others
        each = v[order]
        square = (each * (shape @ seen)) ** 2 + each - each**2 * np.sum(others * seen, axis=0)
        new = (FREEDOM * scale2 + np.bincount(order, square)) / (FREEDOM + width)
        change = new / v
        v = v * change**LONGER
        scale2 = 1.0 / float(np.mean(1.0 / v))
        if float(np.abs(change - 1.0).max()) < SETTLED:
            break
    return np.asarray((others * v[order]) @ others.T)
