"""Names in tables and messages: each is unique, and prints on one line as it is stored."""

from collections.abc import Collection, Iterable
from difflib import get_close_matches


def names_fault(names: Iterable[str]) -> str:
    r"""Fault of the first name that is empty, has characters without a shape, or occurs twice; else nothing.

    Line ends, direction marks and other characters without a shape of their own would break a table, or let a name
    resemble another.

    >>> names_fault(["span", "flap"]), names_fault(["a\nb"]), names_fault(["x", "x"])
    ('', "'a\\nb', expected a name that prints on one line", "'x' twice, expected each name once")
    """
    seen = set[str]()
    for name in names:
        if not name or not name.isprintable():
            return f"{name!r}, expected a name that prints on one line"
        if name in seen:
            return f"{name!r} twice, expected each name once"
        seen.add(name)
    return ""


def hint(name: str, known: Collection[str], most: int = 1, cutoff: float = 0.6) -> str:
    """The names similar to a mistyped one, as the end of a sentence; "" if none is similar.

    >>> hint("thicknes", ["thickness", "mesh"]), hint("x", ["thickness"])
    (' (did you mean thickness?)', '')
    """
    near = get_close_matches(name, known, n=most, cutoff=cutoff)
    return f" (did you mean {' or '.join(near)}?)" if near else ""
