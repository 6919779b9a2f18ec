"""Mesh files that include others, by Abaqus' *INCLUDE or Nastran's INCLUDE: all their lines, each with its place."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TypeAlias

from casingfem.errors import ModelError
from casingfem.io.last_line import check_last_line

NumberedLine: TypeAlias = tuple[str, str]  # its place, "3" or "3 of parts.inp", and the line

ABAQUS = re.compile(r"\s*\*INCLUDE\s*,\s*INPUT\s*=\s*[\"']?([^\"']+?)[\"']?\s*", re.IGNORECASE)
NASTRAN = re.compile(r"\s*INCLUDE\s+[\"']?([^\"']+?)[\"']?\s*", re.IGNORECASE)
INCLUDES = {".inp": ABAQUS} | dict.fromkeys((".bdf", ".nas", ".dat", ".pch", ".dmig"), NASTRAN)
DEEPEST = 20


def read_lines(path: Path, read: Collection[str] | None = None) -> list[NumberedLine]:
    """Lines of a file, those of the files it includes in their places; names are relative to either of the two.

    `read` names the keywords or cards of which more than the name is read, all if left out.

    Raises
    ------
    ModelError
        Where an included file is not there or includes itself, or the last line of a file is not ended and may be a
        part of one (`last_line.py`).
    """
    return [line for _, lines in _files(path, path, (), read) for line in lines]


def included_files(path: Path) -> list[Path]:
    """The files that a file includes, and that these include, in the order of their lines."""
    if path.suffix.lower() not in INCLUDES or not path.is_file():
        return []
    return list(dict.fromkeys(file for file, _ in _files(path, path, (), ()) if file != path))


def _files(
    path: Path, main: Path, above: tuple[Path, ...], read: Collection[str] | None
) -> Iterator[tuple[Path, list[NumberedLine]]]:
    """Stretches of lines with the files they are from."""
    text = path.read_text(encoding="utf-8", errors="replace")
    pattern, lines = INCLUDES[main.suffix.lower()], list[NumberedLine]()
    check_last_line(text, path.name, abaqus=pattern is ABAQUS, read=read)
    of = f" of {path.name}" if above else ""
    if "INCLUDE" not in text.upper():
        yield path, [(f"{number}{of}", line) for number, line in enumerate(text.splitlines(), 1)]
        return
    for number, line in enumerate(text.splitlines(), 1):
        place = f"{number}{of}"
        if (match := pattern.fullmatch(line)) is None:
            lines.append((place, line))
            continue
        yield path, lines
        lines = []
        found = _found(match[1], path, main)
        if found is None:
            raise ModelError("mesh-include", f"{main.name}: line {place}: found no file {match[1]}")
        if found in (*above, path) or len(above) == DEEPEST:
            raise ModelError("mesh-include", f"{main.name}: line {place}: {found.name} includes itself")
        yield from _files(found, main, (*above, path), read)
    yield path, lines


def _found(name: str, path: Path, main: Path) -> Path | None:
    """The file of a name, beside the file that includes it or beside the first."""
    places = (folder / written for folder in (path.parent, main.parent) for written in (name, name.replace("\\", "/")))
    return next((place for place in places if place.is_file()), None)
