"""Files of arrays (npz), read with all that is wanted or refused; `contact.io.npz` writes them."""

import os
from collections.abc import Collection

from casingfem.errors import InputError
from casingfem.io.arrays import Array
from contact.io.npz import load_npz


def read_npz(path: str | os.PathLike[str], wanted: Collection[str] = (), expected: str = "") -> dict[str, Array]:
    """All arrays of a file by name.

    Raises
    ------
    InputError
        No file, another kind of file, or one without an array that is wanted; `expected` says what it should be.
    """
    try:
        stored = load_npz(path)
    except ValueError as error:
        expected = expected or "a file of arrays"
        raise InputError(str(path), found=f"no readable npz file ({error})", expected=expected) from error
    if missing := set(wanted) - stored.keys():
        found = f"an npz without {', '.join(sorted(missing))}"
        raise InputError(str(path), found=found, expected=expected or ", ".join(sorted(wanted)))
    return stored
