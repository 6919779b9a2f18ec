"""C and K of the modes in a basis as functions of speed, with the response of the other modes eliminated.

    M x'' + Omega G x' + K(Omega) x = 0,   K(Omega) = K_s + (Omega^2 - s^2) K1 + (Omega^4 - s^4) K2

K_s is K at the speed s of the modes Phi. Coriolis forces and stress also excite the omitted modes, whose response is in
K_s^-1 G Phi, K_s^-1 K1 Phi and K_s^-1 K2 Phi. These and Phi span a small model of the structure.

With K = L L^T and y = (L^T x, x'), y' = S y with S = [[0, L^T], [-L, -Omega G]], which is skew. `SWEEPS` inverse
iterations bring the motions (L^T Phi, Phi) of the modes towards the slow motions of S. U is their orthonormal basis
nearest to the first one. U^T S U is also skew. The error of its frequencies is the square of the error of U. A rotation
that makes its first block zero gives U^T S U = [[0, B], [-B^T, -C]], the matrices of

    q'' + C q' + B^T B q = 0.

C/Omega and K are smooth in x = Omega^2 - s^2. The basis has polynomials through three speeds: C/Omega of degree 2, K of
degree 3. The speeds extend to a frequency change of `REACH`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import expm, solve_triangular
from scipy.sparse import csc_array

from casingfem.io.arrays import FloatArray
from casingfem.linalg.entries import Symmetric
from casingfem.structure.shell.prestress import Times

SWEEPS = 4  # inverse iterations
TURNS = 4  # rotations towards a zero first block; each squares it
REACH = 0.5  # relative change of a frequency to which the polynomials reach
DEPENDENT = 1e-10  # of unit squares: a direction that is a sum of others
COLUMNS = 64  # multiplied at once
NODES = np.array([0.067, 0.5, 0.933])  # of the range of Omega^2: Chebyshev's points
BOTH = np.array([-0.9, 0.45, 0.95])  # of the ranges below and above the speed of the modes
SHORTER = 6  # times that the range is halved where K is not positive definite


class Kept(NamedTuple):
    """Mass-normalised modes (free, m) of K and the mass, omega (m,) [rad/s], and the solution K^-1 f of loads f.

    `solve` is None for fixed-interface modes.
    """

    vectors: FloatArray
    omega: FloatArray
    K: Symmetric
    mass: csc_array
    solve: Callable[[FloatArray], FloatArray] | None


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class SmallModel:
    """A rotating structure in a few mass-normalised motions, the modes first; matrices (N, N).

    `stiff` K_s, `coriolis` G, `first` and `second` K1 and K2; `modes` is the number of modes, `spin` their speed
    [rad/s].
    """

    stiff: FloatArray
    coriolis: FloatArray
    first: FloatArray
    second: FloatArray
    modes: int
    spin: float

    def stiffness(self, square: float) -> FloatArray:
        """K at a squared speed."""
        s2 = self.spin**2
        return self.stiff + (square - s2) * self.first + (square**2 - s2**2) * self.second

    def between_modes(self) -> dict[str, Any]:
        """Projections of G and of dK/dOmega^2 on the modes, without the motions that respond to them."""
        m = self.modes
        slope = self.first[:m, :m] + 2.0 * self.spin**2 * self.second[:m, :m]
        return {"gyroscopic": self.coriolis[:m, :m], "stiffness_by_speed": slope}


def small_model(modes: Kept, times: Times, spin: float) -> SmallModel:
    """The modes of a basis and the motions that respond to them; `times` gives G, K1 and K2 times motions."""
    assert modes.solve is not None
    of_modes = times(modes.vectors)
    follow = independent(modes.vectors, modes.solve(np.hstack(of_modes)), modes.mass)
    V, m = np.hstack([modes.vectors, follow]), len(modes.omega)
    G, first, second = (np.hstack([V.T @ part, np.zeros((V.shape[1], follow.shape[1]))]) for part in of_modes)
    for begin in range(m, V.shape[1], COLUMNS):
        here = slice(begin, begin + COLUMNS)
        for total, part in zip((G, first, second), times(V[:, here]), strict=True):
            total[:, here] = V.T @ part
    stiff = np.diag(np.concatenate([modes.omega**2, np.zeros(follow.shape[1])]))
    stiff[m:, m:] = follow.T @ (modes.K @ follow)
    stiff, first, second = (0.5 * (part + part.T) for part in (stiff, first, second))
    return SmallModel(stiff=stiff, coriolis=0.5 * (G - G.T), first=first, second=second, modes=m, spin=spin)


def independent(vectors: FloatArray, more: FloatArray, mass: csc_array) -> FloatArray:
    """Mass-normalised columns that span `more` (free, k) beside the mass-normalised `vectors` (free, m)."""
    for _ in range(2):  # the second time for round-off
        more = more - vectors @ (vectors.T @ (mass @ more))
    size = np.sqrt(np.einsum("ij,ij->j", more, mass @ more))
    more = more[:, size > 0.0] / size[size > 0.0]
    squares, turn = np.linalg.eigh(more.T @ (mass @ more))
    kept = squares > DEPENDENT
    return np.asarray(more @ (turn[:, kept] / np.sqrt(squares[kept])))


def series(model: SmallModel) -> dict[str, Any]:
    """Fields of the basis: polynomials of C/Omega and K in Omega^2 - spin^2, or projections if K is indefinite."""
    low, high = squares_within_reach(model)
    for _ in range(SHORTER):
        x = high * NODES if low == 0.0 else np.where(BOTH < 0.0, -low * BOTH, high * BOTH)
        try:
            return through(model, x)
        except np.linalg.LinAlgError:  # K is not positive definite at one of the speeds
            low, high = 0.5 * low, 0.5 * high
    return model.between_modes()


def through(model: SmallModel, x: FloatArray) -> dict[str, Any]:
    """Polynomials through three values of Omega^2 - spin^2, (3,); K also has its value at the speed of the modes.

    Raises LinAlgError if K is not positive definite.
    """
    m, s2 = model.modes, model.spin**2
    at_modes = np.diag(np.diag(model.stiff)[:m]) if s2 == 0.0 else slow_motions(model, s2)[1]
    C, K = (np.array(part) for part in zip(*(slow_motions(model, s2 + one) for one in x.tolist()), strict=True))
    scale = float(np.abs(x).max())
    inverse = np.linalg.inv(np.vander(x / scale, increasing=True))
    G = np.tensordot(inverse / scale ** np.arange(3)[:, None], C, 1)
    E = np.tensordot(inverse / scale ** np.arange(3)[:, None], (K - at_modes) / x[:, None, None], 1)
    found = {
        "gyroscopic": G[0], "gyroscopic_higher": G[1:], "stiffness_by_speed": E[0], "stiffness_higher": E[1:]
    }  # fmt: skip
    return found if s2 == 0.0 else {**found, "stiffness": at_modes - np.diag(np.diag(model.stiff)[:m])}


def squares_within_reach(model: SmallModel) -> tuple[float, float]:
    """Range of Omega^2 - spin^2 in which rotation changes no frequency by more than `REACH`, (low <= 0, high)."""
    m = model.modes
    squares = np.diag(model.stiff)[:m]
    slope = np.diag(model.between_modes()["stiffness_by_speed"]) / squares
    up, down = (1.0 + REACH) ** 2 - 1.0, 1.0 - (1.0 - REACH) ** 2
    lowest = float(squares.min())
    rising, falling = float(slope.max(initial=0.0)), float(-slope.min(initial=0.0))
    high = min(lowest, up / rising if rising else lowest, down / falling if falling else lowest)
    low = min(lowest, down / rising if rising else lowest, up / falling if falling else lowest)
    return -min(low, model.spin**2), high


def slow_motions(model: SmallModel, square: float) -> tuple[FloatArray, FloatArray]:
    """C/Omega and K of the modes at a squared speed, (m, m) each.

    Raises LinAlgError if K is not positive definite.
    """
    m, N, speed = model.modes, len(model.stiff), float(np.sqrt(square))
    L, G = np.linalg.cholesky(model.stiffness(square)), speed * model.coriolis
    start = np.zeros((2 * N, 2 * m))
    start[:N, :m], start[N : N + m, m:] = orthonormal(np.asarray(L.T[:, :m])), np.eye(m)
    U = start
    for _ in range(SWEEPS):
        v = solve_triangular(L, U[:N], lower=True, trans="T")
        U = np.linalg.qr(np.vstack([-solve_triangular(L, U[N:] + G @ v, lower=True), v]))[0]
    U = orthonormal(U @ (U.T @ start))
    y1, y2 = U[:N], U[N:]
    S = y1.T @ (L.T @ y2)
    S = S - S.T - y2.T @ (G @ y2)
    for _ in range(TURNS):
        X = 0.5 * np.linalg.solve(S[:m, m:], S[:m, :m].T).T
        turn = expm(np.block([[np.zeros((m, m)), X], [-X.T, np.zeros((m, m))]]))
        S = turn @ S @ turn.T
    B, C = S[:m, m:], 0.5 * (S[m:, m:].T - S[m:, m:])
    return C / speed, B.T @ B


def orthonormal(U: FloatArray) -> FloatArray:
    """The orthonormal columns nearest to independent ones."""
    left, _, right = np.linalg.svd(U, full_matrices=False)
    return np.asarray(left @ right)
