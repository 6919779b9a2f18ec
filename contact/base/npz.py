"""Files of arrays (npz) of one format: read with all that it needs, or refused with file and key."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from contact.base.errors import InputError
from contact.io.npz import load_npz, require_kinds


def read_npz(path: Path, wanted: str, required: tuple[str, ...], texts: tuple[str, ...]) -> dict[str, Any]:
    """Read every array of an npz file of this format, numbers but for `texts`; raises InputError with file and key."""
    if not os.path.exists(path):  # unlike Path.exists also answers for a name with a zero byte
        raise InputError(f"{path}: found no such file, expected an npz file")
    try:
        data = load_npz(path)
    except ValueError as error:
        raise InputError(f"{path}: not a readable npz file without pickled objects ({error})") from error
    found = str(data.get("format", "no key 'format'"))
    if found != wanted:
        raise InputError(f"{path}: key 'format': found {found!r}, expected {wanted!r}")
    missing = [name for name in required if name not in data]
    if missing:
        raise InputError(f"{path}: missing keys {', '.join(missing)}")
    try:
        require_kinds(data, dict.fromkeys(texts, "text"))
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error
    return data
