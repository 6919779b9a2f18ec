"""Distance of tests from a function: the number of references between them, read from the sources.

References are names: those that a function, class or constant at the top of a file uses, the fixtures of a test, and
modules that a text names. The examples of a docstring are a test. No code is run, so compiled loops and code of other
processes are found too.
"""

import ast
import doctest
import hashlib
import itertools
import string
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

Unit = tuple[str, str]  # a file and a name at its top; "": its other statements
SLOW = "mark.slow"
PATH = frozenset(f"{string.ascii_letters}{string.digits}_.")
FAR = 1000.0


@dataclass(frozen=True, slots=True)
class Source:
    """A parsed file: the names of its imports, and its units."""

    file: str
    imports: dict[str, Unit]
    units: dict[str, list[ast.stmt]]
    slow: bool


@dataclass(frozen=True, slots=True)
class Reach:
    """Units that refer to a unit, and the names of attributes that a unit uses."""

    users: Mapping[Unit, frozenset[Unit]]
    attributes: Mapping[Unit, frozenset[str]]
    tests: Mapping[Unit, bool]  # whether it is slow

    def distances(self, unit: Unit) -> dict[Unit, int]:
        """References between a unit and each test that reaches it."""
        found, edge, steps = {unit: 0}, {unit}, 0
        while edge:
            steps += 1
            edge = {user for there in edge for user in self.users.get(there, frozenset())} - found.keys()
            found |= dict.fromkeys(edge, steps)
        return {there: found[there] for there in self.tests if there in found}

    def nearest(self, file: str, function: str, seed: int) -> list[str]:
        """Tests in the order in which they are likely to see a change, those of one file together.

        Nearer ones first; tests in a file named like the changed one, in the folder that is its folder's or a little
        above it or has its name in theirs, tests named like the changed function, and tests that use the changed method
        by its name, count as nearer, slow ones as farther; files that are equally near come at random.
        """
        top, _, method = function.rpartition(".")
        near = self.distances((file, function.partition(".")[0]))
        words, folder = set(Path(file).stem.split("_")), Path("tests", file).parent.parts
        room, of_function = set(Path(file).parent.name.split("_")), set(method.split("_")) - {""}

        def rank(test: Unit) -> float:
            of_test = set(Path(test[0]).stem.split("_"))
            own, of_room = of_test & words, of_test & room
            named = bool(top) and method in self.attributes[test]
            alike = len(of_function & set(test[1].split("_"))) / max(1, len(of_function))
            own_folder = Path(test[0]).parent.parts
            beside = len(own_folder) / len(folder) if own_folder == folder[: len(own_folder)] else 0.0
            nearer = named + alike + beside + 2.0 * len(own) / len(words) + 4.0 * len(of_room) / len(room)
            return near.get(test, FAR) + 0.5 * self.tests[test] - nearer

        ranks = {test: rank(test) for test in self.tests}
        files: dict[str, float] = {}
        for test, value in ranks.items():
            files[test[0]] = min(files.get(test[0], 2.0 * FAR), value)
        order = sorted(self.tests, key=lambda test: (files[test[0]], shuffled(test[0], seed), test[0], ranks[test]))
        return [f"{test}::{name}" for test, name in order]


def shuffled(file: str, seed: int) -> str:
    """A random order that is the same in every process."""
    return hashlib.sha256(f"{seed} {file}".encode()).hexdigest()


def parse(root: Path, path: Path) -> Source:
    """Read one file."""
    file, text = path.relative_to(root).as_posix(), path.read_text("utf-8")
    tree = ast.parse(text)
    # what a package passes on when it is asked is in a stub beside it
    stub = ast.parse(path.with_suffix(".pyi").read_text("utf-8")) if path.with_suffix(".pyi").exists() else None
    imports = imported(file, [tree, *([stub] if stub else [])])
    units: dict[str, list[ast.stmt]] = {}
    for statement in tree.body:
        if not isinstance(statement, ast.Import | ast.ImportFrom):
            for name in defined(statement):
                units.setdefault(name, []).append(statement)
    for name, text in documented(tree, file.removesuffix(".py").removesuffix("/__init__").replace("/", ".")):
        examples = doctest.DocTestParser().get_examples(text)
        if examples:
            units[name] = ast.parse("".join(example.source for example in examples)).body
            imports = imported(file, units[name]) | imports
    slow = any(SLOW in ast.unparse(there) for there in units.get("pytestmark", []))
    return Source(file, imports, units, slow)


