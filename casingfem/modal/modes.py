"""Modes of a structure: `modes(shell, count)` or `modes(shell, band=(f0, f1))`, and whether the mesh resolves them.

A shape is expanded in Legendre polynomials of each element; if it is resolved the coefficients decrease. On frusta,
cylinders and plates from order 2 to 8, every mesh with frequency errors above 2.5 % had a share above FINEST.
"""

import time
from typing import NamedTuple, overload

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh

from casingfem.errors import ModelError, NumericsError, warn
from casingfem.io.arrays import BoolArray, FloatArray
from casingfem.linalg.eigen import Band, solve, sturm_count
from casingfem.linalg.factor import Direct
from casingfem.linalg.memory import require_affordable
from casingfem.modal.bolted.casing import bolted_modes, obstacle, require_bolts_alone
from casingfem.modal.fourier import SHIFT, fourier_band, fourier_modes
from casingfem.modal.mesh_modes import MeshModes, mesh_modes, require_stable
from casingfem.modal.mode_set import Modes, ModeSet, frequency_scale, labelled
from casingfem.structure.geometry.chart import is_axisymmetric
from casingfem.structure.imported.assembly import MeshStructure, MeshSystem, require_structure
from casingfem.structure.mesh.element import ElementQuadLobatto, lobatto
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.energies import modal_products, point_fields
from casingfem.structure.shell.plausible import extent, warn_of
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System
from casingfem.structure.shell.variation import outer_supports

__all__ = ["MeshModes", "ModeSet", "Modes", "count_below", "modes"]

METHODS = ("auto", "shell", "fourier", "bolts")
COUNT = 40
HIGHEST = 1e15  # Hz: beyond, its square leaves the range of what is counted
FINEST = 0.015  # share of the finest polynomials in a shape beyond which it is not resolved
SPLITTING = 0.0015  # where it splits pairs: share 0.0016 split n = 9 by 0.2 %, 0.007 by 3 %, 0.0003 by 0.006 %


@overload
def modes(
    shell: Shell,
    count: int | None = None,
    *,
    band: Band | None = None,
    method: str = "auto",
    system: System | None = None,
    direct: Direct = "multifrontal",
) -> Modes: ...
@overload
def modes(
    shell: MeshStructure,
    count: int | None = None,
    *,
    band: Band | None = None,
    method: str = "auto",
    system: MeshSystem | None = None,
    direct: Direct = "multifrontal",
) -> MeshModes: ...
def modes(
    shell: Shell | MeshStructure,
    count: int | None = None,
    *,
    band: Band | None = None,
    method: str = "auto",
    system: System | MeshSystem | None = None,
    direct: Direct = "multifrontal",
) -> ModeSet:
    """Lowest `count` modes of a structure, or all in a band, labelled, complete by Sturm counts.

    K phi = omega^2 M phi, phi^T M phi = 1. A rotating shell has the stiffness at its speed; for Coriolis forces use
    `whirl_modes`.

    Parameters
    ----------
    shell
        The structure: a shell on a chart, an imported `Solid` or `MeshShell`, or any `MeshStructure`. Without supports
        the rigid motions come first and are marked.
    count
        Number of modes; by default 40 without a band.
    band
        Lower and upper frequency [Hz], instead of a count. A mode on an end belongs to it, as does its double.
    method
        "shell": the two-dimensional model. "fourier": one meridian problem per n, for perfect casings. "bolts": the
        same problems coupled by the bolts, if nothing else varies around: quicker than "shell" and converged around the
        edge. "auto": the first of "fourier", "bolts" and "shell" that covers the casing; "shell" with `system`.
        Imported structures allow only "auto". Other tasks (`reduce`, updates, `eigen_derivatives`) use the
        two-dimensional model, whose frequencies of bolted casings are 2e-4 higher, up to 2e-3 for stiff bolts.
    system
        The assembled structure, if it exists already.
    direct
        The factorisation: "multifrontal", "superlu", or "pardiso" if pypardiso is installed.

    Raises
    ------
    ValueError
        The method is unknown, the count is below 1, or "fourier" is requested for a casing that is not axisymmetric.
    ModelError
        `rotation-unstable` if the softening of a rotating shell exceeds its stiffness.
    NumericsError
        If the modes cannot be computed or verified.

    Examples
    --------
    >>> from casingfem.structure.geometry.chart import Frustum
    >>> from casingfem.structure.material import Material
    >>> from casingfem.structure.edge.support import Clamped
    >>> casing = Shell(chart=Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3,
    ...                material=Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": Clamped()})
    >>> low = modes(casing, 4)
    >>> low.freq.round(1).tolist(), low.nodal_diameters.tolist()
    ([367.8, 367.8, 382.8, 382.8], [8, 8, 7, 7])
    >>> modes(casing, band=(380.0, 420.0)).nodal_diameters.tolist()
    [7, 7, 9, 9]
    """
    wanted = count_or_band(count, band)
    if not isinstance(shell, Shell):
        require_structure(shell, "modes")
        if method != "auto":
            raise ModelError("modes-method", f'method: found {method!r}, expected "auto" for an imported structure')
        return mesh_modes(shell, wanted, system=system if isinstance(system, MeshSystem) else None, direct=direct)
    if method not in METHODS:
        raise ModelError("modes-method", f"method: found {method!r}, expected one of {', '.join(METHODS)}")
    warn_of(shell)
    if method == "fourier" or (method == "auto" and shell.axisymmetric and system is None):
        require_affordable(plate_count(shell, wanted), DOFS * nodes_of(shell))
        found_by_n = fourier_modes(shell, wanted) if isinstance(wanted, int) else fourier_band(shell, wanted)
        return checked_resolution(found_by_n, around=False)
    if method == "bolts":
        require_bolts_alone(shell)
    if method == "bolts" or (method == "auto" and system is None and not obstacle(shell)):
        require_affordable(plate_count(shell, wanted), DOFS * nodes_of(shell))
        try:
            return checked_resolution(bolted_modes(shell, wanted), around=False)
        except NumericsError:  # the two-dimensional model covers thinner walls
            if method == "bolts":
                raise
    started = time.perf_counter()
    system = system if isinstance(system, System) else assemble(shell)
    assembled = time.perf_counter()
    found = solve(system.stiffness, system.mass, wanted, shift=-((SHIFT * frequency_scale(shell)) ** 2), direct=direct)
    if shell.rotation is None:
        ritz = ritz_modes(system, found.vectors)
    else:  # prestress is assembled, and no sum of squares
        require_stable(system.stiffness, found)
        ritz = RitzModes(found.freq, system.expand(found.vectors), system.expand_own(found.vectors))
    seconds = {"assemble": assembled - started, "solve": time.perf_counter() - assembled}
    kept = wanted if isinstance(wanted, int) else len(found.eigenvalues)
    named = labelled(shell, system.grid, *ritz, count=kept, sturm=found.sturm_count, dofs=system.size, seconds=seconds)
    return checked_resolution(named)


