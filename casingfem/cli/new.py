"""`casingfem example`, `new`, `watch`: examples, a start folder, files that are run again whenever they are saved."""

import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from textwrap import shorten
from typing import Any, NoReturn

import click

from casingfem import examples
from casingfem.cli.running import BAD_INPUT, INTERRUPTED, deliver, fail, options, with_exit_codes
from contact.io.infiles import read_bytes, regular_file
from contact.io.names import hint
from contact.io.outfiles import json_text, write_files

PAUSE = 0.5  # s between two checks of the files
WIDTH = 80  # of the text about an example in the list


@click.command()
@click.argument(
    "name", required=False, shell_complete=lambda *given: [e for e in examples.examples() if e.startswith(given[2])]
)
@options
def example(name: str | None, as_json: bool, out: Path | None) -> None:
    """Write the example NAME with all files it needs, to be run from here; without NAME, list the examples.

    Paths are those of the project's own folder, data/studies and data/scenes, so that the commands in the documentation
    work unchanged; with --out DIR they begin with DIR. Nothing is overwritten.
    """
    known = examples.examples()
    if name is None:
        document = {"examples": [{"name": e.name, "about": e.about, "command": e.verb} for e in known.values()]}
        files = {"examples.json": json_text(document, indent=1)}
        deliver(document, listed(known), as_json=as_json, out=out, files=files)
        return
    if name not in known:
        near = hint(name, known, most=3) or hint(name, [other for other in known if name in other], most=3, cutoff=0.0)
        raise click.UsageError(f"found {name!r}, expected a name from the list of casingfem example{near}")
    folder = Path("data") if out is None else out
    written = [str(path) for path in write(known[name], folder)]
    following = known[name].commands(folder)
    shown({"name": name, "files": written, "next": list(following)}, as_json)


def listed(known: Mapping[str, examples.AnyExample]) -> str:
    """One line for each example, and how to get one."""
    width = max(map(len, known)) + 2
    lines = [f"{e.name:<{width}}{shorten(e.about, WIDTH, placeholder=' ...')}" for e in known.values()]
    return "\n".join([*lines, "casingfem example NAME writes an example with the files that it needs"])


def write(wanted: examples.AnyExample, folder: Path) -> list[Path]:
    """Write an example and its missing files, which may be from another example."""
    contents = {file.as_posix(): (examples.DATA / file).read_bytes() for file in wanted.files}
    there = {name for name in contents if (folder / name).exists()}
    same = {name for name in there if (folder / name).is_file() and read_bytes(folder / name) == contents[name]}
    for name in contents:
        if name in there and (name == wanted.file.as_posix() or name not in same):
            fail(
                f"{folder / name}: found an existing file, which is not overwritten: give another folder with --out",
                BAD_INPUT,
            )
    return write_files(folder, {name: content for name, content in contents.items() if name not in there})


@click.command()
@click.argument("name", metavar="NAME", type=click.Path(path_type=Path))
@options
def new(name: Path, as_json: bool, out: Path | None) -> None:
    """Make a folder NAME with a study, a blade, a scene, a survey and a table, ready to run and to change.

    With --out DIR it is made in DIR.
    """
    folder = name if out is None else out / name
    if folder.exists():
        fail(f"{folder}: found an existing file or folder, which is not overwritten: give another NAME", BAD_INPUT)
    written = [str(path) for path in write_files(folder, examples.first_files())]
    following = [f"cd {folder}", *(f"casingfem {step}" for step in examples.STEPS)]
    shown({"files": written, "next": following}, as_json)


def shown(document: dict[str, Any], as_json: bool) -> None:
    """Print the written files and the next command to type."""
    lines = [*(f"wrote {path}" for path in document["files"]), "next:", *(f"  {line}" for line in document["next"])]
    deliver(document, "\n".join(lines), as_json=as_json, out=None, files={})


@click.command(context_settings={"ignore_unknown_options": True})
@click.argument("file", metavar="FILE", type=click.Path(path_type=Path))
@click.argument("arguments", metavar="[OPTIONS]", nargs=-1, type=click.UNPROCESSED)
@click.option("--run", "verb", metavar="COMMAND", help="Command to run; decided by the content of FILE if left out.")
@with_exit_codes
def watch(file: Path, arguments: tuple[str, ...], verb: str | None) -> NoReturn:
    """Run a command on FILE, and again whenever FILE or a file that it names is saved; end with Ctrl-C.

    OPTIONS, such as --out DIR, are passed to the command. Later runs start faster, since the program stays loaded.
    """
    group = click.get_current_context().find_root().command
    try:
        for _ in changes(file):
            command = [verb or verb_of(file), str(file), *arguments]
            click.echo(f"casingfem {' '.join(command)}", err=True)
            if run_once(group, command) == INTERRUPTED:
                raise KeyboardInterrupt
            click.echo(f"waiting for {file} to be saved; Ctrl-C ends", err=True)
    except KeyboardInterrupt:
        fail("stopped watching", INTERRUPTED)
    raise AssertionError("watching ended without Ctrl-C")


def changes(file: Path, sleep: Callable[[float], None] | None = None) -> Iterator[None]:
    """Yield once at first, and after each change of a file or of one that it names."""
    last = None
    while True:
        now = stamps(file)
        if now != last:
            last = now
            yield
        (sleep or time.sleep)(PAUSE)


def stamps(file: Path) -> dict[Path, tuple[int, int]]:
    """Time of the last change and size of a file and of the existing files that it names."""
    from contact.io.toml import read_toml

    try:
        tables = read_toml(regular_file(file))[1]
    except (OSError, ValueError):  # the command reports the fault
        tables = {}
    made = tables.pop("reduce", None)  # what it writes
    named = [file.parent / text for _, text in examples.strings(tables) if Path(text).suffix]
    found = [
        path
        for path in (file, *named)
        if path.is_file() and not (isinstance(made, dict) and path.name == made.get("out"))
    ]
    return {path: ((at := path.stat()).st_mtime_ns, at.st_size) for path in found}


def verb_of(file: Path) -> str:
    """The command that runs a study or a scene."""
    from contact.io.toml import read_toml

    try:
        tables = read_toml(file)[1]
        return examples.Example(file.stem, file, tables).verb
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return "modes"  # the command reports its fault


def run_once(group: click.Command, command: list[str]) -> int:
    """Run a command in this process; returns its exit code."""
    try:
        group.main(command, prog_name="casingfem", standalone_mode=False)
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except click.Abort:
        return INTERRUPTED
    except SystemExit as ended:
        return int(ended.code or 0)
    return 0
