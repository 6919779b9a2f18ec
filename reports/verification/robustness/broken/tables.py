"""Broken models, part four: tables and responses with faults of test software, spreadsheets and manual editing.

Each table is a file of its own; the message must name the file and the fault in it.
"""

import warnings
from collections.abc import Callable
from pathlib import Path

import contact as ct
import reports.verification.robustness.diverging as scenes
from casingfem.study.load import load_study
from reports.verification.robustness.broken.keys import beside
from reports.verification.robustness.broken.shells import Broken
from reports.verification.robustness.broken.sources import WHEEL
from reports.verification.robustness.sample_files import READERS

# column of a number, that number's text, and a column that must be there
TABLES = {
    "table.csv": ("freq_hz", "371.2"), "survey.csv": ("radius_m", "0.5000"), "blades.csv": ("deviation", "-0.01"),
    "places.csv": ("angle_deg", "36.5"), "picks.csv": ("freq_hz", "371.2"), "profile.csv": ("depth_m", "2.5e-5"),
}  # fmt: skip
# wrong contents of the cell of a number
CELLS = {
    "a word": "broken", "a decimal comma": "371,2", "a question mark": "?", "its unit": "371.2 Hz", "nan": "nan",
    "inf": "inf", "a thousands mark": "1'000.0", "an error of a spreadsheet": "#DIV/0!", "nothing": "",
    "two points": "3.7.1", "a date": "2.Mai", "a calculation": "=371.2*1",
}  # fmt: skip


def read(name: str, change: Callable[[str], str | bytes]) -> Callable[[], object]:
    """Read a sample file of this name with its text changed."""

    def make() -> object:
        folder = Path(beside().name)
        path = folder / f"broken_{name}"
        text = change((folder / name).read_text(encoding="utf-8"))
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        try:
            return READS[name](path)
        finally:
            path.unlink()

    return make


def in_scene(path: Path) -> object:
    """A profile as a scene reads it."""
    scene = path.with_name("profiled.toml")
    scene.write_text(scenes.changed(scenes.RUB, ("friction", f'profile = "{path.name}"\nfriction')), encoding="utf-8")
    return ct.load_scene(scene)


