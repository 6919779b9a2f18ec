"""A beam shaft with rigid disks on bearings: its matrices in a fixed frame, and its modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.base.keyed import require_keyed
from contact.io.keys import Key
from contact.model.bodies.modal_body import ModalBody

SAME = 1e-9  # of the shaft's length: places that are one
LARGEST = 400  # nodes
SHIFT = 1e-6  # of the median K_ii / M_ii
MASSLESS = 1e-13  # of the largest square of a period: one of round-off, of a mode without mass
RIGID = 1e-6  # of the shift: a square of a frequency that is round-off


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """A piece of a shaft of one circular section, `elements` Timoshenko beam elements.

    The shear coefficient is that of Hutchinson (J. Appl. Mech. 68, 2001, 87).

    Raises InputError for sizes that are not positive, an inner diameter as large as the outer one, no element.

    >>> round(Piece(length=0.4, diameter=0.03).mass, 3)
    2.205
    """

    length: Annotated[float, Key("length along the axis [m]", "length", "size")]
    diameter: Annotated[float, Key("outer diameter [m]", "length", "size")]
    inner_diameter: Annotated[float, Key("diameter of the bore [m]", "not negative")] = 0.0
    E: Annotated[float, Key("Young's modulus [Pa]", "positive", "E")] = 210e9
    rho: Annotated[float, Key("density [kg/m^3]", "positive", "rho")] = 7800.0
    nu: Annotated[float, Key("Poisson's ratio [-]", "poisson", "nu")] = 0.3
    loss_time: Annotated[
        float, Key("ratio of the material's internal viscous damping to its stiffness [s]", "not negative")
    ] = 0.0
    elements: Annotated[int, Key("number of beam elements", most=100)] = 4

    def __post_init__(self) -> None:
        require_keyed(self)
        if not -1.0 < self.nu < 0.5:
            raise InputError(f"nu: found {self.nu!r}, expected between -1 and 0.5")
        if self.inner_diameter >= self.diameter:
            found = f"{self.inner_diameter:g} m with an outer diameter of {self.diameter:g} m"
            raise InputError(f"inner_diameter: found {found}, expected a smaller bore")

    @property
    def area(self) -> float:
        """Of the section [m^2]."""
        return 0.25 * np.pi * (self.diameter**2 - self.inner_diameter**2)

    @property
    def inertia(self) -> float:
        """Second moment of the section about a diameter [m^4]."""
        return np.pi / 64.0 * (self.diameter**4 - self.inner_diameter**4)

    @property
    def mass(self) -> float:
        """Of the piece [kg]."""
        return self.rho * self.area * self.length

    @property
    def shear(self) -> float:
        """Shear coefficient [-]."""
        a, b, nu = self.diameter**2, self.inner_diameter**2, self.nu
        below = 7.0 * a * a + 34.0 * a * b + 7.0 * b * b + nu * (12.0 * a * a + 48.0 * a * b + 12.0 * b * b)
        below += nu * nu * (4.0 * a * a + 16.0 * a * b + 4.0 * b * b)
        return 6.0 * (a + b) ** 2 * (1.0 + nu) ** 2 / below


@dataclass(frozen=True, slots=True, kw_only=True)
class Disk:
    """A rigid disk at a position on the shaft, with its moments of inertia about the axis and about a diameter.

    >>> Disk(at=0.2, mass=8.0, polar=0.06, diametral=0.03).polar
    0.06
    """

    at: Annotated[float, Key("position along the axis, from the first end of the shaft [m]", "not negative")]
    mass: Annotated[float, Key("mass of the disk [kg]", "positive", "mass")]
    polar: Annotated[float, Key("moment of inertia about the axis [kg m^2]", "not negative")] = 0.0
    diametral: Annotated[float, Key("moment of inertia about a diameter [kg m^2]", "not negative")] = 0.0

    def __post_init__(self) -> None:
        require_keyed(self)
        if self.polar > 2.0 * self.diametral * (1.0 + 1e-9):
            found = f"{self.polar:g} with a diametral moment of {self.diametral:g} kg m^2"
            raise InputError(f"polar: found {found}, expected at most twice the diametral moment")


@dataclass(frozen=True, slots=True, kw_only=True)
class Bearing:
    """A bearing between a position on the shaft and the ground: f = -K u - C u' for displacements u = (x, y).

    `kyy` and `cyy` default to the values of x. `k_tilt` resists the tilt of the shaft.

    Raises InputError for a negative stiffness or damping along x, y or tilt.

    >>> Bearing(at=0.0, kxx=1e7, kxy=2e6, kyx=-2e6).matrices[0].tolist()
    [[10000000.0, 2000000.0], [-2000000.0, 10000000.0]]
    """

    at: Annotated[float, Key("position along the axis, from the first end of the shaft [m]", "not negative")]
    kxx: Annotated[
        float, Key("stiffness, force along -x per displacement along x [N/m]", "not negative", "stiffness or 0")
    ]
    kyy: Annotated[
        float | None, Key("stiffness, force along -y per displacement along y; kxx if left out [N/m]", "not negative")
    ] = None
    kxy: Annotated[float, Key("stiffness, force along -x per displacement along y [N/m]")] = 0.0
    kyx: Annotated[float, Key("stiffness, force along -y per displacement along x [N/m]")] = 0.0
    cxx: Annotated[float, Key("damping, force along -x per velocity along x [N s/m]", "not negative")] = 0.0
    cyy: Annotated[
        float | None, Key("damping, force along -y per velocity along y; cxx if left out [N s/m]", "not negative")
    ] = None
    cxy: Annotated[float, Key("damping, force along -x per velocity along y [N s/m]")] = 0.0
    cyx: Annotated[float, Key("damping, force along -y per velocity along x [N s/m]")] = 0.0
    k_tilt: Annotated[float, Key("tilting stiffness in both planes [N m/rad]", "not negative")] = 0.0

    def __post_init__(self) -> None:
        require_keyed(self)

    @property
    def matrices(self) -> tuple[Array, Array]:
        """Stiffness [N/m] and damping [N s/m], (2, 2) each."""
        kyy, cyy = (self.kxx if self.kyy is None else self.kyy), (self.cxx if self.cyy is None else self.cyy)
        return np.array([[self.kxx, self.kxy], [self.kyx, kyy]]), np.array([[self.cxx, self.cxy], [self.cyx, cyy]])


class RotorMatrices(NamedTuple):
    """M q'' + (C + Omega G) q' + (K + Omega H) q = f: (n, n) each, and the (node, direction) of each row."""

    M: Array
    C: Array
    K: Array
    G: Array
    H: Array
    dofs: tuple[tuple[int, str], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Shaft:
    """Pieces of a shaft one after the other from z = 0, with disks and bearings; nodes are numbered from 1 along z.

    The frame does not rotate. In the planes x-z and y-z the beam has the matrices of Timoshenko's theory, with the
    rotary inertia M_r of its sections. A rotation about z at Omega couples the planes by 2 Omega M_r, a disk by its
    polar moment (H. D. Nelson, J. Mech. Des. 102, 1980, 793). Internal damping D = loss_time K_shaft acts on the
    motion seen from the shaft: D (u' - Omega J u), with the rotation J by a right angle from x to y.

    Raises InputError for a shaft without pieces or bearings, and for positions beyond its end.

    >>> shaft = Shaft(pieces=(Piece(length=0.6, diameter=0.03),), disks=(Disk(at=0.3, mass=8.0),),
    ...               bearings=(Bearing(at=0.0, kxx=1e8), Bearing(at=0.6, kxx=1e8)))
    >>> shaft.node(0.3), shaft.matrices().M.shape
    (3, (20, 20))
    """

    pieces: Sequence[Piece]
    disks: Sequence[Disk] = ()
    bearings: Sequence[Bearing] = ()
    places: Sequence[float] = ()

    def __post_init__(self) -> None:
        if not self.pieces:
            raise InputError("pieces: found no piece of a shaft, expected one or more")
        if not self.bearings:
            raise InputError("bearings: found no bearing, expected one or more")
        for name in ("pieces", "disks", "bearings", "places"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        for name, at in (
            *((f"disks[{k}].at", disk.at) for k, disk in enumerate(self.disks)),
            *((f"bearings[{k}].at", bearing.at) for k, bearing in enumerate(self.bearings)),
            *((f"places[{k}]", at) for k, at in enumerate(self.places)),
        ):
            if not 0.0 <= at <= self.length * (1.0 + SAME):
                raise InputError(f"{name}: found {at:g} m, expected 0 to the end of the shaft, {self.length:g} m")
        if self.nodes.size > LARGEST:
            raise InputError(f"pieces: found {self.nodes.size} nodes, expected at most {LARGEST}; use fewer elements")

    @property
    def length(self) -> float:
        """Of all pieces [m]."""
        return float(sum(piece.length for piece in self.pieces))

    @property
    def mass(self) -> float:
        """Of shaft and disks [kg]."""
        return float(sum(piece.mass for piece in self.pieces) + sum(disk.mass for disk in self.disks))

    @property
    def nodes(self) -> Array:
        """Positions of the nodes along z [m]: ends of elements, disks, bearings and `places`."""
        ends = np.concatenate(([0.0], np.cumsum([piece.length for piece in self.pieces])))
        found = [np.linspace(a, b, p.elements + 1) for a, b, p in zip(ends[:-1], ends[1:], self.pieces, strict=True)]
        own = [*(disk.at for disk in self.disks), *(bearing.at for bearing in self.bearings)]
        every = np.sort(np.concatenate([*found, np.array([*own, *self.places], dtype=float)]))
        return np.asarray(every[np.concatenate(([True], np.diff(every) > SAME * self.length))])

    def node(self, at: float) -> int:
        """Number of the node at a position [m]; raises InputError if there is none."""
        nodes = self.nodes
        k = int(np.abs(nodes - at).argmin())
        if abs(nodes[k] - at) > 2.0 * SAME * self.length:
            raise InputError(f"at: found {at:g} m, expected a node: {', '.join(f'{z:.4g}' for z in nodes)} m")
        return k + 1

    def matrices(self) -> RotorMatrices:
        """The matrices, with rows x and ry of all nodes, then y and rx."""
        nodes = self.nodes
        n = 2 * nodes.size
        M, K, D, G = (np.zeros((n, n)) for _ in range(4))
        ends = np.cumsum([piece.length for piece in self.pieces])
        for k, (a, b) in enumerate(pairwise(nodes)):
            piece = self.pieces[min(int(np.searchsorted(ends, 0.5 * (a + b))), len(self.pieces) - 1)]
            stiff, moved, tilted = element(piece, b - a)
            own = slice(2 * k, 2 * k + 4)
            M[own, own] += moved + tilted
            G[own, own] += 2.0 * tilted
            K[own, own] += stiff
            D[own, own] += piece.loss_time * stiff
        for disk in self.disks:
            at = 2 * (self.node(disk.at) - 1)
            M[at, at] += disk.mass
            M[at + 1, at + 1] += disk.diametral
            G[at + 1, at + 1] += disk.polar
        zero = np.zeros((n, n))
        G, H = (np.block([[zero, A], [-A, zero]]) for A in (G, D))
        M, K, C = (np.block([[A, zero], [zero, A]]) for A in (M, K, D))
        for bearing in self.bearings:
            at = 2 * (self.node(bearing.at) - 1)
            place = np.ix_([at, n + at], [at, n + at])
            stiffness, damping = bearing.matrices
            K[place] += stiffness
            C[place] += damping
            for row in (at + 1, n + at + 1):
                K[row, row] += bearing.k_tilt
        numbers = range(1, nodes.size + 1)
        dofs = tuple((k, d) for pair in (("x", "ry"), ("y", "rx")) for k in numbers for d in pair)
        sign = np.array([-1.0 if d == "rx" else 1.0 for _, d in dofs])  # the slope of y over z is -rx
        M, C, K, G, H = (np.asarray(sign[:, None] * A * sign) for A in (M, C, K, G, H))
        return RotorMatrices(M=M, C=C, K=K, G=G, H=H, dofs=dofs)

    def reduced(self, modes: int | None = None) -> tuple[ModalBody, Array | None]:
        """Modes of the shaft at rest, with channels 1.x, 1.ry, ...

        at all nodes, and the matrix of its internal damping.

        `modes`: number of kept modes, by default all with mass. Raises InputError if there are fewer modes.
        """
        found, n = self.matrices(), 4 * self.nodes.size
        if modes is not None and not 1 <= modes <= n:
            raise InputError(f"modes: found {modes}, expected 1 to {n}, the modes of the shaft")
        K = 0.5 * (found.K + found.K.T)
        theta, X, shift = _soft_first(K, found.M)
        order = np.flatnonzero(theta > MASSLESS * theta[-1])[::-1][:modes]
        theta, X = theta[order], X[:, order]
        phi = X / np.sqrt(theta)
        squared = 1.0 / theta - shift
        squared[squared < RIGID * shift] = 0.0
        C, G, cross = (phi.T @ A @ phi for A in (found.C, found.G, 0.5 * (found.K - found.K.T)))
        along = np.array([[d == axis for _, d in found.dofs] for axis in "xyz"], dtype=float)
        body = ModalBody(
            omega=np.sqrt(squared), zeta=np.zeros(squared.size), rows=phi, S=_residual(K, phi, squared),
            channels=tuple(f"{node}.{direction}" for node, direction in found.dofs), damping=C if C.any() else None,
            gyroscopic=0.5 * (G - G.T), stiffness=cross if cross.any() else None, participation=along @ found.M @ phi,
        )  # fmt: skip
        return body, np.asarray(phi.T @ found.H @ phi) if found.H.any() else None


def _soft_first(K: Array, M: Array) -> tuple[Array, Array, float]:
    """Eigenvalues of M x = theta (K + shift M) x, which resolves the lowest modes best; shifted if K is singular."""
    from scipy.linalg import eigh

    for shift in (0.0, SHIFT * float(np.median(np.diag(K) / np.diag(M)))):
        try:
            return (*eigh(M, K + shift * M), shift)
        except np.linalg.LinAlgError:
            continue
    expected = "bearings with a positive definite symmetric stiffness"
    raise InputError(f"bearings: found a shaft without a positive stiffness, expected {expected}")


def _residual(K: Array, phi: Array, squared: Array) -> Array:
    """Static compliance of the omitted modes; None if all are kept or some are rigid."""
    if len(squared) == len(K) or not squared.all():
        return np.zeros_like(K)
    lost = np.linalg.inv(K) - phi / squared @ phi.T
    values, vectors = np.linalg.eigh(0.5 * (lost + lost.T))
    lost = (vectors * np.maximum(values, 0.0)) @ vectors.T
    return np.asarray(0.5 * (lost + lost.T))


def element(piece: Piece, length: float) -> tuple[Array, Array, Array]:
    """Stiffness, translational mass and rotary mass of one beam element in one plane, (4, 4) each.

    Displacement and slope at its two ends; J. S. Przemieniecki, Theory of Matrix Structural Analysis, 1968.

    >>> stiff, moved, _ = element(Piece(length=1.0, diameter=0.05), 1.0)
    >>> bool(np.allclose(stiff @ [1.0, 0.0, 1.0, 0.0], 0.0)), round(float(moved[::2, ::2].sum()), 3)
    (True, 15.315)
    """
    EI, L = piece.E * piece.inertia, length
    p = 12.0 * EI / (piece.shear * piece.E / (2.0 * (1.0 + piece.nu)) * piece.area * L * L)
    a, b, c = 6.0 * L, (4.0 + p) * L * L, (2.0 - p) * L * L
    stiff = np.array([[12.0, a, -12.0, a], [a, b, -a, c], [-12.0, -a, 12.0, -a], [a, c, -a, b]])
    a, b = 13.0 / 35.0 + 0.7 * p + p * p / 3.0, (11.0 / 210.0 + 11.0 * p / 120.0 + p * p / 24.0) * L
    c, d = 9.0 / 70.0 + 0.3 * p + p * p / 6.0, (13.0 / 420.0 + 3.0 * p / 40.0 + p * p / 24.0) * L
    e, f = (1.0 / 105.0 + p / 60.0 + p * p / 120.0) * L * L, (1.0 / 140.0 + p / 60.0 + p * p / 120.0) * L * L
    moved = np.array([[a, b, c, -d], [b, e, d, -f], [c, d, a, -b], [-d, -f, -b, e]])
    g, h = 1.2, (0.1 - 0.5 * p) * L
    i, j = (2.0 / 15.0 + p / 6.0 + p * p / 3.0) * L * L, (p * p / 6.0 - p / 6.0 - 1.0 / 30.0) * L * L
    tilted = np.array([[g, h, -g, h], [h, i, -h, j], [-g, -h, g, -h], [h, j, -h, i]])
    return (
        EI / (L**3 * (1.0 + p)) * stiff,
        piece.rho * piece.area * L / (1.0 + p) ** 2 * moved,
        piece.rho * piece.inertia / (L * (1.0 + p) ** 2) * tilted,
    )
