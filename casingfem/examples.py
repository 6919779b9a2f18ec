"""Examples that are part of the program: the studies and scenes of data/, and the files that each needs.

They are in data/ of a checkout, and in casingfem/data of an installation. The files that an example needs are read from
its own file: the tables it names, and the studies whose reduction makes the bases it names. A folder of scenes with a
README.md is an example too: all its files, and the commands that the README names.
"""

import shlex
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from casingfem.extras import ROOT

INSTALLED = Path(__file__).parent / "data"
DATA = INSTALLED if INSTALLED.is_dir() else ROOT / "data"
# by the kind of a scene; else contact
VERBS = {"pair": "stability", "rim": "rub", "rub": "rub", "disk": "rub", "rotor": "rub"}


@dataclass(frozen=True, slots=True)
class Example:
    """A study or a scene: its name, its file below the folder of the examples, and its tables as written."""

    name: str
    file: Path
    tables: dict[str, Any]

    @property
    def about(self) -> str:
        """The first sentence of the file's comment."""
        return first_sentence((DATA / self.file).read_text(encoding="utf-8"))

    @property
    def verb(self) -> str:
        """The command that runs it."""
        if "scene" in self.tables:
            own = next(
                (
                    verb
                    for key, verb in (("sweep", "sweep"), ("drive", "cycles"), ("chance", "chance"))
                    if key in self.tables
                ),
                None,
            )
            return own or VERBS.get(self.tables["scene"]["kind"], "contact")
        random = any("random" in part for part in self.tables.get("imperfection", ()))
        return next((verb for verb in ("rig", "update") if verb in self.tables), "mistune" if random else "modes")

    @property
    def makers(self) -> tuple[Path, ...]:
        """The studies that make the bases it names, from its folder or from the studies."""
        wanted = dict.fromkeys(value for key, value in strings(self.tables) if key == "basis")
        return tuple(maker(name, self.file.parent) for name in wanted if not (DATA / self.file.parent / name).exists())

    @property
    def files(self) -> tuple[Path, ...]:
        """All files that it needs, below the folder of the examples; its own file first."""
        found = [self.file]
        for file in (self.file, *self.makers):
            named = [file.parent / value for _, value in strings(read(file))]
            found += [file, *(below(path) for path in named if path.suffix and (DATA / path).is_file())]
        return tuple(dict.fromkeys(found))

    def commands(self, folder: Path) -> tuple[str, ...]:
        """Commands that run the example in `folder`; commands that make its bases come first."""
        bases = [["reduce", str(folder / path), "--out", str(folder / self.file.parent)] for path in self.makers]
        return tuple(shlex.join(["casingfem", *words]) for words in (*bases, [self.verb, str(folder / self.file)]))


@dataclass(frozen=True, slots=True)
class ExampleFolder:
    """A self-contained folder of studies and scenes; its README.md, below the folder of the examples."""

    name: str
    file: Path

    @property
    def about(self) -> str:
        """The first sentence below the README's title."""
        text = (DATA / self.file).read_text(encoding="utf-8").partition("\n\n")[2]
        return first_sentence("".join(f"# {line}\n" for line in text.partition("\n\n")[0].splitlines()))

    @property
    def verb(self) -> str:
        """Text that is shown instead of a single command."""
        return "folder"

    @property
    def files(self) -> tuple[Path, ...]:
        """All files in the folder, its README first."""
        folder = self.file.parent
        return self.file, *(folder / path.name for path in sorted((DATA / folder).iterdir()) if path.suffix in KEPT)

    def commands(self, folder: Path) -> tuple[str, ...]:
        """A command that enters the folder, then the commands of the README's code blocks."""
        lines = (DATA / self.file).read_text(encoding="utf-8").splitlines()
        named = [line.partition("#")[0].strip() for line in lines if line.startswith("casingfem ")]
        return shlex.join(["cd", str(folder / self.file.parent)]), *named


AnyExample: TypeAlias = Example | ExampleFolder
KEPT = (".toml", ".csv")  # files of a folder of scenes, except its README


