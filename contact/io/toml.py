"""TOML files of both packages: bytes and tables, or one sentence on the fault; location of a value in the file."""

import re
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from contact.io.infiles import read_bytes, text_of

PLACE = re.compile(r"at line (\d+), column \d+\)$")
# frequent spellings that TOML does not allow, and the correct ones
HABITS = {
    r"[=,\[]\s*[+-]?(\.\d|\d+\.(?!\d))": "write digits on both sides of the decimal point: 0.5, 100.0",
    r"=\s*[+-]?\d+,\d+\s*$": "write a decimal point, not a comma: 0.5",
    r"[=,\[]\s*(True|False|TRUE|FALSE)\b": "write true and false in lower case",
    r"=\s*[A-Za-z_/]": "write text in quotes",
}
SHOWN = 60  # characters of a line
MOST = 16e6  # bytes: large data are in files of their own
DEEPEST = 100  # parts of a key, a.b.c
BETWEEN_KEYS = re.compile(r"[={,\[\]]")
KEY = re.compile(r"[ \t]*([\w-]+|\"[^\"]*\"|'[^']*')[ \t]*")


def read_toml(file: Path) -> tuple[bytes, dict[str, Any]]:
    """The bytes and the tables of a TOML file.

    Raises
    ------
    OSError
        The file cannot be read; `strerror` states what was found and what is expected.
    ValueError
        The file is not text ("line 2: found ...") or not TOML ("not TOML: ...").
    """
    data = read_bytes(file, most=MOST)
    text = text_of(data)
    require_short_keys(text)
    try:
        return data, tomllib.loads(text)
    except RecursionError:
        raise ValueError("not TOML: found values nested hundreds of levels deep, expected tables and lists") from None
    except ValueError as error:  # also of numbers with thousands of digits
        raise ValueError(f"not TOML: {error}{spelling(str(error), text)}") from None


def require_short_keys(text: str) -> None:
    """Refuse keys of more than `DEEPEST` parts, whose parsing takes quadratic time.

    >>> require_short_keys("speed.hz = 5.0")
    """
    for number, line in enumerate(text.split("\n"), 1):
        if line.count(".") <= DEEPEST:
            continue
        for part in BETWEEN_KEYS.split(line):
            words = part.split(".")
            if len(words) > DEEPEST and all(KEY.fullmatch(word) for word in words):
                found = f"a key of {len(words)} parts at line {number}"
                raise ValueError(f"not TOML: found {found}, expected at most {DEEPEST} parts")


def spelling(error: str, text: str) -> str:
    r"""The line of a TOML error with the corrected spelling; empty if the error names no line.

    >>> spelling("Invalid value (at line 2, column 5)", "a = 1\nb = .5")
    ': b = .5; write digits on both sides of the decimal point: 0.5, 100.0'
    """
    named = PLACE.search(error)
    if named is None:
        return ""
    line = text.split("\n")[int(named[1]) - 1].strip()
    shown = line if len(line) <= SHOWN else f"{line[:SHOWN]} ..."
    return "; ".join([f": {shown}", *(way for habit, way in HABITS.items() if re.search(habit, line))][:2])


def entries(value: object) -> Mapping[Any, Any]:
    """Entries of a value of a file: a table's by key, a list's by number from 0; none for a plain value.

    >>> entries({"hz": 5.0}), entries([2, 3]), entries(5.0)
    ({'hz': 5.0}, {0: 2, 1: 3}, {})
    """
    if isinstance(value, dict):
        return value
    return dict(enumerate(value)) if isinstance(value, list) else {}


def written(path: Iterable[str | int]) -> str:
    """Path of a value as text: entries of lists counted from 1.

    >>> written(("imperfection", 0, "harmonics", 2, "p"))
    'imperfection[1].harmonics[3].p'
    """
    return "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in path).removeprefix(".")
