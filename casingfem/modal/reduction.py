"""Reduction of a structure to a modal basis seen from its interface.

Free modes with residual compliance (MacNeal, Computers & Structures 1, 1971, 581): the modes of the supported shell,
and S = P^T K^-1 P - (P^T Phi) Lambda^-1 (Phi^T P) for all omitted modes, with the interface's load columns P. S is
computed as R^T K R of the part R of K^-1 P that is M-orthogonal to the modes. Craig-Bampton (AIAA J. 6, 1968, 1313):
static shapes of unit interface displacements and the modes of the shell with fixed interface, diagonalised; exact in
statics with S = 0, but the interface then has mass. Both reproduce the static response to interface forces exactly. A
rim's basis, and that of a structure with a rotation, has the matrices of rotation between its modes (`turning.py`).
"""

import hashlib
from collections.abc import Callable, Sequence
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eigh
from scipy.sparse import csc_array
from scipy.sparse.linalg import LinearOperator, eigsh

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.linalg.element_sum import ElementSum
from casingfem.linalg.entries import Symmetric
from casingfem.linalg.factor import Factor, factorise
from casingfem.linalg.krylov import START_SEED
from casingfem.linalg.memory import MemoryNeedError
from casingfem.linalg.multigrid import static_by_cycles
from casingfem.modal.basis import ModalBasis
from casingfem.modal.interface.kinds import Interface, Rim
from casingfem.modal.interface.output import Output, output_rows
from casingfem.modal.interface.view import load_columns, view
from casingfem.modal.mesh_modes import thick
from casingfem.modal.modes import modes as lowest_modes
from casingfem.modal.turning import modal_turning
from casingfem.modal.turning_series import Kept
from casingfem.structure.geometry.rotation import rigid_motions
from casingfem.structure.imported.assembly import MeshStructure, MeshSystem, require_structure
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.plausible import warn_of
from casingfem.structure.shell.rigid import free_motions
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System
from contact.io.threads import one_thread

METHODS = ("free", "craig-bampton")
Solve = Callable[[FloatArray], FloatArray]


