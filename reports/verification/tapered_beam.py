"""Euler-Bernoulli cantilevers of any taper: the equation integrated, and Kirchhoff's wedge by Bessel functions.

    (B w'')'' = omega^2 m w,   B and m relative to the root's, x from 0 (root) to 1 (tip)

w = w' = 0 at the root, B w'' = (B w'')' = 0 at the tip. Frequencies come as omega L^2 sqrt(rho A/(E I)) of the root.
"""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import iv, jv, kv, yv

from casingfem.io.arrays import FloatArray

Factor = Callable[[float], float]


def cantilever(B: Factor, m: Factor, count: int) -> FloatArray:
    """The lowest frequency factors of a cantilever with stiffness B(x) and mass m(x)."""

    def tip(factor: float) -> float:
        def slope(x: float, state: FloatArray) -> FloatArray:
            w, turn, moment, shear = state.reshape(4, 2)
            return np.concatenate([turn, moment / B(x), shear, factor**2 * m(x) * w])

        root = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0])  # a moment, a shear force
        end = solve_ivp(slope, (0.0, 1.0), root, method="DOP853", rtol=1e-10, atol=1e-11).y[:, -1].reshape(4, 2)
        return float(np.linalg.det(end[2:]))

    return roots(tip, count)


def wedge(tip: float, count: int) -> FloatArray:
    """The same of a wedge whose thickness falls to `tip` of the root's, by Bessel functions of 2 sqrt(factor z).

    Kirchhoff, Monatsberichte Akad. Berlin, 1879, 815; z counts from the apex, 1 at the root of the whole wedge. With
    w = z^(-1/2) C_1, w' ~ z^-1 C_2, M ~ z^(3/2) C_3, V ~ z C_2; `tip` 0 is the sharp wedge, 5.315, 15.207, 30.02.
    """
    kinds = [(jv, -1.0, 1.0), (iv, 1.0, 1.0), (yv, -1.0, 1.0), (kv, -1.0, -1.0)]  # signs of slope and shear
    kinds = kinds if tip > 0.0 else kinds[:2]

    def determinant(factor: float) -> float:
        k = factor / (1.0 - tip) ** 2  # the factor of the wedge drawn out to its apex
        q1, q2 = 2.0 * np.sqrt(k), 2.0 * np.sqrt(k * tip)
        rows = [[C(1, q1) for C, _, _ in kinds], [s * C(2, q1) for C, s, _ in kinds]]
        if tip > 0.0:
            rows += [[C(3, q2) for C, _, _ in kinds], [v * C(2, q2) for C, _, v in kinds]]
        matrix = np.array(rows)
        return float(np.linalg.det(matrix / np.abs(matrix).max(axis=0)))

    return roots(determinant, count)


def roots(f: Callable[[float], float], count: int) -> FloatArray:
    """The first sign changes of f from 1 on, on steps of a tenth, refined."""
    found: list[float] = []
    low, value = 1.0, f(1.0)
    while len(found) < count:
        high = 1.1 * low
        after = f(high)
        if value * after < 0.0:
            found.append(float(brentq(f, low, high, rtol=1e-12)))
        low, value = high, after
    return np.array(found)
