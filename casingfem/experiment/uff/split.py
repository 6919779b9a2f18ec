"""Split a universal file into its data sets; errors name set and line.

A set is between two lines `-1`; its first line is its number (SDRC universal file format, published by the Structural
Dynamics Research Laboratory, University of Cincinnati). Readers that search for the text ` -1` split sets where a
header contains a node number -1. Here a mark is a whole line, and one inside the text lines of a header is text, unless
another mark or the end of the file follows it.
"""

import re
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from casingfem.errors import InputError, warn

KINDS = {
    "15": "nodes",
    "18": "coordinate systems",
    "55": "shapes at nodes",
    "56": "data at elements",
    "57": "data at the nodes of elements",
    "58": "functions",
    "58b": "functions, binary",
    "82": "trace lines",
    "151": "header",
    "161": "history",
    "164": "units",
    "780": "elements",
    "755": "restraints",
    "757": "constraints",
    "770": "permanent groups",
    "781": "nodes, double precision",
    "1858": "qualifiers of functions",
    "2400": "model header",
    "2411": "nodes, double precision",
    "2412": "elements",
    "2414": "analysis data",
    "2417": "permanent groups",
    "2420": "coordinate systems",
    "2429": "permanent groups",
    "2435": "permanent groups",
    "2452": "permanent groups",
    "2467": "permanent groups",
}
TEXT_LINES = {"55": 5, "58": 5, "151": 7}  # lines below the number that may contain any text
UNCOUNTED = ("15", "55", "781", "2411", "2412")  # sets that are read and do not state how many entries they have
BINARY_LINES = 11  # the header of a binary function
NUMBERS_LINE = 6  # of the header of a function, from 0: data type, points, spacing (3I10)
NUMBERS = {2: 1, 4: 1, 5: 2, 6: 2}  # of the ordinate at a point, by data type
DOUBLES = (4, 6)
_BINARY_ENDS = (7, 13, 19, 31, 43)  # ends of the columns of the line "58b ..."


class BinaryHeader(NamedTuple):
    """First line of a binary function: byte order ("<" or ">") and number of bytes."""

    order: str
    size: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RawSet:
    """One data set as text: its lines below the number, the line number of the first, and the bytes of binary data.

    `payload` ends at the closing mark, even if the header `binary` states another length.
    """

    path: str
    number: str
    lines: tuple[str, ...]
    first: int
    binary: BinaryHeader | None = None
    payload: bytes = b""

    @property
    def name(self) -> str:
        """Number and kind, for messages."""
        return named(self.number)

    def error(self, index: int, found: str, expected: str) -> InputError:
        """An error about a line, counted from 0 below the set's number."""
        return InputError(self.path, where=self.name, line=self.first + index, found=found, expected=expected)


def named(number: str) -> str:
    """Set number and kind.

    >>> named("58"), named("9999")
    ('set 58 (functions)', 'set 9999 (a kind this reader does not know)')
    """
    return f"set {number} ({KINDS.get(number, 'a kind this reader does not know')})"


def split(data: bytes, path: str) -> list[RawSet]:
    r"""Split a universal file into its data sets; only blank lines may be outside them.

    Raises
    ------
    InputError
        The file has no set, text outside sets, a set without an end, or binary data without an end where the header
        allows one.

    Warns
    -----
    ModelWarning
        `uff-end`: the last set lacks its closing -1, but its header states its length; `uff-empty`: a set has no
        content.

    Examples
    --------
    >>> [raw.number for raw in split(b"    -1\n   151\na\nb\n    -1\n", "test.uff")]
    ['151']
    """
    scan = _Scan(data=data, path=path)
    sets: list[RawSet] = []
    position = scan.skip_blank(0)
    if position >= len(data):
        raise InputError(path, where="before the first set", line=1, found="nothing", expected="a universal file")
    while position < len(data):
        before = f"after {sets[-1].name}" if sets else "before the first set"
        text, following = scan.text(position)
        if not is_mark(text):
            found, expected = repr(text.strip()[:40]), "-1 in columns 5 and 6, which opens a set"
            raise InputError(path, where=before, line=scan.number(position), found=found, expected=expected)
        opened = scan.skip_marks(following)
        ended = scan.skip_blank(opened) >= len(data)
        if opened != following or (ended and sets):
            line = scan.number(position)
            warn("uff-empty", f"{path}, line {line}, {before}: found -1 and no set below it", stacklevel=5)
        if ended and sets:
            break
        raw, position = _one_set(scan, opened, before)
        sets.append(raw)
        position = scan.skip_blank(position)
    return sets


