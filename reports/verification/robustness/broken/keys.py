"""Broken models, part three: studies and scenes in which one key, value or heading is written wrongly.

Each numeral is replaced by text with its unit, by nan, by a list, and by a negative number if that is invalid. Each key
is misspelt, and left out if it is required. Each word is replaced by another, each heading is misspelt. The message
must name the file and the key. A key that means the same in several files is broken in the first of them only.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import contact as ct
import reports.verification.robustness.diverging as scenes
from casingfem.study.load import load_study
from contact.prepared import prepared
from contact.scene.cycles import load_cycles
from contact.scene.stability import load_stability
from contact.sweep.plan import load_sweep
from reports.verification.robustness.broken.shells import Broken
from reports.verification.robustness.broken.sources import SOURCES, Source
from reports.verification.robustness.sample_files import write_samples

KEY = re.compile(r"(\w+)\s*=\s*(.+?)(\s+#.*)?")
HEAD = re.compile(r"(\[+)([\w.\"]+)(\]+)(\s+#.*)?")
NUMBER = re.compile(r"[-+]?\d+\.?\d*(e[-+]?\d+)?")


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a file: its place, the table it is in, key and value."""

    place: int
    table: str
    key: str
    value: str

    @property
    def name(self) -> str:
        """Table and key."""
        return f"{self.table}.{self.key}"

    @property
    def numeral(self) -> bool:
        """Whether the value is one number."""
        return NUMBER.fullmatch(self.value) is not None

    @property
    def word(self) -> bool:
        """Whether the value is one text."""
        return self.value.startswith('"') and self.value.endswith('"')


def lines(text: str) -> Iterator[Line]:
    """The keys of a file, one-line values only."""
    table = ""
    for place, line in enumerate(text.splitlines()):
        if found := HEAD.fullmatch(line.strip()):
            table = found[2]
        elif (found := KEY.fullmatch(line.strip())) and (found[2].count("[") == found[2].count("]")):
            yield Line(place, table, found[1], found[2])


def misspelt(word: str) -> str:
    """A misspelt word: one letter missing, two exchanged, or one too many."""
    if len(word) > 3:
        return word[:-2] + word[-1]
    return word[::-1] if len(word) > 1 and word != word[::-1] else word + "m"


# keys that may be left out, by table: they have a default, or another key replaces them
OPTIONAL = {
    "imperfection": "n_max degree scale p_max", "support.base": "offset", "support.base.support": "k_rot loose",
    "modes": "count", "mesh": "order rows around", "reduce": "n_max modes zeta out", "taper": "along across",
    "chart": "camber_deg twist_deg sweep lean", "rotation": "hub_radius stagger_deg", "cyclic": "faces mistuning",
    "rig": "zeta_spread quantity", "rig.drive": "angle_deg mass", "rig.sensor": "count", "rig.scan": "mirror_hz snr_db",
    "rig.test": "blocks force snr_db bits", "blade": "lean_deg count zeta", "casing": "zeta", "casing.pair": "kick",
    "contact": "friction slide lean_deg clearance stiffness", "disk": "compliance lean_deg", "body": "S load",
    "ground": "friction", "beam": "zeta load elements torque", "scheme": "law modes restitution",
    "record": "every state_every", "circle": "offset", "rod": "elements velocity", "scene": "gravity", "mass": "x",
    "wall": "x", "speed": "steps", "sweep": "kind", "continuation": "channels",
}  # fmt: skip
# keys that may be below zero: angles, positions, directions; bounds are checked with their parameter
SIGNED = {
    "material": "nu", "rotation": "stagger_deg", "chart": "twist_deg", "rig.drive": "angle_deg",
    "rig.scan": "mirror_hz snr_db", "rig.test": "snr_db", "blade": "lean_deg", "speed": "hz from_hz",
    "casing.pair": "kick", "disk": "lean_deg", "beam": "load torque", "rod": "velocity", "scene": "gravity",
    "mass": "x", "sweep.vary": "from to", "update.parameter": "lower",
}  # fmt: skip
WHOLE = ("casing", "rub", "pair")
NAMED = {"scene": "scene", "rod": "rod"}  # key that is missing then: the kind of a scene, the second rod of a sweep
VARIED = ("sweep", "rod.velocity")  # a sweep puts values of its own there
UNITS = {
    "E": "Pa", "rho": "kg/m3", "nu": "-", "hz": "Hz", "freq_hz": "Hz", "dt": "s", "t_end": "s", "mass": "kg",
    "k": "N/m",
}  # fmt: skip
READ: dict[str, Callable[[Path], object]] = {
    "study": lambda path: load_study(path, wheel=True),
    "scene": lambda path: prepared(ct.load_scene(path)),
    "stability": load_stability, "cycles": load_cycles, "sweep": load_sweep,
}  # fmt: skip


@cache
def beside() -> TemporaryDirectory[str]:
    """A folder with everything to which the files refer."""
    folder = TemporaryDirectory()
    write_samples(Path(folder.name))
    scenes.bodies(Path(folder.name))
    return folder


