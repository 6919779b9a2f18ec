"""Twenty passages of pages, forty docstrings and forty messages at random, to be read as a new user would.

`.venv/bin/python -m reports.tools.drawn --seed 7` prints them with their places. Sentences that must be read twice are
rewritten; then another seed is drawn.
"""

import argparse
import ast
import random
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

ROOT = Path(__file__).parents[2]
PACKAGES = ("casingfem", "contact")
LISTS = ("keys.md", "errors.md", "names.md", "columns.md")  # pages that programs write
PAGES, DOCSTRINGS, MESSAGES = 20, 40, 40
WORDS = 8  # that a message has at least
T = TypeVar("T")


class Passage(NamedTuple):
    """A text and its place: file, and line or heading."""

    place: str
    text: str


def pages(root: Path = ROOT) -> list[list[Passage]]:
    """Every page of the documentation as its passages of prose: paragraphs and lists without code and tables."""
    files = [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").rglob("*.md"))]
    kept = [file for file in files if file.name not in LISTS and "built" not in file.parts and file.is_file()]
    return [found for file in kept if (found := prose(file.read_text(encoding="utf-8"), str(file.relative_to(root))))]


def prose(text: str, place: str) -> list[Passage]:
    r"""Paragraphs of a page, each with the heading above it.

    >>> prose("# A\n\nOne sentence.\n\n```python\nx = 1\n```\n\n| a | b |\n\n## B\n\nMore.\n", "a.md")
    [Passage(place='a.md, A', text='One sentence.'), Passage(place='a.md, B', text='More.')]
    """
    heading, found = "", list[Passage]()
    for block in re.split(r"\n\s*\n", re.sub(r"```.*?```|\$\$.*?\$\$", "", text, flags=re.DOTALL)):
        words = block.strip()
        if words.startswith("#"):
            heading, _, words = words.lstrip("# ").partition("\n")
            words = words.strip()
        if words and words[0] not in "|!<:":
            found.append(Passage(f"{place}, {heading}", words))
    return found


def trees(root: Path = ROOT) -> Iterator[tuple[str, ast.Module]]:
    """Every module of both packages, parsed, with its path."""
    for package in PACKAGES:
        for file in sorted((root / package).rglob("*.py")):
            yield str(file.relative_to(root)), ast.parse(file.read_text(encoding="utf-8"))


def docstrings(root: Path = ROOT) -> list[Passage]:
    """Every docstring of both packages, up to its examples."""
    kinds = (ast.Module, ast.ClassDef, ast.FunctionDef)
    return [
        Passage(f"{path}, {getattr(node, 'name', 'module')}", re.split(r"\n\s*(?:Examples\n|>>>)", text)[0].strip())
        for path, tree in trees(root)
        for node in ast.walk(tree)
        if isinstance(node, kinds) and (text := ast.get_docstring(node))
    ]


def messages(root: Path = ROOT) -> list[Passage]:
    """Every text of WORDS words or more that is raised or printed; braces hold what a run fills in."""
    found = []
    for path, tree in trees(root):
        for node in ast.walk(tree):
            if isinstance(node, ast.Raise) or (
                isinstance(node, ast.Call) and called(node) in ("echo", "fail", "Fault")
            ):
                for part in texts(node):
                    text = text_of(part)
                    if len(text.split()) >= WORDS:
                        found.append(Passage(f"{path}:{part.lineno}", text))  # type: ignore[attr-defined]
    return list(dict.fromkeys(found))


def texts(node: ast.AST) -> Iterator[ast.AST]:
    """The strings below a node; a string with filled-in values is one string."""
    for part in ast.iter_child_nodes(node):
        if text_of(part):
            yield part
        else:
            yield from texts(part)


def called(node: ast.Call) -> str:
    """The last name of the called function."""
    return getattr(node.func, "attr", getattr(node.func, "id", ""))


def text_of(node: ast.AST) -> str:
    """A string, or one with values filled in, as its source says it; else nothing."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        parts = (part.value if isinstance(part, ast.Constant) else f"{{{ast.unparse(part.value)}}}"  # type: ignore[attr-defined]
                 for part in node.values)  # fmt: skip
        return "".join(map(str, parts))
    return ""


def drawn(seed: int, root: Path = ROOT) -> dict[str, list[Passage]]:
    """The passages to read: one of each drawn page, docstrings, messages."""
    chance = random.Random(seed)
    return {
        "pages": [chance.choice(page) for page in some(chance, pages(root), PAGES)],
        "docstrings": some(chance, docstrings(root), DOCSTRINGS),
        "messages": some(chance, messages(root), MESSAGES),
    }


def some(chance: random.Random, things: Sequence[T], count: int) -> list[T]:
    """Some items at random; all if there are fewer."""
    return chance.sample(list(things), min(count, len(things)))


def main() -> None:
    """Print the passages that a seed draws."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, required=True)
    for kind, passages in drawn(parser.parse_args().seed).items():
        print(f"\n==== {kind}")
        for passage in passages:
            print(f"\n[{passage.place}]\n{passage.text}")


if __name__ == "__main__":
    main()
