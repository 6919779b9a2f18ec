"""Result files: written under a temporary name and moved into place, all of a set or none."""

import json
import os
from collections.abc import Callable, Mapping
from math import isfinite
from pathlib import Path
from typing import Any

Content = str | bytes | Callable[[Path], object]  # what a file holds, or what writes it at a path


def write_files(folder: str | os.PathLike[str], files: Mapping[str, Content]) -> list[Path]:
    r"""Write files into a folder (made if need be, like those in a file's name); none appears before all are complete.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in write_files(folder, {"modes.csv": "mode,freq_hz\n"})]
    ['modes.csv']
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    waiting: dict[Path, Path] = {}
    try:
        for name, content in files.items():
            final = target / name
            final.parent.mkdir(parents=True, exist_ok=True)
            part = final.with_name(f".{final.name}.{os.getpid()}.part")
            waiting[part] = final
            if callable(content):
                content(part)
            else:
                part.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
        for part, final in waiting.items():
            os.replace(part, final)
    finally:
        for part in waiting:
            part.unlink(missing_ok=True)
    return list(waiting.values())


def write_atomic(path: str | os.PathLike[str], content: Content) -> Path:
    """Write one file, whole or not at all."""
    final = Path(path)
    return write_files(final.parent, {final.name: content})[0]


def json_text(document: Any, *, indent: int | None = None) -> str:
    r"""One JSON document, ending in a newline; numbers that JSON has no word for become null.

    >>> json_text({"freq_hz": 371.2, "zeta": float("nan")})
    '{"freq_hz": 371.2, "zeta": null}\n'
    """
    return json.dumps(finite(document), indent=indent, allow_nan=False, ensure_ascii=False) + "\n"


def finite(value: Any) -> Any:
    """The same plain data with nan and inf replaced by None."""
    if isinstance(value, float):  # nearly all entries are, and there may be millions
        return value if isfinite(value) else None
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    if isinstance(value, Mapping):
        return {key: finite(entry) for key, entry in value.items()}
    return value
