"""Someone's matrices M, K, C as a body: checked, in SI, and reduced to modes with residual compliance.

    K phi = omega^2 M phi,   S = P^T G P - (P^T Phi) diag(1/omega^2) (P^T Phi)^T

P are the unit forces on the contact channels, G the static compliance K^-1. A free body has the compliance of its
elastic modes alone, by inertia relief: G P = u with K u = P - M R R^T P and R^T M u = 0, R its rigid modes. Massless
dofs are kept by S exactly. Modes come from M x = theta (K + s M) x, theta = 1/(omega^2 + s), in which the lowest ones
are the sharpest, rigid modes and massless dofs do no harm.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.units import units_of

DIRECTIONS = ("q", "x", "y", "z", "rx", "ry", "rz")  # q: a scalar, such as the amplitude of a mode
MODES = 20  # kept where nothing is said
DENSE = 1500  # unknowns up to which all modes are computed at once
SKEW = 1e-4  # asymmetry of a matrix, of its largest entry, beyond which it is refused
RIGID = 1e-6  # omega^2 over that of the seventh mode below which a mode is rigid
NOTHING = 1e-9  # of the static compliance: below it the residual is round-off

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


@dataclass(frozen=True, slots=True, kw_only=True)
class MatrixReport:
    """What to know of matrices before anything is done with them.

    `mass` [kg] along x, y, z (equal for a whole body without scalar dofs left out); `centre` [m] and `inertia` [kg m^2]
    about it, None without points; `rigid` modes at zero frequency; `skew` of M and K relative to their largest entry;
    `massless` dofs; `freq_hz` the lowest elastic frequencies; `kept` modes of `size` unknowns; `residual` the share of
    S in the static compliance at the contact; `coupling` the largest damping between two modes over their own.
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
        lines.append(f"asymmetry of M and K: {self.skew[0]:.1e}, {self.skew[1]:.1e} of the largest entry")
        lines.append(f"lowest elastic frequencies [Hz]: {' '.join(f'{f:.6g}' for f in self.freq_hz)}")
        if self.coupling is not None:
            lines.append(f"damping between modes: up to {self.coupling:.2g} of their own, left out")
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


def checked_dof(dof: Dof) -> tuple[int, str]:
    """A dof as (node, direction), directions by name or as 1 to 6, 0 for a scalar."""
    node, direction = dof
    name = DIRECTIONS[direction] if isinstance(direction, int | np.integer) and 0 <= direction < 7 else str(direction)
    if name not in DIRECTIONS:
        raise InputError(f"dofs: found direction {direction!r} at node {node}, expected {', '.join(DIRECTIONS)}")
    return int(node), name


def symmetric_part(name: str, A: Any, size: int) -> tuple[Any, float]:
    """A sparse symmetric matrix and the asymmetry taken out, relative to the largest entry."""
    from scipy.sparse import csc_array

    sparse = csc_array(A, dtype=float)
    if sparse.shape != (size, size):
        raise InputError(f"{name}: found shape {sparse.shape}, expected ({size}, {size}), a row for each dof")
    if not np.isfinite(sparse.data).all():
        raise InputError(f"{name}: found entries that are NaN or infinite, expected finite numbers")
    largest = float(np.abs(sparse.data).max(initial=0.0))
    if largest == 0.0:
        if name == "C":
            return sparse, 0.0
        raise InputError(f"{name}: found zeros alone, expected a mass and a stiffness")
    skew = float(np.abs((sparse - sparse.T).data).max(initial=0.0)) / largest
    if skew > SKEW:
        raise InputError(f"{name}: found asymmetry of {skew:.2e} of its largest entry, expected a symmetric matrix")
    return csc_array(0.5 * (sparse + sparse.T)), skew


def reduced(
    matrices: Matrices, contact: Contact, *, modes: int | None = None, zeta: float = 0.0
) -> tuple[dict[str, Any], MatrixReport]:
    """Fields of the modal body that matrices are at their contact, and what they are; 20 modes, or all if fewer.

    Raises InputError for indefinite matrices, dofs that are not there, or more modes than there are.
    """
    modes = min(MODES, matrices.size) if modes is None else modes
    if not 1 <= modes <= matrices.size:
        raise InputError(f"modes: found {modes}, expected 1 to the {matrices.size} unknowns")
    channels, P = matrices.loads(contact)
    lam, phi, rigid = lowest_modes(matrices, modes)
    omega = np.sqrt(lam)
    R = phi[:, :rigid]
    G = elastic_compliance(matrices, P, R)
    rows = P.T @ phi
    elastic = rows[:, rigid:] / omega[rigid:]
    total, S = P.T @ G, P.T @ G - elastic @ elastic.T
    S = 0.5 * (S + S.T)
    if np.abs(S).max() <= NOTHING * np.abs(total).max():
        S = np.zeros_like(S)
    damping, coupling = modal_damping(matrices, phi, omega, zeta)
    facts = report_of(matrices, lam, rigid, len(lam), float(np.trace(S) / np.trace(total)), coupling)
    body = dict(
        omega=omega,
        zeta=damping,
        channels=channels,
        rows=rows,
        S=S,
        participation=matrices.rigid_motions()[:, :3].T @ (matrices.M @ phi),
        provenance=json.dumps({"method": "matrices", "modes": len(lam), "matrices": as_json(facts)}, sort_keys=True),
    )
    return body, facts