def reads(name: str, reader: str, content: str | bytes) -> Callable[[], object]:
    """Read a file of that content."""

    def make() -> object:
        path = Path(beside().name) / f"{name}.toml"
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        try:
            return READ[reader](path)
        finally:
            path.unlink()

    return make


def changed(text: str, place: int, line: str | None) -> str:
    """The text with one line replaced or removed."""
    all_lines = text.splitlines()
    return "\n".join(all_lines[:place] + ([] if line is None else [line]) + all_lines[place + 1 :]) + "\n"


def broken_line(line: Line) -> Iterator[tuple[str, str | None, str]]:
    """Ways to break a key and its value: a description, the new line, and what the message must name."""
    wrong = misspelt(line.key)
    yield "misspelt", f"{wrong} = {line.value}", "kind" if line.key == "kind" else wrong  # lists the existing keys
    if line.key not in OPTIONAL.get(line.table, "").split():
        yield "left out", None, line.key
    if line.numeral:
        yield "text with a unit", f'{line.key} = "{line.value} {UNITS.get(line.key, "m")}"', line.key
        yield "nan", f"{line.key} = nan", line.key
        yield "in brackets", f"{line.key} = [{line.value}]", line.key
        if float(line.value) > 0.0 and line.key not in SIGNED.get(line.table, "").split():
            yield "below zero", f"{line.key} = -{line.value}", line.key
    if line.word:
        word = line.value.strip('"')
        yield "a number", f"{line.key} = 1", line.key
        yield "another word", f'{line.key} = "{misspelt(word)}"', misspelt(word)


def headings(source: Source) -> Iterator[tuple[str, str, str]]:
    """Ways to misspell a heading: a description, the new text, and what the message must name."""
    for place, line in enumerate(source.text.splitlines()):
        if (head := HEAD.fullmatch(line.strip())) and not head[2].count('"'):
            first, *rest = head[2].split(".")
            wrong = ".".join([misspelt(first), *rest])
            yield head[2], changed(source.text, place, f"{head[1]}{wrong}{head[3]}"), NAMED.get(first, misspelt(first))


def whole(text: str) -> dict[str, str | bytes]:
    """Changes that editors, mail and other programs make to a file."""
    value = next(line for line in lines(text) if "." in line.value and line.numeral)
    word = next(line for line in lines(text) if line.word)
    bracket = next(place for place, line in enumerate(text.splitlines()) if line.startswith("["))
    return {
        "empty": "", "of another program": "<?xml version='1.0'?>\n<model/>\n",
        "cut off in a value": text[: len(text) // 2].rpartition("=")[0] + "= ",
        "with a decimal comma": changed(text, value.place, f"{value.key} = {value.value.replace('.', ',')}"),
        "with a unit behind a number": changed(text, value.place, f"{value.key} = {value.value} m"),
        "with a colon for =": changed(text, value.place, f"{value.key}: {value.value}"),
        "with a key twice": changed(text, value.place, f"{value.key} = {value.value}\n{value.key} = {value.value}"),
        "with typographic quotes": changed(text, word.place, f"{word.key} = \u201c{word.value.strip(chr(34))}\u201d"),
        "with a word without quotes": changed(text, word.place, f"{word.key} = {word.value.strip(chr(34))}"),
        "with a bracket missing": changed(text, bracket, text.splitlines()[bracket].rstrip("]")),
        "with a comment of //": f"// a comment\n{text}", "in UTF-16": text.encode("utf-16"),
        "in Latin-1": f"# f\u00fcr\n{text}".encode("latin-1"),
        "with a conflict of git": f"<<<<<<< HEAD\n{text}=======\n",
        "with zero bytes": text.encode().replace(b"\n", b"\n\0", 1),
        "a calculation": changed(text, value.place, f"{value.key} = {value.value} * 2"),
    }  # fmt: skip


def rows() -> list[Broken]:
    """All of them."""
    found: list[Broken] = []
    done: set[tuple[str, str, str]] = set()
    for source in SOURCES:
        for what, text, name in headings(source):
            if (source.reader, what, "heading") not in done:
                done.add((source.reader, what, "heading"))
                make = reads(source.name, source.reader, text)
                found.append(Broken(f"{source.name}: [{what}] misspelt", make, "", (f"{source.name}.toml", name)))
        if source.name in WHOLE:
            for how, content in whole(source.text).items():
                make = reads(source.name, source.reader, content)
                found.append(Broken(f"{source.name}: the file {how}", make, "", (f"{source.name}.toml",)))
        for line in lines(source.text):
            for how, new, name in broken_line(line):
                if (source.reader, line.name, how) in done or (source.reader, line.name) == VARIED:
                    continue
                done.add((source.reader, line.name, how))
                make = reads(source.name, source.reader, changed(source.text, line.place, new))
                found.append(Broken(f"{source.name}: {line.name} {how}", make, "", (f"{source.name}.toml", name)))
    return found
