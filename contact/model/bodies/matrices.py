"""Someone's matrices M, K, C, checked and in SI: what their rows mean, unit forces on a contact, their facts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.units import units_of

DIRECTIONS = ("q", "x", "y", "z", "rx", "ry", "rz")  # q: a scalar, such as the amplitude of a mode
NUMBERED: dict[str | int, str] = dict(enumerate(DIRECTIONS))
SKEW = 1e-4  # asymmetry of a matrix, of the entries in its rows, beyond which it is refused

Dof: TypeAlias = tuple[int, str | int]
Contact: TypeAlias = Sequence[int] | Sequence[Dof] | Mapping[str, Any]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Matrices:
    """Matrices in SI, and what their rows mean.

    `M`, `K` (n, n) sparse; `C` likewise or None. `dofs` (n,) pairs (node, direction), direction one of `DIRECTIONS`.
    `points` node -> position [m].
    """

    M: Any
    K: Any
    C: Any
    dofs: tuple[tuple[int, str], ...]
    points: Mapping[int, Array]
    skew: tuple[float, float]

    @staticmethod
    def of(
        M: Any,
        K: Any,
        C: Any = None,
        *,
        dofs: Sequence[Dof],
        points: Mapping[int, Sequence[float]] | None = None,
        units: str = "m-kg-s",
    ) -> Matrices:
        """Check matrices in any consistent units; raises InputError naming what does not fit."""
        from scipy.sparse import csc_array, diags_array

        try:
            system = units_of(units)
        except ValueError as error:
            raise InputError(str(error)) from None
        named = tuple(checked_dof(dof) for dof in dofs)
        if len(set(named)) < len(named):
            twice = next(dof for k, dof in enumerate(named) if dof in named[:k])
            raise InputError(f"dofs: found {twice[0]}.{twice[1]} twice, expected each once")
        size = [system.length if dof[1][0] == "r" else 1.0 for dof in named]  # a rotation times this is a length
        scale = csc_array(diags_array(np.array(size)))
        matrices: list[Any] = []
        skews: list[float] = []
        for name, A, unit in (("M", M, system.mass), ("K", K, system.stiffness), ("C", C, system.damping)):
            if A is None and name == "C":
                matrices.append(None)
                continue
            symmetric, skew = symmetric_part(name, A, len(named))
            matrices.append(csc_array(unit * (scale @ symmetric @ scale)))
            skews.append(skew)
        places = {int(node): system.length * np.asarray(x, dtype=float) for node, x in (points or {}).items()}
        for node, x in places.items():
            if x.shape != (3,) or not np.isfinite(x).all():
                raise InputError(f"points: found {points[node] if points else x!r} for node {node}, expected x, y, z")
        M, K, C = matrices
        empty = np.flatnonzero((abs(M) + abs(K)).sum(axis=0) == 0.0)
        if empty.size:
            node, direction = named[int(empty[0])]
            found = f"found neither mass nor stiffness at {node}.{direction}, the first of {empty.size} such dofs"
            raise InputError(f"M, K: {found}, expected one or both; leave out their rows and columns")
        return Matrices(M=M, K=K, C=C, dofs=named, points=places, skew=(skews[0], skews[1]))

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.dofs)

    def rigid_motions(self) -> Array:
        """Translations along x, y, z and rotations about the origin, (n, 6); rotations only where points are known."""
        motions = np.zeros((self.size, 6))
        for row, (node, direction) in enumerate(self.dofs):
            if direction in ("x", "y", "z"):
                i = "xyz".index(direction)
                motions[row, i] = 1.0
                if node in self.points:
                    motions[row, 3:] = np.cross(np.eye(3), self.points[node])[:, i]
            elif direction != "q":
                motions[row, 3 + "xyz".index(direction[1])] = 1.0
        return motions

    def loads(self, contact: Contact) -> tuple[tuple[str, ...], Array]:
        """Channel names and unit forces on them, (n, channels)."""
        if isinstance(contact, Mapping):
            P = np.stack([np.asarray(row, dtype=float) for row in contact.values()], axis=1)
            if P.shape[0] != self.size:
                raise InputError(f"contact: found rows of {P.shape[0]} entries, expected {self.size}, one a dof")
            return tuple(contact), P
        wanted: list[tuple[int, str]] = []
        for item in contact:
            if isinstance(item, tuple):
                wanted.append(checked_dof(item))
                continue
            own = [(int(item), axis) for axis in "xyz" if (int(item), axis) in self.dofs]
            if not own:
                raise InputError(f"contact: found node {item}, which no dof belongs to")
            wanted += own
        missing = [f"{node}.{direction}" for node, direction in wanted if (node, direction) not in self.dofs]
        if missing or not wanted or len(set(wanted)) < len(wanted):
            found = f"{missing[0]}, which is no dof" if missing else f"{wanted}"
            raise InputError(f"contact: found {found}, expected nodes or dofs of the matrices, each once")
        P = np.zeros((self.size, len(wanted)))
        P[[self.dofs.index(dof) for dof in wanted], range(len(wanted))] = 1.0
        return tuple(f"{node}.{direction}" for node, direction in wanted), P


def checked_dof(dof: Dof) -> tuple[int, str]:
    """A dof as (node, direction), directions by name or as 1 to 6, 0 for a scalar."""
    node, direction = dof
    name = NUMBERED.get(direction, str(direction))
    if name not in DIRECTIONS:
        raise InputError(f"dofs: found direction {direction!r} at node {node}, expected {', '.join(DIRECTIONS)}")
    return int(node), name


def symmetric_part(name: str, A: Any, size: int) -> tuple[Any, float]:
    """A sparse symmetric matrix and the asymmetry taken out, relative to the entries in the same rows."""
    from scipy.sparse import csc_array

    given = csc_array(A)
    if given.dtype.kind == "c":
        raise InputError(f"{name}: found complex numbers, expected real ones")
    sparse = csc_array(given, dtype=float)
    if sparse.shape != (size, size):
        raise InputError(f"{name}: found shape {sparse.shape}, expected ({size}, {size}), a row for each dof")
    if not np.isfinite(sparse.data).all():
        raise InputError(f"{name}: found entries that are NaN or infinite, expected finite numbers")
    if not sparse.count_nonzero():
        if name == "C":
            return sparse, 0.0
        raise InputError(f"{name}: found zeros alone, expected a mass and a stiffness")
    skew = asymmetry(sparse)
    if skew > SKEW:
        raise InputError(f"{name}: found asymmetry of {skew:.2e} of its entries, expected a symmetric matrix")
    return csc_array(0.5 * (sparse + sparse.T)), skew


def asymmetry(A: Any) -> float:
    """The largest |A_ij - A_ji| over the mean sqrt(a_i a_j) of the largest entries a of both rows.

    Not over the largest entry of all: beside the penalty of a support, 1e20, a missing half is as nothing. Rows that
    hold round-off alone, as the stiffness of a free Craig-Bampton set, count with the median of the rows.

    >>> asymmetry(np.array([[1e20, 0.0, 0.0], [0.0, 2.0, -1.0], [0.0, 0.0, 2.0]]))
    0.5
    """
    from scipy.sparse import coo_array

    entries, odd = coo_array(A), coo_array(A - A.T)
    largest = np.zeros(A.shape[0])
    for places in entries.coords:
        np.maximum.at(largest, places, np.abs(entries.data))
    largest = np.maximum(largest, np.median(largest[largest > 0.0]))
    rows, columns = odd.coords
    return float((np.abs(odd.data) / np.sqrt(largest[rows] * largest[columns])).max(initial=0.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class MatrixReport:
    """What to know of matrices before anything is done with them.

    `mass` [kg] along x, y, z (equal for a whole body without scalar dofs left out); `centre` [m] and `inertia` [kg m^2]
    about it, None without points; `rigid` modes at zero frequency; `skew` of M and K relative to the entries in the
    same rows; `massless` dofs; `freq_hz` the lowest elastic frequencies; `kept` modes of `size` unknowns; `residual`
    the share of S in the static compliance at the contact; `coupling` the largest damping between two modes over their
    own; `undamped` rigid modes that C damps and the body does not.
    """

    size: int
    mass: tuple[float, float, float]
    centre: tuple[float, ...] | None
    inertia: tuple[tuple[float, ...], ...] | None
    rigid: int
    massless: int
    skew: tuple[float, float]
    freq_hz: tuple[float, ...]
    kept: int
    residual: float
    coupling: float | None
    undamped: int | None

    def __str__(self) -> str:
        """The lines of the printout."""
        lines = [
            f"{self.size} unknowns, {self.massless} of them without mass, {self.rigid} rigid modes",
            f"mass [kg]: {' '.join(f'{m:.6g}' for m in self.mass)} along x, y, z",
        ]
        if self.centre is not None and self.inertia is not None:
            lines.append(f"centre [m]: {' '.join(f'{x:.6g}' for x in self.centre)}")
            rows = "; ".join(" ".join(f"{x:.6g}" for x in row) for row in self.inertia)
            lines.append(f"inertia about it [kg m^2]: {rows}")
        else:
            lines.append("inertia: not known without the positions of the nodes")
        lines.append(f"asymmetry of M and K: {self.skew[0]:.1e}, {self.skew[1]:.1e} of the entries in the same rows")
        lines.append(f"lowest elastic frequencies [Hz]: {' '.join(f'{f:.6g}' for f in self.freq_hz)}")
        if self.coupling is not None:
            lines.append(f"damping between modes: up to {self.coupling:.2g} of their own, left out")
        if self.undamped:
            lines.append(f"damping of rigid modes: left out in {self.undamped} of {self.rigid}, which move on undamped")
        return "\n".join([*lines, self.words])

    @property
    def words(self) -> str:
        """Whether the basis has residual compliance, and what that means."""
        if self.residual > 0.0:
            return (
                f"residual compliance: present, {100 * self.residual:.3g} % of the static compliance at the contact; "
                f"without it the {self.kept} modes would be so much too stiff there"
            )
        return (
            "residual compliance: none, all modes are kept; statics are exact, but the contact then carries mass and "
            "the step must resolve the highest mode: keep fewer modes, and S takes the rest"
        )


def report_of(
    matrices: Matrices, lam: Array, rigid: int, kept: int, residual: float, coupling: float | None, undamped: int | None
) -> MatrixReport:
    """The facts of matrices and of the modes kept."""
    motions = matrices.rigid_motions()
    inertia = motions.T @ (matrices.M @ motions)
    mass = np.diag(inertia)[:3]
    known = all(node in matrices.points for node, axis in matrices.dofs if axis != "q") and mass.min() > 0.0
    centre = about = None
    if known:
        # the mean of the diagonal's three masses: the part of the first moment that is skew gives the centre
        m = float(mass.mean())
        first = inertia[:3, 3:]
        x = np.array([first[1, 2] - first[2, 1], first[2, 0] - first[0, 2], first[0, 1] - first[1, 0]]) / (2.0 * m)
        steiner = m * (x @ x * np.eye(3) - np.outer(x, x))
        centre = tuple(x.tolist())
        about = tuple(map(tuple, (inertia[3:, 3:] - steiner).tolist()))
    a, b, c = mass.tolist()
    return MatrixReport(
        size=matrices.size,
        mass=(a, b, c),
        centre=centre,
        inertia=about,
        rigid=rigid,
        massless=int(np.count_nonzero(matrices.M.diagonal() == 0.0)),
        skew=matrices.skew,
        freq_hz=tuple((np.sqrt(lam[rigid : rigid + 6]) / (2.0 * np.pi)).tolist()),
        kept=kept,
        residual=residual,
        coupling=coupling,
        undamped=undamped,
    )
