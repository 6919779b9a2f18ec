"""JSON files that carry the checksum of what they hold: one that is torn, altered or another's is as good as none."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import Any

from contact.io.outfiles import write_atomic


def digest_of(document: Any) -> str:
    """Hash of plain data, whatever the order of its keys.

    >>> digest_of({"a": 1.0, "b": [2]}) == digest_of({"b": [2], "a": 1.0})
    True
    """
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def write_checked(path: str | os.PathLike[str], name: str, value: Any, **head: Any) -> None:
    """Write `value` under its name, what says whose it is, and its checksum: whole or not at all."""
    content = {**head, name: value, "sha256": digest_of(value)}
    write_atomic(path, json.dumps(content, allow_nan=False) + "\n")


def read_checked(path: str | os.PathLike[str], name: str, **head: Any) -> Any:
    """What `write_checked` wrote with the same head; None where there is none, or none that is whole."""
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        value = content[name]
        whole = content["sha256"] == digest_of(value) and all(content[key] == said for key, said in head.items())
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    return value if whole else None