def in_wheel(path: Path) -> object:
    """Deviations as a study reads them."""
    study = path.with_name("mistuned.toml")
    study.write_text(WHEEL.replace("blades.csv", path.name), encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of its mesh
        return load_study(study, wheel=True)


READS = READERS | {"profile.csv": in_scene, "blades.csv": in_wheel}


def once(old: str, new: str) -> Callable[[str], str]:
    """Replace the first occurrence of a text by another."""

    def change(text: str) -> str:
        assert old in text, old
        return text.replace(old, new, 1)

    return change


def head(text: str) -> int:
    """End of the line of column names."""
    lines = text.splitlines(keepends=True)
    cards = sum(1 for line in lines if line.startswith("#"))
    return sum(map(len, lines[: cards + 1]))


def tables() -> list[Broken]:
    """The same faults for every table."""
    found = []
    for name, (column, number) in TABLES.items():
        shapes: dict[str, tuple[Callable[[str], str | bytes], str]] = {
            "without its column names": (lambda text: text[head(text) :], ""),
            "with a column misnamed": (once(column, f"{column}x"), column),
            "with nothing but column names": (lambda text: text[: head(text)], ""),
            "empty": (lambda text: "", ""),
            "with a row cut short": (lambda text: text.rstrip("\n").rpartition(",")[0] + "\n", ""),
            "with a row too long": (lambda text: text.rstrip("\n") + ",1.0,2.0\n", "line"),
            "as a workbook": (lambda text: b"PK\x03\x04\x14\x00\x06\x00" + bytes(range(256)), ""),
            "with a column twice": (once(column, f"{column},{column}"), column),
        }
        cells = dict(CELLS)
        if name == "picks.csv":  # tables of one column: rows cannot be short, and an empty row is ignored
            del shapes["with a row cut short"], cells["nothing"]
        found += [
            Broken(f"{name} {how}", read(name, change), "", (name, named)) for how, (change, named) in shapes.items()
        ]
        found += [
            Broken(f"{name}, {column} holds {what}", read(name, once(number, cell)), "", (name, "line"))
            for what, cell in cells.items()
        ]
    return found


def frequencies() -> list[Broken]:
    """Faults of frequency tables."""
    ways = {
        "a frequency below zero": ("371.2", "-371.2", "freq_hz"), "a frequency of zero": ("371.2", "0", "freq_hz"),
        "a sigma of zero": ("371.2,0.4", "371.2,0", "sigma_hz"),
        "a sigma below zero": ("371.2,0.4", "371.2,-1", "sigma_hz"),
        "a mode twice": ("\n2,8", "\n1,8", "mode"), "a mode of 1.5": ("\n2,8", "\n1.5,8", "mode"),
        "nodal diameters of 7.5": ("\n3,7", "\n3,7.5", "n"), "nodal diameters below zero": ("\n3,7", "\n3,-7", "n"),
        "a damping ratio in per cent": ("0.0021", "21", "zeta"),
        "a damping ratio below zero": ("0.0021", "-0.0021", "zeta"),
    }  # fmt: skip
    return [
        Broken(f"table.csv: {what}", read("table.csv", once(old, new)), "", ("table.csv", name))
        for what, (old, new, name) in ways.items()
    ]


def others() -> list[Broken]:
    """Surveys, places, profiles, deviations, responses."""
    ways = (
        ("survey.csv", "a radius below zero", "0.5000", "-0.5", "radius"),
        ("places.csv", "a point twice", "\n5,36.5", "\n3,36.5", "3"),
        ("places.csv", "a point of 5.5", "\n5,36.5", "\n5.5,36.5", "point"),
        ("places.csv", "a radius below zero", "36.5,0.45", "36.5,-0.45", "radius"),
        ("profile.csv", "an angle twice", "\n180,0", "\n90,0", "line 4"),
        ("profile.csv", "angles that descend", "\n180,0", "\n45,0", "line 4"),
        ("blades.csv", "a blade twice", "\n3,", "\n2,", "2"),
        ("blades.csv", "a blade left out", "\n3,-0.01\n", "\n", "blade"),
        ("blades.csv", "a blade of number 0", "\n1,", "\n0,", "0"),
    )
    return [
        Broken(f"{name}: {what}", read(name, once(old, new)), "", (name, said)) for name, what, old, new, said in ways
    ]


def missing(name: str) -> Broken:
    """A missing file, read by its reader."""
    reader = READERS[name]
    ending = name.rpartition(".")[2]
    return Broken(
        f"no {name}", lambda: reader(Path(beside().name) / f"not_there.{ending}"), "", (f"not_there.{ending}",)
    )


def folders(name: str) -> Broken:
    """A folder in place of a file."""

    def make() -> object:
        path = Path(beside().name) / f"folder_{name}"
        path.mkdir(exist_ok=True)
        return READERS[name](path)

    return Broken(f"a folder for {name}", make, "", (f"folder_{name}",))


def other_format(name: str, content: str) -> Broken:
    """A file of another kind under this name."""

    def make() -> object:
        path = Path(beside().name) / f"other_{name}"
        path.write_bytes((Path(beside().name) / content).read_bytes())
        return READERS[name](path)

    return Broken(f"{content} under the name {name}", make, "", (f"other_{name}",))


# files whose name states another kind
MIXED = {
    "frfs.npz": "blade.npz", "blade.npz": "frfs.npz", "scan.npz": "casing.npz", "identified.npz": "frfs.npz",
    "result.npz": "blade.npz", "craig_bampton.npz": "result.npz", "frfs.csv": "survey.csv",
    "table.csv": "places.csv", "survey.csv": "table.csv", "frfs.h5": "part.h5", "part.h5": "frfs.h5",
    "part.mat": "part.h5", "mesh.inp": "mesh.bdf", "mesh.bdf": "mesh.inp", "mesh.msh": "mesh.cdb",
    "mesh.vtu": "mesh.msh", "mesh.cdb": "mesh.msh", "part.op4": "part.pch", "part.pch": "part.op4",
    "55.uff": "table.csv", "part.npz": "blade.npz", "places.csv": "table.csv", "profile.csv": "blades.csv",
    "picks.csv": "profile.csv", "blades.csv": "picks.csv",
}  # fmt: skip


def rows() -> list[Broken]:
    """All of them."""
    mixed = [other_format(name, content) for name, content in MIXED.items()]
    whole = [make(name) for name in READERS for make in (missing, folders) if name != "run.json"]
    loose = Broken("blades.csv: a deviation below -1", read("blades.csv", once("-0.01", "-1.5")), "cyclic-mistuning")
    return [loose, *tables(), *frequencies(), *others(), *mixed, *whole]
