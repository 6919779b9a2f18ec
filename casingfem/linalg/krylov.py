"""Eigenvalues nearest a shift: block Lanczos on (A - sigma B)^-1 B with thick restarts.

A random block of vectors is multiplied repeatedly, and every new block is made B-orthogonal to all previous ones.
Rayleigh-Ritz on the small projected matrix gives theta = 1/(lambda - sigma). A block finds both members of a double
mode at once, while a single vector finds the second only through round-off. It also multiplies its vectors in one pass
over the factor. A basis that grows too large restarts from its best Ritz vectors (Wu & Simon, SIAM J. Matrix Anal.
Appl. 22, 2000, 602), including converged ones.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import eigh

from casingfem.errors import NumericsError
from casingfem.io.arrays import Array, FloatArray
from casingfem.linalg.pencil import Pencil
from casingfem.linalg.substitution import kernels
from contact.io.progress import tell

NOISE = 1e-13  # of a block's size: what is left after orthogonalisation below this is round-off
BLOCKS = (8, 32, 128)  # vectors multiplied together: clusters up to this size are met whole; larger on a miss
TOLERANCE = 1e-9  # residual of the inverted problem, relative to each theta; eigenvalues are right to its square
ROUND_OFF = 1e-14  # the same, relative to the largest theta: what arithmetic can reach,
LOOSEST = 1e-7  # but no looser than this, which leaves eigenvalues right to its square
SPARE = 1e2  # how much larger the residual of the last vectors may be, which only locate the gap behind the others
FALL = 30.0  # what residuals fall by at most from block to block, at first: an earlier check shows nothing
QUICKER = 1.5  # how much faster they may fall than they did before, in powers of ten
RESTARTS = 20
START_SEED = 7391  # the first block is fixed: same input, same bits

Solve = Callable[[Array], Array]


class ConvergenceError(NumericsError):
    """The basis was restarted too often."""


@dataclass(frozen=True, slots=True, eq=False)
class RitzPairs:
    """Eigenvalues (k,), nearest the shift first, B-orthonormal vectors (n, k), and the number of products."""

    values: FloatArray
    vectors: Array
    products: int


@dataclass(slots=True, eq=False)
class Basis:
    """A B-orthonormal basis Q (n, count), the next block, and T = Q^H B (A - sigma B)^-1 B Q.

    Up to round-off, the image of the next block only has components along the vectors from number `tied` on.
    """

    pencil: Pencil
    solve: Solve
    Q: Array
    T: Array
    fresh: Array = field(default_factory=lambda: np.empty((0, 0)))
    coupling: Array = field(default_factory=lambda: np.empty((0, 0)))
    count: int = 0
    tied: int = 0
    products: int = 0

    def grow(self) -> None:
        """Add the next block to the basis and multiply it."""
        old, self.count = self.count, self.count + self.fresh.shape[1]
        self.Q[:, old : self.count] = self.fresh
        Q = self.Q[:, : self.count]
        image = np.asfortranarray(self.solve(self.pencil.weigh(self.fresh)))  # multifrontal ones are by columns
        self.products += self.fresh.shape[1]
        H = np.zeros((self.count, self.fresh.shape[1]), dtype=Q.dtype)
        size = self.pencil.norm(image)
        for first in (self.tied, 0):  # twice is enough for orthogonality to round-off
            H[first:] += project_out(self.pencil, Q[:, first:], image)
        self.tied = old
        self.T[: self.count, old : self.count] = H
        self.T[old : self.count, : self.count] = H.conj().T
        self.fresh, self.coupling = orthonormal(self.pencil, image, NOISE * size)

    def begin(self, block: Array) -> None:
        """Use a block of new directions as the next one."""
        Q, block = self.Q[:, : self.count], np.array(block, dtype=self.Q.dtype, order="F")
        size = self.pencil.norm(block)
        for _ in range(2):
            project_out(self.pencil, Q, block)
        self.fresh, _ = orthonormal(self.pencil, block, NOISE * size)
        self.coupling = np.zeros((self.fresh.shape[1], self.coupling.shape[1]))

    def ritz(self) -> tuple[FloatArray, Array, FloatArray]:
        """Ritz values theta, largest first, their coefficients in Q, and their residuals relative to the tolerance."""
        theta, S = eigh(self.T[: self.count, : self.count])
        order = np.argsort(-np.abs(theta))
        theta, S = theta[order], S[:, order]
        residuals = np.linalg.norm(self.coupling @ S[self.count - self.coupling.shape[1] :], axis=0)
        size = np.abs(theta)
        return theta, S, residuals / np.clip(ROUND_OFF * size[0], TOLERANCE * size, LOOSEST * size)

    def restart(self, theta: FloatArray, S: Array, kept: int) -> None:
        """Keep only the best Ritz vectors; the next block is unchanged."""
        self.Q[:, :kept] = self.Q[:, : self.count] @ S[:, :kept]
        self.T[:] = 0.0
        self.T[np.arange(kept), np.arange(kept)] = theta[:kept]
        self.count, self.tied = kept, 0


def nearest(
    pencil: Pencil, solve: Solve, sigma: float, wanted: int, block: int = BLOCKS[0], spare: int = 0
) -> RitzPairs:
    """The `wanted` eigenpairs of A x = lambda B x nearest sigma.

    Parameters
    ----------
    pencil
        A and B.
    solve
        (A - sigma B)^-1 on several columns (n, k).
    sigma
        The shift; not an eigenvalue.
    wanted
        Number of pairs, at most the modes of the pencil.
    block
        Vectors multiplied together.
    spare
        Number of the last wanted pairs that may be `SPARE` times less accurate.

    Raises
    ------
    ConvergenceError
        If the pairs do not converge.

    >>> from scipy.sparse import csc_array
    >>> from casingfem.linalg.pencil import make_pencil
    >>> pencil = make_pencil(csc_array(np.diag(np.arange(1.0, 61.0))), np.ones(60))
    >>> found = nearest(pencil, lambda b: b / np.arange(-9.2, 50.0)[:, None], 10.2, 3)
    >>> found.values.round(9).tolist()
    [10.0, 11.0, 9.0]
    """
    size, rng = pencil.size, np.random.default_rng(START_SEED)
    room = min(size, 4 * wanted + 4 * block) + block
    Q, T = np.empty((size, room), dtype=pencil.A.dtype, order="F"), np.zeros((room, room), dtype=pencil.A.dtype)
    basis = Basis(pencil=pencil, solve=solve, Q=Q, T=T)
    basis.begin(solve(pencil.weigh(rng.standard_normal((size, min(block, size))))))
    for _ in range(RESTARTS):
        look, fall, before, ready = 2 * wanted, np.log(FALL), (0, np.inf), 0
        while basis.count + basis.fresh.shape[1] <= room:
            basis.grow()
            tell(f"{ready} of {wanted} modes converged", ready / wanted if ready else None)
            closed = not basis.fresh.shape[1]  # what the block can reach is found
            if closed and basis.count < wanted:
                basis.begin(rng.standard_normal((size, min(block, size - basis.count))))
                if not basis.fresh.shape[1]:
                    raise NumericsError(f"the mass moves {basis.count} ways, {wanted} modes were requested")
            elif closed or basis.count >= min(look, room - 2 * block):
                theta, S, left = basis.ritz()
                left[max(wanted - spare, 0) :] /= SPARE
                ready = int(np.count_nonzero(left[:wanted] <= 1.0))
                if basis.count >= wanted and np.all(left[:wanted] <= 1.0):
                    vectors = basis.Q[:, : basis.count] @ S[:, :wanted]
                    if pencil.massless:  # B does not see what round-off leaves on these unknowns
                        vectors = solve(pencil.weigh(vectors)) / theta[:wanted]
                    return RitzPairs(values=sigma + 1.0 / theta[:wanted], vectors=vectors, products=basis.products)
                to_go = float(np.log(np.maximum(left[:wanted], 1.0).max()))
                if before[0]:
                    fall = QUICKER * max(before[1] - to_go, 1.0) * block / (basis.count - before[0])
                look, before = basis.count + block * max(1, int(to_go / fall)), (basis.count, to_go)
        basis.restart(theta, S, min(wanted + block, basis.count - block))
    converged = int(np.count_nonzero(left[:wanted] <= 1.0))
    raise ConvergenceError(f"{converged} of {wanted} modes near shift {sigma:.6g} converged in {RESTARTS} restarts")


def project_out(pencil: Pencil, Q: Array, block: Array) -> Array:
    """Remove from a block (n, k), in place, its components (count, k) in a B-orthonormal basis Q (n, count).

    Both are stored by columns, so that BLAS neither copies nor sums separately.
    """
    gemm = kernels(Q).gemm
    if not (Q.size and block.size):
        return np.zeros((Q.shape[1], block.shape[1]), dtype=Q.dtype)
    part = gemm(1.0, Q, pencil.weigh(block), trans_a=kernels(Q).adjoint)
    gemm(-1.0, Q, part, beta=1.0, c=block, overwrite_c=1)
    return np.asarray(part)


def orthonormal(pencil: Pencil, block: Array, noise: float) -> tuple[Array, Array]:
    """B-orthonormal basis X of a block (n, k) and C with block = X C; directions shorter than `noise` are dropped."""
    X = independent(pencil, independent(pencil, block, noise))
    return X, X.conj().T @ pencil.weigh(block)


def independent(pencil: Pencil, X: Array, noise: float = 0.0) -> Array:
    """Orthonormal columns, up to round-off, that span X (n, k) without directions shorter than `noise`."""
    gram = X.conj().T @ pencil.weigh(X)
    squares, V = np.linalg.eigh(0.5 * (gram + gram.conj().T))  # a few columns: faster than scipy's routine
    good = squares > max(noise**2, 1e-15 * squares.max(initial=0.0))
    return np.asarray(((V[:, good] / np.sqrt(squares[good])).T @ X.T).T)  # by columns, as X is
