"""Read files of arrays (npz) completely or refuse them; `contact.io.npz` writes them."""

import os
from collections.abc import Collection, Mapping

from casingfem.errors import InputError
from casingfem.io.arrays import Array
from contact.io.npz import ArrayKind, load_npz, require_kinds


def read_npz(
    path: str | os.PathLike[str],
    wanted: Collection[str] = (),
    expected: str = "",
    kinds: Mapping[str, ArrayKind] | None = None,
) -> dict[str, Array]:
    """All arrays of a file by name.

    Raises
    ------
    InputError
        The file is missing, of another kind, or lacks a required array; `expected` states the expectation. With
        `kinds`, an array is of another kind; arrays that it does not name must be real numbers.
    """
    try:
        stored = load_npz(path)
    except ValueError as error:
        expected = expected or "a file of arrays"
        raise InputError(str(path), found=f"no readable npz file ({error})", expected=expected) from error
    if missing := set(wanted) - stored.keys():
        found = f"no array {', '.join(sorted(missing))}"
        raise InputError(str(path), found=found, expected=expected or ", ".join(sorted(wanted)))
    if kinds is not None:
        try:
            require_kinds(stored, kinds)
        except ValueError as error:
            raise InputError(f"{path}: {error}") from error
    return stored
