"""Track each mode from one step of an update to the next by its shape, not by its number.

Modes of similar structures correspond if their shapes span the same space: the modes for a row of the table are those
with the largest share in the plane of its previous modes,

    share of mode j in the plane of (a, b) = (phi_a^T M phi_j)^2 + (phi_b^T M phi_j)^2,

doublets as planes, assigned all at once. A mode with a share below a third is lost; where two modes mix, the share is a
half.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import chain

import numpy as np

from casingfem.experiment.correlation.matches import Match, Pairing
from casingfem.experiment.correlation.pairing import member_of
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray
from casingfem.linalg.assignment import assignment
from casingfem.modal.mesh_modes import MeshModes
from casingfem.modal.mode_set import Modes, ModeSet
from casingfem.structure.imported.cells.mapped import mapped_parts
from casingfem.structure.shell.nodal_mass import nodal_mass

LOST = 1.0 / 3.0


class LostModeError(ValueError):
    """A step was so long that a mode of the table was lost; `rows` are its rows in the table, counted from 0."""

    def __init__(self, rows: tuple[int, ...], share: float) -> None:
        names = "row " + str(rows[0] + 1) if len(rows) == 1 else "rows " + " and ".join(str(row + 1) for row in rows)
        super().__init__(
            f"{names} of the table: the mode could not be followed in a step; the most similar new mode has a MAC of"
            f" {share:.2f}, expected {LOST:.2f} or more; check imperfections and start values, or narrow the bounds"
        )
        self.rows = rows


def overlaps(old: Modes | MeshModes, new: Modes | MeshModes) -> FloatArray:
    """(phi_i^T M phi_j)^2 of old and new modes over their norms, (old, new); for imported parts by displacements."""
    weigh: Callable[[FloatArray], FloatArray]
    if isinstance(old, MeshModes):
        inertia = np.zeros((old.fields.shape[0], old.fields.shape[1]))
        inertia[:, :3] = nodal_inertia(old)[:, None]
        weigh = partial(np.multiply, inertia[:, :, None])
    else:
        weigh = nodal_mass(old.shell, old.grid).times
    before, after = (modes.fields.reshape(-1, len(modes)) for modes in (old, new))
    measured, weighted = (weigh(modes.fields).reshape(-1, len(modes)) for modes in (old, new))
    norms = np.sqrt(np.outer(np.sum(before * measured, axis=0), np.sum(after * weighted, axis=0)))
    return np.asarray((before.T @ weighted / norms) ** 2)


def nodal_inertia(modes: MeshModes) -> FloatArray:
    """Mass of each node for comparing shapes, (nodes,): the mass of every cell is divided equally among its nodes."""
    mesh = modes.structure.mesh
    density = modes.structure.density()
    total = np.zeros(len(mesh.points))
    for rows, nodes, on in mapped_parts(mesh):
        np.add.at(total, nodes, (on.measure.sum(axis=1) * density[rows] / nodes.shape[1])[:, None])
    return total


def followed(pairing: Pairing, old: Modes | MeshModes, new: Modes | MeshModes, table: FrequencyTable) -> Pairing:
    """Transfer the pairing of old modes with rows to new modes.

    Raises
    ------
    LostModeError
        If a mode with a row is not found again.
    """
    share = overlaps(old, new)
    planes = [plane_of(match, old, pairing) for match in pairing.matches]
    wanted = [(k, share[list(plane)].sum(axis=0)) for k, plane in enumerate(planes) for _ in pairing.matches[k].modes]
    profit = np.array([row for _, row in wanted])
    profit = np.pad(profit, ((0, 0), (0, max(len(profit) - len(new), 0))))  # fewer modes than rows: some are lost
    places, found = assignment(-profit)
    of: dict[int, list[int]] = {}
    for place, mode in zip(places.tolist(), found.tolist(), strict=True):
        match = wanted[place][0]
        if profit[place, mode] < LOST:
            raise LostModeError(pairing.matches[match].rows, float(profit[place, mode]))
        of.setdefault(match, []).append(mode)
    matches = tuple(
        moved(match, sorted(of[k]), len(planes[k]) > len(match.modes), new, table)
        for k, match in enumerate(pairing.matches)
    )
    taken = set(chain.from_iterable(match.modes for match in matches))
    rest = tuple(mode for mode in range(len(new)) if mode not in taken)
    return replace(pairing, matches=matches, unpaired_modes=rest)


def plane_of(match: Match, modes: ModeSet, pairing: Pairing) -> tuple[int, ...]:
    """Modes of a match; for one member of a doublet both members, if the other has no row of its own."""
    if len(match.modes) == 2:
        return match.modes
    whole = next((pair for pair in modes.doublets if match.modes[0] in pair), match.modes)
    return whole if all(mode in match.modes or mode in pairing.unpaired_modes for mode in whole) else match.modes


def moved(match: Match, modes: list[int], whole: bool, new: ModeSet, table: FrequencyTable) -> Match:
    """A match transferred to other modes; for one member of a doublet, the member that its row represents."""
    if whole:
        pair = next((pair for pair in new.doublets if modes[0] in pair), (modes[0],))
        modes = [member_of(pair, new, table, match.rows[0]) if len(pair) == 2 else pair[0]]
    return replace(match, modes=tuple(modes), computed_hz=tuple(float(new.freq[mode]) for mode in modes))


def paired_rows(pairing: Pairing) -> tuple[tuple[int, ...], ...]:
    """Rows of the table that pair with modes, and their groups."""
    return tuple(sorted(match.rows for match in pairing.matches))