def lowest_modes(matrices: Matrices, count: int) -> tuple[Array, Array, int]:
    """omega^2 ascending (at most `count`, those of massless dofs left out), mass-normalised modes, rigid ones first."""
    from scipy.linalg import eigh
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import LinearOperator, eigsh, splu

    M, K, n = matrices.M, matrices.K, matrices.size
    heavy = M.diagonal() > 0.0
    if not heavy.any():
        raise InputError("M: found no mass on its diagonal")
    shift = 1e-6 * float(np.median(K.diagonal()[heavy] / M.diagonal()[heavy]))
    if n <= DENSE:
        try:
            theta, X = eigh(M.toarray(), (K + shift * M).toarray())
        except np.linalg.LinAlgError:
            raise InputError(
                "K: found an indefinite or singular stiffness, expected one without negative modes"
            ) from None
        if theta[0] < -1e-9 * theta[-1]:
            raise InputError("M: found negative modal masses, expected a mass matrix without negative eigenvalues")
        theta, X = theta[::-1], X[:, ::-1]
        alive = theta > 1e-15 * theta[0]
        theta, X = theta[alive], X[:, alive]
    else:
        factor = splu(csc_array(K + shift * M))
        inverse = LinearOperator((n, n), matvec=factor.solve)
        start = factor.solve(M @ np.random.default_rng(7).standard_normal(n))
        wanted = min(max(count, 7) + 6, n - 1)
        values, X = eigsh(K, wanted, M=M, sigma=-shift, OPinv=inverse, which="LM", v0=start)
        order = np.argsort(values)
        theta, X = 1.0 / (values[order] + shift), X[:, order]
        if (theta < 0.0).any():
            raise InputError("K: found an indefinite stiffness, expected one without negative modes")
    X = X / np.sqrt(np.einsum("ij,ij->j", X, M @ X))
    lam = 1.0 / theta - shift
    level = float(lam[min(6, len(lam) - 1)])
    if lam[0] < -RIGID * level:
        raise InputError(f"K: found omega^2 = {lam[0]:.3g} rad^2/s^2, expected a stiffness without negative modes")
    rigid = int(np.count_nonzero(lam < RIGID * level))
    lam[:rigid] = 0.0
    kept = min(count, len(lam))
    if kept < rigid:
        raise InputError(f"modes: found {count}, expected at least the {rigid} rigid modes of these matrices")
    return lam[:kept], np.ascontiguousarray(X[:, :kept]), rigid


def elastic_compliance(matrices: Matrices, P: Array, R: Array) -> Array:
    """Static displacements under unit forces on the channels, (n, channels), of a free body by inertia relief."""
    from scipy.sparse import block_array, csc_array
    from scipy.sparse.linalg import splu

    if not R.shape[1]:
        return np.asarray(splu(csc_array(matrices.K)).solve(P))
    momenta = matrices.M @ R
    scale = float(np.abs(matrices.K.diagonal()).mean() / np.abs(momenta).max())
    border = csc_array(scale * momenta)
    bordered = csc_array(block_array([[matrices.K, border], [border.T, None]]))
    balanced = P - momenta @ (R.T @ P)
    solved = splu(bordered).solve(np.vstack([balanced, np.zeros((R.shape[1], P.shape[1]))]))
    return np.asarray(solved[: matrices.size])


def modal_damping(matrices: Matrices, phi: Array, omega: Array, zeta: float) -> tuple[Array, float | None]:
    """Damping ratios, and the largest coupling between modes that they leave out (None without C)."""
    if matrices.C is None:
        return np.full(len(omega), zeta), None
    c = phi.T @ (matrices.C @ phi)
    own = np.abs(np.diag(c))
    ratio = np.divide(own, 2.0 * omega, out=np.full(len(omega), zeta), where=omega > 0.0)
    if ratio.max(initial=0.0) >= 1.0:
        k = int(ratio.argmax())
        raise InputError(f"C: found a damping ratio of {ratio[k]:.3g} in mode {k + 1}, expected less than 1")
    size = np.sqrt(np.outer(own, own))
    off = np.abs(c - np.diag(np.diag(c)))
    return ratio, float(np.divide(off, size, out=np.zeros_like(off), where=size > 0.0).max(initial=0.0))


def report_of(
    matrices: Matrices, lam: Array, rigid: int, kept: int, residual: float, coupling: float | None
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
    )


def as_json(facts: MatrixReport) -> dict[str, Any]:
    """The report as plain values."""
    from dataclasses import asdict

    return asdict(facts)
