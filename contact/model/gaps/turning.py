"""The side of a rub that rotates: the casing, or the blades."""

from __future__ import annotations

from contact.base.errors import InputError


def casing_turns(turning: str) -> bool:
    """Whether the casing rotates; raises InputError for a word that is neither "casing" nor "blades".

    >>> casing_turns("casing"), casing_turns("blades")
    (True, False)
    """
    if turning not in ("casing", "blades"):
        raise InputError(f"turning: found {turning!r}, expected casing or blades")
    return turning == "casing"
