"""How the project is built: modules, folders, names, arrows of the import graph, lines that stand twice.

`python -m reports.tools.structure [CHECKOUT] [--out DIR]`. Read from the sources of this checkout, or of another one
beside it in a second column; nothing is imported. Figures are those of the two packages; of reports and tests, modules
and folders are counted. Lines are not blank. An arrow is an import, those inside functions and those for types alone
too; a circle is a set of modules, or of folders, that reach each other along arrows. Two folders of which each imports
the other are on no order of floors.
"""

import argparse
import ast
import hashlib
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from statistics import median

from reports.tables import OUT, ROOT, Row, show, write
from reports.tools.imports_of_tests import of_tests

PACKAGES = ("casingfem", "contact")
BESIDE = ("reports", "tests")  # of which modules and folders are counted, no more
TOGETHER = 6  # lines, one below the other, that are in two places: a duplicate
Graph = Mapping[str, frozenset[str]]


@dataclass(frozen=True, eq=False)
class Structure:
    """Modules by dotted name and what they import."""

    root: Path

    @cached_property
    def files(self) -> dict[str, Path]:
        """Path of every module; a package is named by its folder."""
        found = {}
        for package in PACKAGES:
            for path in sorted((self.root / package).rglob("*.py")):
                name = ".".join(path.relative_to(self.root).with_suffix("").parts)
                found[name.removesuffix(".__init__")] = path
        return found

    @cached_property
    def trees(self) -> dict[str, ast.Module]:
        """Parsed sources."""
        return {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in self.files.items()}

    @cached_property
    def lines(self) -> dict[str, list[str]]:
        """Lines that are not blank, without the space around them."""
        texts = {name: path.read_text(encoding="utf-8") for name, path in self.files.items()}
        return {name: [line.strip() for line in text.splitlines() if line.strip()] for name, text in texts.items()}

    @cached_property
    def bodies(self) -> dict[str, list[str]]:
        """Lines as in `lines`, without those of imports, which may run over several."""
        found = {}
        for name, tree in self.trees.items():
            imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
            left_out = {row for node in imports for row in range(node.lineno, (node.end_lineno or node.lineno) + 1)}
            text = self.files[name].read_text(encoding="utf-8").splitlines()
            found[name] = [line.strip() for row, line in enumerate(text, 1) if line.strip() and row not in left_out]
        return found

    @cached_property
    def imports(self) -> Graph:
        """Modules that each imports; names handed on by a package's face are not followed."""
        return {name: frozenset(self._imports(name, tree)) for name, tree in self.trees.items()}

    def _imports(self, name: str, tree: ast.Module) -> Iterable[str]:
        for node in statements(tree):
            if isinstance(node, ast.Import):
                yield from (alias.name for alias in node.names if alias.name in self.files)
            elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
                for alias in node.names:
                    whole = f"{node.module}.{alias.name}"
                    target = whole if whole in self.files else node.module
                    if target in self.files and target != name:
                        yield target

    @cached_property
    def folders(self) -> Graph:
        """Folders that each imports from, files of one folder left out."""
        of = {
            name: path.parent.relative_to(self.root).as_posix() for name, path in self.files.items()
            if path.name != "__main__.py"  # the way in, which is at the top and opens the command line
        }  # fmt: skip
        found: dict[str, set[str]] = {folder: set() for folder in of.values()}
        for name, folder in of.items():
            found[folder] |= {of[target] for target in self.imports[name]} - {folder}
        return {folder: frozenset(targets) for folder, targets in found.items()}


def statements(tree: ast.AST) -> Iterator[ast.AST]:
    """Statements at every depth; a tenth of the nodes that `ast.walk` visits."""
    for name in ("body", "orelse", "finalbody", "handlers", "cases"):
        for node in getattr(tree, name, ()):
            yield node
            yield from statements(node)


def circles(graph: Graph) -> list[list[str]]:
    """Sets of nodes that reach each other (Tarjan, SIAM J. Comput. 1, 1972, 146), the largest first."""
    number: dict[str, int] = {}
    low: dict[str, int] = {}
    open_: list[str] = []
    found = []

    def visit(node: str) -> None:
        number[node] = low[node] = len(number)
        open_.append(node)
        for target in sorted(graph[node]):
            if target not in number:
                visit(target)
                low[node] = min(low[node], low[target])
            elif target in open_:
                low[node] = min(low[node], number[target])
        if low[node] == number[node]:
            at = open_.index(node)
            found.append(sorted(open_[at:]))
            del open_[at:]

    for node in sorted(graph):
        if node not in number:
            visit(node)
    return sorted((one for one in found if len(one) > 1), key=len, reverse=True)


def duplicates(lines: Mapping[str, list[str]]) -> int:
    """Places where `TOGETHER` lines or more repeat others; comments, brackets and examples of docstrings left out."""
    seen: dict[str, tuple[str, int]] = {}
    count = 0
    for name, all_ in lines.items():
        kept = [line for line in all_ if not line.startswith(("#", '"""', ")", "]", "}", "@", ">>>", "..."))]
        at = 0
        while at + TOGETHER <= len(kept):
            block = hashlib.sha256("\n".join(kept[at : at + TOGETHER]).encode()).hexdigest()
            first = seen.setdefault(block, (name, at))
            count += first != (name, at)
            at += 1 if first == (name, at) else TOGETHER
    return count