def warn_of_surveys(found: Modes) -> None:
    """Warn of modes with more nodal diameters than a survey can split: cos 2n theta is beyond its resolution."""
    n = int(found.nodal_diameters.max(initial=0))
    for quantity, field in found.shell.defects.items():
        resolved = getattr(field, "n_resolved", None)
        if resolved is not None and 2 * n > resolved:
            gap = getattr(field, "coverage_deg", None)
            wide = "" if gap is None else f": its widest gap around is {gap:.3g} degrees"
            message = (
                f"pairs up to n = {n} are split by harmonic {2 * n}, but the survey of the {quantity} resolves "
                f"harmonics up to {resolved}{wide}"
            )
            warn("field-resolution", message, stacklevel=5)


def count_or_band(count: int | None, band: Band | None) -> int | Band:
    """The requested count or band after checks; the default is 40 modes."""
    if count is not None and band is not None:
        raise ModelError("modes-band", "modes: found both count and band, expected one of them")
    if band is not None and not 0.0 <= band[0] < band[1] < HIGHEST:
        raise ModelError("modes-band", f"band: found {band[0]!r} to {band[1]!r} Hz")
    if count is not None and count < 1:
        raise ModelError("modes-count", f"count must be at least 1, found {count}")
    return band or count or COUNT


def nodes_of(shell: Shell) -> int:
    """Number of nodes of the mesh of a closed casing."""
    mesh = shell.mesh
    return mesh.order * mesh.columns * (mesh.order * (len(mesh.breaks) - 1) + 1)


def plate_count(shell: Shell, wanted: int | Band) -> float:
    """Number of modes in a band, from the modal density of a plate, sqrt(3) area/(c t) per hertz."""
    if isinstance(wanted, int):
        return float(wanted)
    size, steel = extent(shell), shell.material
    c = float(np.sqrt(np.real(steel.E / (steel.rho * (1.0 - steel.nu**2)))))
    return float(np.sqrt(3.0) * size.sides.prod() * (wanted[1] - wanted[0]) / (c * size.thickness.min()))


