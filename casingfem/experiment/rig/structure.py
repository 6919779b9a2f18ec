"""A structure on the test rig: its modes at chosen places, their static residual, and the mass of its sensors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import eigh

from casingfem.errors import InputError
from casingfem.experiment.rig.rig import Probe, Rig
from casingfem.io.arrays import FloatArray
from casingfem.linalg.factor import factorise
from casingfem.modal.mode_set import Modes, require_energies
from casingfem.structure.mesh.kinematics import DOFS, frame
from casingfem.structure.mesh.place import interpolation
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.system import System

CYLINDRICAL = ("radial", "hoop", "axial")
CARTESIAN = ("x", "y", "z")
DIRECTIONS = (*CYLINDRICAL, *CARTESIAN, "normal")
RANK = 1e-12  # of the largest residual compliance: below it there is none


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Parameters (a, b) of the chart and a direction: radial, hoop, axial about z; x, y, z; or normal to the wall.

    On a casing a is the height [m] and b the angle [rad], and the normal points inwards.
    `mass` [kg] is that of the attached sensor.

    >>> Place(at=(0.25, 0.0)).direction
    'radial'
    """

    at: tuple[float, float]
    direction: str = "radial"
    mass: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.mass < np.inf:
            raise InputError(f"mass: found {self.mass!r} kg, expected 0 or more")
        if self.direction not in DIRECTIONS:
            raise InputError(f"direction: found {self.direction!r}, expected one of {', '.join(DIRECTIONS)}")


def circle(
    height: float, count: int, *, first_angle: float = 0.0, direction: str = "radial", mass: float = 0.0
) -> list[Place]:
    """Evenly spaced points around a casing.

    >>> [round(float(place.at[1]), 4) for place in circle(0.25, 4)]
    [0.0, 1.5708, 3.1416, 4.7124]
    """
    if count < 1:
        raise InputError(f"count: found {count}, expected at least one place")
    angles = (first_angle + 2.0 * np.pi * np.arange(count) / count).tolist()
    return [Place(at=(height, angle), direction=direction, mass=mass) for angle in angles]


def rig_of(
    modes: Modes, places: Sequence[Place], *, zeta: float | FloatArray, system: System | None = None, first: int = 1
) -> Rig:
    """The rig of a shell: its modes at places, with S from one static solution.

    S = P^T K^-1 P - sum_k phi_k phi_k^T/omega_k^2. The masses of sensors change the modes (`loaded`). On a
    shear-deformable wall S at the place of the force grows as ln(1/h) with the mesh size h (`PointLoad`); the mesh size
    represents that of the shaker's head.

    Parameters
    ----------
    modes
        Elastic modes of a supported shell, without a rigid motion.
    places
        Probes, numbered from `first` on; equal positions get one number.
    zeta
        Damping ratio, or one for each mode.
    system
        The assembled shell, if it exists already.

    Raises
    ------
    InputError
        There are rigid motions, or places off the surface.

    Examples
    --------
    >>> import casingfem as cf
    >>> casing = cf.Shell(chart=cf.Cylinder(radius=0.3, height=0.1), thickness=4e-3, supports={"base": cf.Clamped()},
    ...                   material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                   mesh=cf.ShellMesh(order=6, rows=2, around=9))
    >>> rig = cf.rig.rig_of(cf.modes(casing, 2), [cf.rig.Place(at=(0.1, angle)) for angle in (0.0, 1.0)], zeta=0.002)
    >>> rig.omega.size, rig.rows.shape
    (2, (2, 2))
    """
    if modes.rigid:
        raise InputError(f"modes: found {modes.rigid} rigid motions, expected a supported structure")
    require_energies(modes)
    if not places:
        raise InputError("places: found none, expected at least one")
    system = system or assemble(modes.shell)
    heavy = [place for place in places if place.mass]
    under = [Place(at=place.at, direction=d) for place in heavy for d in CARTESIAN]
    nodal, probes = probe_rows(modes, [*places, *under], first)
    rows = np.einsum("pnd,ndm->pm", nodal, modes.fields, optimize=True)
    P = system.restrict(nodal.transpose(1, 2, 0))
    S = P.T @ factorise(system.K).solve(P) - (rows / modes.omega**2) @ rows.T
    damping = np.broadcast_to(np.asarray(zeta, np.float64), modes.omega.shape)
    bare = Rig(omega=modes.omega, zeta=damping, rows=rows, S=0.5 * (S + S.T), probes=probes)
    if not heavy:
        return bare
    return loaded(bare, range(len(places), len(probes)), np.repeat([place.mass for place in heavy], 3)).taking(
        range(len(places))
    )