def exported(structure: Structure, package: str) -> int:
    """Names that a package offers at its top: those of its stub, else of its face."""
    stub = structure.root / package / "__init__.pyi"
    tree = ast.parse(stub.read_text(encoding="utf-8")) if stub.exists() else structure.trees[package]
    names = {
        alias.asname or alias.name for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names
    }
    return len({name for name in names if not name.startswith("_")})


def calls(tree: ast.AST, name: str) -> int:
    """How often a function is called by this name."""
    return sum(isinstance(n, ast.Call) and isinstance(n.func, ast.Name) and n.func.id == name for n in ast.walk(tree))


def modules_of(root: Path, top: str) -> Counter[str]:
    """Modules in each folder below a top folder of a checkout; results of reports left out."""
    paths = [path.relative_to(root) for path in (root / top).rglob("*.py")]
    return Counter(path.parent.as_posix() for path in paths if "out" not in path.parts)


def entries(structure: Structure) -> int:
    """Step loops of `contact` that numba compiles and Python calls."""
    return sum(
        isinstance(node, ast.FunctionDef)
        and any(isinstance(d, ast.Name) and d.id in ("jit_entry", "jit_vectors") for d in node.decorator_list)
        and node.name.startswith("advance")
        for name, tree in structure.trees.items()
        if name.startswith("contact.loop")
        for node in ast.walk(tree)
    )


def on_the_way(structure: Structure, words: frozenset[str] = frozenset({"mu", "friction"})) -> int:
    """Modules of `contact` that use a friction coefficient, as a name, an argument, a keyword or an attribute."""

    def uses(node: ast.AST) -> bool:
        named = getattr(node, "id", getattr(node, "arg", getattr(node, "attr", "")))
        return isinstance(node, ast.Name | ast.arg | ast.keyword | ast.Attribute) and named in words

    return sum(any(map(uses, ast.walk(tree))) for name, tree in structure.trees.items() if name.startswith("contact."))


def measures(structure: Structure) -> dict[str, str]:
    """Every figure by its name."""
    code = {name: len(lines) for name, lines in structure.lines.items()}
    largest = max(code, key=lambda name: code[name])
    folders = {top: modules_of(structure.root, top) for top in (*PACKAGES, *BESIDE)}
    per_folder = sum((folders[package] for package in PACKAGES), Counter[str]())
    folder, count = per_folder.most_common(1)[0]
    importers: dict[str, set[str]] = defaultdict(set)
    for name, targets in structure.imports.items():
        for target in targets:
            importers[target].add(name)
    both = sum(a < b and a in structure.folders[b] for a, targets in structure.folders.items() for b in targets)
    loops = circles(structure.imports)
    tests = of_tests(structure.root)
    return {
        "modules": str(len(code)),
        "lines": str(sum(code.values())),
        "median module": f"{median(code.values()):g}",
        "largest module": f"{code[largest]} {largest}",
        "largest folder": f"{count} {folder}",
        "folders over 25 modules": str(sum(n > 25 for n in per_folder.values())),
        **{f"names of {package}": str(exported(structure, package)) for package in PACKAGES},
        "isinstance in contact": str(
            sum(calls(tree, "isinstance") for name, tree in structure.trees.items() if name.startswith("contact"))
        ),
        "lines of contact": str(sum(n for name, n in code.items() if name.startswith("contact"))),
        "step loops of contact": str(entries(structure)),
        "modules of contact that use a friction coefficient": str(on_the_way(structure)),
        "modules with one importer": str(sum(len(found) == 1 for found in importers.values())),
        "duplicates": str(duplicates(structure.bodies)),
        "circles of modules": f"{len(loops)}: {sum(map(len, loops))} modules",
        "pairs of folders that import each other": str(both),
        "largest circle of folders": str(max(map(len, circles(structure.folders)), default=0)),
        **{f"modules of {top}": str(folders[top].total()) for top in BESIDE},
        **{
            f"largest folder of {top}": " ".join(f"{n} {name}" for name, n in folders[top].most_common(1))
            for top in BESIDE
        },
        "tests that use public names only": f"{sum(not names for names in tests.values())} of {len(tests)}",
        "internal names in tests": str(sum(map(len, tests.values()))),
    }


def main(checkouts: Iterable[Path], out: Path = OUT) -> list[Row]:
    """Print and write the table; returns its rows."""
    found = {path.resolve().name if path != ROOT else "here": measures(Structure(path)) for path in checkouts}
    rows: list[Row] = [
        {"figure": name, **{where: figures[name] for where, figures in found.items()}}
        for name in next(iter(found.values()))
    ]
    show("How the project is built", rows)
    write(out / "structure.csv", rows)
    return rows


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", type=Path, nargs="?", help="another checkout, beside this one")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the table")
    given = parser.parse_args()
    if given.other is not None and not (given.other / "casingfem").is_dir():
        parser.error(f"{given.other}: found no casingfem/, expected a checkout")
    main([ROOT] if given.other is None else [given.other, ROOT], given.out)
