"""Whether a rim or a tip before it has moved too far: looked at in passing, so that a run that diverges ends there."""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit_inside
from contact.model.gaps.limits import REACHED, RIM, TIP


@jit_inside
def tip_motion(limits: Array, moved: float) -> None:
    """Note how far a tip has moved against the rim."""
    limits[REACHED + TIP] = max(limits[REACHED + TIP], abs(moved))


@jit_inside
def outgrown(limits: Array) -> bool:
    """Whether rim or tip moved too far, which ends a run that diverges; NaN is found by the energies (`run`)."""
    return not (limits[REACHED + RIM] <= limits[RIM] and limits[REACHED + TIP] <= limits[TIP])
