"""Someone's matrices M, K, C, G, K4, checked and in SI: what their rows mean, unit forces on a contact, their facts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.units import units_of

DIRECTIONS = ("q", "x", "y", "z", "rx", "ry", "rz")  # q: a scalar, such as the amplitude of a mode
NUMBERED: dict[str | int, str] = dict(enumerate(DIRECTIONS))
EYE = np.eye(3)
OPTIONAL = ("C", "K4", "G")
SQUARE = 1e-3  # of axes: three digits
ROUND_OFF = 1e-12  # of a direction's components
UNEQUAL = 1e-2  # of masses along x, y, z: one centre and inertia need one mass
MINOR = 1e-6  # of minors and diagonals: matrices of single precision have seven digits
DOUBLE, SINGLE = 2.0**-53, 2.0**-24  # largest relative error of a rounded number
DIGITS = range(7, 11)  # significant decimal digits of a text file by which its numbers may be rounded
WHOLE = 1e-4  # of the last digit: what a decimal number in double precision is off a whole number
SKEW = 1e-4  # asymmetry of a matrix, of the entries in its rows, beyond which it is refused

Dof: TypeAlias = tuple[int, str | int]
Contact: TypeAlias = Sequence[int] | Sequence[Dof] | Mapping[str, Any]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Matrices:
    """Matrices in SI, and what their rows mean.

    `M`, `K` (n, n) sparse; `C` and `K4` (structural damping, the imaginary part of K) likewise or None. `G` is the
    gyroscopic matrix, skew: Omega G beside C at a speed Omega [rad/s]. `cross` is the skew part of a nonsymmetric
    stiffness, whose symmetric part is `K`; both None where there is none. `skew`: asymmetry of M and K. `dofs`
    (n,) pairs (node, direction), direction one of `DIRECTIONS`. `points` node -> position [m]; `axes` node ->
    directions of its own x, y, z in the axes of the points, rows (3, 3), for nodes whose dofs are along those.
    `rounding`: largest relative error of an entry of K by the precision in which it was stored.

    >>> found = Matrices.of(K=np.diag([4.0, 9.0]), M=np.eye(2), dofs=[(1, "x"), (1, "y")])
    >>> found.size, found.skew
    (2, (0.0, 0.0))
    """

    M: Any
    K: Any
    C: Any
    dofs: tuple[tuple[int, str], ...]
    points: Mapping[int, Array]
    skew: tuple[float, float]
    K4: Any = None
    G: Any = None
    cross: Any = None
    axes: Mapping[int, Array] = field(default_factory=dict)
    rounding: float = DOUBLE

    @staticmethod
    def of(
        M: Any,
        K: Any,
        C: Any = None,
        *,
        dofs: Sequence[Dof],
        points: Mapping[int, Sequence[float]] | None = None,
        units: str = "m-kg-s",
        K4: Any = None,
        G: Any = None,
        nonsymmetric: bool = False,
        axes: Mapping[int, Any] | None = None,
    ) -> Matrices:
        """Check matrices in any consistent units; raises InputError naming what does not fit.

        K and C must be symmetric unless they are given as `nonsymmetric`, such as with cross-coupled bearings.
        """
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
        matrices: dict[str, Any] = {}
        skews: dict[str, float] = {}
        given = [
            ("M", M, system.mass), ("K", K, system.stiffness), ("C", C, system.damping), ("K4", K4, system.stiffness),
            ("G", G, system.mass),
        ]  # fmt: skip
        for name, A, unit in given:
            if A is None and name in OPTIONAL:
                matrices[name] = None
                continue
            if name == "G":
                found = skew_part(A, len(named))
            elif nonsymmetric and name in ("K", "C"):
                found = checked(name, A, len(named))
                skews[name] = asymmetry(found)
            else:
                found, skews[name] = symmetric_part(name, A, len(named))
            matrices[name] = csc_array(unit * (scale @ found @ scale))
        places = {int(node): system.length * np.asarray(x, dtype=float) for node, x in (points or {}).items()}
        for node, x in places.items():
            if x.shape != (3,) or not np.isfinite(x).all():
                raise InputError(f"points: found {points[node] if points else x!r} for node {node}, expected x, y, z")
        rounding = rounding_of(csc_array(K).data)
        M, K = matrices["M"], matrices["K"]
        cross = csc_array(0.5 * (K - K.T)) if skews["K"] > SKEW else None
        K = csc_array(0.5 * (K + K.T))
        check_minors(M, named)
        empty = np.flatnonzero((abs(M) + abs(K)).sum(axis=0) == 0.0)
        if empty.size:
            node, direction = named[int(empty[0])]
            found = f"found neither mass nor stiffness at {node}.{direction}, the first of {empty.size} such dofs"
            raise InputError(f"M, K: {found}, expected one or both; leave out their rows and columns")
        turned = {int(node): checked_axes(int(node), own) for node, own in (axes or {}).items()}
        return Matrices(
            M=M, K=K, C=matrices["C"], K4=matrices["K4"], G=matrices["G"], cross=cross, dofs=named, points=places,
            axes=turned, skew=(skews["M"], skews["K"]), rounding=rounding,
        )  # fmt: skip

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.dofs)

    def along(self) -> Array:
        """Direction of each row in the axes of the points, (n, 3); zero for a scalar."""
        directions = np.zeros((self.size, 3))
        for row, (node, direction) in enumerate(self.dofs):
            if direction != "q":
                directions[row] = self.axes.get(node, EYE)["xyz".index(direction[-1])]
        return directions

    def rigid_motions(self, about: Array | None = None) -> Array:
        """Translations along x, y, z and rotations about a point (the origin), (n, 6); these where points are known."""
        motions = np.zeros((self.size, 6))
        at = np.zeros(3) if about is None else about
        for row, ((node, direction), along) in enumerate(zip(self.dofs, self.along(), strict=True)):
            if len(direction) == 2:
                motions[row, 3:] = along
                continue
            motions[row, :3] = along
            if node in self.points:
                motions[row, 3:] = np.cross(self.points[node] - at, along)
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
            own = [(int(item), axis) for axis in "xyz" if self.unit_force(int(item), axis) is not None]
            if not own:
                raise InputError(f"contact: found node {item}, which no dof belongs to")
            wanted += own
        forces = [self.unit_force(node, direction) for node, direction in wanted]
        missing = [f"{node}.{axis}" for (node, axis), force in zip(wanted, forces, strict=True) if force is None]
        if missing or not wanted or len(set(wanted)) < len(wanted):
            found = f"{missing[0]}, which is no dof" if missing else f"{wanted}"
            raise InputError(f"contact: found {found}, expected nodes or dofs of the matrices, each once")
        P = np.zeros((self.size, len(wanted)))
        for column, force in enumerate(forces):
            for row, share in (force or {}).items():
                P[row, column] = share
        return tuple(f"{node}.{direction}" for node, direction in wanted), P

    def unit_force(self, node: int, direction: str) -> dict[int, float] | None:
        """Row -> share of a unit force along x, y or z of the points' axes; None where the node's dofs lack a part."""
        kind = direction[:-1]
        own = {"q": 1.0}
        if direction != "q":
            shares = self.axes.get(node, EYE)[:, "xyz".index(direction[-1])]
            own = {kind + axis: float(v) for axis, v in zip("xyz", shares, strict=True) if abs(v) > ROUND_OFF}
        rows = {dof: row for row, dof in enumerate(self.dofs) if dof[0] == node}
        if not all((node, axis) in rows for axis in own):
            return None
        return {rows[node, axis]: share for axis, share in own.items()}


def checked_axes(node: int, own: Any) -> Array:
    """Axes of a node, at right angles."""
    axes = np.asarray(own, dtype=float)
    if axes.shape != (3, 3) or not np.abs(axes @ axes.T - EYE).max() <= SQUARE or np.linalg.det(axes) < 0.0:
        raise InputError(f"axes: found {axes.tolist()} at node {node}, expected three unit vectors at right angles")
    return axes


def check_minors(M: Any, dofs: Sequence[tuple[int, str]]) -> None:
    """Refuse what no mass matrix has: M_ii < 0, or |M_ij| above the root of M_ii M_jj, by a millionth of the mean."""
    from scipy.sparse import coo_array

    diagonal = M.diagonal()
    if not diagonal.any():
        return
    floor = MINOR * float(np.abs(diagonal).mean())
    expected = "expected a mass matrix without negative eigenvalues"
    worst = int(diagonal.argmin())
    if diagonal[worst] < -floor:
        node, direction = dofs[worst]
        raise InputError(f"M: found {diagonal[worst]:.3g} on the diagonal at {node}.{direction}, {expected}")
    entries = coo_array(M)
    rows, columns = entries.coords
    root = np.sqrt(np.maximum(diagonal, 0.0))
    beyond = np.abs(entries.data) - (1.0 + MINOR) * root[rows] * root[columns] - floor
    if beyond.size and beyond.max() > 0.0:
        k = int(beyond.argmax())
        (one, axis), (other, other_axis) = dofs[int(rows[k])], dofs[int(columns[k])]
        found = f"found {entries.data[k]:.3g} between {one}.{axis} and {other}.{other_axis}"
        raise InputError(f"M: {found}, more than their diagonals allow, {expected}")


def checked_dof(dof: Dof) -> tuple[int, str]:
    """A dof as (node, direction), directions by name or as 1 to 6, 0 for a scalar."""
    node, direction = dof
    name = NUMBERED.get(direction, str(direction))
    if name not in DIRECTIONS:
        raise InputError(f"dofs: found direction {direction!r} at node {node}, expected {', '.join(DIRECTIONS)}")
    return int(node), name


def checked(name: str, A: Any, size: int) -> Any:
    """A sparse matrix of finite numbers with a row for each dof; only an optional one may be zero."""
    from scipy.sparse import csc_array

    given = csc_array(A)
    if given.dtype.kind == "c":
        raise InputError(f"{name}: found complex numbers, expected real ones")
    sparse = csc_array(given, dtype=float)
    if sparse.shape != (size, size):
        raise InputError(f"{name}: found shape {sparse.shape}, expected ({size}, {size}), a row for each dof")
    if not np.isfinite(sparse.data).all():
        raise InputError(f"{name}: found entries that are NaN or infinite, expected finite numbers")
    if not sparse.count_nonzero() and name not in OPTIONAL:
        raise InputError(f"{name}: found zeros alone, expected a mass and a stiffness")
    return sparse


def rounding_of(values: Any) -> float:
    """Largest relative error of numbers by the precision in which they were stored, which the numbers themselves show.

    2^-24 where single precision has them all, 0.5 10^(1 - d) where d significant digits do, 2^-53 otherwise.

    >>> third = np.array([1.0, 2.0]) / 3.0
    >>> rounding_of(third) == 2.0**-53, rounding_of(third.astype(np.float32)) == 2.0**-24
    (True, True)
    >>> f"{rounding_of(np.array([3.3333333e9, -6.6666667e-3])):.0e}"
    '5e-08'
    """
    given = np.asarray(values)
    numbers = np.abs(given[given != 0.0].astype(float))
    with np.errstate(over="ignore", under="ignore"):
        if given.dtype == np.float32 or np.array_equal(numbers.astype(np.float32).astype(float), numbers):
            return SINGLE
    mantissas = numbers / 10.0 ** np.floor(np.log10(numbers))
    for digits in DIGITS:
        scaled = mantissas * 10.0 ** (digits - 1)
        if np.abs(scaled - np.rint(scaled)).max(initial=0.0) <= WHOLE:
            return float(0.5 * 10.0 ** (1 - digits))
    return DOUBLE


def symmetric_part(name: str, A: Any, size: int) -> tuple[Any, float]:
    """A sparse symmetric matrix and the asymmetry taken out, relative to the entries in the same rows."""
    from scipy.sparse import csc_array

    sparse = checked(name, A, size)
    skew = asymmetry(sparse)
    if skew > SKEW:
        more = "; if cross-coupling is meant, give the matrices as nonsymmetric" if name in ("K", "C") else ""
        raise InputError(f"{name}: found asymmetry of {skew:.2e} of its entries, expected a symmetric matrix{more}")
    return csc_array(0.5 * (sparse + sparse.T)), skew


def skew_part(G: Any, size: int) -> Any:
    """A sparse gyroscopic matrix without the symmetric part that is round-off."""
    from scipy.sparse import coo_array, csc_array

    sparse = checked("G", G, size)
    even = coo_array(sparse + sparse.T)
    largest = float(np.abs(even.data).max(initial=0.0))
    if largest > SKEW * float(np.abs(sparse.data).max(initial=0.0)):
        k = int(np.abs(even.data).argmax())
        row, column = int(even.coords[0][k]), int(even.coords[1][k])
        found = f"{sparse[row, column]:.6g} at ({row}, {column}) and {sparse[column, row]:.6g} at ({column}, {row})"
        raise InputError(f"G: found {found}, expected a skew matrix, G[i, j] = -G[j, i], per rad/s of the speed")
    return csc_array(0.5 * (sparse - sparse.T))


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
    if not largest.any():
        return 0.0
    largest = np.maximum(largest, np.median(largest[largest > 0.0]))
    rows, columns = odd.coords
    return float((np.abs(odd.data) / np.sqrt(largest[rows] * largest[columns])).max(initial=0.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class MatrixReport:
    """What to know of matrices before anything is done with them.

    `mass` [kg] along x, y, z (equal for a whole body without scalar dofs left out); `centre` [m] and `inertia` [kg m^2]
    about it, None without points; `rigid` modes at zero frequency; `skew` of M and K relative to the entries in the
    same rows; `massless` dofs; `freq_hz` the lowest elastic frequencies; `kept` modes of `size` unknowns; `residual`
    the share of S in the static compliance at the contact; `coupling` the largest damping between two modes by C over
    their own; `structural` the least and largest loss factor g of a mode by structural damping, `structural_coupling`
    the largest between two modes over their own; None without. `gyroscopic` and `cross`: whether there is a gyroscopic
    matrix, a nonsymmetric stiffness; `rigid_motion` what the test of rigid motions found.

    >>> import contact as ct
    >>> K = 1e6 * np.array([[2.0, -1.0], [-1.0, 1.0]])
    >>> chain = ct.bodies.Matrices.of(K=K, M=np.eye(2), dofs=[(1, "x"), (2, "x")])
    >>> _, report = ct.bodies.body_of(chain, [(2, "x")])
    >>> report.size, report.rigid, [round(one, 2) for one in report.freq_hz]
    (2, 0, [98.36, 257.52])
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
    structural: tuple[float, float] | None = None
    structural_coupling: float = 0.0
    gyroscopic: bool = False
    cross: bool = False
    rigid_motion: str = ""

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
            lines.append("inertia: not known without the positions of the nodes, or with masses that differ")
        lines.append(f"asymmetry of M and K: {self.skew[0]:.1e}, {self.skew[1]:.1e} of the entries in the same rows")
        lines.append(f"lowest elastic frequencies [Hz]: {' '.join(f'{f:.6g}' for f in self.freq_hz)}")
        if self.coupling is not None:
            lines.append(f"damping between modes: up to {self.coupling:.2g} of their own, kept in the basis")
        if self.gyroscopic:
            lines.append("gyroscopic matrix: kept between the modes, by the speed")
        if self.cross:
            lines.append(
                "nonsymmetric stiffness: its skew part is kept between the modes, not in the residual compliance"
            )
        if self.structural is not None:
            least, most = self.structural
            lines.append(
                f"structural damping: g from {least:.4g} to {most:.4g}, taken as zeta = g/2 of each mode: "
                "the same at resonance alone"
            )
            if self.structural_coupling > 0.0:
                share = f"up to {self.structural_coupling:.2g} of their own"
                lines.append(f"structural damping between modes: {share}, left out")
        if self.rigid_motion:
            lines.append(self.rigid_motion)
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
    matrices: Matrices, lam: Array, rigid: int, kept: int, residual: float, coupling: float | None
) -> MatrixReport:
    """The facts of matrices and of the modes kept."""
    motions = matrices.rigid_motions()
    inertia = motions.T @ (matrices.M @ motions)
    mass = np.diag(inertia)[:3]
    known = all(node in matrices.points for node, axis in matrices.dofs if axis != "q") and mass.min() > 0.0
    known = known and np.ptp(mass) <= UNEQUAL * mass.max()  # supports may leave out single directions
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
        gyroscopic=matrices.G is not None,
        cross=matrices.cross is not None,
    )
