"""Flag for friction forces that double precision leaves inexact; a separate module, since the solver compiles."""

from __future__ import annotations

from contact.io.trust import LEFT, MUCH_LEFT, Flag


def inexact(left: float) -> tuple[Flag, ...]:
    """Flag if forces leave an error above LEFT of a contact's free motion."""
    if left <= LEFT:
        return ()
    words = (
        f"forces leave {left:.1e} of a contact's motion in a step: contacts are coupled so closely, W conditioned to "
        "about 1e10 and more, that double precision does no better; let contacts yield (S), or leave some out"
    )
    return (Flag(words, "unconverged", failed=left > MUCH_LEFT),)