def count_below(structure: Shell | MeshStructure, freq: float, system: System | None = None) -> int:
    """Number of modes below a frequency [Hz], by one factorisation and its inertia; `system` is the assembled shell."""
    if not freq < HIGHEST:
        raise ModelError("modes-band", f"count_below: found {freq!r} Hz, expected a finite frequency")
    place = (2.0 * np.pi * freq) ** 2
    if isinstance(structure, Shell):
        shell = system or assemble(structure)
        return sturm_count(shell.stiffness, shell.mass, place)
    mesh = structure.assembled()
    return sturm_count(mesh.K, mesh.M, place)


def finest_shares(modes: Modes) -> FloatArray:
    """Amplitude share of the highest polynomials along both parameters, (2, modes)."""
    order = modes.grid.mesh.order
    i, j = ElementQuadLobatto(order).pairs.T
    to_legendre = np.linalg.inv(legendre.legvander(2.0 * lobatto(order)[0] - 1.0, order))
    u = modes.fields[modes.grid.elements][:, :, :3]
    lattice = np.empty((order + 1, order + 1, u.shape[0], 3, u.shape[3]))
    lattice[i, j] = np.moveaxis(u, 1, 0)
    coefficients = np.einsum("ai,bj,ijeck->abeck", to_legendre, to_legendre, lattice, optimize=True)
    norms = 1.0 / (2.0 * np.arange(order + 1) + 1.0)  # mean squares of Legendre polynomials
    energy = np.einsum("abeck,a,b->abk", coefficients**2, norms, norms, optimize=True)
    finest = np.stack([energy[-1].sum(axis=0), energy[:, -1].sum(axis=0)])
    return np.asarray(np.sqrt(finest / energy.sum(axis=(0, 1))))


def split_by_mesh(modes: Modes) -> BoolArray:
    """Modes of a casing of revolution whose pairs equal elements split: their number divides 2n, (modes,)."""
    n = np.asarray(modes.nodal_diameters)
    return np.asarray((n > 0) & (2 * n % modes.grid.mesh.columns == 0) & is_axisymmetric(modes.shell.chart))


def warn_of_coarse_mesh(modes: Modes, *, around: bool) -> None:
    """Warn of shapes that the mesh does not resolve; with `around` False only along the meridian."""
    shares = finest_shares(modes)
    worst = shares.max(axis=0) if around else shares[0]
    split = split_by_mesh(modes) & around
    poor = np.flatnonzero((worst > FINEST) | (split & (shares[1] > SPLITTING)))
    if len(poor):
        which = f"mode {poor[0] + 1}" if len(poor) == 1 else f"{len(poor)} modes from mode {poor[0] + 1} on"
        mesh, share = modes.grid.mesh, worst[poor].max()
        elements = f"{len(mesh.breaks) - 1} x {mesh.columns} elements of order {mesh.order}"
        more = "; with so few elements around, the mesh itself splits pairs" if split[poor].any() else ""
        found = f"{which}: found up to {share:.1%} of the shape in the highest polynomials of {elements}{more}"
        warn("mesh-coarse", found, stacklevel=5)


def checked_resolution(modes: Modes, *, around: bool = True) -> Modes:
    """The same modes, after warnings of a coarse mesh or survey, or of supports that leave motions free."""
    if around:
        warn_of_surveys(modes)
    warn_of_coarse_mesh(modes, around=around)
    held = ", ".join(edge for edge, holding in outer_supports(modes.shell).items() if holding is not None)
    if modes.rigid and held:
        warn("support-incomplete", f"found {modes.rigid} rigid-body modes, although {held} is supported", stacklevel=4)
    return modes


class RitzModes(NamedTuple):
    """Frequencies [Hz] ascending, nodal fields (nodes, 5, modes) and the additional dofs of rings (own, modes)."""

    freq: FloatArray
    fields: FloatArray
    own: FloatArray


def ritz_modes(system: System, vectors: FloatArray) -> RitzModes:
    """Rayleigh-Ritz on modes (free, modes) with their strain and kinetic energies.

    (Phi^T K Phi) y = omega^2 (Phi^T M Phi) y with both products summed over points, not from the assembled matrices. So
    frequencies are exact to round-off relative to themselves, and close pairs are separated. It costs about a tenth of
    an assembly.
    """
    fields, own = system.expand(vectors), system.expand_own(vectors)
    if not vectors.shape[1]:
        return RitzModes(np.zeros(0), fields, own)
    products = modal_products(system.shell, point_fields(system.shell, system.grid, fields, own))
    values, turn = eigh(products.K, products.M)
    return RitzModes(np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi), fields @ turn, own @ turn)
