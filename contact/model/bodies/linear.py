"""Any linear structure with contacts, as plain arrays: M u'' + C u' + K u = f(t) + Q^T force, g = gap0 + Q u."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from contact.base.arrays import Array, keep_readonly, readonly, require_shape
from contact.base.errors import InputError
from contact.io.brief import brief

Amplitude = Callable[[Array], Array]
SYMMETRIC = 1e-9  # of the largest entry


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Forcing:
    """A load that varies in time: shape (N,) [N] times amplitude(t), t an array of times [s].

    >>> Forcing(shape=np.array([0.0, 2.0]), amplitude=np.cos).shape.tolist()
    [0.0, 2.0]
    """

    shape: Array
    amplitude: Amplitude

    def __post_init__(self) -> None:
        keep_readonly(self, "shape")


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Part:
    """Coordinates start .. end-1 are one body; if `rigid`, its mean velocity is r.M v/r.M r with r = 1 on them.

    >>> Part(name="left", start=0, end=20, number=0, rigid=True).end
    20
    """

    name: str
    start: int
    end: int
    number: int = 0
    rigid: bool = False

    __repr__ = brief


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class LinearBody:
    """M u'' + C u' + K u = load + sum of forcing + Q^T force;  gap = gap0 + Q u, force >= 0 opens it.

    `M`, `K`, `C` (N, N), dense or SciPy sparse, symmetric, or (N,) when diagonal; `Q` (k, N) and `gap0` (k,)
    of k contacts; `load`, `displacement`, `velocity` (N,) zero when left out; `potential` [J] of the load at
    u = 0. M must be positive definite (`MasslessBoundary` makes its own). Storage and time grow with N times the
    band width that reverse Cuthill-McKee leaves, or with the entries (of the factor, for implicit schemes) where these
    fill less than an eighth of it.

    Raises InputError naming the array: shapes, NaN, asymmetry, empty contact rows, penetration at t = 0.

    >>> ball = LinearBody(M=np.array([2.0]), K=np.zeros((1, 1)), Q=np.array([[1.0]]), gap0=np.array([0.1]))
    >>> ball.size, ball.contacts
    (1, 1)
    """

    M: Any
    K: Any
    Q: Any
    gap0: Array
    C: Any = None
    load: Array | None = None
    displacement: Array | None = None
    velocity: Array | None = None
    forcing: tuple[Forcing, ...] = ()
    parts: tuple[Part, ...] = ()
    potential: float = 0.0
    crossing_time: ClassVar[float] = math.inf
    in_order: ClassVar[bool] = False

    __repr__ = brief

    def __post_init__(self) -> None:
        n = np.shape(self.M)[0] if np.ndim(self.M) else 1
        for name in ("M", "K", "C"):
            object.__setattr__(self, name, _matrix(name, getattr(self, name), n))
        object.__setattr__(self, "gap0", readonly(np.atleast_1d(self.gap0)))
        rows = self.Q if hasattr(self.Q, "tocsr") else readonly(np.atleast_2d(self.Q))
        object.__setattr__(self, "Q", rows)
        _require_rows(rows, self.gap0, n)
        for name in ("load", "displacement", "velocity"):
            given = getattr(self, name)
            values = readonly(np.zeros(n) if given is None else given)
            require_shape(name, values, (n,))
            object.__setattr__(self, name, values)
        for forcing in self.forcing:
            require_shape("forcing", forcing.shape, (n,))
        if not self.parts:
            object.__setattr__(self, "parts", (Part(name="body 1", start=0, end=n),))
        self._require_apart()

    def linear_form(self) -> LinearBody:
        """The body itself."""
        return self

    def dense(self) -> tuple[Array, Array, Array, Array]:
        """M, C, K (N, N) and Q (k, N) as plain arrays, for small bodies.

        >>> LinearBody(M=[2.0], K=[[8.0]], Q=[[1.0]], gap0=[0.1]).dense()[2].tolist()
        [[8.0]]
        """
        M, C, K, Q = (A.toarray() if hasattr(A, "toarray") else np.array(A) for A in (self.M, self.C, self.K, self.Q))
        return M, C, K, Q

    @property
    def size(self) -> int:
        """Number of coordinates N."""
        return int(self.M.shape[0])

    @property
    def contacts(self) -> int:
        """Number of contacts k."""
        return int(self.gap0.size)

    def _require_apart(self) -> None:
        assert self.displacement is not None
        gap = self.gap0 + self.Q @ self.displacement
        k = int(np.argmin(gap))
        scale = max(1.0, float(np.abs(self.gap0).max()), float(np.abs(self.displacement).max()))
        if gap[k] < -1e-12 * scale:
            raise InputError(f"gap0: contact {k + 1} penetrates by {-gap[k]:g} m at t = 0, expected a gap >= 0")


def _matrix(name: str, A: Any, n: int) -> Any:
    """A symmetric (N, N) matrix; lumped ones become sparse diagonals."""
    from scipy.sparse import csr_array, diags_array, issparse

    if A is None:
        return csr_array((n, n))
    if np.shape(A) not in ((n, n), (n,)):
        raise InputError(f"{name}: found shape {np.shape(A)}, expected {(n, n)}, or {(n,)} of a diagonal matrix")
    if np.ndim(A) == 1:
        vector = readonly(A)
        require_shape(name, vector, (n,))
        if name == "M" and not np.all(vector > 0.0):
            k = int(np.argmin(vector))
            raise InputError(f"M: found {vector[k]:g} kg at coordinate {k + 1}, expected a mass > 0")
        return diags_array(vector).tocsr()
    matrix = A.tocsr() if issparse(A) else np.array(A, dtype=np.float64)
    values = matrix.data if issparse(matrix) else matrix
    if not np.isfinite(values).all():
        raise InputError(f"{name}: found entries that are NaN or infinite, expected finite numbers")
    skew, size = abs(matrix - matrix.T).max(), abs(matrix).max()
    if skew > SYMMETRIC * size:
        raise InputError(f"{name}: found an asymmetry of {skew / size:.2g} of the largest entry, expected symmetry")
    return matrix


def _require_rows(rows: Any, gap0: Array, n: int) -> None:
    if rows.shape != (gap0.size, n):
        raise InputError(f"Q: found shape {rows.shape}, expected {(gap0.size, n)}, a row for each of gap0")
    if not gap0.size:
        raise InputError("Q: found no rows, expected one for each contact")
    require_shape("gap0", gap0, (gap0.size,))
    sizes = np.asarray(abs(rows).sum(axis=1)).ravel()
    if not np.isfinite(sizes).all():
        raise InputError("Q: found entries that are NaN or infinite, expected finite numbers")
    if not np.all(sizes > 0.0):
        k = int(np.argmin(sizes))
        raise InputError(f"Q: row {k + 1} is zero: contact {k + 1} touches nothing, expected a row that moves it")
