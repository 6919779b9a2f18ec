"""Exact two-step coefficients of modes that are coupled: q'' + C q' + K q = f with full C and K.

Over a step h with constant f, q -> a q + b v + J f, v -> g q + d v + b f, where [a b J; g d b] are blocks of
exp([0 I 0; -K -C I; 0 0 0] h). Eliminating v,

 D <- alpha D - beta q + c f;  q <- q + D,  alpha = b d b^-1 a - b g,  c = J + b b - b d b^-1 J,  beta = c K.

One mode gives the coefficients of `propagator`; damping above critical and zero or negative stiffness are included,
since c is an integral of the propagator, without K^-1. The coefficients are singular with b, when the phase of a mode
advances by pi in a step.

Discrete energy E = D^T N D/2 + q_(n-1)^T K_s q_n/2, N = (c^-1 + c^-T)/2, K = K_s + K_a (symmetric, skew):
with s = D_n + D_(n+1),

 E_(n+1) - E_n = s^T f/2 - s^T P D_n/2 - s^T K_a q_n/2,  P = c^-T - c^-1 alpha.

A gyroscopic force does no work. P_0, from only the skew part of C and the symmetric part of K, is therefore an error of
E; it is zero for a perfect pair and of order h^2 otherwise, and its work counts as that of the scheme. P - P_0 belongs
to damping. A P_0 below 1e-8 of N is not separated from damping.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array, Indices, readonly
from contact.base.groups import joined_groups
from contact.model.gaps.modal_system import NOISE

FALSE = 1e-8
FAINT = 1e-10  # of a frequency: couplings that move no pole by more
ROUND_OFF = 4.0 * float(np.finfo(float).eps)
PARTS = ("alpha", "beta", "c", "lost", "false", "odd", "inertia", "stiff", "mean", "fly", "lift")


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Coupled:
    """Coefficients of b coupled modes over a step h, (b, b) each; `modes` their indices, `top` the largest |Im s|.

    `lost` P - P_0, `false` P_0, `odd` K_a, `inertia` N and `stiff` K_s as in the module. The velocity at t_n of the
    motion through q_(n-1) and q_n under a constant force f is mean q_n - fly q_(n-1) + lift f.
    """

    h: float
    modes: Indices
    top: float
    alpha: Array
    beta: Array
    c: Array
    lost: Array
    false: Array
    odd: Array
    inertia: Array
    stiff: Array
    mean: Array
    fly: Array
    lift: Array

    def velocity(self, q: Array, d: Array, force: Array) -> Array:
        """Velocity at t_n of the motion through q_(n-1), q_n with constant `force`, all (b,)."""
        return np.asarray(self.mean @ q - self.fly @ (q - d) + self.lift @ force)

    def backward(self, q: Array, velocity: Array, load: Array) -> Array:
        """D = q(0) - q(-h) of the motion through (q, velocity) under the load."""
        return np.asarray(q - np.linalg.solve(self.fly, self.mean @ q + self.lift @ load - velocity))

    def discrete(self, q: Array, d: Array) -> float:
        """The discrete energy E."""
        return 0.5 * float(d @ self.inertia @ d + (q - d) @ self.stiff @ q)


def couplings(C: Array, K: Array) -> list[Indices]:
    """Modes that C and K (m, m) couple, as connected components in ascending order, including single modes.

    An off-diagonal entry counts as zero if it is below 1e-10 of the matrix's largest off-diagonal entry (for C also the
    diagonal), the noise of an eigenvalue solver. It also counts as zero if it moves no pole by more than 1e-10 of its
    frequency: |K_ij| <= 1e-10 sqrt|K_ii K_jj|, |C_ij| <= 1e-10 |K_ii K_jj|^(1/4). Frequencies from a mesh have errors
    of this size, from an iteration. An entry moves poles most if both modes have the same frequency w: by K_ij/(2 w)
    and C_ij/2. In (omega q, q') the matrix of undamped modes is skew, so that all omitted entries together move no pole
    by more than their norm in these coordinates, at most m 1e-10 of the highest frequency of m modes.

    >>> couplings(np.array([[0.0, 0.0, 2.0], [0.0, 0.1, 0.0], [-2.0, 0.0, 0.0]]), np.diag([1.0, 2.0, 3.0]))
    [array([0, 2]), array([1])]
    """
    return list(joined_groups(_joined(C, K)))


def _joined(C: Array, K: Array) -> NDArray[np.bool_]:
    """Whether C or K couples two modes, (m, m)."""
    stiff = np.sqrt(np.abs(np.diag(K)))
    off = np.abs(K - np.diag(np.diag(K)))
    floor = np.maximum(NOISE * off.max(initial=0.0), FAINT * np.multiply.outer(stiff, stiff))
    turning = np.abs(C - np.diag(np.diag(C)))
    turning_floor = np.maximum(NOISE * np.abs(C).max(initial=0.0), FAINT * np.sqrt(np.multiply.outer(stiff, stiff)))
    return np.asarray((off > floor) | (turning > turning_floor))


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Form:
    """Modes of a scene at some speeds: `omega` and `zeta` (m,) of single modes, `blocks` of coupled ones.

    `modes` are the coupled ones in ascending order. An uncoupled mode is single if its stiffness is the same at all
    speeds and its damping is below critical.
    """

    omega: Array
    zeta: Array
    modes: Indices
    blocks: list[Indices]


def form(matrices: Sequence[tuple[Array, Array]], omega: Array, zeta: Array) -> Form:
    """Single and coupled modes of C, K (m, m) at one or several speeds.

    `omega`, `zeta` are those of the bodies at rest.

    >>> C, K = np.diag([0.2, 0.0, 9.0]), np.diag([4.0, 9.0, 16.0])
    >>> found = form([(C, K)], np.array([2.0, 3.0, 4.0]), np.zeros(3))
    >>> found.omega.tolist(), found.zeta.tolist(), found.modes.tolist()  # the third has zeta = 1.125
    ([2.0, 3.0, 0.0], [0.05, 0.0, 0.0], [2])
    """
    joined = np.any([_joined(C, K) for C, K in matrices], axis=0)
    C, K = (np.array([np.diag(pair[k]) for pair in matrices]) for k in (0, 1))
    alone = np.ptp(C, axis=0) + np.ptp(K, axis=0) == 0.0
    alone &= ((K[0] > 0.0) & (C[0] ** 2 < 4.0 * K[0]) & (C[0] >= 0.0)) | ((K[0] == 0.0) & (C[0] == 0.0))
    blocks = [block for block in joined_groups(joined) if block.size > 1 or not alone[block[0]]]
    modes = np.sort(np.concatenate([np.zeros(0, dtype=np.int64), *blocks]))
    single = np.ones(omega.size, dtype=bool)
    single[modes] = False
    own = np.where(single, np.where(K[0] == omega**2, omega, np.sqrt(np.maximum(K[0], 0.0))), 0.0)
    moving = own > 0.0
    damped = np.where(C[0] == 2.0 * zeta * omega, zeta, C[0] / (2.0 * np.where(moving, own, 1.0)))
    return Form(omega=readonly(own), zeta=readonly(np.where(moving, damped, 0.0)), modes=modes, blocks=blocks)


def coupled(C: Array, K: Array, modes: Indices, blocks: list[Indices], h: float, top: float = 0.0) -> Coupled:
    """Coefficients for a step h [s] of the modes `modes` of C and K (m, m), which separate into `blocks`.

    `top` is the largest |Im s| if it is known.

    >>> C, K = np.array([[0.0, -3.0], [3.0, 0.0]]), np.diag([16.0, 25.0])
    >>> part = coupled(C, K, np.arange(2), [np.arange(2)], 0.1)
    >>> bool(np.abs(part.lost).max() < 1e-10), round(part.top, 4)  # the gyroscopic force does no work
    (True, 6.3246)
    """
    from scipy.linalg import block_diag

    made = [_coefficients(C[np.ix_(block, block)], K[np.ix_(block, block)], h) for block in blocks]
    order = np.argsort(np.searchsorted(modes, np.concatenate([np.zeros(0, dtype=np.int64), *blocks])))
    arrays = {name: readonly(block_diag(*[one[name] for one in made])[np.ix_(order, order)]) for name in PARTS}
    return Coupled(h=h, modes=modes, top=top or top_of(C, K, blocks), **arrays)


def top_of(C: Array, K: Array, blocks: list[Indices]) -> float:
    """Largest |Im s| of the blocks of C and K [rad/s]."""
    return max((float(np.abs(poles(C[np.ix_(b, b)], K[np.ix_(b, b)]).imag).max()) for b in blocks), default=0.0)


def poles(C: Array, K: Array) -> Array:
    """Poles s of q'' + C q' + K q = 0, (2 b,) complex."""
    from scipy.linalg import eigvals

    b = len(K)
    return np.asarray(eigvals(np.block([[np.zeros((b, b)), np.eye(b)], [-K, -C]])))


def propagated(C: Array, K: Array, h: float) -> tuple[Array, Array, Array, Array, Array]:
    """Blocks a, b, g, d, J of the module, (b, b) each; time is counted in steps, so that all are of order 1."""
    from scipy.linalg import expm

    m = len(K)
    A = np.zeros((3 * m, 3 * m))
    A[:m, m : 2 * m] = A[m : 2 * m, 2 * m :] = np.eye(m)
    A[m : 2 * m, :m], A[m : 2 * m, m : 2 * m] = -h * h * K, -h * C
    E = expm(A)
    return E[:m, :m], E[:m, m : 2 * m], E[m : 2 * m, :m], E[m : 2 * m, m : 2 * m], E[:m, 2 * m :]


def _coefficients(C: Array, K: Array, h: float) -> dict[str, Array]:
    """Coefficients of one block."""
    found, even, skew = _one(C, K, h), 0.5 * (K + K.T), 0.5 * (C - C.T)
    alone = np.array_equal(C, skew) and np.array_equal(K, even)
    false = found["lost"] if alone else _one(skew, even, h)["lost"]
    largest = float(np.abs(found["inertia"]).max())
    noise = ROUND_OFF * len(C) * largest
    false = _without(false, noise if float(np.abs(false).max()) > FALSE * largest else math.inf)
    lost = 0.0 * false if alone and false.any() else found["lost"] - false
    return {**found, "false": false, "lost": _without(lost, noise)}


def _without(matrix: Array, noise: float) -> Array:
    """The matrix without entries of negligible size."""
    return np.asarray(np.where(np.abs(matrix) > noise, matrix, 0.0))


def _one(C: Array, K: Array, h: float) -> dict[str, Array]:
    """Coefficients of one block, with the whole of P in `lost`."""
    a, b, g, d, J = propagated(C, K, h)
    carried = np.asarray(np.linalg.solve(b.T, d.T).T, dtype=np.float64)  # d b^-1
    c = h * h * (J + b @ b - b @ carried @ J)
    alpha = b @ (carried @ a - g)
    inverse = np.linalg.inv(c)
    return {
        "alpha": alpha, "beta": c @ K, "c": c, "lost": inverse.T - inverse @ alpha, "odd": 0.5 * (K - K.T),
        "inertia": 0.5 * (inverse + inverse.T), "stiff": 0.5 * (K + K.T), "mean": carried / h,
        "fly": (carried @ a - g) / h, "lift": h * (b - carried @ J),
    }  # fmt: skip
