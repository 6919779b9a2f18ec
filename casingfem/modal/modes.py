"""Modes of a structure: `modes(shell, count)` or `modes(shell, band=(f0, f1))`."""

import time
from typing import overload

import numpy as np

from casingfem.errors import ModelError, warn
from casingfem.linalg.cost import require_affordable
from casingfem.linalg.eigen import Band, solve, sturm_count
from casingfem.linalg.factor import Direct
from casingfem.modal.fourier import SHIFT, fourier_band, fourier_modes
from casingfem.modal.mesh_modes import MeshModes, mesh_modes
from casingfem.modal.mode_set import Modes, ModeSet, frequency_scale, labelled
from casingfem.modal.resolution import checked_resolution
from casingfem.modal.ritz import RitzModes, ritz_modes
from casingfem.modal.stable import require_stable
from casingfem.structure.imported.assembly import MeshStructure, MeshSystem, require_structure
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.plausible import extent, warn_of
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System

__all__ = ["MeshModes", "ModeSet", "Modes", "count_below", "modes"]

COUNT = 40
HIGHEST = 1e15  # Hz: beyond, its square leaves the range of what is counted


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

    K phi = omega^2 M phi, phi^T M phi = 1. A rotating shell has the stiffness of its speed; Coriolis forces
    are left to `whirl_modes`.

    Parameters
    ----------
    shell
        The structure: a shell on a chart, an imported `Solid` or `MeshShell`, or any `MeshStructure`. Without supports
        the rigid motions come first and are marked as such.
    count
        Number of modes; 40 where no band is given either.
    band
        Lower and upper frequency [Hz], instead of a count. A mode on an end belongs to it, and so does its double.
    method
        "shell": the two-dimensional model. "fourier": one meridian problem per n, for perfect casings.
        "auto": "fourier" where nothing varies around, else "shell". Imported structures take "auto" alone.
    system
        The assembled structure, if there is one already.
    direct
        The factorisation: "multifrontal", "superlu", or "pardiso" if pypardiso is installed.

    Raises
    ------
    ValueError
        Unknown method, count below 1, or "fourier" asked of a casing that is not axisymmetric.
    ModelError
        `rotation-unstable` where a rotating shell softens more than it is held.
    NumericsError
        If the modes cannot be computed or certified.

    Examples
    --------
    >>> from casingfem.structure.geometry.chart import Frustum
    >>> from casingfem.structure.material import Material
    >>> from casingfem.structure.edge.support import Clamped
    >>> casing = Shell(chart=Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3,
    ...                material=Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": Clamped()})
    >>> low = modes(casing, 4)
    >>> low.freq.round(1).tolist(), low.nodal_diameters.tolist()
    ([367.9, 367.9, 382.8, 382.8], [8, 8, 7, 7])
    >>> modes(casing, band=(380.0, 420.0)).nodal_diameters.tolist()
    [7, 7, 9, 9]
    """
    wanted = count_or_band(count, band)
    if not isinstance(shell, Shell):
        require_structure(shell, "modes")
        if method != "auto":
            raise ValueError(f'method must be "auto" for an imported structure, found {method!r}')
        return mesh_modes(shell, wanted, system=system if isinstance(system, MeshSystem) else None, direct=direct)
    if method not in ("auto", "shell", "fourier"):
        raise ModelError("modes-method", f'method must be "auto", "shell" or "fourier", found {method!r}')
    warn_of(shell)
    if method == "fourier" or (method == "auto" and shell.axisymmetric and system is None):
        mesh = shell.mesh
        nodes = mesh.order * mesh.around * (mesh.order * (len(mesh.breaks) - 1) + 1)
        require_affordable(plate_count(shell, wanted), DOFS * nodes)
        found_by_n = fourier_modes(shell, wanted) if isinstance(wanted, int) else fourier_band(shell, wanted)
        return checked_resolution(found_by_n, around=False)
    started = time.perf_counter()
    system = system if isinstance(system, System) else assemble(shell)
    assembled = time.perf_counter()
    found = solve(system.stiffness, system.mass, wanted, shift=-((SHIFT * frequency_scale(shell)) ** 2), direct=direct)
    if shell.rotation is not None:
        require_stable(system.stiffness, found)
    if shell.rotation is None:
        ritz = ritz_modes(system, found.vectors)
    else:  # prestress is assembled, and no sum of squares
        ritz = RitzModes(found.freq, system.expand(found.vectors), system.expand_own(found.vectors))
    solved = time.perf_counter()
    named = labelled(
        shell,
        system.grid,
        ritz.freq,
        ritz.fields,
        count=wanted if isinstance(wanted, int) else len(found.eigenvalues),
        sturm=found.sturm_count,
        dofs=system.size,
        own=ritz.own,
        seconds={"assemble": assembled - started, "solve": solved - assembled},
    )
    warn_of_surveys(named)
    return checked_resolution(named)


def warn_of_surveys(found: Modes) -> None:
    """Warn where modes have more nodal diameters than a survey can split: cos 2n theta beyond its resolution."""
    n = int(found.nodal_diameters.max(initial=0))
    for quantity, field in found.shell.defects.items():
        resolved = getattr(field, "n_resolved", None)
        if resolved is not None and 2 * n > resolved:
            message = f"modes to n = {n} split by harmonic {2 * n}; the survey of the {quantity} resolves {resolved}"
            warn("field-resolution", message, stacklevel=4)


def count_or_band(count: int | None, band: Band | None) -> int | Band:
    """What is asked for, checked; 40 modes if nothing is said."""
    if count is not None and band is not None:
        raise ModelError("modes-band", "found both a count of modes and a band")
    if band is not None and not 0.0 <= band[0] < band[1] < HIGHEST:
        raise ModelError("modes-band", f"the band runs from {band[0]!r} to {band[1]!r} Hz")
    if count is not None and count < 1:
        raise ModelError("modes-count", f"count must be at least 1, found {count}")
    return band or count or COUNT


def plate_count(shell: Shell, wanted: int | Band) -> float:
    """How many modes are wanted: those of a band by the modal density of a plate, sqrt(3) area/(c t) a hertz."""
    if isinstance(wanted, int):
        return float(wanted)
    size, steel = extent(shell), shell.material
    c = float(np.sqrt(np.real(steel.E / (steel.rho * (1.0 - steel.nu**2)))))
    return float(np.sqrt(3.0) * size.sides.prod() * (wanted[1] - wanted[0]) / (c * size.thickness.min()))


def count_below(structure: Shell | MeshStructure, freq: float, system: System | None = None) -> int:
    """Number of modes below a frequency [Hz], by one factorisation and its inertia; `system` is the assembled shell."""
    if not freq < HIGHEST:
        raise ModelError("modes-band", f"modes below {freq!r} Hz were to be counted")
    place = (2.0 * np.pi * freq) ** 2
    if isinstance(structure, Shell):
        shell = system or assemble(structure)
        return sturm_count(shell.stiffness, shell.mass, place)
    mesh = structure.assembled()
    return sturm_count(mesh.K, mesh.M, place)
