"""Derivatives of linear functions ("readings") of mode shapes: their adjoints, for all modes from one Krylov space.

A reading b^T phi_i of mode i changes with a parameter by z^T (K' - lambda_i M') phi_i, plus a part within its own
plane,

    (K - lambda_i M) z = -(b - M Phi_i Phi_i^T b),   z M-orthogonal to Phi_i, the mode or its doublet,

(Fox & Kapoor, AIAA J. 6, 1968, 2426, with omitted modes by their static response). Among the computed modes
the solution is explicit. The rest lies in span[F b, F M F b, ...], F = (K - s M)^-1: one Galerkin space serves all
lambda_i, and each further power multiplies its error by about (lambda_i/lambda_m)^2, with the first omitted mode m.

Many sensors measure the same motions, so only directions of a block above `SMALL` of its largest are kept.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, qr, svd

from casingfem.io.arrays import FloatArray
from casingfem.modal.neighbour import Solution

DEPTH = 3
SMALL = 1e-5  # a combination of sensors below it reads motions of modes at 300 times the frequency and above


@dataclass(frozen=True, slots=True, eq=False)
class AdjointSpace:
    """Motions that span all adjoints of some readings: the computed modes, and directions beyond them.

    Attributes
    ----------
    fields, own
        Nodal motions and those of the rings' own dofs, modes first: (nodes, 5, motions), (own, motions).
    values
        phi^T K phi of the motions, all mass-normalised and orthogonal [rad^2/s^2], (motions,).
    readings
        b^T of each motion, (readings, motions).
    """

    fields: FloatArray
    own: FloatArray
    values: FloatArray
    readings: FloatArray

    def weights(self, reading: int, mode: int, plane: Sequence[int]) -> FloatArray:
        """The coefficients (motions,) of the motions in the adjoint z of one reading for one mode."""
        away = self.values[mode] - self.values
        away[list(plane)] = np.inf
        return np.asarray(self.readings[reading] / away)


def adjoint_space(solution: Solution, loads: FloatArray, depth: int = DEPTH) -> AdjointSpace:
    """The space of the adjoints of readings given as nodal loads (nodes, 5, readings)."""
    pencil, system, modes = solution.pencil, solution.system, solution.modes
    scale = pencil.scale[:, None]
    b = scale * system.restrict(loads)
    X = solution.vectors[:, : len(modes)]
    basis, block = X, b
    for _ in range(depth):
        block = directions(solution.old.apply(pencil, block), basis)
        basis = np.hstack([basis, block])
    V = basis[:, len(modes) :]
    values, turn = eigh(V.T @ (pencil.A @ V))
    V = V @ turn
    fields, own = system.expand(scale * V), system.expand_own(scale * V)
    return AdjointSpace(
        fields=np.concatenate([modes.fields, fields], axis=2),
        own=np.concatenate([modes.own, own], axis=1),
        values=np.concatenate([modes.omega**2, values]),
        readings=np.concatenate([np.einsum("ncr,ncm->rm", loads, modes.fields), b.T @ V], axis=1),
    )


def directions(block: FloatArray, basis: FloatArray) -> FloatArray:
    """Orthonormal directions of a block (dofs, any) beyond a basis, those above `SMALL` of the block."""
    R = qr(block, mode="r")[0][: block.shape[1]]
    least = SMALL * np.linalg.norm(R, 2)
    block = block - basis @ (basis.T @ block)
    left, sizes, _ = svd(block - basis @ (basis.T @ block), full_matrices=False)
    kept = left[:, sizes > least]
    return np.asarray(kept - basis @ (basis.T @ kept))
