"""Damaged universal files: numbers that are refused, read unchanged, or lose data without an error.

Each sample file (`reports/verification/robustness/uff_samples.py`) is damaged in one place a time, 2,000 times a kind
of set: cut off, lines dropped, doubled or emptied, characters deleted, inserted or turned into letters, counts changed,
exponents and line ends rewritten, bytes of binary data lost. No reader can detect digits replaced by other digits,
exchanged lines, and binary data of real doubles declared as complex singles (the same number of bytes).
"""

import math
import time
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from casingfem.errors import InputError, ModelWarning
from casingfem.experiment.uff.read import UniversalFile, parse_uff
from casingfem.experiment.uff.write import write_uff
from reports.tables import Row, command_line, show, write
from reports.verification.robustness.uff_samples import Count, Sample, samples

EACH, QUICK = 2000, 60
SLOW = 1.0  # s: a reader that takes longer over a file of a few kilobytes hangs
OUTCOMES = ("refused", "same", "warned", "text", "last entry", "SILENT", "BAD MESSAGE", "SLOW")
Random = np.random.Generator
Damage = Callable[[bytes, Random, tuple[Count, ...]], bytes]


def on_lines(change: Callable[[list[bytes], int], None]) -> Damage:
    """A damage to one line, chosen at random."""

    def damage(data: bytes, rng: Random, counts: tuple[Count, ...]) -> bytes:
        lines = data.split(b"\n")
        change(lines, int(rng.integers(len(lines) - 1)))
        return b"\n".join(lines)

    return damage


def at_character(change: Callable[[bytes, int, Random], bytes]) -> Damage:
    """A damage at one place, chosen at random."""
    return lambda data, rng, counts: change(data, int(rng.integers(len(data))), rng)


def text_end(data: bytes) -> int:
    """Where the text before binary data ends, less three; the end of a file that is all text."""
    binary = data.startswith(b"    -1\n    58b")
    return (sum(map(len, data.split(b"\n")[:13])) + 13 if binary else len(data)) - 3


def to_letter(data: bytes, rng: Random, counts: tuple[Count, ...]) -> bytes:
    """One digit becomes a letter."""
    places = [k for k, byte in enumerate(data[: text_end(data)]) if chr(byte).isdigit()]
    place = int(rng.choice(places))
    return data[:place] + b"OlIxNS"[(k := int(rng.integers(6))) : k + 1] + data[place + 1 :]


def wrong_count(data: bytes, rng: Random, counts: tuple[Count, ...]) -> bytes:
    """A number of a header that says how much follows becomes another."""
    if not counts:
        return to_letter(data, rng, counts)
    line, column, width = counts[int(rng.integers(len(counts)))]
    lines = data.split(b"\n")
    old = int(lines[line][column : column + width])
    new = old + int(rng.choice([-8, -2, -1, 1, 2, 8, 1000]))
    lines[line] = lines[line][:column] + f"{new:{width}d}".encode() + lines[line][column + width :]
    return b"\n".join(lines)