def is_mark(text: str) -> bool:
    """Whether a line opens or closes a set: -1 within the first six columns, and nothing else."""
    return text.strip() == "-1" and len(text.rstrip()) <= 6


@dataclass(frozen=True, slots=True, kw_only=True)
class _Scan:
    data: bytes
    path: str

    def text(self, position: int) -> tuple[str, int]:
        """The line at a position, decoded, and the position of the next."""
        end = self.data.find(b"\n", position)
        stop = len(self.data) if end < 0 else end
        return decoded(self.data[position:stop].removesuffix(b"\r")), (stop if end < 0 else end + 1)

    def number(self, position: int) -> int:
        """The number of the line at a position, from 1."""
        return self.data.count(b"\n", 0, position) + 1

    def skip_blank(self, position: int) -> int:
        """The position of the next nonblank line, or the end."""
        while position < len(self.data):
            text, following = self.text(position)
            if text.strip():
                break
            position = following
        return position

    def skip_marks(self, position: int) -> int:
        """The position after further marks and the blank lines before them; unchanged if no mark follows."""
        at = self.skip_blank(position)
        while at < len(self.data) and is_mark(self.text(at)[0]):
            position = self.text(at)[1]
            at = self.skip_blank(position)
        return position

    def closes(self, following: int) -> bool:
        """Whether a mark closes a set: the end of the file, or a mark that opens the next set, follows it."""
        position = self.skip_blank(following)
        return position >= len(self.data) or is_mark(self.text(position)[0])


def decoded(line: bytes) -> str:
    r"""Text of a line: UTF-8 if valid, else Latin-1, which is common for units in test files.

    >>> decoded(b"m/s\xb2"), decoded("m/s²".encode())
    ('m/s²', 'm/s²')
    """
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        return line.decode("latin-1")


def _one_set(scan: _Scan, position: int, before: str) -> tuple[RawSet, int]:
    """The set whose number is at a position, and the position after its closing mark."""
    text, following = scan.text(position)
    start = scan.number(position)
    number = re.fullmatch(r"[0-9]{1,6}", text.strip())
    if text[:7].strip() == "58b":
        return _binary_set(scan, text, start, following)
    if number is None or len(text.rstrip()) > 6:
        found = repr(text.strip()[:40]) if position < len(scan.data) else "the end of the file"
        expected = "the number of a set in columns 1 to 6"
        raise InputError(scan.path, where=before, line=start, found=found, expected=expected)
    name = number.group()
    lines: list[str] = []
    while following < len(scan.data):
        text, after = scan.text(following)
        if is_mark(text):
            if scan.closes(after):
                return RawSet(path=scan.path, number=name, lines=tuple(lines), first=start + 1), after
            if len(lines) >= TEXT_LINES.get(name, 0):
                found = "-1, and neither another -1 nor the end of the file below it"
                expected = "-1 where a set ends, and again where the next begins"
                line = scan.number(following)
                raise InputError(scan.path, where=named(name), line=line, found=found, expected=expected)
        lines.append(text)
        following = after
    if name in UNCOUNTED:
        found, expected = "the end of the file", "-1, the set's end"
        raise InputError(scan.path, where=named(name), line=start + len(lines), found=found, expected=expected)
    warn_end(scan.path, name, start + len(lines))
    return RawSet(path=scan.path, number=name, lines=tuple(lines), first=start + 1), following


def warn_end(path: str, number: str, line: int) -> None:
    """Warn of a last set without its closing mark."""
    warn("uff-end", f"{path}, line {line}, {named(number)}: found the end of the file, expected -1", stacklevel=7)


