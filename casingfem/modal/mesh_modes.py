"""Modes of imported solids and shells, labelled by nodal diameters if the mesh is a body of revolution about z."""

import time
from dataclasses import dataclass

import numpy as np

from casingfem.errors import ModelError, warn
from casingfem.io.arrays import Array, FloatArray
from casingfem.linalg.eigen import Band, EigenResult, solve
from casingfem.linalg.entries import Symmetric
from casingfem.linalg.factor import Direct
from casingfem.linalg.memory import MemoryNeedError
from casingfem.linalg.multigrid import multigrid_modes
from casingfem.linalg.pencil import round_off
from casingfem.modal.harmonics import Rings
from casingfem.modal.mode_set import RIGID, ModeSet, first_modes, make_labels
from casingfem.structure.geometry.rotation import rigid_motions
from casingfem.structure.imported.assembly import MeshStructure, MeshSystem
from casingfem.structure.imported.cells.mapped import mapped_parts
from casingfem.structure.imported.revolution import elements_around, round_about_z
from casingfem.structure.imported.turning_structure import rotation_of

SHIFT = 0.5  # shift-invert about minus the square of this part of the system's `frequency_scale`
LARGE, THICK = 50_000, 0.1  # unknowns, and wall over size, from which LOBPCG with multigrid is quicker
COUNTABLE = 70_000  # unknowns of a thick solid up to which a Sturm count is affordable: ten seconds at 60,000
DEGREE = 3  # of the polynomials in r and z that describe the meridional shape in the projection


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class MeshModes(ModeSet):
    """Modes of an imported structure: `fields` are at the nodes of its mesh.

    >>> import casingfem as cf
    >>> cube = cf.imported.grid_mesh("tetra10", (1, 1, 1), lambda u: u, groups={"base": (2, 0.0)})
    >>> held = cf.Solid(mesh=cube, material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()})
    >>> found = cf.modes(held, 2)
    >>> type(found).__name__, found.freq.size, found.fields.shape
    ('MeshModes', 2, (27, 3, 2))
    """

    structure: MeshStructure


def mesh_modes(
    structure: MeshStructure,
    wanted: int | Band = 40,
    *,
    system: MeshSystem | None = None,
    direct: Direct = "multifrontal",
    multigrid: bool | None = None,
) -> MeshModes:
    """Modes of an imported structure, labelled, complete by Sturm counts: what `modes` calls, with a choice of solver.

    K phi = omega^2 M phi. A count of modes of a large thick solid is found by LOBPCG with multigrid, if that fails by
    shift-invert with a warning. Above 70,000 unknowns a Sturm count of it takes longer than its modes: missing ones are
    then searched for, not counted, and `sturm_count` is None.

    Parameters
    ----------
    structure
        A `Solid`, a `MeshShell` or any `MeshStructure`.
    wanted
        Number of modes, or lower and upper frequency [Hz].
    system
        The assembled structure, if it exists already.
    direct
        The factorisation: "multifrontal", "superlu", or "pardiso" if pypardiso is installed; with another than the
        first the default is shift-invert.
    multigrid
        Whether LOBPCG with multigrid is used, which needs no factorisation; by default for large thick solids.

    Raises
    ------
    NumericsError
        If the modes cannot be computed or verified.

    Examples
    --------
    >>> from casingfem.structure.material import Material
    >>> from casingfem.structure.imported.grid import grid_mesh, revolved
    >>> from casingfem.structure.imported.solid import Solid
    >>> from casingfem.structure.edge.support import Clamped
    >>> ring = grid_mesh("hexahedron20", (1, 24, 2), revolved((0.5, 0.45), (0.0, 0.25), 0.04), wrap=1,
    ...                  groups={"base": (2, 0.0)})
    >>> found = mesh_modes(Solid(mesh=ring, material=Material(E=210e9, nu=0.3, rho=7800.0),
    ...                          supports={"base": Clamped()}), 4)
    >>> found.nodal_diameters.tolist(), found.doublets
    ([3, 3, 2, 2], ((0, 1), (2, 3)))
    """
    started = time.perf_counter()
    system = system or structure.assembled()
    assembled = time.perf_counter()
    if multigrid is None:
        multigrid = direct == "multifrontal" and large_and_thick(system)
    found = solved_by(system, wanted, direct, multigrid=multigrid)
    solved = time.perf_counter()
    if rotation_of(structure) is not None:
        require_stable(system.K, found)
    freq = found.freq
    check_rigid(system, freq)
    rigid = min(system.rigid, len(freq)) if isinstance(wanted, int) or wanted[0] == 0.0 else 0
    fields = system.expand(found.vectors)
    rings = projected(structure, fields) if round_about_z(structure.mesh) else None
    labels = make_labels(rings, freq, fields, rigid)
    kept = min(wanted, len(freq)) if isinstance(wanted, int) else len(freq)
    return MeshModes(
        structure=structure,
        **first_modes(freq, labels, kept),
        rigid=min(rigid, kept),
        sturm_count=found.sturm_count,
        dofs=system.size,
        seconds={"assemble": assembled - started, "solve": solved - assembled, "label": time.perf_counter() - solved},
    )


def large_and_thick(system: MeshSystem) -> bool:
    """Whether LOBPCG with multigrid is faster: a solid of `LARGE` unknowns or more, its wall `THICK` of its size.

    The wall is twice the volume over the surface, the size the diagonal of its box. Blocks with .18 gain from about
    50,000 unknowns on, a plate with .035 loses, one with .003 fails: `python -m reports.benchmarks.solid_solvers
    --large`.
    """
    return system.size >= LARGE and thick(system)


