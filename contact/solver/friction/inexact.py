"""Flag for friction forces that double precision leaves inexact; a separate module, since the solver compiles."""

from __future__ import annotations

from contact.io.trust import LEFT, MUCH_LEFT, Flag


def inexact(left: float) -> tuple[Flag, ...]:
    """Flag if forces leave an error above LEFT of a contact's free motion."""
    if left <= LEFT:
        return ()
    words = (
        f"the contact forces have an error of {left:.1e} of a contact's free motion in a step, expected at most "
        f"{LEFT:g}: the contacts are nearly dependent, so that W is ill-conditioned; give them a compliance (S), or "
        "remove some"
    )
    return (Flag(words, "unconverged", failed=left > MUCH_LEFT),)
