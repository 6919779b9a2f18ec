"""Factorisations of symmetric sparse matrices, and the inertia from their pivots, for statics, modes and reduction.

"multifrontal" is this package's: L D L^H by dense fronts (`multifrontal`) along a nested dissection; its memory is
known and checked beforehand. "superlu" comes with scipy: minimum degree on A^T + A, symmetric mode and diagonal pivots
are some 30 times faster here than its default. Because pivots stay on the diagonal, the signs of U's diagonal are the
inertia of A (Sylvester). "pardiso" is MKL's LDL^T, if the extra `direct` is installed: pypardiso, which this module
alone imports.
"""

import weakref
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np
from scipy.sparse import csc_array, csr_matrix, triu
from scipy.sparse.linalg import SuperLU, splu

from casingfem.errors import ModelError, NumericsError, sentence
from casingfem.extras import remedy
from casingfem.io.arrays import Array, FloatArray
from casingfem.linalg.element_sum import ElementSum
from casingfem.linalg.entries import Symmetric
from casingfem.linalg.fronts import planned
from casingfem.linalg.memory import MemoryNeedError, free_memory, require_memory
from casingfem.linalg.multifrontal import SINGULAR, MultifrontalFactor, factored

Direct: TypeAlias = Literal["multifrontal", "superlu", "pardiso"]

BALANCE = 1e-3  # relative error of u K u = u f beyond which K is singular; 1e-5 is round-off at t/L 3e-4
SYMMETRIC_INDEFINITE = -2  # Pardiso's matrix type: L D L^T with Bunch-Kaufman pivots
NEGATIVE, ZERO_PIVOTS = 23, 14  # where its output parameters are, counted from one


@dataclass(frozen=True, slots=True, eq=False)
class SuperLUFactor:
    """LU by SuperLU with pivots on the diagonal."""

    lu: SuperLU

    def solve(self, rhs: Array) -> Array:
        """A^-1 rhs."""
        return np.asarray(self.lu.solve(rhs))

    def negative(self) -> int:
        """Number of negative pivots, also for a Hermitian matrix; NumericsError if pivots left the diagonal."""
        if not np.array_equal(self.lu.perm_r, self.lu.perm_c):
            raise NumericsError(
                'SuperLU used pivots off the diagonal, so that modes cannot be counted: use direct = "multifrontal"'
            )
        return int(np.count_nonzero(np.real(self.lu.U.diagonal()) < 0.0))


class PardisoFactor:
    """L D L^T of a symmetric matrix; the inertia is Pardiso's own count of negative eigenvalues of D."""

    def __init__(self, A: csc_array) -> None:
        try:
            from pypardiso import PyPardisoSolver
            from pypardiso.pardiso_wrapper import PyPardisoError
        except ImportError as error:
            raise NumericsError(f'direct = "pardiso" needs the package pypardiso: {remedy("direct")}') from error
        self.upper = csr_matrix(triu(A, format="csr"))
        self.upper.sort_indices()
        self.solver = PyPardisoSolver(mtype=SYMMETRIC_INDEFINITE)
        weakref.finalize(self, self.solver.free_memory, everything=True)
        try:
            self.solver.factorize(self.upper)
        except (PyPardisoError, ValueError) as error:
            raise NumericsError(f"Pardiso could not factorise the matrix: {error}") from error
        if self.solver.get_iparm(ZERO_PIVOTS):
            raise NumericsError(SINGULAR)

    def solve(self, rhs: FloatArray) -> FloatArray:
        """A^-1 rhs."""
        return np.asarray(self.solver.solve(self.upper, rhs))

    def negative(self) -> int:
        """Number of negative eigenvalues of A."""
        return int(self.solver.get_iparm(NEGATIVE))


Factor: TypeAlias = MultifrontalFactor | SuperLUFactor | PardisoFactor


def canonical(A: csc_array) -> csc_array:
    """The matrix with sorted, unique entries; unchanged if they are."""
    if not A.has_canonical_format:
        A = A.copy()
        A.sum_duplicates()
    return A


def multifrontal(A: Symmetric, keep: bool) -> Factor:
    """Factorise by dense fronts, or only count negative eigenvalues."""
    A = A if isinstance(A, ElementSum) else canonical(A)  # as plans expect it
    try:
        fronts = planned(A)
        require_memory(fronts.bytes(keep, A.dtype.itemsize), A.shape[0], free_memory())
        return factored(A, fronts, keep)
    except MemoryError as error:
        if isinstance(error, MemoryNeedError):
            raise
        raise MemoryNeedError(sentence("modes-memory", f"found no memory to factor {A.shape[0]} unknowns")) from error


def superlu(A: csc_array) -> Factor:
    """Factorise by SuperLU."""
    try:
        lu = splu(A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise NumericsError(SINGULAR) from error
    except MemoryError as error:
        raise MemoryNeedError(sentence("modes-memory", f"found no memory to factor {A.shape[0]} unknowns")) from error
    return SuperLUFactor(lu)


def factorise(A: Symmetric, direct: Direct = "multifrontal", *, keep: bool = True) -> Factor:
    """Factor a symmetric or Hermitian matrix, also an indefinite one; without `keep` only for its inertia.

    Raises
    ------
    NumericsError
        If the matrix is singular, or the solver is not installed.
    MemoryNeedError
        `modes-memory`, also a `NumericsError`, if it does not fit into the free memory.

    >>> factor = factorise(csc_array(np.diag([2.0, -4.0])))
    >>> factor.solve(np.ones(2)).tolist(), factor.negative()
    ([0.5, -0.25], 1)
    """
    if direct not in get_args(Direct):
        raise NumericsError(f"direct must be one of {', '.join(get_args(Direct))}, found {direct!r}")
    if direct == "multifrontal":
        return multifrontal(A if isinstance(A, ElementSum) else csc_array(A), keep)
    A = A.tocsc() if isinstance(A, ElementSum) else csc_array(A)
    return superlu(A) if direct == "superlu" else PardisoFactor(A)


def solve_held(K: Symmetric, f: FloatArray) -> FloatArray:
    """K u = f (free,) for a structure that must be supported.

    Raises
    ------
    ModelError
        `static-loose` if a rigid motion is not restrained: K is singular, or the energy u K u is not the work u f.
    """
    try:
        u = np.asarray(factorise(K).solve(f))
    except NumericsError as error:
        raise ModelError("static-loose", "static solution: found a singular stiffness") from error
    return balanced(K, u, f)


def balanced(K: Symmetric, u: FloatArray, f: FloatArray) -> FloatArray:
    """A static solution u (free,) for a load f whose strain energy equals the work of the load.

    Raises
    ------
    ModelError
        `static-loose` if it is not: a rigid motion is not restrained.
    """
    work, strain = float(u @ f), float(u @ (K @ u))
    if not abs(work - strain) <= BALANCE * abs(work):
        raise ModelError("static-loose", f"static solution: found {strain:.3g} J of strain for {work:.3g} J of work")
    return u
