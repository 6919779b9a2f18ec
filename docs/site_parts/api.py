"""Pages of the API: one for each public module; a name is on the page of the module nearest to the top."""

import importlib
import inspect
import re
from pathlib import Path
from types import ModuleType

from sphinx.application import Sphinx

PACKAGES = ("casingfem", "contact")
ARRAY = re.compile(r"(?:numpy\.)?ndarray\[tuple\[(?:typing\.)?Any, \.\.\.\], (?:numpy\.)?dtype\[[\w.]+\]\]")
SHORT = {"casingfem": "cf", "contact": "ct"}


def public_modules() -> dict[str, ModuleType]:
    """The packages and the public modules below them by address, the nearest to the top first."""
    found: dict[str, ModuleType] = {}
    waiting = [(name, importlib.import_module(name)) for name in PACKAGES]
    while waiting:
        address, module = waiting.pop(0)
        if module in found.values():  # a module below another is also at the top
            continue
        found[address] = module
        parts = ((name, getattr(module, name)) for name in names(module))
        waiting += [(f"{address}.{name}", part) for name, part in parts if inspect.ismodule(part)]
    return found


def names(module: ModuleType) -> list[str]:
    """Names that a module exports: its `__all__`, or names defined in it."""
    own = (name for name, item in vars(module).items() if getattr(item, "__module__", "") == module.__name__)
    return sorted(getattr(module, "__all__", None) or own, key=str.lower)


def page(address: str, module: ModuleType, seen: dict[int, str]) -> str:
    """The page of a module; names on an earlier page are listed with a link."""
    first, _, rest = address.partition(".")
    called = SHORT[first] + (f".{rest}" if rest else "")
    lines = [f"``{called}``", "=" * (len(called) + 4), "", f".. module:: {address}", ""]
    lines += [inspect.getdoc(module).partition("\n")[0] if module.__doc__ else "", ""]
    elsewhere = []
    for name in names(module):
        item = getattr(module, name)
        if inspect.ismodule(item) or not callable(item):
            continue
        if id(item) in seen:
            elsewhere.append(f":obj:`~{seen[id(item)]}`")
            continue
        seen[id(item)] = f"{address}.{name}"
        kind = "autoclass" if inspect.isclass(item) else "autofunction"
        lines += [f".. {kind}:: {address}.{name}", "   :members:" if kind == "autoclass" else "", ""]
    if elsewhere:
        lines += ["Also here: " + ", ".join(elsewhere) + ".", ""]
    return "\n".join(lines) + "\n"


def write(app: Sphinx) -> None:
    """Write docs/built/api before the pages are read."""
    folder = Path(app.srcdir, "built", "api")
    folder.mkdir(parents=True, exist_ok=True)
    seen: dict[int, str] = {}
    found = public_modules()
    for address, module in found.items():
        text = page(address, module, seen)
        path = folder / f"{address}.rst"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    title = "Every name"
    index = [title, "=" * len(title), "", ".. toctree::", "", *(f"   {address}" for address in found)]
    (folder / "index.rst").write_text("\n".join(index) + "\n", encoding="utf-8")


def plain(app: Sphinx, what: str, name: str, item: object, options: object, lines: list[str]) -> None:
    """What docstrings mean: |u| is a modulus, no name to be replaced; indented lines are formulas, no quotation."""
    lines[:] = [line if line.lstrip().startswith((">>>", "...")) else line.replace("|", "\\|") for line in lines]
    for k in range(len(lines) - 1, 1, -1):
        before = next((line for line in reversed(lines[:k]) if line.strip()), "")
        begins = lines[k].startswith("  ") and not lines[k - 1].strip() and not before.startswith(" ")
        if begins and not lines[k].lstrip().startswith(">>>"):
            lines[k:k] = ["::", ""]
            end = next((j for j in range(k + 2, len(lines)) if lines[j][:1].strip()), len(lines))
            lines[k:end] = [line.replace("\\|", "|") for line in lines[k:end]]


def short(
    app: Sphinx, what: str, name: str, item: object, options: object, signature: str | None, returns: str | None
) -> tuple[str | None, str | None]:
    """A signature that says Array, where numpy's own name fills a line."""
    return tuple(text and ARRAY.sub("Array", text) for text in (signature, returns))


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("builder-inited", write)
    app.connect("autodoc-process-docstring", plain, priority=400)  # before napoleon
    app.connect("autodoc-process-signature", short)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