def reduce(
    structure: Shell | MeshStructure,
    interface: Interface,
    *,
    modes: int = 40,
    method: str = "free",
    zeta: float = 0.0,
    recovery: bool = False,
    outputs: Sequence[Output] = (),
    system: System | MeshSystem | None = None,
) -> ModalBasis:
    """Reduce a supported structure to `modes` modes with an interface.

    Parameters
    ----------
    structure
        A supported shell on a chart, an imported `Solid` or `MeshShell`, or any `MeshStructure`.
    interface
        `Rim` of a casing, `Tip` or `TipNodes` of a blade; on an imported part their edge is a group of facets.
        `AtNodes` of an imported part.
    modes
        Number of kept free modes, or of fixed-interface modes in addition to the static shapes.
    method
        "free" (with residual compliance) or "craig-bampton".
    zeta
        Damping ratio given to every mode.
    recovery
        Also store the data for displacements at all nodes, and the cells for pictures.
    outputs
        Quantities that a run gives by name: `Displacement` and `Strain` at places of a chart, `NodeDisplacement`,
        `NodeStrain` and `NodeStress` of an imported part.
    system
        The assembled structure, if it exists already.

    Raises
    ------
    ValueError
        The method is unknown, damping is negative, the structure does not have the interface, there are rigid motions,
        or the axis of rotation differs from that of a rim.
    NumericsError
        If the stiffness is singular.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=6, rows=2, around=1))
    >>> basis = cf.reduce(plate, cf.Tip(), modes=4)
    >>> exact = cf.modes(plate, 4)
    >>> bool(np.allclose(basis.freq, exact.freq)), basis.S.shape
    (True, (2, 2))
    """
    if method not in METHODS:
        raise ModelError("reduce-method", f"method must be one of {', '.join(METHODS)}, found {method!r}")
    if not 0.0 <= zeta < 1.0:
        raise ModelError("reduce-damping", f"zeta must lie in [0, 1), found {zeta!r}")
    if not isinstance(structure, Shell):
        require_structure(structure, "reduce")
    if not any(structure.supports.values()):
        raise ModelError("reduce-rigid", "found a structure without supports, expected one without rigid motions")
    if isinstance(structure, Shell):
        warn_of(structure)
        system = system or assemble(structure)
    else:
        system = system or structure.assembled()
    if not 1 <= modes < system.size // 2:
        raise ModelError("modes-count", f"modes must lie between 1 and {system.size // 2 - 1} here, found {modes!r}")
    seen = view(system, interface)
    wanted = output_rows(system, tuple(outputs))
    P = seen.loads
    if not P.any():
        where = interface.where if isinstance(interface, Rim) else repr(getattr(interface, "edge", ""))
        raise ModelError("interface-held", f"interface: {where} is fixed, so forces there have no effect")
    with one_thread():
        turning = modal_turning(structure, system, interface, seen.axes, seen.radius)
        loads = P if turning is None else np.hstack([P, turning.load])
        solve: Solve | None = None
        if method == "free":
            vectors, omega = free_vectors(system, modes)
            solve = static_solver(system)
            shapes = solve(loads)
            attachment = shapes[:, : P.shape[1]]
        else:
            factor = factorise(stiffness(system))
            shapes = factor.solve(loads)
            attachment = shapes[:, : P.shape[1]]
            vectors, omega = craig_bampton_vectors(system, factor, P, attachment, modes)
        at_interface = P.T @ vectors
        left = beside(vectors, attachment, system.M)
        S = np.zeros((P.shape[1], P.shape[1]))
        if method == "free":
            S = left.T @ (stiffness(system) @ left)
            S = 0.5 * (S + S.T)
        stored: dict[str, Any] = {}
        if recovery:
            stored = {
                "recovery": system.expand(vectors)[:, :3].reshape(-1, len(omega)),
                "recovery_S": system.expand(left)[:, :3].reshape(-1, P.shape[1]),
                "recovery_points": system.points,
                "recovery_cells": system.cells,
            }
        if outputs:
            restricted = load_columns(system, wanted).T
            stored |= {"output_rows": restricted @ vectors, "output_S": restricted @ left}
        if turning is not None:
            kept = Kept(vectors, omega, stiffness(system), system.M, solve)
            stored |= turning.arrays(shapes[:, P.shape[1] :], kept)
    return ModalBasis(
        omega=omega,
        zeta=np.full(len(omega), zeta),
        channels=seen.channels,
        outputs=tuple(output.name for output in outputs),
        lines=seen.lines,
        line_thickness=seen.line_thickness,
        out_of_roundness=seen.out_of_roundness,
        rows=at_interface,
        S=S,
        participation=participation(system, seen.axes, vectors),
        kind="rim" if isinstance(interface, Rim) else "point",
        n_max=interface.n_max if isinstance(interface, Rim) else 0,
        radius=seen.radius,
        thickness=seen.thickness,
        provenance=provenance(system, method, modes) | seen.facts,
        **stored,
    )


def beside(vectors: FloatArray, motions: FloatArray, mass: csc_array) -> FloatArray:
    """The part of motions (free, k) outside the mass-normalised modes `vectors` (free, m).

    For K^-1 P this is (K^-1 - Phi Lambda^-1 Phi^T) P. A difference of compliances would contain the round-off of a soft
    support, which can exceed the residual.
    """
    for _ in range(2):  # the second time for round-off
        motions = motions - vectors @ (vectors.T @ (mass @ motions))
    return motions


def participation(system: System | MeshSystem, axes: FloatArray, vectors: FloatArray) -> FloatArray:
    """Phi^T M e for unit translations e, (3, modes) [sqrt(kg)].

    Along x, y, z of a casing, span, flap, chord of a blade.

    Its squares are effective masses: over all modes they add up to the mass that moves.
    """
    return np.asarray((system.M @ system.translations(axes)).T @ vectors)


