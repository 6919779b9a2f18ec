"""Factorisation of symmetric sparse matrices: what statics, modes and reduction share.

The factor's ordering decides the cost: SuperLU with minimum degree on A^T + A, symmetric mode and diagonal
pivots is some 30 times faster here than its default.
"""

from scipy.sparse import csc_array
from scipy.sparse.linalg import SuperLU, splu


class EigenError(RuntimeError):
    """The matrix could not be factorised, or the eigenproblem not be solved or certified."""


def factorise(A: csc_array) -> SuperLU:
    """LU of a symmetric sparse matrix with pivots on the diagonal.

    Raises
    ------
    EigenError
        If the matrix is singular.
    """
    try:
        return splu(
            csc_array(A),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError as error:
        raise EigenError(
            "the matrix is singular: the structure is not supported, or the shift is an eigenvalue"
        ) from error
