"""The page of keys: `.venv/bin/python docs/keys.py` writes docs/keys.md, all tables of study.toml and scene.toml."""

from collections.abc import Iterator
from pathlib import Path

from casingfem.cli.schema import headline, kept, roots
from contact.io.tables import Model, keys, kinds, members, type_words

PAGE = Path(__file__).parent / "keys.md"
HEAD = """# Every key of study.toml and scene.toml

Made by `.venv/bin/python docs/keys.py`; `casingfem schema chart.frustum` prints one of these tables. Numbers are SI
unless a key's name or its meaning says otherwise. A key that is not listed is refused.
"""


def places(model: Model, path: str, above: tuple[Model, ...] = ()) -> Iterator[tuple[Model, str]]:
    """A table and all tables below it, each with the path that a file writes to it."""
    if model in above:
        return
    yield model, path
    for name, info in keys(model).items():
        for below in members(info.annotation):
            yield from places(below, f"{path}.{name}" if path else name, (*above, model))


def title(model: Model, path: str, file: str) -> str:
    """A table's name as `casingfem schema` takes it."""
    named = [path] if file == "study" and path else [file, *([path] if path else [])]
    return ".".join([*named, *map(str, kinds(model)[:1] if path else ())])


def section(model: Model, found: dict[str, list[str]]) -> str:
    """One table of the page."""
    first = next(iter(found))
    places_of = "; ".join(f"{path or 'the file'} ({', '.join(files)})" for path, files in found.items())
    rows = [
        f"| {name} | {info.description} | {type_words(info)} | {kept(info)} |" for name, info in keys(model).items()
    ]
    lines = [
        "", f"## {title(model, first, found[first][0])}", "", f"{headline(model)} Used at {places_of}.", "",
        "| key | meaning | values | default |", "|---|---|---|---|", *rows, "",
    ]  # fmt: skip
    return "\n".join(lines)


def page() -> str:
    """The page as text."""
    known: dict[Model, dict[str, list[str]]] = {}
    for file, model in roots().items():
        for table, path in places(model, ""):
            files = known.setdefault(table, {}).setdefault(path, [])
            if file not in files:
                files.append(file)
    return HEAD + "".join(section(model, found) for model, found in known.items())


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE}")