def examples() -> dict[str, AnyExample]:
    """All examples by name: studies by file name, scenes by path below data/scenes, folders that have a README.

    >>> examples()["two_rods"].commands(Path("data"))
    ('casingfem contact data/scenes/two_rods.toml',)
    """
    found: dict[str, AnyExample] = {}
    for path in sorted((DATA / "scenes").glob("*/README.md")):
        found[path.parent.name] = ExampleFolder(path.parent.name, path.relative_to(DATA))
    for kind, mark in (("studies", "material"), ("scenes", "scene")):
        for path in sorted((DATA / kind).rglob("*.toml")):
            file = path.relative_to(DATA)
            tables = read(file)
            if mark in tables:
                name = file.relative_to(kind).with_suffix("").as_posix()
                found[name] = Example(name, file, tables)
    return found


def maker(basis: str, folder: Path) -> Path:
    """The study whose key reduce.out is `basis`, next to a scene or among the studies."""
    for path in (*sorted((DATA / folder).glob("*.toml")), *sorted((DATA / "studies").glob("*.toml"))):
        file = path.relative_to(DATA)
        if read(file).get("reduce", {}).get("out") == basis:
            return file
    raise FileNotFoundError(2, "no study makes this basis", str(folder / basis))


def read(file: Path) -> dict[str, Any]:
    """The tables of a file below the folder of the examples."""
    return tomllib.loads((DATA / file).read_text(encoding="utf-8"))


def below(path: Path) -> Path:
    """A path below the folder of the examples without `..`."""
    return (DATA / path).resolve().relative_to(DATA.resolve())


def strings(tables: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """Every string of nested tables, with its key.

    >>> list(strings({"casing": {"basis": "casing.npz"}, "speed": [1.0, {"of": "hz"}]}))
    [('basis', 'casing.npz'), ('of', 'hz')]
    """
    if isinstance(tables, str):
        yield key, tables
    elif isinstance(tables, dict):
        for name, value in tables.items():
            yield from strings(value, name)
    elif isinstance(tables, list):
        for value in tables:
            yield from strings(value, key)


def first_sentence(text: str) -> str:
    r"""The first sentence of a file's comment.

    >>> first_sentence("# A casing on the bench,\n# by day. What it is for.\n[material]")
    'A casing on the bench, by day.'
    """
    lines = []
    for line in text.splitlines():
        if not line.startswith("# "):
            break
        lines.append(line[2:])
        if line.endswith((".", ":")):
            break
    words, _, more = " ".join(lines).partition(". ")
    return f"{words}." if more else words


FIRST = {
    "scenes/first_rub.toml": "rub.toml",
    "studies/rig_casing.toml": "casing.toml",
    "studies/rig_blade.toml": "blade.toml",
    "surveys/rig_casing.csv": "survey.csv",
    "experiments/rig_casing.csv": "frequencies.csv",
}  # files of a new project, and their names in it
STEPS = ("modes casing.toml", "update casing.toml", "reduce casing.toml --out .", "reduce blade.toml --out .",
         "rub rub.toml --out results", "interactions rub.toml --runs 10 --out results",
         "report casing.toml --out results")  # fmt: skip


def first_files() -> dict[str, str]:
    """A study, a blade, a scene, a survey and a frequency table for one folder, by their names there.

    >>> sorted(first_files())
    ['blade.toml', 'casing.toml', 'frequencies.csv', 'rub.toml', 'survey.csv']
    """
    places = {f"../{there}": here for there, here in FIRST.items()}
    bases = {f"{Path(there).stem}.npz": f"{Path(here).stem}.npz" for there, here in FIRST.items() if "studies" in there}
    found = {}
    for there, here in FIRST.items():
        text = (DATA / there).read_text(encoding="utf-8")
        for old, new in (places | bases).items() if here.endswith(".toml") else ():
            text = text.replace(f'"{old}"', f'"{new}"')
        found[here] = text.replace(f"data/{there} --out reports/out", f"{here} --out results")
    return found
