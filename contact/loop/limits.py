"""Whether a rim or a tip has moved too far; checked during the run, so that a diverging run ends early."""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit_inside
from contact.model.gaps.limits import REACHED, RIM, TIP


@jit_inside
def tip_motion(limits: Array, moved: float) -> None:
    """Record how far a tip has moved against the rim."""
    limits[REACHED + TIP] = max(limits[REACHED + TIP], abs(moved))


@jit_inside
def outgrown(limits: Array) -> bool:
    """Whether rim or tip moved too far, which ends a diverging run; NaN is found from the energies (`run`)."""
    return not (limits[REACHED + RIM] <= limits[RIM] and limits[REACHED + TIP] <= limits[TIP])