def probe_rows(modes: Modes, places: Sequence[Place], first: int) -> tuple[FloatArray, tuple[Probe, ...]]:
    """Displacements at the places as rows over nodal fields, (places, nodes, 5), and the probes."""
    at = np.array([place.at for place in places], np.float64).T
    try:
        nodes, weights = interpolation(modes.grid, *at)
    except ValueError as error:
        raise InputError(f"places: {error}") from error
    surface = modes.shell.geometry(*at).surface
    points, normals = np.real(surface.x).T, frame(surface).normal.T
    closed = modes.shell.chart.periodic
    rows = np.zeros((len(places), modes.grid.nodes.shape[1], DOFS))
    probes, numbers = [], dict[tuple[float, float], int]()
    for k, place in enumerate(places):
        angle = float(np.arctan2(points[k, 1], points[k, 0]))
        unit, code = towards(place.direction, angle, normals[k], closed=closed)
        rows[k, nodes[k], :3] = weights[k][:, None] * unit
        node = numbers.setdefault(place.at, first + len(numbers))
        x, y, z = points[k].tolist()
        probes.append(Probe(node, code, (x, y, z), angle))
    return rows, tuple(probes)


def towards(direction: str, angle: float, normal: FloatArray, *, closed: bool) -> tuple[FloatArray, int]:
    """Unit vector of a direction, and its number in universal files: see `Probe`."""
    if direction == "normal":
        return normal, 0
    if direction in CARTESIAN:
        axis = CARTESIAN.index(direction)
        return np.eye(3)[axis], 3 if axis == 2 else 0 if closed else axis + 1
    c, s = np.cos(angle), np.sin(angle)
    axis = CYLINDRICAL.index(direction)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])[axis], axis + 1 if closed or axis == 2 else 0


def damping_spread(zeta: float, spread: float, count: int, *, seed: int) -> FloatArray:
    """Random damping ratios about `zeta`, log-normal: ln zeta_k has the standard deviation `spread`.

    >>> damping_spread(0.002, 0.0, 2, seed=3).tolist()
    [0.002, 0.002]
    """
    return np.asarray(zeta * np.exp(spread * np.random.default_rng(seed).standard_normal(count)))


def loaded(rig: Rig, probes: Sequence[int], mass: ArrayLike) -> Rig:
    """The rig with masses [kg] at probes (mass loading), such as the masses of sensors.

    A mass acts in the direction of its probe: a sensor needs three probes. The displacements at the masses m are u =
    R q + B z with B B^T = S there: modes and residual, which the masses also excite. With T = (|q'|^2 + u'^T m u')/2
    and V = (q^T Omega^2 q + z^T z)/2 this is a small eigenproblem, whose static response is that of the bare structure.
    M = I + R^T m R (modes and residuals), solved again. As many modes as before are kept; the rest goes into S. Damping
    stays diagonal: the complex modes of a close pair with different damping are not modelled.

    Parameters
    ----------
    probes
        Indices of the probes, from 0.
    mass
        Mass [kg] at each of these probes, or one for all.

    Raises
    ------
    InputError
        A probe does not exist, or a mass is negative or not finite.

    Examples
    --------
    >>> bare = Rig.of(omega=[100.0], zeta=[0.01], rows=[[1.0]])  # 1 kg
    >>> loaded(bare, [0], [3.0]).omega.round(9).tolist()
    [50.0]
    """
    at = rig.checked(probes)
    m = np.broadcast_to(np.asarray(mass, np.float64), (len(at),))
    if not (np.isfinite(m).all() and m.min() >= 0.0):
        raise InputError(f"mass: found {m.min():g} kg, expected masses of 0 kg or more")
    beyond = residual_shapes(rig.S, at)
    rows = np.hstack([rig.rows, beyond])
    added = rows[at].T @ (m[:, None] * rows[at])
    own = np.r_[np.ones(len(rig)), np.zeros(beyond.shape[1])]
    stiff = np.r_[rig.omega, np.ones(beyond.shape[1])]
    turned = (np.diag(own) + added) / np.outer(stiff, stiff)
    inverse, x = eigh(turned, subset_by_index=(len(stiff) - len(rig), len(stiff) - 1))
    omega = 1.0 / np.sqrt(inverse[::-1])
    shapes = x[:, ::-1] / stiff[:, None] * omega  # phi^T M phi = 1
    damping = shapes[: len(rig)].T ** 2 @ (2.0 * rig.zeta * rig.omega)
    now = rows @ shapes
    S = (rig.rows / rig.omega**2) @ rig.rows.T + rig.S - (now / omega**2) @ now.T
    return Rig(omega=omega, zeta=damping / (2.0 * omega), rows=now, S=0.5 * (S + S.T), probes=rig.probes)


def residual_shapes(S: FloatArray, at: Sequence[int]) -> FloatArray:
    """Displacements of all probes in the residual coordinates of some, (probes, coordinates)."""
    values, vectors = np.linalg.eigh(S[np.ix_(at, at)])
    kept = values > RANK * max(float(values.max()), np.finfo(float).tiny)
    return np.asarray(S[:, at] @ vectors[:, kept] / np.sqrt(values[kept]))
