"""Reduction of a shell to a modal basis seen from its interface.

Free modes with residual compliance (MacNeal, Computers & Structures 1, 1971, 581): the modes of the supported
shell, and S = P^T K^-1 P - (P^T Phi) Lambda^-1 (Phi^T P) for all that they leave out, P the interface's load
columns. Craig-Bampton (AIAA J. 6, 1968, 1313): static shapes of unit interface displacements and the modes of
the shell held there, diagonalised; exact in statics with S = 0, but the interface then carries mass. Both answer a
static push at the interface exactly as the full model does.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eigh
from scipy.sparse.linalg import LinearOperator, eigsh

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray
from casingfem.linalg.eigen import START_SEED
from casingfem.linalg.factor import Factor, factorise
from casingfem.modal.basis import ModalBasis
from casingfem.modal.interface import Rim, Tip, TipNodes, interface_rows, rim_lines, tip_directions
from casingfem.modal.modes import modes as lowest_modes
from casingfem.modal.output import Output, output_rows
from casingfem.modal.roundness import rim_shape, rim_thickness
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.shell.assembly import assemble, spin
from casingfem.structure.shell.plausible import warn_of
from casingfem.structure.shell.rigid import free_motions
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System

METHODS = ("free", "craig-bampton")


def reduce(
    structure: Shell,
    interface: Rim | Tip | TipNodes,
    *,
    modes: int = 40,
    method: str = "free",
    zeta: float = 0.0,
    recovery: bool = False,
    outputs: Sequence[Output] = (),
    system: System | None = None,
) -> ModalBasis:
    """Reduce a supported shell to `modes` modes seen from an interface.

    Parameters
    ----------
    structure
        The shell, supported.
    interface
        `Rim` of a casing, `Tip` or `TipNodes` of a blade.
    modes
        Free modes kept, or fixed-interface modes beside the static shapes.
    method
        "free" (with residual compliance) or "craig-bampton".
    zeta
        Damping ratio given to every mode.
    recovery
        Also store what recovers all displacements of the shell.
    outputs
        `Displacement` and `Strain` at chosen places, to be had from a run by their names.
    system
        The assembled shell, if there is one already.

    Raises
    ------
    ValueError
        Unknown method, negative damping, an interface the shell does not have, or rigid motions.
    NumericsError
        If the stiffness is singular.
    """
    if method not in METHODS:
        raise ModelError("reduce-method", f"method must be one of {', '.join(METHODS)}, found {method!r}")
    if not 0.0 <= zeta < 1.0:
        raise ModelError("reduce-damping", f"zeta must lie in [0, 1), found {zeta!r}")
    if not any(structure.supports.values()):
        raise ModelError("reduce-rigid", "an unsupported shell has rigid motions")
    warn_of(structure)
    system = system or assemble(structure)
    if not 1 <= modes < system.size // 2:
        raise ModelError("modes-count", f"modes must lie between 1 and {system.size // 2 - 1} here, found {modes!r}")
    rows, channels = interface_rows(system, interface)
    wanted = output_rows(system, tuple(outputs))
    P = load_columns(system, rows)
    if not P.any():
        raise ModelError("interface-held", f"interface: edge {interface.edge!r} is held, nothing can be pushed there")
    factor = factorise(system.K)
    attachment = factor.solve(P)
    if method == "free":
        vectors, omega = free_vectors(system, modes)
    else:
        vectors, omega = craig_bampton_vectors(system, factor, P, attachment, modes)
    at_interface = P.T @ vectors
    S = np.zeros((len(channels), len(channels)))
    if method == "free":
        S = P.T @ attachment - (at_interface / omega**2) @ at_interface.T
        S = 0.5 * (S + S.T)
    stored: dict[str, Array] = {}
    left = attachment - (vectors / omega**2) @ at_interface.T
    if recovery:
        stored = {
            "recovery": system.expand(vectors)[:, :3].reshape(-1, len(omega)),
            "recovery_S": system.expand(left)[:, :3].reshape(-1, len(channels)),
            "recovery_points": system.points,
        }
    if outputs:
        seen = load_columns(system, wanted).T
        stored |= {"output_rows": seen @ vectors, "output_S": seen @ left}
    if structure.rotation is not None:
        stored["K_omega"] = stiffening(structure, vectors)
    return ModalBasis(
        omega=omega,
        zeta=np.full(len(omega), zeta),
        channels=channels,
        outputs=tuple(output.name for output in outputs),
        spin=0.0 if structure.rotation is None else structure.rotation.omega,
        lines=rim_lines(system, interface) if isinstance(interface, Rim) else np.zeros((0, 2)),
        out_of_roundness=rim_shape(structure, interface) if isinstance(interface, Rim) else np.zeros((0, 0)),
        rows=at_interface,
        S=S,
        participation=participation(system, interface, vectors),
        kind="rim" if isinstance(interface, Rim) else "point",
        n_max=interface.n_max if isinstance(interface, Rim) else 0,
        radius=rim_radius(system, interface) if isinstance(interface, Rim) else 0.0,
        thickness=rim_thickness(structure, interface) if isinstance(interface, Rim) else 0.0,
        provenance=provenance(system, method, modes),
        **stored,
    )


def stiffening(structure: Shell, vectors: FloatArray) -> FloatArray:
    """Modal stiffness Phi^T K1 Phi that each (rad/s)^2 adds to a rotating shell, (modes, modes)."""
    assert structure.rotation is not None
    at_rest = assemble(replace(structure, rotation=None))
    added = vectors.T @ (spin(at_rest, structure.rotation).K1 @ vectors)
    return np.asarray(0.5 * (added + added.T))


def participation(system: System, interface: Rim | Tip | TipNodes, vectors: FloatArray) -> FloatArray:
    """Phi^T M e of unit translations e, (3, modes) [sqrt(kg)]: along x, y, z of a casing, span, flap, chord of a blade.

    Its squares are effective masses: over all modes they add up to the mass that moves.
    """
    axes = np.eye(3) if isinstance(interface, Rim) else tip_directions(system, interface)
    shift = np.zeros((len(system.frames), DOFS, 3))
    shift[:, :3] = axes.T
    moved = system.collect(shift, np.zeros((system.own, 3)))
    return np.asarray((system.mass[:, None] * moved).T @ vectors)


def load_columns(system: System, rows: FloatArray) -> FloatArray:
    """Interface rows over nodal fields -> load columns on the free dofs, (free, channels)."""
    return np.asarray(system.restrict(rows.T.reshape(-1, DOFS, len(rows))))


def rim_radius(system: System, rim: Rim) -> float:
    """Mean radius of a rim [m]."""
    return float(np.linalg.norm(system.points[system.grid.edges[rim.edge].nodes, :2], axis=1).mean())


def free_vectors(system: System, count: int) -> tuple[FloatArray, FloatArray]:
    """Mass-normalised modes of the supported shell on its free dofs, and their omega."""
    found = lowest_modes(system.shell, count, method="shell", system=system)
    if found.rigid:
        raise ModelError("reduce-rigid", f"the shell has {found.rigid} rigid motions")
    return system.collect(found.fields, found.own), found.omega


def craig_bampton_vectors(
    system: System, factor: Factor, P: FloatArray, attachment: FloatArray, count: int
) -> tuple[FloatArray, FloatArray]:
    """Diagonalised Craig-Bampton basis: static interface shapes and `count` fixed-interface modes.

    The inverse of K under P^T u = 0 is K^-1 - K^-1 P (P^T K^-1 P)^-1 P^T K^-1; its largest eigenvalues are the
    fixed-interface modes, so one factorisation serves both parts.
    """
    rigid = free_motions(system.shell, system.grid).shape[2]
    if rigid:
        raise ModelError("reduce-rigid", f"the shell has {rigid} rigid motions")
    compliance = P.T @ attachment
    held = cho_factor(0.5 * (compliance + compliance.T))
    root = np.sqrt(system.mass)

    def constrained(x: FloatArray) -> FloatArray:
        loaded = root * np.ravel(x)
        return np.asarray(root * (factor.solve(loaded) - attachment @ cho_solve(held, attachment.T @ loaded)))

    start = constrained(np.random.default_rng(START_SEED).standard_normal(system.size))
    operator = LinearOperator((system.size, system.size), matvec=constrained, dtype=float)
    _, inner = eigsh(operator, count, which="LM", v0=start)
    static = cho_solve(held, attachment.T).T
    V = np.hstack([static, inner / root[:, None]])
    V /= np.sqrt(np.einsum("ij,i,ij->j", V, system.mass, V))
    K, M = V.T @ (system.K @ V), V.T @ (system.mass[:, None] * V)
    values, turn = eigh(0.5 * (K + K.T), 0.5 * (M + M.T))
    return V @ turn, np.sqrt(values)


def provenance(system: System, method: str, count: int) -> dict[str, object]:
    """Method, package versions, and a hash of the matrices the basis was made from."""
    digest = hashlib.sha256(system.K.data.tobytes() + system.mass.tobytes()).hexdigest()
    versions = {}
    for package in ("casingfem", "numpy", "scipy", "scikit-fem"):
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            versions[package] = "not installed"
    return {"method": method, "modes": count, "dofs": system.size, "matrices": digest, "versions": versions}