def stiffness(system: System | MeshSystem) -> Symmetric:
    """K (free, free) in the form that is cheapest to factorise."""
    return system.stiffness if isinstance(system, System) else system.K


def static_solver(system: System | MeshSystem) -> Solve:
    """Solver for loads (free, k) -> K^-1 loads; by multigrid for thick solids whose factor does not fit into memory."""
    try:
        factor = factorise(stiffness(system))
    except MemoryNeedError:
        if isinstance(system, System) or not thick(system):
            raise
        refuse_rigid(system.rigid)
        K, motions = system.K, rigid_motions(system.points)[system.free]
        return lambda loads: static_by_cycles(K, motions, loads)
    return lambda loads: np.asarray(factor.solve(loads))


def free_vectors(system: System | MeshSystem, count: int) -> tuple[FloatArray, FloatArray]:
    """Mass-normalised modes of the supported structure on its free dofs, and their omega."""
    if isinstance(system, System):
        of_shell = lowest_modes(system.shell, count, method="shell", system=system)
        refuse_rigid(of_shell.rigid)
        return system.collect(of_shell.fields, of_shell.own), of_shell.omega
    refuse_rigid(system.rigid)
    found = lowest_modes(system.structure, count, system=system)
    return system.collect(found.fields), found.omega


def refuse_rigid(rigid: int) -> None:
    """Refuse a structure with rigid motions."""
    if rigid:
        raise ModelError("reduce-rigid", f"found {rigid} rigid-body modes of the structure, expected none")


def craig_bampton_vectors(
    system: System | MeshSystem, factor: Factor, P: FloatArray, attachment: FloatArray, count: int
) -> tuple[FloatArray, FloatArray]:
    """Diagonalised Craig-Bampton basis: static interface shapes and `count` fixed-interface modes.

    The inverse of K under P^T u = 0 is K^-1 - K^-1 P (P^T K^-1 P)^-1 P^T K^-1; its largest eigenvalues are the
    fixed-interface modes, so one factorisation serves both parts.
    """
    refuse_rigid(free_motions(system.shell, system.grid).shape[2] if isinstance(system, System) else system.rigid)
    loaded = P.any(axis=0)  # a channel along which a support fixes the node has no shape
    P, attachment = P[:, loaded], attachment[:, loaded]
    compliance = P.T @ attachment
    held = cho_factor(0.5 * (compliance + compliance.T))

    def constrained(x: FloatArray) -> FloatArray:
        return np.asarray(factor.solve(np.ravel(x)) - attachment @ cho_solve(held, attachment.T @ np.ravel(x)))

    start = constrained(system.M @ np.random.default_rng(START_SEED).standard_normal(system.size))
    inverse = LinearOperator((system.size, system.size), matvec=constrained, dtype=float)
    _, inner = eigsh(system.K, count, M=system.M, sigma=0.0, OPinv=inverse, which="LM", v0=start)
    V = np.hstack([cho_solve(held, attachment.T).T, inner])
    V /= np.sqrt(np.einsum("ij,ij->j", V, system.M @ V))
    K, M = V.T @ (system.K @ V), V.T @ (system.M @ V)
    values, turn = eigh(0.5 * (K + K.T), 0.5 * (M + M.T))
    return V @ turn, np.sqrt(values)


def provenance(system: System | MeshSystem, method: str, count: int) -> dict[str, object]:
    """Method, package versions, and a hash of the matrices from which the basis was made.

    A stiffness in the form of its elements is hashed in that form: to assemble it takes a tenth of a reduction.
    """
    K = stiffness(system)
    parts = K.numbers if isinstance(K, ElementSum) else (K.data,)
    digest = hashlib.sha256()
    for part in (*parts, system.M.data):
        digest.update(np.ascontiguousarray(part).data)
    versions = {}
    for package in ("casingfem", "numpy", "scipy", "scikit-fem"):
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            versions[package] = "not installed"
    return {"method": method, "modes": count, "dofs": system.size, "matrices": digest.hexdigest(), "versions": versions}
