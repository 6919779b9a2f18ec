"""The modal basis of a perfect casing, harmonic by harmonic: any number of modes in milliseconds.

Each n is a dense meridian problem (`structure.axisymmetric`), so modes are chosen by nodal diameters and meridional
order rather than by frequency, and the residual compliance S comes from the same small matrices.
"""

from collections.abc import Callable, Iterator

import numpy as np
from scipy.linalg import block_diag

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.linalg.factor import solve_held
from casingfem.modal.basis import ModalBasis
from casingfem.modal.fourier import SHIFT, lowest, resolving, revolve_shape
from casingfem.modal.interface.chart_rows import rim_thickness
from casingfem.modal.interface.kinds import Rim
from casingfem.modal.mode_set import frequency_scale
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.shell.assembly import assemble, turning
from casingfem.structure.shell.axisymmetric import Meridian, harmonic_matrices
from casingfem.structure.shell.prestress import carries_more
from casingfem.structure.shell.shell import Shell
from contact.io.names import hint


def harmonic_basis(
    shell: Shell, rim: Rim, *, orders: int | Callable[[int], int], zeta: float = 0.0, residual: bool = True
) -> ModalBasis:
    """Free modes of a perfect casing by n = 0 to rim.n_max and meridional order, with residual compliance.

    S = P^T K^-1 P - (P^T Phi) Lambda^-1 (Phi^T P), as in `reduce`, but for each harmonic on its own. The matrices of
    rotation about the casing's axis couple modes of one n alone.

    Parameters
    ----------
    shell
        A casing on which nothing varies around, supported.
    rim
        Edge and highest harmonic.
    orders
        Number of meridional orders that are kept, or a function of n.
    zeta
        Damping ratio of every mode.
    residual
        Whether S has the compliance of the omitted modes; without it the basis is too stiff.

    Raises
    ------
    ValueError
        If anything varies around the shell, or it has no such edge.

    Examples
    --------
    >>> import casingfem as cf
    >>> casing = cf.Shell(chart=cf.Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3,
    ...                   material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()})
    >>> len(harmonic_basis(casing, cf.Rim("top", n_max=20), orders=1))
    42
    """
    if rim.edge not in shell.chart.edges:
        raise ModelError(
            "interface-edge",
            f"this chart has no edge {rim.edge!r}; it has {', '.join(shell.chart.edges)}"
            + hint(rim.edge, shell.chart.edges),
        )
    if rim.lines:
        raise ModelError("interface-lines", f"rim.lines: found {rim.lines}, expected none here: the edge itself")
    size = len(rim.channels)
    turned = None if carries_more(assemble(shell)) else Turned(shell, rim.n_max)
    S = np.zeros((size, size))
    omega: list[FloatArray] = []
    rows: list[FloatArray] = []
    shares: list[FloatArray] = []
    spun: list[tuple[FloatArray, FloatArray]] = []
    for n in range(rim.n_max + 1):
        meridian = harmonic_matrices(shell, n)
        squares, vectors = kept_modes(shell, meridian, orders if isinstance(orders, int) else orders(n))
        if turned is not None:
            spun.append(turned.matrices(meridian, vectors))
        for family, (channels, loads) in enumerate(families(shell, rim, meridian)):
            at_rim = loads.T @ vectors
            shares.append(participation(meridian, family, vectors))
            omega.append(np.sqrt(squares))
            block = np.zeros((size, len(squares)))
            block[channels] = at_rim
            rows.append(block)
            S[np.ix_(channels, channels)] += loads.T @ np.linalg.solve(meridian.K, loads)
            S[np.ix_(channels, channels)] -= (at_rim / squares) @ at_rim.T
    order = np.argsort(np.concatenate(omega), kind="stable")
    rotation: dict[str, FloatArray] = {}  # none of a casing with rings or masses
    if spun:
        gyroscopic, added = (block_diag(*blocks)[np.ix_(order, order)] for blocks in zip(*spun, strict=True))
        rotation = {"gyroscopic": gyroscopic, "stiffness_by_speed": added}
    return ModalBasis(
        omega=np.concatenate(omega)[order],
        zeta=np.full(len(order), zeta),
        channels=rim.channels,
        rows=np.concatenate(rows, axis=1)[:, order],
        S=0.5 * (S + S.T) * residual,
        **rotation,
        participation=np.concatenate(shares, axis=1)[:, order],
        kind="rim",
        n_max=rim.n_max,
        radius=rim_radius(shell, rim),
        thickness=float(rim_thickness(shell, rim).min()),
        provenance={"method": "harmonic", "residual": residual},
    )