def imported(file: str, trees: Iterable[ast.AST]) -> dict[str, Unit]:
    """Names that imports define, with their sources."""
    found: dict[str, Unit] = {}
    for node in itertools.chain.from_iterable(map(ast.walk, trees)):
        if isinstance(node, ast.ImportFrom):
            above = [".".join(Path(file).parts[: -node.level])] if node.level else []
            module = ".".join([*above, *([node.module] if node.module else [])])
            found |= {name.asname or name.name: (module, name.name) for name in node.names}
        elif isinstance(node, ast.Import):
            found |= {name.asname or name.name: (name.name, "") for name in node.names}
    return found


def documented(node: ast.Module | ast.ClassDef | ast.FunctionDef, name: str) -> Iterator[tuple[str, str]]:
    """The docstrings of a module and of what it defines, by their dotted names."""
    yield name, ast.get_docstring(node) or ""
    for inner in node.body:
        if isinstance(inner, ast.ClassDef | ast.FunctionDef):
            yield from documented(inner, f"{name}.{inner.name}")


def defined(statement: ast.stmt) -> list[str]:
    """Names that a statement defines, or "" for none."""
    if isinstance(statement, ast.FunctionDef | ast.ClassDef):
        return [statement.name]
    stored = [n.id for n in ast.walk(statement) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)]
    return stored if stored and isinstance(statement, ast.Assign | ast.AnnAssign) else [""]


def names(statements: Iterable[ast.stmt]) -> Iterator[str]:
    """Names that statements use, with what they take from modules as "room.module.name"; arguments may be fixtures."""
    for statement in statements:
        for node in ast.walk(statement):
            if isinstance(node, ast.Name):
                yield node.id
            elif isinstance(node, ast.arg):
                yield node.arg
            elif isinstance(node, ast.Attribute) and set(ast.unparse(node)) <= PATH:
                yield ast.unparse(node)


def written(statements: Iterable[ast.stmt]) -> Iterator[str]:
    """Texts with a dot: a test that runs a loop without compiling it names its module by one."""
    for statement in statements:
        for node in ast.walk(statement):
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and "." in node.value:
                yield node.value


def read_reach(root: Path, packages: Iterable[str], beside: Iterable[str]) -> Reach:
    """The references of all files of packages and of folders beside them, below a root.

    Tests are those in files named so, and the examples of the packages.
    """
    examples = tuple(f"{name}/" for name in packages)
    paths = sorted(path for folder in (*packages, *beside) for path in (root / folder).rglob("*.py"))
    paths = [path for path in paths if "out" not in path.relative_to(root).parts]  # results hold copies
    sources = {source.file: source for source in (parse(root, path) for path in paths)}
    modules = {file.removesuffix(".py").removesuffix("/__init__").replace("/", "."): file for file in sources}
    # tests import what is beside them by its bare name
    modules |= {Path(file).stem: file for file in sources if file.startswith("tests/")}
    fixtures = next((file for file in sources if file.endswith("tests/conftest.py")), "")

    def meant(file: str, name: str) -> Unit | None:
        """The unit behind a name in a file, also through files that only re-export it."""
        source = sources.get(file)
        if source is None or name in source.units:
            return None if source is None else (file, name)
        first, _, rest = name.partition(".")
        if first not in source.imports:
            return (fixtures, first) if fixtures and first in sources[fixtures].units and "tests/" in file else None
        module, there = source.imports[first]
        inner = f"{module}.{there}" if there else module
        if inner in modules:
            return meant(modules[inner], rest) if rest else None
        return meant(modules.get(module, ""), there)

    users: defaultdict[Unit, set[Unit]] = defaultdict(set)
    attributes: dict[Unit, frozenset[str]] = {}
    for file, source in sources.items():
        for name, statements in source.units.items():
            used = set(names(statements))
            for target in {meant(file, word) for word in used} | {(file, "")}:
                if target not in (None, (file, name)):
                    users[target].add((file, name))
            for other in {modules[text] for text in written(statements) if text in modules} - {file}:
                for unit in sources[other].units:
                    users[other, unit].add((file, name))
            attributes[file, name] = frozenset(word.rpartition(".")[2] for word in used if "." in word)
    tests = {
        (file, name): source.slow or any(SLOW in ast.unparse(d) for s in body for d in getattr(s, "decorator_list", []))
        for file, source in sources.items()
        for name, body in source.units.items()
        if ("." in name and file.startswith(examples))
        or (name.startswith(("test_", "Test")) and Path(file).name.startswith("test_"))
    }
    return Reach({unit: frozenset(found) for unit, found in users.items()}, attributes, tests)
