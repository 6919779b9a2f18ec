"""MKL Pardiso behind pypardiso, an optional package; the one module that imports it."""

import weakref

import numpy as np
from scipy.sparse import csc_array, csr_matrix, triu

from casingfem.errors import NumericsError
from casingfem.io.arrays import FloatArray

SYMMETRIC_INDEFINITE = -2  # Pardiso's matrix type: L D L^T with Bunch-Kaufman pivots
NEGATIVE, ZERO_PIVOTS = 23, 14  # where its output parameters stand, counted from one


class PardisoFactor:
    """L D L^T of a symmetric matrix; the inertia is Pardiso's own count of negative eigenvalues of D."""

    def __init__(self, A: csc_array) -> None:
        from pypardiso import PyPardisoSolver
        from pypardiso.pardiso_wrapper import PyPardisoError

        self.upper = csr_matrix(triu(A, format="csr"))
        self.upper.sort_indices()
        self.solver = PyPardisoSolver(mtype=SYMMETRIC_INDEFINITE)
        weakref.finalize(self, self.solver.free_memory, everything=True)
        try:
            self.solver.factorize(self.upper)
        except (PyPardisoError, ValueError) as error:
            raise NumericsError(f"Pardiso could not factorise the matrix: {error}") from error
        if self.solver.get_iparm(ZERO_PIVOTS):
            raise NumericsError("the matrix is singular: the structure is not supported, or the shift is an eigenvalue")

    def solve(self, rhs: FloatArray) -> FloatArray:
        """A^-1 rhs."""
        return np.asarray(self.solver.solve(self.upper, rhs))

    def negative(self) -> int:
        """Number of negative eigenvalues of A."""
        return int(self.solver.get_iparm(NEGATIVE))