def _binary_set(scan: _Scan, text: str, start: int, position: int) -> tuple[RawSet, int]:
    """A binary function: the lines of its header, as many bytes as it states, then the closing mark."""
    header = _binary_header(scan.path, text, start)
    lines: list[str] = []
    for _ in range(BINARY_LINES):
        if position >= len(scan.data):
            found, expected = "the end of the file", f"{BINARY_LINES} lines of header"
            raise InputError(scan.path, where=named("58b"), line=start + len(lines) + 1, found=found, expected=expected)
        line, position = scan.text(position)
        lines.append(line)
    place = scan.number(position)
    likely, other = _sizes(lines[NUMBERS_LINE])
    for size in dict.fromkeys((*likely, header.size, *other)):
        if (after := _closed(scan, position, size, header.order)) is not None:
            break
    else:
        there = len(scan.data) - position
        if there < header.size:
            found, expected = f"{there} bytes of data", f"{header.size}, as line {start} states"
        else:
            sizes = " or ".join(str(size) for size in dict.fromkeys((header.size, *likely)))
            found, expected = f"no closing -1 behind {sizes} bytes of data", f"it there, as line {start} states"
        raise InputError(scan.path, where=named("58b"), line=place, found=found, expected=expected)
    if not scan.data[position + size : after].strip():
        warn_end(scan.path, "58b", place)
    payload = scan.data[position : position + size]
    raw = RawSet(path=scan.path, number="58b", lines=tuple(lines), first=start + 1, binary=header, payload=payload)
    return raw, after


def _closed(scan: _Scan, position: int, size: int, order: str) -> int | None:
    """Position after the closing mark at a number of bytes, or the end of the file there; None if there is neither."""
    end = position + size
    if end > len(scan.data):
        return None
    behind = next(end + len(mark) for mark in (b"\r\n", b"\n", b"") if scan.data.startswith(mark, end))
    if behind == len(scan.data):
        return behind
    mark, after = scan.text(behind)
    swallowed = order == "<" and behind == end and scan.data.endswith(b"\n", position, end)  # a number of 1e-33 at most
    return after if mark.rstrip() == "    -1" and scan.closes(after) and not swallowed else None


def _sizes(line: str) -> tuple[list[int], list[int]]:
    """Possible sizes of a function's data by record 7: in the precision of its data type, and in the other [bytes].

    The abscissa of uneven points has 4 bytes, with doubles 4 or 8.

    >>> _sizes(f"{6:10d}{400:10d}{1:10d}"), _sizes(f"{2:10d}{10:10d}{0:10d}"), _sizes("no numbers")
    (([6400], [3200]), ([80], [120, 160]), ([], []))
    """
    cells = [line[low : low + 10].strip() for low in (0, 10, 20)]
    if not all(re.fullmatch("[0-9]{1,10}", cell) for cell in cells) or int(cells[0]) not in NUMBERS:
        return [], []
    form, points, even = map(int, cells)
    single = [points * (4 * NUMBERS[form] + (0 if even else 4))]
    double = [points * (8 * NUMBERS[form] + x) for x in ((0,) if even else (4, 8))]
    return (double, single) if form in DOUBLES else (single, double)


def _binary_header(path: str, text: str, start: int) -> BinaryHeader:
    """Byte order and length from the line `58b`: (I6, A1, 2I6, 2I12, 2I6, 2I12)."""
    cells = [text[low:high] for low, high in pairwise(_BINARY_ENDS)]
    if not all(re.fullmatch(r" *[0-9]+", cell) for cell in cells):
        found, expected = repr(text.strip()), "58b, byte order, floating format, lines of header, bytes of data"
        raise InputError(path, where=named("58b"), line=start, found=found, expected=expected)
    order, form, lines, size = map(int, cells)
    for what, value, good in (
        ("byte order", order, {1: "little endian", 2: "big endian"}),
        ("floating format", form, {2: "IEEE 754; DEC and IBM numbers are not read"}),
        ("lines of header", lines, {BINARY_LINES: "the header of set 58"}),
    ):
        if value not in good:
            expected = ", ".join(f"{key} ({word})" for key, word in good.items())
            raise InputError(path, where=named("58b"), line=start, found=f"{what} {value}", expected=expected)
    return BinaryHeader("<" if order == 1 else ">", size)
