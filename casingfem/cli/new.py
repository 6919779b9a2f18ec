"""`casingfem new` and `casingfem watch`: a folder to begin with, and its files run again whenever they are saved."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NoReturn

import click

from casingfem.cli.running import BAD_INPUT, INTERRUPTED, deliver, fail, options, with_exit_codes
from contact.io.outfiles import write_files

PAUSE = 0.5  # s between looks at files


@click.command()
@click.argument("name", metavar="NAME", type=click.Path(path_type=Path))
@options
def new(name: Path, as_json: bool, out: Path | None) -> None:
    """A folder NAME with a study, a blade, a scene, a survey and a table to change, which run as they are.

    With --out DIR it is made there.
    """
    from casingfem.examples import STEPS, first_files

    folder = name if out is None else out / name
    if folder.exists():
        fail(f"{folder}: found such a file or folder, expected none: it stays; give another NAME", BAD_INPUT)
    written = [str(path) for path in write_files(folder, first_files())]
    following = [f"cd {folder}", *(f"casingfem {step}" for step in STEPS)]
    words = [*(f"wrote {path}" for path in written), "next:", *(f"  {line}" for line in following)]
    deliver({"files": written, "next": following}, "\n".join(words), as_json=as_json, out=None, files={})


@click.command(context_settings={"ignore_unknown_options": True})
@click.argument("file", metavar="FILE", type=click.Path(path_type=Path))
@click.argument("arguments", metavar="[OPTIONS]", nargs=-1, type=click.UNPROCESSED)
@click.option("--run", "verb", metavar="COMMAND", help="What to run; by what is in FILE if left out.")
@with_exit_codes
def watch(file: Path, arguments: tuple[str, ...], verb: str | None) -> NoReturn:
    """Run a command on FILE, and again whenever FILE or a file that it names is saved; Ctrl-C ends.

    OPTIONS, as --out DIR, go to the command. The first run loads what later ones find loaded.
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
    raise AssertionError("watching has no end")


def changes(file: Path, sleep: Callable[[float], None] | None = None) -> Iterator[None]:
    """Once at first, and after each change of a file or of one that it names."""
    last = None
    while True:
        now = stamps(file)
        if now != last:
            last = now
            yield
        (sleep or time.sleep)(PAUSE)


def stamps(file: Path) -> dict[Path, tuple[int, int]]:
    """When a file and those that it names were changed last, and how large they are; those that are there."""
    from casingfem.examples import strings
    from contact.io.toml import read_toml

    try:
        tables = read_toml(file)[1]
    except (OSError, ValueError):  # the command says what is wrong
        tables = {}
    made = tables.pop("reduce", None)  # what it writes
    named = [file.parent / text for _, text in strings(tables) if Path(text).suffix]
    found = [
        path
        for path in (file, *named)
        if path.is_file() and not (isinstance(made, dict) and path.name == made.get("out"))
    ]
    return {path: ((at := path.stat()).st_mtime_ns, at.st_size) for path in found}


def verb_of(file: Path) -> str:
    """The command that runs a study or a scene."""
    from casingfem.examples import Example
    from contact.io.toml import read_toml

    try:
        tables = read_toml(file)[1]
        return Example(file.stem, file, tables).verb
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return "modes"  # says what is wrong with it


def run_once(group: click.Command, command: list[str]) -> int:
    """Run a command in this process; its exit code."""
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
