"""What is said of friction forces that double precision leaves inexact; beside the solver, which compiles."""

from __future__ import annotations

LEFT = 1e-6  # of a contact's free motion: a larger error is told


def inexact(left: float) -> str:
    """What to say of forces that leave so much of a contact's free motion; nothing up to LEFT."""
    if left <= LEFT:
        return ""
    return (
        f"forces leave {left:.1e} of a contact's motion in a step: contacts are coupled so closely, W conditioned to "
        "about 1e10 and more, that double precision does no better; let contacts yield (S), or leave some out"
    )