DAMAGES: dict[str, Damage] = {
    "cut off": lambda data, rng, counts: data[: int(rng.integers(1, len(data)))],
    "line dropped": on_lines(lambda lines, k: lines.pop(k) and None),
    "line doubled": on_lines(lambda lines, k: lines.insert(k, lines[k])),
    "line emptied": on_lines(lambda lines, k: lines.__setitem__(k, b"")),
    "empty line": on_lines(lambda lines, k: lines.insert(k, b"")),
    "mark inserted": on_lines(lambda lines, k: lines.insert(k, b"    -1")),
    "line cut": on_lines(lambda lines, k: lines.__setitem__(k, lines[k][: len(lines[k]) // 2])),
    "character deleted": at_character(lambda data, k, rng: data[:k] + data[k + 1 :]),
    "character inserted": at_character(lambda data, k, rng: data[:k] + b" 7-.E"[(j := k % 5) : j + 1] + data[k:]),
    "digit to letter": to_letter,
    "nan": at_character(lambda data, k, rng: data[: (j := k % text_end(data))] + b"NaN" + data[j + 3 :]),
    "wrong count": wrong_count,
    "part dropped": at_character(lambda data, k, rng: data[:k] + data[k + int(rng.integers(2, 200)) :]),
    "CRLF": lambda data, rng, counts: data.replace(b"\n", b"\r\n"),
    "trailing blanks": on_lines(lambda lines, k: lines.__setitem__(k, lines[k] + b"   ")),
    "stripped": lambda data, rng, counts: b"\n".join(line.rstrip() for line in data.split(b"\n")),
    "D exponents": lambda data, rng, counts: data.replace(b"E+", b"D+").replace(b"E-", b"D-"),
}  # fmt: skip


def content(value: object, *, text: bool) -> object:
    """Contents of a file as plain tuples, with or without its texts."""
    if isinstance(value, str):
        return value if text else None
    if isinstance(value, np.ndarray):
        return (value.shape, value.tobytes())
    if is_dataclass(value):
        return tuple(content(getattr(value, f.name), text=text) for f in fields(value) if f.name != "path")
    if isinstance(value, tuple | list):
        return tuple(content(part, text=text) for part in value)
    return value


def entries(found: UniversalFile) -> list[object]:
    """The entries that no count of the format covers: nodes, elements, values of shapes, whole shapes; in order."""
    parts: list[object] = []
    if found.nodes is not None:
        n = found.nodes
        parts += [(n.labels[k], n.points[k].tobytes(), n.systems[k], n.motions[k]) for k in range(len(n.labels))]
    if found.elements is not None:
        e = found.elements
        rows = zip(e.labels, e.kinds, e.properties, e.beams, e.nodes, strict=True)
        parts += [tuple(np.asarray(cell).tobytes() for cell in row) for row in rows]
    for shape in found.shapes:
        parts += [(shape.reals, node, value.tobytes()) for node, value in zip(shape.nodes, shape.values, strict=True)]
    return parts


def judged(mutant: bytes, whole: UniversalFile) -> str:
    """Outcome of reading a damaged file."""
    started = time.perf_counter()
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = parse_uff(mutant, "mutant.uff")
    except InputError as error:
        placed = "set" in error.where and f"line {error.line}" in str(error)
        return "refused" if placed else "BAD MESSAGE"
    if time.perf_counter() - started > SLOW:
        return "SLOW"
    if content(found, text=True) == content(whole, text=True):
        return "same"
    if any(issubclass(warning.category, ModelWarning) for warning in caught):
        return "warned"
    if content(found, text=False) == content(whole, text=False):
        return "text"
    before, after = entries(whole), entries(found)
    shorter = 0 < len(after) < len(before)
    return "last entry" if shorter and before[: len(after)] == after and not whole.functions else "SILENT"


def damaged(name: str, sample: Sample, each: int, folder: Path) -> tuple[Counter[str], dict[str, Counter[str]]]:
    """Outcomes of one kind of file, in sum and by damage."""
    data = write_uff(folder / "whole.uff", **sample.parts).read_bytes()
    whole = parse_uff(data, "whole.uff")
    rng = np.random.default_rng([ord(letter) for letter in name])
    by_damage: dict[str, Counter[str]] = {damage: Counter() for damage in DAMAGES}
    for k in range(each):
        damage = list(DAMAGES)[k % len(DAMAGES)]
        by_damage[damage][judged(DAMAGES[damage](data, rng, sample.counts), whole)] += 1
    return sum(by_damage.values(), Counter()), by_damage


def main(out: Path, quick: bool = False) -> list[Row]:
    """Damage every sample and count what the reader does."""
    rows: list[Row] = []
    of_damages: dict[str, Counter[str]] = {damage: Counter() for damage in DAMAGES}
    with TemporaryDirectory() as folder:
        for name, sample in samples().items():
            total, by_damage = damaged(name, sample, QUICK if quick else EACH, Path(folder))
            rows.append({"set": name, "files": sum(total.values()), **{word: total[word] for word in OUTCOMES}})
            for damage, counter in by_damage.items():
                of_damages[damage] += counter
    show("Damaged universal files, by set", rows)
    damages: list[Row] = [{"damage": name, **{word: of[word] for word in OUTCOMES}} for name, of in of_damages.items()]
    show("The same, by damage", damages)
    silent = sum(int(str(row[word])) for row in rows for word in ("SILENT", "BAD MESSAGE", "SLOW"))
    files = math.fsum(int(str(row["files"])) for row in rows)
    print(
        f"\n{files:.0f} damaged files: {silent} lost data in silence, hung, or were refused without set and line."
        '\n"same": every number and text as before. "text": only text changed, which nothing guards. "last entry": the'
        "\nend of a list that has no count in the format is gone, line by whole line; the file is a valid shorter one."
    )
    write(out / "uff_mutations.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
