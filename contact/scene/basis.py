"""Basis files that scenes name: each is read once as long as it stays the same."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from contact.model.bodies.modal_body import ModalBody


def read_basis(path: Path) -> ModalBody:
    """The body of a basis file; raises InputError."""
    try:
        stat = path.stat()
    except (OSError, ValueError):  # the latter of a name with a zero byte
        return ModalBody.load(path)  # which says what is wrong
    return _basis_as(path, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=32)
def _basis_as(path: Path, _changed: int, _size: int) -> ModalBody:
    return ModalBody.load(path)
