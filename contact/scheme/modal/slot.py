"""Arrays of a run with one tip for one of eight slots: its rows as sums of waves, and its start."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, readonly
from contact.base.remembered import remembered
from contact.model.gaps.deflection import RimRows, rim_rows
from contact.model.gaps.modal_system import ModalSystem, RowTable, rim_system
from contact.model.trig import Terms
from contact.scheme.modal.rub_stepper import RubStepper


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Slot:
    """Arrays of a run for its slot.

    `memory`: g_n, g_{n-1} of q, force, its drag over it, S_nn, S_nt, S_tt at phi_{n-1}, tangential S lam, heat, work of
    the drive against friction.
    """

    system: ModalSystem
    normal: Terms  # rows of the modes, clearance, S_nn, S_nt and S_tt
    tangent: Terms
    reach: Array  # how far each of the casing's modes moves the rim at most, zero for others
    rim: RimRows
    memory: Array


def slot_of(run: RubStepper) -> Slot:
    """The slot of a run at its start."""
    assert run.rim is not None
    system, s = rim_system(run.rim), run.state
    normal, tangent = system.sums()
    assert system.table is not None
    before = system.angle + system.speed * run.dt
    gaps = _gap(system, system.angle, s.q), _gap(system, before, s.q - s.d)
    S = [part(before) for part in (system.S_nn, system.S_nt, system.S_tt)]
    return Slot(
        system=system, normal=normal, tangent=tangent, reach=_reach(system.table, int(system.first[1])),
        rim=rim_rows(run.rub.casing, run.dimensions, run.rub.flexible),
        memory=np.array([*gaps, 0.0, 0.0, *S, 0.0, 0.0, 0.0]),
    )  # fmt: skip


def _gap(system: ModalSystem, phi: float, q: Array) -> float:
    """Gap of the modal coordinates at an angle."""
    if not q.any():
        return system.clearance(phi)
    assert system.table is not None
    return system.clearance(phi) + float(system.table.rows(phi)[0] @ q)


@remembered
def _reach(table: RowTable, casing: int) -> Array:
    size = table.start.size - 1
    owner = np.repeat(np.arange(size), np.diff(table.start))
    reach = np.bincount(owner, np.hypot(table.q_cos, table.q_sin), minlength=size)
    reach[casing:] = 0.0
    return readonly(reach)


def give_back(run: RubStepper, slot: Slot, q: Array, d: Array, memory: Array) -> None:
    """Copy the end of a slot into its run: motion, the force of the last step and its work."""
    s, (force, pull) = run.state, memory[2:4]
    s.q[:], s.d[:] = q, d
    s.heat[0], s.drive[0] = memory[8:10]
    s.lam[:] = (force, -pull * force)[: run.dimensions]
    s.strain[-1] = memory[7] if run.dimensions > 1 else 0.0
    s.known[0], s.contact[:] = 0, 0.0
    if force > 0.0:
        system = slot.system
        assert system.table is not None
        Q, T = system.table.rows(system.angle - system.speed * (int(run.steps[0]) - 1) * run.dt)
        s.contact[:] = (Q - pull * T) * force
