"""`casingfem example`: the studies and scenes that come with the program."""

from collections.abc import Mapping
from pathlib import Path
from textwrap import shorten
from typing import TYPE_CHECKING

import click

from casingfem.cli.running import BAD_INPUT, deliver, fail, options
from contact.io.names import hint
from contact.io.outfiles import json_text, write_files

if TYPE_CHECKING:
    from casingfem.examples import Example

WIDTH = 80  # of the text about an example in the list


def names_of(context: click.Context, parameter: click.Parameter, text: str) -> list[str]:
    """The examples that begin with this, for the shell."""
    from casingfem.examples import examples

    return [name for name in examples() if name.startswith(text)]


@click.command()
@click.argument("name", required=False, shell_complete=names_of)
@options
def example(name: str | None, as_json: bool, out: Path | None) -> None:
    """Write the example NAME with all it needs, to be run from here; all names if left out.

    Paths are those of the project's own folder, data/studies and data/scenes, so that the commands of its pages work as
    they stand; with --out DIR they begin with DIR. Nothing is overwritten.
    """
    from casingfem.examples import examples

    known = examples()
    if name is None:
        document = {"examples": [{"name": e.name, "about": e.about, "command": e.verb} for e in known.values()]}
        files = {"examples.json": json_text(document, indent=1)}
        deliver(document, listed(known), as_json=as_json, out=out, files=files)
        return
    if name not in known:
        near = hint(name, known, most=3) or hint(name, [other for other in known if name in other], most=3, cutoff=0.0)
        raise click.UsageError(f"found {name!r}, expected a name that casingfem example lists{near}")
    folder = Path("data") if out is None else out
    written = [str(path) for path in write(known[name], folder)]
    following = known[name].commands(folder)
    words = [*(f"wrote {path}" for path in written), "next:", *(f"  {line}" for line in following)]
    result = {"name": name, "files": written, "next": list(following)}
    deliver(result, "\n".join(words), as_json=as_json, out=None, files={})


def listed(known: "Mapping[str, Example]") -> str:
    """A line for each, and how to have one."""
    width = max(map(len, known)) + 2
    lines = [f"{e.name:<{width}}{shorten(e.about, WIDTH, placeholder=' ...')}" for e in known.values()]
    return "\n".join([*lines, "casingfem example NAME writes one, with what it needs"])


def write(wanted: "Example", folder: Path) -> list[Path]:
    """Write an example and those of the files it needs that are not there yet, from another example."""
    from casingfem.examples import DATA

    contents = {file.as_posix(): (DATA / file).read_bytes() for file in wanted.files}
    there = {name for name in contents if (folder / name).exists()}
    same = {name for name in there if (folder / name).is_file() and (folder / name).read_bytes() == contents[name]}
    for name in contents:
        if name in there and (name == wanted.file.as_posix() or name not in same):
            fail(f"{folder / name}: found such a file, expected none: it stays; give another --out DIR", BAD_INPUT)
    return write_files(folder, {name: content for name, content in contents.items() if name not in there})
