"""Check the fields of a value against the ranges that their keys state."""

from __future__ import annotations

from typing import Any, get_args

from contact.base.arrays import require_count, require_finite, require_not_negative, require_positive
from contact.base.errors import InputError
from contact.io.keys import keyed

REQUIRE = {
    "any": require_finite, "turn": require_finite, "positive": require_positive, "not negative": require_not_negative,
    "ratio": require_not_negative, "length": require_positive, "place": require_finite, "lean": require_finite,
    "poisson": require_finite,
}  # fmt: skip


def require_keyed(value: object) -> None:
    """Raise InputError for the first field of a dataclass instance that is outside the range of its key."""
    kind: Any = type(value)
    for one in keyed(kind):
        found: Any = getattr(value, one.name)
        if one.optional and found is None:
            continue
        if one.type is float:
            REQUIRE[one.key.range](**{one.name: found})
        elif one.type is int:
            require_count(**{one.name: found})
        elif (words := get_args(one.type)) and found not in words:
            *first, last = map(repr, words)
            raise InputError(f"{one.name}: found {found!r}, expected {', '.join(first)} or {last}")