class Turned:
    """Terms that rotation about its axis adds to the modes of a casing at rest, from its mesh around."""

    def __init__(self, shell: Shell, n_max: int) -> None:
        system = assemble(resolving(shell, n_max))
        part = turning(system, Rotation(omega=0.0))
        self.system, self.times = system, part.products(solve_held(system.stiffness, part.load)).times

    def matrices(self, meridian: Meridian, vectors: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gyroscopic matrix and stiffness by speed of the cosines and then the sines of one n, (modes, modes) each."""
        grid, shapes = self.system.grid, meridian.expand(vectors)
        fields = [
            revolve_shape(grid, shapes[:, :, k], meridian.n, sine=sine)
            for sine in ((False, True) if meridian.n else (False,))
            for k in range(vectors.shape[1])
        ]
        if not fields:
            return np.zeros((0, 0)), np.zeros((0, 0))
        free = self.system.collect(np.stack(fields, axis=-1), np.zeros((0, len(fields))))
        G, added, _ = (free.T @ part for part in self.times(free))
        return 0.5 * (G - G.T), 0.5 * (added + added.T)


def families(shell: Shell, rim: Rim, meridian: Meridian) -> Iterator[tuple[list[int], FloatArray]]:
    """Channels and load columns (free dofs, channels) of the families cos n theta and sin n theta.

    The cosine family moves (u_r cos, -u_theta sin, u_z cos), the sine family (u_r sin, u_theta cos, u_z sin) n theta,
    each with kinetic energy pi times the meridian's; n = 0 has one family of all directions with 2 pi.
    """
    n, size = meridian.n, 2 * rim.n_max + 1
    node = 0 if shell.chart.edges[rim.edge][1] == 0 else len(meridian.z) - 1
    directions = len(rim.directions)
    unit = np.zeros((len(meridian.z) * DOFS, directions))
    unit[node * DOFS : node * DOFS + 3] = np.eye(3, directions)
    loads = meridian.restrict(unit)
    first = size * np.arange(directions)
    if n == 0:
        yield first.tolist(), loads / np.sqrt(2.0 * np.pi)
        return
    wave = np.array([0, rim.n_max, 0])[:directions]  # the hoop's motion is in quadrature
    turned = loads * np.array([1.0, -1.0, 1.0])[:directions]
    yield (first + wave + n).tolist(), turned / np.sqrt(np.pi)
    yield (first + rim.n_max - wave + n).tolist(), loads / np.sqrt(np.pi)


def kept_modes(shell: Shell, meridian: Meridian, keep: int) -> tuple[FloatArray, FloatArray]:
    """Squares of omega (modes,) and vectors (free, modes) of the lowest modes of one family."""
    if keep == 0:
        return np.zeros(0), np.zeros((len(meridian.mass), 0))
    wanted = 2 * keep if meridian.n == 0 else keep  # n = 0 holds radial and torsional motions
    return lowest(meridian, wanted, (SHIFT * frequency_scale(shell)) ** 2)


def participation(meridian: Meridian, family: int, vectors: FloatArray) -> FloatArray:
    """Phi^T M e of translations along x, y, z, (3, modes): (1, 1, 0) of n = 1 is x or y, (0, 0, 1) of n = 0 is z."""
    found = np.zeros((3, vectors.shape[1]))
    if meridian.n > 1:
        return found
    shift = np.array([1.0, 1.0, 0.0, 0.0, 0.0] if meridian.n else [0.0, 0.0, 1.0, 0.0, 0.0])
    fields = np.tile(shift[:, None], (len(meridian.z), 1, 1))
    moved = meridian.collect(fields, np.zeros((meridian.own, 1)))[:, 0]
    whole = np.sqrt(np.pi if meridian.n else 2.0 * np.pi)
    found[family if meridian.n else 2] = whole * (meridian.mass * moved) @ vectors
    return found


def rim_radius(shell: Shell, rim: Rim) -> float:
    """Radius of a rim [m]."""
    (z0, z1), _ = shell.chart.bounds
    z = np.array([z1 if shell.chart.edges[rim.edge][1] else z0])
    return float(np.linalg.norm(shell.chart.surface(z, np.zeros(1), None).x[:2]))
