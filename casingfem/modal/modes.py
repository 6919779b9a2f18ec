"""Modes of a shell: `modes(shell, count)`."""

import time
from typing import overload

import numpy as np

from casingfem.errors import ModelError
from casingfem.modal.eigen import solve_modes, sturm_count
from casingfem.modal.fourier import SHIFT, fourier_modes
from casingfem.modal.mesh_modes import IMPORTED, MeshModes, mesh_modes
from casingfem.modal.mode_set import Modes, ModeSet, frequency_scale, labelled
from casingfem.structure.assembly import System, assemble
from casingfem.structure.mesh_assembly import MeshSystem
from casingfem.structure.shell import Shell
from casingfem.structure.solid import Solid

__all__ = ["MeshModes", "ModeSet", "Modes", "count_below", "modes"]


@overload
def modes(shell: Shell, count: int = 40, *, method: str = "auto", system: System | None = None) -> Modes: ...
@overload
def modes(shell: Solid, count: int = 40, *, method: str = "auto", system: MeshSystem | None = None) -> MeshModes: ...
def modes(
    shell: Shell | Solid, count: int = 40, *, method: str = "auto", system: System | MeshSystem | None = None
) -> ModeSet:
    """Lowest `count` modes of a structure, labelled, complete by a Sturm count.

    K phi = omega^2 M phi, phi^T M phi = 1.

    Parameters
    ----------
    shell
        The structure: a shell on a chart, or an imported `Solid`. Without supports the rigid motions come first and
        are marked as such.
    count
        Number of modes.
    method
        "shell": the two-dimensional model. "fourier": one meridian problem per n, for perfect casings.
        "auto": "fourier" where nothing varies around, else "shell". Imported structures take "auto" alone.
    system
        The assembled structure, if there is one already.

    Raises
    ------
    ValueError
        Unknown method, count below 1, or "fourier" asked of a casing that is not axisymmetric.
    EigenError
        If the modes cannot be computed or certified.

    Examples
    --------
    >>> from casingfem.structure.chart import Frustum
    >>> from casingfem.structure.material import Material
    >>> from casingfem.structure.support import Clamped
    >>> casing = Shell(chart=Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3,
    ...                material=Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": Clamped()})
    >>> low = modes(casing, 4)
    >>> low.freq.round(1).tolist(), low.nodal_diameters.tolist()
    ([367.9, 367.9, 382.8, 382.8], [8, 8, 7, 7])
    """
    if isinstance(shell, IMPORTED):
        if method != "auto":
            raise ValueError(f'method must be "auto" for an imported structure, found {method!r}')
        return mesh_modes(shell, count, system=system if isinstance(system, MeshSystem) else None)
    if method not in ("auto", "shell", "fourier"):
        raise ModelError("modes-method", f'method must be "auto", "shell" or "fourier", found {method!r}')
    if count < 1:
        raise ModelError("modes-count", f"count must be at least 1, found {count}")
    if method == "fourier" or (method == "auto" and shell.axisymmetric and system is None):
        return fourier_modes(shell, count)
    started = time.perf_counter()
    system = system if isinstance(system, System) else assemble(shell)
    assembled = time.perf_counter()
    shift = -((SHIFT * frequency_scale(shell)) ** 2)
    found = solve_modes(system.K, system.mass, count, shift=shift)
    solved = time.perf_counter()
    freq = np.sqrt(np.maximum(found.eigenvalues, 0.0)) / (2.0 * np.pi)
    fields = system.expand(found.vectors)
    return labelled(
        shell,
        system.grid,
        freq,
        fields,
        count=count,
        sturm=found.sturm_count,
        dofs=system.size,
        seconds={"assemble": assembled - started, "solve": solved - assembled},
    )


def count_below(shell: Shell, freq: float) -> int:
    """Number of modes below a frequency [Hz], by one factorisation and its inertia."""
    system = assemble(shell)
    return sturm_count(system.K, system.mass, (2.0 * np.pi * freq) ** 2)
