"""Names that go into tables and messages: each prints on one line as it is stored, and is there once."""

from collections.abc import Iterable


def names_fault(names: Iterable[str]) -> str:
    r"""What is wrong with the first name that is empty, does not print as it is, or is there twice; else nothing.

    Line ends, direction marks and other characters without a shape of their own would break a table, or let a name
    look like another.

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
