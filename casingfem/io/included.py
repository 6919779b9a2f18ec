"""Lines of mesh files and their included files (*INCLUDE of Abaqus, INCLUDE of Nastran), each with its place.

Editors may leave a last line without a line end, and so does a truncated copy, in which a number may be truncated too.
A number is complete if its field is full or a blank follows, or if it is as wide as all others of its kind. A line that
is not read does not matter. Other cases cannot be decided.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TypeAlias

from casingfem.errors import ModelError, warn
from contact.io.infiles import read_loose_text

NumberedLine: TypeAlias = tuple[str, str]  # its place, "3" or "3 of parts.inp", and the line

ABAQUS = re.compile(r"\s*\*INCLUDE\s*,\s*INPUT\s*=\s*[\"']?([^\"']+?)[\"']?\s*", re.IGNORECASE)
NASTRAN = re.compile(r"\s*INCLUDE\s+[\"']?([^\"']+?)[\"']?\s*", re.IGNORECASE)
INCLUDES = {".inp": ABAQUS} | dict.fromkeys((".bdf", ".nas", ".dat", ".pch", ".dmig"), NASTRAN)
DEEPEST = 20

ENDS = ("*END", "**", "ENDDATA", "$", "*INCLUDE", "INCLUDE")  # last lines that hold no number
LAST_COLUMN = 72  # of a line of Nastran's columns
DECIMAL = re.compile(r"[+-]?\d*\.\d*")
NUMBER = re.compile(r"[+-]?\d*\.?\d*([EDed]?[+-]\d+|[EDed]\d+)?")


def read_lines(path: Path, read: Collection[str] | None = None) -> list[NumberedLine]:
    """Lines of a file with those of its included files in place; file names are relative to either file.

    `read` names the keywords or cards whose content is read, by default all.

    Raises
    ------
    ModelError
        An included file is missing or includes itself, or a last line without an end may be truncated
        (`check_last_line`).
    """
    return [line for _, lines in _files(path, path, (), read) for line in lines]


def included_files(path: Path) -> list[Path]:
    """The files that a file includes, directly or indirectly, in the order of their lines."""
    if path.suffix.lower() not in INCLUDES or not path.is_file():
        return []
    return list(dict.fromkeys(file for file, _ in _files(path, path, (), ()) if file != path))


def _files(
    path: Path, main: Path, above: tuple[Path, ...], read: Collection[str] | None
) -> Iterator[tuple[Path, list[NumberedLine]]]:
    """Ranges of lines with the files that they are from."""
    text = read_loose_text(path)
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
            raise ModelError("mesh-include", f"{main.name}: line {place}: found {found.name}, which includes itself")
        yield from _files(found, main, (*above, path), read)
    yield path, lines


def _found(name: str, path: Path, main: Path) -> Path | None:
    """The file with a name, next to the including file or next to the first."""
    places = (folder / written for folder in (path.parent, main.parent) for written in (name, name.replace("\\", "/")))
    return next((place for place in places if place.is_file()), None)


def check_last_line(text: str, name: str, *, abaqus: bool, read: Collection[str] | None) -> None:
    r"""Refuse a last line without an end that may be truncated; warn if only digits may be missing.

    Parameters
    ----------
    text, name
        Text and name of the file.
    abaqus
        Whether the file has Abaqus keywords and commas, not Nastran cards and fields.
    read
        Keywords or names of cards that are read; all if None.

    Raises
    ------
    ModelError
        `mesh-file`.

    Warns
    -----
    ModelWarning
        `mesh-last-line` if the last decimal number may have lost digits.

    >>> check_last_line("GRID,1,,0.5,1.\nMAT1,1,2.", "a.bdf", abaqus=False, read={"GRID"})
    >>> check_last_line("*NODE\n1, 0.5, 1.0\n2, 0.5, 2.0", "a.inp", abaqus=True, read=None)
    """
    if not text or text[-1] in "\r\n":
        return
    lines = text.splitlines()
    last = lines[-1]
    head = owner(lines, abaqus)
    if not last.strip() or last.strip().upper().startswith(ENDS) or head == "ENDDATA":
        return
    if read is not None and head and head not in read:
        return
    found, above = fields(last, abaqus), fields(lines[-2], abaqus) if len(lines) > 1 else []
    number = found[-1].strip() if found else ""
    if not abaqus and "," not in last and len(last.expandtabs(8)) >= LAST_COLUMN:
        return
    alike = len(found) == len(above) and (abaqus or found[0] == above[0])
    if alike and number and NUMBER.fullmatch(number):
        if full(last, abaqus) or padded(found, above):
            return
        if DECIMAL.fullmatch(number):
            text = f"{name}: found no line break after the last line, {last.strip()[-40:]!r}"
            warn("mesh-last-line", text, stacklevel=6)
            return
    text = f"{name}: found no line break after the last line, {last.strip()[-40:]!r}: cut short?"
    raise ModelError("mesh-file", text)


def owner(lines: list[str], abaqus: bool) -> str:
    """Keyword or card name of the last line; "" if it is unknown or may itself be truncated."""
    for line in reversed(lines):
        if abaqus and line.lstrip()[:1] == "*" and line.lstrip()[:2] != "**":
            head = " ".join(line.strip()[1:].partition(",")[0].upper().split())
            return head if line is not lines[-1] or "," in line else ""
        if not abaqus and line[:1].isalpha():
            if any(before.strip().upper().startswith("ENDDATA") for before in lines[:-1]):
                return "ENDDATA"
            head = (line.partition(",")[0] if "," in line else line[:8]).strip().rstrip("*").upper()
            return head if line is not lines[-1] or len(line) > len(head) + 1 else ""
    return ""


def fields(line: str, abaqus: bool) -> list[str]:
    """Fields between commas, or in Nastran's columns, without empty ones at the end."""
    if abaqus or "," in line:
        return line.rstrip(", \t").split(",")
    line = line.expandtabs(8)
    width = 16 if "*" in line[:8] else 8
    return [line[:8].strip(), *(line[k : k + width] for k in range(8, len(line.rstrip()), width))]


def padded(found: list[str], above: list[str]) -> bool:
    """Whether the last number is as wide as all others of its kind in two lines, as programs write them.

    A number that ends in its decimal point may have lost digits in any case.

    >>> padded(["9", " 1.50", " 0.25"], ["8", " 0.00", " 1.25"]), padded(["9", " 1.5", " 0."], ["8", " 0.", " 0."])
    (True, False)
    """
    last = found[-1].rstrip()
    point = "." in last
    widths = {len(one.rstrip()) for one in (*found[1:], *above[1:]) if one.strip() and ("." in one) == point}
    return not last.endswith(".") and ("." in above[-1]) == point and widths == {len(last)}


def full(line: str, abaqus: bool) -> bool:
    """Whether a blank or comma follows the last number of a line, or the number fills its columns."""
    if line[-1] in " \t,":
        return True
    width = 16 if "*" in line[:8] else 8
    return not abaqus and "," not in line and (len(line.expandtabs(8)) - 8) % width == 0