def thick(system: MeshSystem) -> bool:
    """Whether a solid's wall is `THICK` of its size and it has no attachments, so that multigrid converges."""
    mesh = system.structure.mesh
    free = system.lift is None and bool(np.all(system.M.diagonal() > 0.0))
    return mesh.cell_kind.dim == 3 and free and system.wall >= THICK * mesh.size


def solved_by(system: MeshSystem, wanted: int | Band, direct: Direct, *, multigrid: bool) -> EigenResult:
    """The eigenpairs, by LOBPCG with multigrid if suitable and a count is requested, else by shift-invert.

    LOBPCG is also used for a thick solid whose factor does not fit into memory.
    """
    shift = -((SHIFT * system.frequency_scale) ** 2)
    if multigrid and isinstance(wanted, int):
        near_null = rigid_motions(system.points)[system.free]
        return multigrid_modes(system.K, system.M, near_null, wanted, shift, counted=system.size <= COUNTABLE)
    try:
        return solve(system.K, system.M, wanted, shift=shift, direct=direct)
    except MemoryNeedError:
        if multigrid or not (isinstance(wanted, int) and thick(system)):
            raise
        return solved_by(system, wanted, direct, multigrid=True)


def check_rigid(system: MeshSystem, freq: FloatArray) -> None:
    """Warn of a body with more near-zero motions than its supports allow: parts hinge on an edge or a node."""
    near_zero = int(np.count_nonzero(2.0 * np.pi * freq < RIGID * system.frequency_scale))
    if near_zero > system.rigid:
        where = system.structure.mesh.source
        found = f"{where}: found {near_zero} modes near 0 Hz, expected {system.rigid} rigid-body modes"
        warn("mesh-mechanism", found, stacklevel=5)


def projected(structure: MeshStructure, fields: Array, n_max: int | None = None) -> Rings:
    """Mass-weighted Fourier content of nodal fields: u = Re sum_nj c_nj P_j(r, z) e^(i n theta).

    P_j are polynomials in r and z, orthonormal over the mass; each takes the role of a ring of nodes, so labels,
    partners and angles are found as on a shell. By default n is at most a third of the number of nodes around.
    """
    mesh = structure.mesh
    n_max = n_max or max(2, elements_around(mesh) * (1 + bool(mesh.cell_kind.middles)) // 3)
    density, parts = structure.density(), list(mapped_parts(mesh, 2 if mesh.kind.startswith("tetra") else 3))
    weight = np.concatenate([(on.measure * density[rows, None]).ravel() for rows, _, on in parts])
    x = np.concatenate([on.x.reshape(-1, 3) for _, _, on in parts])
    c, s = (x[:, i] / np.maximum(np.linalg.norm(x[:, :2], axis=1), np.finfo(float).tiny) for i in (0, 1))
    shapes = meridional_shapes(np.linalg.norm(x[:, :2], axis=1), x[:, 2], weight) * weight[:, None]
    at = [np.einsum("kq,ekcm->eqcm", on.values, fields[nodes, :3], optimize=True) for _, nodes, on in parts]
    moved = np.concatenate([part.reshape(part.shape[0] * part.shape[1], *part.shape[2:]) for part in at])
    u, v = moved[:, 0], moved[:, 1]
    moved = np.stack([u * c[:, None] + v * s[:, None], v * c[:, None] - u * s[:, None], moved[:, 2]], axis=1)
    flat = moved.reshape(len(x), 3 * fields.shape[2])
    turn = c - 1j * s
    wave = np.ones(len(x), dtype=complex)
    amplitudes = np.empty((n_max + 1, shapes.shape[1], 3, fields.shape[2]), dtype=complex)
    for n in range(n_max + 1):
        content = (shapes * wave.real[:, None]).T @ flat + 1j * ((shapes * wave.imag[:, None]).T @ flat)
        amplitudes[n] = (content * (2.0 if n else 1.0)).reshape(amplitudes.shape[1:])
        wave = wave * turn
    return Rings(amplitudes=amplitudes, weights=np.full(shapes.shape[1], 1.0 / shapes.shape[1]))


def meridional_shapes(r: FloatArray, z: FloatArray, weight: FloatArray) -> FloatArray:
    """Polynomials in r and z up to `DEGREE`, orthonormal under the weights, (points, functions).

    Both are scaled by the size of the body, since the radius of a cylinder varies only by the rounding of its file,
    which depends on theta and is no meridional coordinate.

    >>> r, z, weight = np.array([1.0, 2.0, 1.5, 1.2]), np.array([0.0, 1.0, 0.3, 0.2]), np.ones(4)
    >>> P = meridional_shapes(r, z, weight)
    >>> bool(np.allclose(P.T @ (weight[:, None] * P), np.eye(P.shape[1])))
    True
    """
    size = max(np.abs(r).max(), np.ptp(z), np.finfo(float).tiny)
    a, b = ((2.0 * q - q.max() - q.min()) / size for q in (r, z))
    powers = [a**i * b**j for i in range(DEGREE + 1) for j in range(DEGREE + 1 - i)]
    table = np.stack(powers, axis=1)
    values, vectors = np.linalg.eigh(table.T @ (weight[:, None] * table))
    kept = values > 1e-8 * values[-1]  # on a cone r and z are one coordinate
    return np.asarray(table @ vectors[:, kept] / np.sqrt(values[kept]))


def require_stable(K: Symmetric, found: EigenResult, where: str = "") -> None:
    """Refuse a rotating structure whose lowest omega^2 is below zero by more than round-off in K(Omega).

    Raises
    ------
    ModelError
        `rotation-unstable`.
    """
    lowest = found.eigenvalues[:1]  # none in a band without modes
    if np.any(lowest < -round_off(K, found.vectors[:, :1])):
        raise ModelError("rotation-unstable", f"modes: found omega^2 = {lowest[0]:.4g} rad^2/s^2{where}")
