"""Exact steps of a linear rotor: the propagator of (q, v, rotating force, constant force) and the work of its forces.

 q' = v,  v' = -K(Omega) q - C(Omega) v + plane^T (c, s) + load,  c' = -Omega s,  s' = Omega c,  1' = 0

is z' = A z at constant speed, so that z(t + h) = e^(A h) z(t) is exact for any step, also under the rotating force. A
force with power z^T Q z does the work z^T W z over the step, W = int_0^h e^(A^T s) Q e^(A s) ds, so that the energies
balance to round-off. W is computed by a Gauss rule over a short interval, then doubled, W(2 s) = W(s) + P(s)^T W(s)
P(s).
"""

from __future__ import annotations

import math

import numpy as np

from contact.base.arrays import Array
from contact.model.rotor.rotor import Rotor

SHORT = 0.1  # radians of the highest frequency in the interval of the Gauss rule
POINTS = 6  # of the Gauss rule: error 0.1^12


def stored_stiffness(rotor: Rotor) -> Array:
    """Symmetric stiffness at rest, which determines the stored energy, (m, m) [1/s^2]."""
    K = rotor.matrices(0.0)[1]
    return np.asarray(0.5 * (K + K.T))


def generator(rotor: Rotor, omega: float) -> tuple[Array, Array]:
    """A (d, d) and Q (3, d, d) at a speed [rad/s]: powers of damping, of the drive of the rotor, of the unbalance.

    Forces that belong neither to the stored stiffness nor to the symmetric damping take their work from the drive:
    internal damping and cross-coupling.
    """
    C, K = rotor.matrices(omega)
    m = len(C)
    A, Q = np.zeros((2 * m + 3, 2 * m + 3)), np.zeros((3, 2 * m + 3, 2 * m + 3))
    q, v, turn = slice(0, m), slice(m, 2 * m), slice(2 * m, 2 * m + 2)
    A[q, v] = np.eye(m)
    A[v, q], A[v, v], A[v, turn], A[v, -1] = -K, -C, rotor.plane.T, rotor.load
    A[turn, turn] = omega * np.array([[0.0, -1.0], [1.0, 0.0]])
    Q[0, v, v] = -0.5 * (C + C.T)
    Q[1, v, q] = stored_stiffness(rotor) - K
    Q[2, v, turn] = rotor.plane.T
    return A, Q


def step_of(rotor: Rotor, omega: float, h: float) -> tuple[Array, Array]:
    """P (d, d) and W (3, d, d) for a step h [s] at a speed [rad/s]."""
    from scipy.linalg import expm

    A, Q = generator(rotor, omega)
    if h == 0.0:
        return np.eye(len(A)), np.zeros_like(Q)
    m, top = rotor.body.omega.size, highest(A) or 1.0
    scale = np.ones(len(A))  # coordinates times a frequency are velocities: the matrices have one size
    scale[:m] = np.maximum(rotor.body.omega, 0.01 * top)
    A, Q = scale[:, None] * A / scale, Q / (scale[:, None] * scale)
    halvings = math.ceil(math.log2(max(top * h / SHORT, 1.0)))
    short = h / 2**halvings
    place, weight = np.polynomial.legendre.leggauss(POINTS)
    W = np.zeros_like(Q)
    for x, w in zip(place.tolist(), weight.tolist(), strict=True):
        at = expm(A * (0.5 * short * (1.0 + x)))
        W += 0.5 * short * w * (at.T @ Q @ at)
    P = expm(A * short)
    for _ in range(halvings):
        W = W + P.T @ W @ P
        P = P @ P
    return np.asarray(P / scale[:, None] * scale), np.asarray(scale[:, None] * W * scale)


def highest(A: Array) -> float:
    """Largest |eigenvalue| [rad/s]."""
    return float(np.abs(np.linalg.eigvals(A)).max(initial=0.0))
