"""Contact targets of the rotating beam, its flexible ring and the disc on the ground."""

from __future__ import annotations

import math
from dataclasses import replace

import contact as ct
from reports.tables import Row
from reports.verification.schemes import hertz
from reports.verification.schemes.rotating_beam import BEAM, CIRCLE, EXPLICIT, RING, row_of, run
from reports.verification.schemes.targets.rods import target


def rows(quick: bool) -> list[Row]:
    """All lines; `quick` uses coarser beams and omits the ring and the fine disc."""
    lines = [*_beam(10 if quick else 20), *_disc(0.2 if quick else 0.1)]
    return lines if quick else [*lines, *_ring()]


def _beam(elements: int) -> list[Row]:
    scene = replace(CIRCLE, beam=replace(BEAM, elements=elements))
    found = row_of("", scene, run(scene, EXPLICIT, 1.4 * scene.first_contact_time, courant=0.5))
    energy = run(scene, EXPLICIT, 0.95 * scene.first_contact_time, courant=0.1).result.energy
    work = energy.start.potential - energy.end.potential
    head = f"rotating beam, {elements} elements"
    return [
        target(f"{head}: first contact, time", 0.003, 0.01 * abs(float(str(found["first contact %"])))),
        target(f"{head}: first contact, angle", 0.003, 0.01 * abs(float(str(found["its angle %"])))),
        target(f"{head}: penetration [m]", 0.0, float(str(found["penetration [m]"]))),
        target(f"{head}: T + U = W before contact", 1e-6, abs(energy.end.total - energy.start.total) / work),
        target(f"{head}: angular momentum", 1e-8, float(str(found["ang. momentum"]))),
        target(f"{head}: ledger unaccounted", 1e-10, float(str(found["unaccounted"]))),
    ]


def _impulse(ring: ct.ModalBody | None) -> float:
    scene = replace(CIRCLE, beam=replace(BEAM, elements=20), ring=ring)
    return float(run(scene, EXPLICIT, 1.2 * CIRCLE.first_contact_time, courant=0.5).result.impulse.sum())


def _ring() -> list[Row]:
    rigid, modal, elements = (
        _impulse(r) for r in (None, ct.bodies.ring_modes(RING, 20), ct.bodies.ring_elements(RING, 60, 20))
    )
    stiff = _impulse(ct.bodies.ring_modes(replace(RING, E=1e6 * RING.E, k_r=1e6 * RING.k_r, k_t=1e6 * RING.k_t), 20))
    return [
        target("flexible ring: modes against finite elements, impulse", 0.01, abs(elements / modal - 1.0)),
        target("flexible ring: 1e6 times as stiff against rigid, impulse", 0.01, abs(stiff / rigid - 1.0)),
    ]


def _disc(part: float) -> list[Row]:
    row, _, _ = hertz.case(part)
    error = float(str(row["pressure L2 %"]))
    head = f"disc on the ground, cells of {part:g} half widths"
    return [
        target(f"{head}: pressure against Hertz, L2", 0.05, 0.01 * error if math.isfinite(error) else math.inf),
        target(f"{head}: sum of forces against P", 1e-6, abs(float(str(row["sum of forces/P"])) - 1.0)),
    ]
