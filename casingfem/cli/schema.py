"""`casingfem schema`: keys of study.toml and scene.toml, as text or JSON schema; `explain`: error codes."""

from collections.abc import Sequence
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import click

from casingfem.cli.running import deliver, options
from casingfem.faults import CATALOGUE
from contact.io.names import hint
from contact.io.outfiles import json_text

if TYPE_CHECKING:
    from contact.io.tables import Model


def keys_of(context: click.Context, parameter: click.Parameter, text: str) -> list[str]:
    """Tables whose names begin with a text, for completion in the shell."""
    from contact.io.tables import keys

    known = {*roots(), "scene", *(name for model in roots().values() for name in keys(model))}
    return sorted(name for name in known if name.startswith(text))


@click.command()
@click.argument("key", required=False, shell_complete=keys_of)
@options
def schema(key: str | None, as_json: bool, out: Path | None) -> None:
    """Describe the table or key KEY of study.toml and scene.toml; without KEY, list the names of all tables.

    KEY is written as in a file: chart, support.base, update.parameter. Kinds of tables and of scenes may be part of it:
    chart.frustum, rub.contact; study, scene and a kind of scene name all their tables. Without KEY, --json and --out
    give the JSON schemas of all files.
    """
    if key is not None:
        found = explained(key)
        if not found:
            near = hint(key, keys_of(click.get_current_context(), schema.params[0], ""), most=3)
            raise click.UsageError(f"found {key!r}, expected a table or key of a file{near}")
        text = "\n\n".join(part["text"] for part in found)
        deliver({"tables": found}, text, as_json=as_json, out=out, files={"schema.txt": text + "\n"})
        return
    from casingfem.study import schema as study_schema
    from contact.scene.schema import scene_schema

    document = {"study": study_schema(), "scene": scene_schema()}
    files = {f"{name}.schema.json": json_text(part, indent=1) for name, part in document.items()}
    deliver(document, overview(), as_json=as_json, out=out, files=files)


def overview() -> str:
    """Tables of each kind of file, one on each line."""
    from contact.io.tables import keys, members

    lines = ["Tables by kind of file; `casingfem schema KEY` explains one, --json prints the JSON schemas."]
    for name, model in roots().items():
        tables = [key for key, info in keys(model).items() if members(info.annotation)]
        single = [key for key in keys(model) if key not in tables]
        text = ", ".join([*tables, *(f"{key} (a key)" for key in single)])
        lines += ["", f"{name}: {headline(model)}", *wrap(text, 100, initial_indent="  ", subsequent_indent="  ")]
    return "\n".join(lines)


def roots() -> dict[str, "Model"]:
    """Root tables of the file kinds, and of the tables [sweep] and [chance], by kind."""
    from casingfem.chance.tables import ChanceTable
    from casingfem.study.tables.tasks import StudyFile
    from contact.scene.schema import scene_models
    from contact.sweep.tables import SweepTable

    return {"study": StudyFile, **scene_models(), "sweep": SweepTable, "chance": ChanceTable}


def explained(key: str) -> list[dict[str, Any]]:
    """Description of a key: one part for each table with this name, with the files that contain it."""
    first, *rest = key.split(".")
    known = roots()
    if first == "scene" and not rest:
        return [listed(name, model) for name, model in known.items() if name not in ("study", "sweep", "chance")]
    starts = {first: (known[first], rest)} if first in known else {k: (m, [first, *rest]) for k, m in known.items()}
    ends: dict[tuple[Any, ...], list[str]] = {}
    for name, (model, path) in starts.items():
        if end := walked(model, path):
            ends.setdefault(end, []).append(name)
    if len(ends) < 2:
        return [explanation(key, end, names) for end, names in ends.items()]
    lines = [f"  {', '.join(f'{n}.{key}' for n in names)}: {headline_of(end)}" for end, names in ends.items()]
    return [{"key": key, "text": "\n".join([f"{key} differs between kinds of file; give one of", *lines])}]


