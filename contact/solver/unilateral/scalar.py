"""The one-step problem of one contact: find force >= 0 with H force + gap >= 0, complementary.

H is the Delassus number Q c W: the gap that a unit force opens within a step. Friction makes it
nonsymmetric (W = Q - mu s T) and, for a digging blade, negative: then no force opens the gap, the contact is
jammed, and the step has no solution.
"""

from __future__ import annotations

from contact.jit.compiled import jit_inside

JAMMED = -1.0


@jit_inside
def scalar_force(H: float, gap: float) -> float:
    """Force of one closed contact, -gap/H; JAMMED where H <= 0. Call only when gap < 0."""
    if H > 0.0:
        return -gap / H
    return JAMMED
