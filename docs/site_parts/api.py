"""Pages of the API: one for each public module; a name is on the page of the module nearest to the top."""

import importlib
import inspect
import re
from pathlib import Path
from types import ModuleType

from docutils import nodes
from docutils.nodes import Element
from sphinx import addnodes
from sphinx.application import Sphinx

PACKAGES = ("casingfem", "contact")
ARRAY = re.compile(r"(?:numpy\.)?ndarray\[tuple\[(?:typing\.)?Any, \.\.\.\], (?:numpy\.)?dtype\[[\w.]+\]\]")
NAMED = r"~?(?:\w+\.)*"  # what is before a name in a signature
SUPPORTS = rf"{NAMED}_SupportsArray\[{NAMED}dtype\[{NAMED}Any\]\]"
LIKE = re.compile(
    rf"{NAMED}_Buffer \| {SUPPORTS} \| {NAMED}_NestedSequence\[{SUPPORTS}\] \| complex \| bytes \| str \| "
    rf"{NAMED}_NestedSequence\[complex \| bytes \| str\]"
)
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
    """Docstrings as reST: |u| is a modulus and no substitution, indented lines are formulas and no quotation."""
    lines[:] = [line if line.lstrip().startswith((">>>", "...")) else line.replace("|", "\\|") for line in lines]
    for k in range(len(lines) - 1, 1, -1):
        before = next((line for line in reversed(lines[:k]) if line.strip()), "")
        begins = lines[k].startswith("  ") and not lines[k - 1].strip() and not before.startswith(" ")
        if begins and not lines[k].lstrip().startswith(">>>"):
            lines[k:k] = ["::", ""]
            end = next((j for j in range(k + 2, len(lines)) if lines[j][:1].strip()), len(lines))
            lines[k:end] = [line.replace("\\|", "|") for line in lines[k:end]]
    if what in {"property", "attribute", "data"}:  # napoleon reads words before a colon in their first line as a type
        lines[:0] = ["..", ""]


def readable(text: str) -> str:
    """A type as a reader would write it: Array and ArrayLike for numpy's types, a key's type without its description.

    >>> readable("ndarray[tuple[Any, ...], dtype[float64]] | None")
    'Array | None'
    >>> readable("~typing.Annotated[float, ~contact.io.Key(text=it acts (here), range=any)] = 0.0")
    'float = 0.0'
    """
    text = LIKE.sub("ArrayLike", ARRAY.sub("Array", text))
    while found := re.search(r"~?(?:typing\.)?Annotated\[", text):
        depth, comma, end = 1, 0, found.end()
        while depth and end < len(text):
            depth += (text[end] in "([") - (text[end] in ")]")
            comma = comma or (end if depth == 1 and text[end] == "," else 0)
            end += 1
        text = text[: found.start()] + text[found.end() : comma or end - 1] + text[end:]
    return text


def short(
    app: Sphinx, what: str, name: str, item: object, options: object, signature: str | None, returns: str | None
) -> tuple[str | None, str | None]:
    """Signature and returned type, with types as a reader would write them."""
    return tuple(text and readable(text) for text in (signature, returns))


def of_properties(app: Sphinx, domain: str, kind: str, content: Element) -> None:
    """Types of properties and attributes, which have no signature."""
    for heading in content.parent.findall(addnodes.desc_signature):
        for part in heading.findall(addnodes.desc_annotation):
            if (text := part.astext()) != (new := readable(text)):
                part.clear()
                part += nodes.Text(new)


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("builder-inited", write)
    app.connect("autodoc-process-docstring", plain, priority=400)  # before napoleon
    app.connect("autodoc-process-signature", short)
    app.connect("object-description-transform", of_properties)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
