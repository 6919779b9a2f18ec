"""Checksums of plain data, independent of the order of its keys, and of files."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

CHUNK = 1 << 20


def digest_of(document: Any) -> str:
    """Hash of plain data, independent of the order of its keys.

    >>> digest_of({"a": 1.0, "b": [2]}) == digest_of({"b": [2], "a": 1.0})
    True
    """
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def digest_of_file(path: Path) -> str:
    """Hash of the content of a regular file."""
    found = hashlib.sha256()
    with path.open("rb") as stream:
        while piece := stream.read(CHUNK):
            found.update(piece)
    return found.hexdigest()
