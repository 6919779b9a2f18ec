"""Combine all faults of a file in one error, so that they can be corrected at once."""

from collections.abc import Sequence

from casingfem.errors import InputError

MOST = 20  # problems in words; of further ones the number


def together(errors: Sequence[InputError]) -> InputError:
    """One error from several: a line for each, up to twenty, and the number of further ones.

    >>> print(together([InputError("t.csv", line=k, found="'x'", expected="a number") for k in range(2, 25)][:2]))
    t.csv, line 2: found 'x'; expected a number
    t.csv, line 3: found 'x'; expected a number
    """
    if len(errors) == 1:
        return errors[0]
    first, more = errors[0], len(errors) - MOST
    lines = [str(error) for error in errors[:MOST]]
    if more > 0:
        lines.append(f"{first.path}: {more} further problem{'s' if more > 1 else ''} of this kind")
    whole = InputError("\n".join(lines))
    for name in ("path", "line", "column", "where", "found", "expected"):
        setattr(whole, name, getattr(first, name))
    return whole
