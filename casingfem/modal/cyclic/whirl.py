"""Waves on a rotating wheel with Coriolis forces: the two members of a pair split into forward and backward."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csc_array

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray, IntArray, frozen
from casingfem.modal.cyclic.modes import checked_diameters
from casingfem.modal.whirl import expand_complex, freq_at_rest, gyroscopic_modes
from casingfem.structure.imported.cyclic.sector import CyclicSector, assemble_cyclic
from contact.io.columns import Column, records_of, table_lines

SENSES = {1: "forward", -1: "backward", 0: "single"}
COLUMNS = (
    Column("n", "Nodal diameters.", lambda found: found.nodal_diameters, format="d"),
    Column("sense", "1 for a wave that runs with the rotation, -1 for one against it, 0 for a single mode.",
           lambda found: found.sense, head="wave", format=SENSES.__getitem__),
    Column("freq_hz", "Frequency for an observer who turns with the wheel.", lambda found: found.freq,
           head="turning", unit="Hz", format=".3f"),
    Column("freq_fixed_hz", "Frequency for an observer at rest.", lambda found: found.freq_fixed, head="at rest",
           unit="Hz", format=".3f"),
)  # fmt: skip


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class CyclicWhirl:
    """Modes of a rotating wheel with Coriolis forces, by nodal diameter, sense, and frequency.

    Attributes
    ----------
    sector
        The wheel.
    freq
        Frequencies in the rotating frame [Hz], (modes,).
    nodal_diameters
        n, (modes,).
    sense
        1 for a wave that travels with the rotation, -1 for one against it, 0 for n = 0 and N/2, (modes,).
    fields
        Complex shapes of sector 0, largest displacement 1, (nodes, 3 or 5, modes): in the axes of sector j the motion
        is the real part of shape times e^(i omega t -+ 2 pi i n j/N).

    Examples
    --------
    >>> import casingfem as cf
    >>> wall = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.12)
    >>> part = cf.imported.grid_mesh("hexahedron20", (1, 3, 1), lambda u: wall(u * [1.0, 0.125, 1.0]),
    ...                              groups={"base": (2, 0.0), "top": (2, 1.0)})
    >>> held = cf.Solid(mesh=part, material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()},
    ...                 rotation=cf.Rotation(omega=300.0))
    >>> sector = cf.imported.CyclicSector(structure=held, sectors=8)
    >>> found = cf.modal.cyclic_whirl(sector, 1, diameters=[1])
    >>> (found.freq_fixed() if callable(found.freq_fixed) else found.freq_fixed).shape
    (2,)
    """

    sector: CyclicSector
    freq: FloatArray
    nodal_diameters: IntArray
    sense: IntArray
    fields: Array

    def __len__(self) -> int:
        """Return the number of modes."""
        return len(self.freq)

    @property
    def freq_fixed(self) -> FloatArray:
        """Frequencies [Hz] of the waves in the fixed frame: |f + sense n Omega/2 pi|, (modes,)."""
        return freq_at_rest(self.freq, self.sense * self.nodal_diameters, self.sector.structure.rotation)

    def records(self) -> list[dict[str, Any]]:
        """One plain dictionary for each mode: n, sense, freq_hz in the rotating frame, freq_fixed_hz."""
        return records_of(COLUMNS, self)

    def __repr__(self) -> str:
        """The columns as a table."""
        return "\n".join(table_lines(COLUMNS, self.records()))


def cyclic_whirl(sector: CyclicSector, count: int = 6, *, diameters: Sequence[int] | None = None) -> CyclicWhirl:
    """Lowest `count` modes of each nodal diameter and sense, complete by a count of inertia.

    M x'' + Omega G x' + K(Omega) x = 0 with the matrices of n for a wave against the sense of the axis, and their
    conjugates for one with it.

    Raises
    ------
    ModelError
        `rotation-none` for a sector at rest, `rotation-unstable` if K(Omega) is not positive definite.
    NumericsError
        If the modes cannot be computed or verified.

    Examples
    --------
    >>> import casingfem as cf
    >>> wall = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.12)
    >>> part = cf.imported.grid_mesh("hexahedron20", (1, 3, 1), lambda u: wall(u * [1.0, 0.125, 1.0]),
    ...                              groups={"base": (2, 0.0), "top": (2, 1.0)})
    >>> held = cf.Solid(mesh=part, material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()},
    ...                 rotation=cf.Rotation(omega=300.0))
    >>> sector = cf.imported.CyclicSector(structure=held, sectors=8)
    >>> found = cyclic_whirl(sector, 1, diameters=[1])
    >>> found.sense.tolist()
    [-1, 1]
    """
    chosen = checked_diameters(sector, diameters)
    system, rotation = assemble_cyclic(sector), sector.structure.rotation
    if rotation is None or system.spin is None:
        raise ModelError("rotation-none", "cyclic_whirl: found a wheel without rotation, expected one with")
    axis = np.asarray(sector.axis) / np.linalg.norm(sector.axis)
    turning = int(np.sign(rotation.omega * (rotation.direction @ axis)))
    freq, fields, labels = [], [], []
    for n in chosen:
        K, M, T = system.matrices(n)
        G = csc_array(rotation.omega * (T.conj().T @ system.spin.G @ T))
        G = csc_array(0.5 * (G - G.conj().T))
        waves = [(1, True), (-1, False)] if sector.count(n) == 2 else [(0, False)]
        for sense, against in sorted((sense * turning, against) for sense, against in waves):
            own = [csc_array(A.conj()) if against else A for A in (K, G, M, T)]
            omega, vectors, _ = gyroscopic_modes(own[0], own[1], count, scale=system.frequency_scale, mass=own[2])
            freq.append(omega[:count] / (2.0 * np.pi))
            fields.append(expand_complex(system.system, own[3] @ vectors[:, :count]))
            labels += [(n, sense)] * len(freq[-1])
    return CyclicWhirl(
        sector=sector,
        freq=frozen(np.concatenate(freq)),
        nodal_diameters=frozen(np.array([n for n, _ in labels])),
        sense=frozen(np.array([sense for _, sense in labels])),
        fields=frozen(np.concatenate(fields, axis=2)),
    )
