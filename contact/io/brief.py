"""One line that describes a frozen value, printed for a shell, a mesh or a scene. Arrays are shown by their shapes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import MISSING, Field, fields
from typing import Any

MANY, LONG = 4, 90  # entries of a list, characters of a part, that are shown


def brief(value: Any) -> str:
    """Describe a value of a dataclass in one line: its class, and its fields that differ from their defaults.

    A dataclass of your own, such as a law or a gap, prints like those of the package with `__repr__ = ct.io.brief`.

    Parameters
    ----------
    value
        A value of a dataclass. Numbers have six digits, arrays are shown by their shapes, and of a list or mapping of
        more than four entries the first four and their number. A part of more than 90 characters is shown by the name
        of its class.

    Returns
    -------
    str
        One line, such as "Wall(x=0.1)".

    Raises
    ------
    TypeError
        The value is not one of a dataclass.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Ring:
    ...     radius: float
    ...     bolts: int = 0
    ...     angle: Any = None
    >>> brief(Ring(0.5)), brief(Ring(1.0 / 3.0, 12, list(range(24))))
    ('Ring(radius=0.5)', 'Ring(radius=0.333333, bolts=12, angle=[0, 1, 2, 3, ... 24])')
    """
    parts = (f"{field.name}={part(getattr(value, field.name))}" for field in fields(value) if not_default(value, field))
    return f"{type(value).__name__}({', '.join(parts)})"


def not_default(value: Any, field: Field[Any]) -> bool:
    """Whether a field is not at its default."""
    default = field.default_factory() if field.default_factory is not MISSING else field.default
    found = getattr(value, field.name)
    if not field.repr or found is default:
        return False
    if hasattr(default, "shape") or hasattr(found, "shape"):
        return getattr(default, "shape", None) != getattr(found, "shape", None) or bool((found != default).any())
    return bool(found != default)


def part(value: Any) -> str:
    """A nested value in one line."""
    if isinstance(value, str):
        return repr(value)
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        return f"{{{listed(f'{key}: {part(entry)}' for key, entry in value.items())}}}"
    if isinstance(value, tuple | list):
        return f"[{listed(map(part, value))}]"
    if getattr(value, "shape", ()):
        return f"{type(value).__name__.replace('ndarray', 'array')}({' x '.join(map(str, value.shape))})"
    text = repr(value).partition("\n")[0]
    return text if len(text) <= LONG else f"{type(value).__name__}(...)"


def listed(entries: Iterable[str]) -> str:
    """The first few entries, and the number of entries."""
    found = list(entries)
    return ", ".join(found) if len(found) <= MANY else f"{', '.join(found[:MANY])}, ... {len(found)}"