def walked(root: "Model", path: Sequence[str]) -> tuple[Any, ...]:
    """The table models at the end of a path, or the last key with its model; empty for a wrong path."""
    from contact.io.tables import keys, kinds, members

    found, named = [root], False
    for place, part in enumerate(path):
        name = part.partition("[")[0]
        holders = [m for m in found if name in keys(m)]
        of_kind = [m for m in found if name in kinds(m)]
        if not holders and not of_kind and not named:
            return ()
        if holders:
            annotations = [keys(m)[name].annotation for m in holders]
            below = [model for annotation in annotations for model in members(annotation)]
            if not below:
                return (name, *holders) if place == len(path) - 1 else ()
            found, named = list(dict.fromkeys(below)), any("dict[" in str(annotation) for annotation in annotations)
        else:  # a kind of table, or the name of an edge or a group
            found, named = of_kind or found, False
    return tuple(found)


def explanation(key: str, end: tuple[Any, ...], files: list[str]) -> dict[str, Any]:
    """Description of one table, its kinds, or one key."""
    from contact.io.tables import keys, kinds

    where = "" if files == ["study"] else f" ({', '.join(files)})"
    if isinstance(end[0], str):
        name, *models = end
        lines = described(name, keys(models[0])[name], len(name))
        return {"key": key, "files": files, "text": "\n".join([f"{key}{where}", *lines])}
    if len(end) == 1:
        return listed(f"{key}{where}", end[0])
    lines = [f"{kinds(model)[0]:<16}{headline(model)}" for model in end if kinds(model)]
    return {"key": key, "files": files, "text": "\n".join([f"{key}{where}: one of these kinds", *lines])}


def listed(title: str, model: "Model") -> dict[str, Any]:
    """A table with all its keys."""
    from contact.io.tables import keys

    known = keys(model)
    wide = max(map(len, known))
    lines = [line for name, info in known.items() for line in described(name, info, wide)]
    rows = [{"key": name, "meaning": info.description} for name, info in known.items()]
    return {"key": title, "keys": rows, "text": "\n".join([f"{title}: {headline(model)}", *lines])}


def headline(model: "Model") -> str:
    """First sentence of a table's docstring, without the table's name."""
    text = " ".join((model.__doc__ or "").partition("\n\n")[0].split())
    head, mark, rest = text.partition(": ")
    return rest if mark and head.startswith("[") else text


def headline_of(end: tuple[Any, ...]) -> str:
    """One line that describes the last part of a path of keys."""
    from contact.io.tables import keys

    return str(keys(end[1])[end[0]].description) if isinstance(end[0], str) else headline(end[0])


def described(name: str, info: Any, wide: int) -> list[str]:
    """A key: its meaning, allowed values and default. A table's key gets one line if that has at most 80 characters."""
    from contact.io.tables import type_words

    meaning, values = f"  {name:<{wide}}  {info.description}", f"{type_words(info)}; {kept(info)}"
    if "table;" in values and len(meaning) + len(values) <= 77:
        return [f"{meaning} ({values})"]
    return [meaning, f"  {'':<{wide}}    {values}"]


def kept(info: Any) -> str:
    """The default of a key."""
    if info.is_required():
        return "must be given"
    default = info.default if info.default_factory is None else info.default_factory()
    plain = bool | int | float | str
    if isinstance(default, plain) or (isinstance(default, list) and default and isinstance(default[0], plain)):
        return f"{str(default).lower() if isinstance(default, bool) else default} if left out"
    return "may be left out"


@click.command()
@click.argument("code", required=False, shell_complete=lambda *given: [c for c in CATALOGUE if c.startswith(given[2])])
@options
def explain(code: str | None, as_json: bool, out: Path | None) -> None:
    """Print cause and remedy of an error or warning by its CODE; without CODE, of all codes."""
    wanted = list(CATALOGUE) if code is None else [code.strip("[]")]
    for name in wanted:
        if name not in CATALOGUE:
            near = hint(name, CATALOGUE, most=3)
            raise click.UsageError(f"found {name!r}, expected a code such as shell-thickness{near}")
    document = {name: {"cause": CATALOGUE[name].cause, "remedy": CATALOGUE[name].remedy} for name in wanted}
    text = "\n".join(f"{name}\n  cause:  {one['cause']}\n  remedy: {one['remedy']}" for name, one in document.items())
    deliver({"faults": document}, text, as_json=as_json, out=out, files={"errors.json": json_text(document, indent=1)})
