"""What tests import of the packages: public names, or names that only the packages themselves should use.

Public are the names in the stubs of `casingfem`, `contact` and their rooms, taken from there: `cf.modes` is public,
`casingfem.modal.modes.modes` is not. The error classes and `casingfem.cli.main`, the command line, are public too.
Imports inside functions count. So do attributes of modules (`cf.edge.ring`), names in strings that `monkeypatch`
replaces (`"casingfem.io.npz.np"`) and modules that are imported by a string (`import_module("contact.run")`), also by
`tests/contact/plain.py`.
"""

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

PACKAGES = ("casingfem", "contact")
APART = ("contact.gpu", "contact.solver")  # public packages that are imported by their own names
OPEN_MODULES = ("casingfem.errors", "casingfem.structure.shell.loads")  # every name without an underscore is public
COMMAND_LINE = "casingfem.cli.main"


@dataclass(frozen=True, eq=False)
class PublicNames:
    """Public names of a checkout: of each face, what it offers and where that is defined.

    A face is a package with a stub. A name whose place is a face is a room, such as `cf.edge`.
    """

    root: Path
    faces: dict[str, dict[str, str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for package in (*PACKAGES, *APART):
            self._read(package)

    def _read(self, module: str) -> None:
        stub = self.root / Path(*module.split(".")) / "__init__.pyi"
        if module in self.faces or not stub.exists():
            return
        names = self.faces[module] = {}
        for node in ast.parse(stub.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ImportFrom):
                parent = module.split(".")[: len(module.split(".")) - (node.level - 1)] if node.level else []
                source = ".".join([*parent, *([node.module] if node.module else [])])
                names |= {alias.asname or alias.name: f"{source}.{alias.name}" for alias in node.names}
        for target in list(names.values()):
            self._read(target)

    def is_public(self, dotted: str) -> bool:
        """Whether a name, given by where it is imported from, is a public one."""
        module, _, name = dotted.rpartition(".")
        if dotted in PACKAGES or dotted == COMMAND_LINE or dotted in self.faces:
            return True
        return name in self.faces.get(module, {}) or (module in OPEN_MODULES and not name.startswith("_"))

    def is_module(self, dotted: str) -> bool:
        """Whether a module, given by its own name, is a package with a stub or a module that a stub exports."""
        parent, _, name = dotted.rpartition(".")
        return dotted in (*PACKAGES, COMMAND_LINE, *self.faces) or self.faces.get(parent, {}).get(name) == dotted

    def leads(self, package: str, attributes: list[str]) -> bool:
        """Whether attributes of a package, one after the other, are public until an object is reached."""
        at = package
        for name in attributes:
            if at not in self.faces:
                return True
            if name.startswith("__") or (at in PACKAGES and name == "errors"):
                return True
            if name not in self.faces[at]:
                return False
            at = self.faces[at][name]
        return True


def internal_names(text: str, public: PublicNames) -> list[str]:
    """Dotted names that a source uses of the packages and that are not public, in the order of the syntax tree."""
    tree = ast.parse(text)
    aliases = {
        alias.asname or alias.name: alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import)
        for alias in node.names
        if alias.name in PACKAGES
    }
    return [name for node in ast.walk(tree) for name in _of_node(node, aliases, public)]


def _of_node(node: ast.AST, aliases: dict[str, str], public: PublicNames) -> Iterator[str]:
    if isinstance(node, ast.Import):
        names = [alias.name for alias in node.names if alias.name.partition(".")[0] in PACKAGES]
        yield from (name for name in names if not public.is_public(name))
    elif isinstance(node, ast.ImportFrom) and node.module and node.module.partition(".")[0] in PACKAGES:
        yield from (
            f"{node.module}.{alias.name}" for alias in node.names if not public.is_public(f"{node.module}.{alias.name}")
        )
    elif isinstance(node, ast.Attribute):
        chain = _chain(node)
        if chain and chain[0] in aliases and not public.leads(aliases[chain[0]], chain[1:]):
            yield ".".join([aliases[chain[0]], *chain[1:]])
    elif isinstance(node, ast.Call):
        called = getattr(node.func, "attr", getattr(node.func, "id", ""))
        texts = [str(given.value) for given in node.args if isinstance(given, ast.Constant)]
        dotted = [text for text in texts if text.partition(".")[0] in PACKAGES and "." in text]
        if called in ("setattr", "delattr", "patch"):
            yield from dotted
        elif called in ("import_module", "module", "names"):
            yield from (name for name in dotted if not public.is_module(name))


def _chain(node: ast.Attribute) -> list[str]:
    """Names of an attribute of a name, the first one first; empty for an attribute of anything else."""
    parts: list[str] = []
    at: ast.expr = node
    while isinstance(at, ast.Attribute):
        parts.append(at.attr)
        at = at.value
    return [at.id, *reversed(parts)] if isinstance(at, ast.Name) else []


def of_tests(root: Path, below: str = "tests") -> dict[str, list[str]]:
    """Internal names that each module below a folder of tests uses."""
    public = PublicNames(root)
    paths = sorted((root / below).rglob("*.py"))
    return {
        path.relative_to(root).as_posix(): internal_names(path.read_text(encoding="utf-8"), public) for path in paths
    }
