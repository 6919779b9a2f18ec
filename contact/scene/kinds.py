"""Kinds of scene files; the tables of a kind are imported when a file needs them."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from contact.scene.beams import BeamFile, CantileverFile
    from contact.scene.pair import PairFile
    from contact.scene.patch import PatchFile
    from contact.scene.rim import DiskFile, RimFile
    from contact.scene.rods import RodsFile
    from contact.scene.rotor import RotorFile
    from contact.scene.rub import RubFile

    File = RodsFile | RimFile | RubFile | DiskFile | BeamFile | CantileverFile | PatchFile | PairFile | RotorFile

KINDS = {
    "rods": ("rods", "RodsFile"), "rim": ("rim", "RimFile"), "rub": ("rub", "RubFile"), "disk": ("rim", "DiskFile"),
    "beam": ("beams", "BeamFile"), "cantilever": ("beams", "CantileverFile"), "patch": ("patch", "PatchFile"),
    "pair": ("pair", "PairFile"), "rotor": ("rotor", "RotorFile"),
}  # fmt: skip


def file_of(kind: str) -> type[File]:
    """The tables of a kind of scene file.

    >>> file_of("rods").__name__
    'RodsFile'
    """
    module, name = KINDS[kind]
    found: type[File] = getattr(import_module(f"contact.scene.{module}"), name)
    return found
