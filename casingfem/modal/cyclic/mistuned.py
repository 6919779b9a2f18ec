"""Modes of a wheel with different blades: a basis of tuned waves, with the exact stiffness of the blades.

Blade j with relative frequency deviation delta_j has (1 + delta_j)^2 times the stiffness of the tuned one. In the waves
of the tuned wheel the stiffness is diag(omega^2) + sum_j ((1 + delta_j)^2 - 1) V_j^T K_b V_j, the mass one (subset of
nominal modes: M.-T. Yang & J. H. Griffin, J. Eng. Gas Turbines Power 123, 2001, 893).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import eigh

from casingfem.errors import ModelError, NumericsError
from casingfem.io.arrays import FloatArray, IntArray, frozen
from casingfem.modal.cyclic.waves import Waves, wheel_waves
from casingfem.structure.imported.cyclic.sector import CyclicSector, assemble_cyclic
from casingfem.structure.imported.cyclic.wheel import blade_stiffness
from contact.io.columns import Column, records_of, table_lines

Deviations = Sequence[float] | FloatArray
COLUMNS = (
    Column("mode", "Number of the mode, from 1.", lambda found: range(1, 1 + len(found)), format="d"),
    Column("freq_hz", "Natural frequency.", lambda found: found.freq, head="freq", unit="Hz", format=".3f"),
    Column("n", "Nodal diameters with the largest share of the mode.", lambda found: found.nodal_diameters, format="d"),
    Column("n_share", "Share of these nodal diameters.", lambda found: found.content.max(axis=1), head="share of n",
           format=".2f"),
    Column("blade", "Blade with the largest share of the elastic energy, from 1.",
           lambda found: found.energy.argmax(axis=1) + 1, format="d"),
    Column("localisation", "Largest share of one blade over the mean share.", lambda found: found.localisation,
           format=".2f"),
)  # fmt: skip


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class MistunedModes:
    """Modes of a mistuned wheel, ascending.

    Attributes
    ----------
    freq
        Frequencies [Hz], (modes,).
    content
        Share of each nodal diameter 0 .. N/2 in a mode's mass, (modes, diameters).
    energy
        Share of each blade in the elastic energy of all blades, (modes, blades).

    Examples
    --------
    >>> import numpy as np
    >>> content = np.array([[0.9, 0.1], [0.2, 0.8]])
    >>> found = MistunedModes(freq=np.array([100.0, 101.0]), content=content, energy=np.full((2, 2), 0.5))
    >>> found.nodal_diameters.tolist()
    [0, 1]
    """

    freq: FloatArray
    content: FloatArray
    energy: FloatArray

    def __len__(self) -> int:
        """Return the number of modes."""
        return len(self.freq)

    @property
    def nodal_diameters(self) -> IntArray:
        """The diameter with the largest share, (modes,)."""
        return np.asarray(self.content.argmax(axis=1))

    @property
    def localisation(self) -> FloatArray:
        """Largest energy share of one blade over the mean share, (modes,).

        1 to 2 for tuned pairs, N for a single blade.
        """
        return np.asarray(self.energy.max(axis=1) * self.energy.shape[1])

    def records(self) -> list[dict[str, Any]]:
        """One plain dictionary for each mode: mode, freq_hz, n, n_share, blade (from 1), localisation."""
        return records_of(COLUMNS, self)

    def __repr__(self) -> str:
        """The columns as a table."""
        return "\n".join(table_lines(COLUMNS, self.records()))


def mistuned_modes(
    sector: CyclicSector, deviations: Deviations, count: int = 6, *, blade: str | None = None, families: int = 0
) -> MistunedModes:
    """Modes of a wheel with mistuned blades.

    `count` times the number of sectors, like `count` tuned modes of each diameter.

    Parameters
    ----------
    deviations
        Relative deviation of each blade's own frequency, (sectors,); sector 0 is that of the mesh.
    blade
        Group of the cells whose stiffness deviates; by default the whole sector.
    families
        Tuned modes of each diameter in the basis; by default twice `count` plus two.

    Raises
    ------
    ModelError
        `cyclic-mistuning` unless there is one deviation above -1 for each sector.

    Examples
    --------
    >>> import casingfem as cf
    >>> wall = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.12)
    >>> part = cf.imported.grid_mesh("hexahedron20", (1, 3, 1), lambda u: wall(u * [1.0, 0.125, 1.0]),
    ...                              groups={"base": (2, 0.0), "top": (2, 1.0)})
    >>> held = cf.Solid(mesh=part, material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()})
    >>> sector = cf.imported.CyclicSector(structure=held, sectors=8)
    >>> found = mistuned_modes(sector, [0.01, -0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 1)
    >>> found.freq.size, found.energy.shape
    (8, (8, 8))
    """
    values = checked_deviations(deviations, sector.sectors)
    system = assemble_cyclic(sector)
    stiff = blade_stiffness(sector.structure, system.system, blade)
    waves = wheel_waves(system, families or richer(count), None, stiff)
    omega, turn = mixed(waves, values)
    kept = slice(count * sector.sectors)
    turn = turn[:, kept]
    energy = np.stack([np.einsum("dk,dk->k", turn, waves.blade_energy(j) @ turn) for j in range(sector.sectors)])
    content = np.stack([(turn[waves.n == n] ** 2).sum(axis=0) for n in sector.diameters])
    return MistunedModes(
        freq=frozen(omega[kept] / (2.0 * np.pi)),
        content=frozen(content.T),
        energy=frozen((energy / energy.sum(axis=0)).T),
    )


def richer(count: int) -> int:
    """Number of tuned modes of each diameter in the basis for a given number of mistuned modes."""
    return 2 * count + 2


def mixed(waves: Waves, deviations: FloatArray | None) -> tuple[FloatArray, FloatArray]:
    """Frequencies [rad/s] and modes (D, D) in the waves of a wheel with deviating blades, ascending, tuned modes first.

    Raises
    ------
    NumericsError
        If the remaining stiffness of a mode is negative.
    """
    if deviations is None:
        order = np.lexsort((waves.omega, ~waves.modes))
        return waves.omega[order], np.eye(len(order))[:, order]
    stiffness = np.diag(waves.omega**2)
    for j, deviation in enumerate(deviations):
        if deviation:
            stiffness += ((1.0 + deviation) ** 2 - 1.0) * waves.blade_energy(j)
    squares, turn = eigh(0.5 * (stiffness + stiffness.T))
    if squares[0] < 0.0:
        found = f"found omega^2 = {squares[0]:.4g} rad^2/s^2, expected 0 or more"
        raise NumericsError(f"mistuned wheel: {found}: the wheel is unstable at this speed")
    return np.sqrt(squares), turn


def checked_deviations(deviations: Deviations, sectors: int) -> FloatArray:
    """Check deviations (sectors,), which must be above -1."""
    values = np.asarray(deviations, dtype=float)
    if values.shape != (sectors,) or not np.all(np.isfinite(values)) or values.min() <= -1.0:
        found = f"{values.size} values" if values.shape != (sectors,) else f"{values.min():g}"
        raise ModelError("cyclic-mistuning", f"cyclic.mistuning: found {found}, expected {sectors}, each above -1")
    return values
