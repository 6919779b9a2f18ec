"""The page of names: `.venv/bin/python docs/names.py` writes docs/names.md, all that the packages export."""

import importlib
import inspect
from pathlib import Path
from types import ModuleType

PAGE = Path(__file__).parent / "names.md"
SHORT = {"casingfem": "cf", "contact": "ct"}
APART = ("contact.gpu", "contact.solver")  # imported by their own names: an extra, and parts of schemes
HEAD = """# Public names

Made by `.venv/bin/python docs/names.py`: every name that `import casingfem as cf` and `import contact as ct` give, each
once, in the module nearest to the top; and those of `contact.gpu` and `contact.solver`, which are imported by their own
names. `help(cf.modes)` shows parameters, errors and an example.
"""


def public_modules() -> dict[str, ModuleType]:
    """The packages and their public modules by address, the nearest to the top first."""
    found: dict[str, ModuleType] = {}
    waiting = [
        (short, importlib.import_module(name)) for name, short in (*SHORT.items(), *zip(APART, APART, strict=True))
    ]
    while waiting:
        address, module = waiting.pop(0)
        if module not in found.values():
            found[address] = module
            parts = ((name, getattr(module, name)) for name in exported(module))
            waiting += [(f"{address}.{name}", part) for name, part in parts if inspect.ismodule(part)]
    return found


def exported(module: ModuleType) -> list[str]:
    """Names that a module exports: its `__all__`, or names defined in it."""
    own = (name for name, item in vars(module).items() if getattr(item, "__module__", "") == module.__name__)
    listed = getattr(module, "__all__", None) or [name for name in own if not name.startswith("_")]
    return sorted((name for name in listed if not name.startswith("__")), key=str.lower)


def public() -> dict[str, dict[str, object]]:
    """The exported objects by module and name, each once, without modules."""
    found: dict[str, dict[str, object]] = {}
    seen: list[object] = []
    for address, module in public_modules().items():
        items = {name: getattr(module, name) for name in exported(module)}
        new = {
            name: item
            for name, item in items.items()
            if not inspect.ismodule(item) and all(item is not one for one in seen)
        }
        seen += new.values()
        found[address] = new
    return found


def line(item: object) -> str:
    """The first paragraph of a docstring as one line."""
    text = inspect.cleandoc(getattr(item, "__doc__", None) or "")  # its own, not one that it inherits
    return " ".join(text.partition("\n\n")[0].split()).replace("|", "\\|")


def page() -> str:
    """The page as text."""
    modules, parts = public_modules(), [HEAD]
    for address, items in public().items():
        rows = [f"| `{address}.{name}` | {line(item)} |" for name, item in items.items()]
        parts += (
            ["", f"## {address}", "", line(modules[address]), "", "| name | meaning |", "|---|---|", *rows]
            if rows
            else []
        )
    return "\n".join(parts) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE}")
