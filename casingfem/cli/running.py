"""Behaviour common to all commands: --json and --out, stdout and stderr, warnings, exit codes."""

import hashlib
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Any, NoReturn, ParamSpec, TypeVar

import click

from casingfem.errors import ModelWarning
from contact.io.infiles import pipes_read_once, read_bytes
from contact.io.outfiles import Content, in_the_way, json_text, write_files
from contact.io.trust import SceneWarning

BAD_INPUT, NUMERICS_FAILED, INTERRUPTED = 2, 3, 130
STORES = {  # folders and files in which commands store finished work
    "sweep": "store", "mistune": "draws", "chance": "draws", "cycles": "cycles.part.npz", "contact": "contact.part.npz",
    "rub": "rub.part.npz", "report": "report.part.npz",
}  # fmt: skip
CODED = (ModelWarning, SceneWarning)
MOST = 3  # warnings of one code: an update repeats the same warning with other numbers
_collected: list[dict[str, str]] = []

P = ParamSpec("P")
R = TypeVar("R")


def options(command: Callable[P, R]) -> Callable[P, R]:
    """Add --json and --out DIR, and the exit codes."""
    folder = click.Path(file_okay=False, path_type=Path)
    decorated = click.option(
        "--out", "out", type=folder, metavar="DIR", help="Write result files there.", callback=free_way
    )(with_exit_codes(command))
    return click.option("--json", "as_json", is_flag=True, help="One JSON document on stdout, nothing else.")(decorated)


def free_way(context: click.Context, parameter: click.Parameter, out: Path | None) -> Path | None:
    """The --out option; a file in its place is refused before any computation."""
    way = None if out is None else in_the_way(out.parent if out.suffix == ".npz" else out)
    if way is not None:
        fail(f"{out}: {way}", BAD_INPUT)
    return out


def with_exit_codes(command: Callable[P, R]) -> Callable[P, R]:
    """Convert errors to messages on stderr and exit codes; nothing else is caught."""

    @wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> R:
        files = kwargs.get("files", (kwargs.get("file", ""),))
        assert isinstance(files, tuple)
        read = [str(file) for file in files]
        try:
            with collecting(), pipes_read_once():
                return command(*args, **kwargs)
        except KeyboardInterrupt:
            fail(what_is_safe(click.get_current_context().info_name, kwargs.get("out")), INTERRUPTED)
        except (ValueError, RuntimeError) as error:
            if not is_own_error(error):
                raise
            if isinstance(error, RuntimeError) or singular(error):
                where = click.get_current_context().info_name
                fail(f"{where} {', '.join(read)}: the computation failed: {error}", NUMERICS_FAILED)
            text, paths = str(error), [*read, *(str(value) for value in kwargs.values() if isinstance(value, Path))]
            fail(text if any(path in text for path in paths) else f"{', '.join(read)}: {text}", BAD_INPUT)
        except OSError as error:
            if isinstance(error, BrokenPipeError):
                raise
            fail(f"{error.filename or 'standard output'}: {error.strerror or error}", BAD_INPUT)

    return run


def what_is_safe(command: str | None, out: object) -> str:
    """One sentence after Ctrl-C: which results are stored, and how to continue."""
    store = STORES.get(command or "")
    kept = sorted(out.glob(f"*{store}")) if isinstance(out, Path) and store else []  # a report has one for each scene
    if kept:
        return f"stopped: finished results are stored in {kept[0]}; the same command continues from them"
    if isinstance(out, Path):
        return f"stopped: no file in {out} is half written; run the same command again"
    return "stopped: no results were stored; run the same command again" + (
        "; with --out DIR a stopped command can continue" if store else ""
    )


def is_own_error(error: Exception) -> bool:
    """Whether an error belongs to one of the two packages, and is meant for the user."""
    modules = {base.__module__.partition(".")[0] for base in type(error).__mro__}
    return bool(modules & {"casingfem", "contact"}) or singular(error)


def singular(error: Exception) -> bool:
    """Whether an error is numpy's LinAlgError, which is a ValueError but not a fault of the input."""
    from numpy.linalg import LinAlgError

    return isinstance(error, LinAlgError)


def fail(message: str, code: int) -> NoReturn:
    """Write a message to stderr and exit."""
    click.echo(message, err=True)
    raise SystemExit(code)


def deliver(
    document: Mapping[str, Any], text: str, *, as_json: bool, out: Path | None, files: Mapping[str, Content]
) -> None:
    """Write the files, then print the document, or the text and the paths of the files."""
    written: list[Path] = []
    if out is not None and files:
        from casingfem.cli.tables import parquets

        written = write_files(out, {**files, **parquets(files)})
    if as_json:
        click.echo(json_text({**document, "warnings": collected()}), nl=False)
        return
    click.echo(text)
    for path in written:
        if path.parent == out:
            click.echo(f"wrote {path}")
    for folder in dict.fromkeys(path.parent for path in written if path.parent != out):
        click.echo(f"wrote {sum(path.parent == folder for path in written)} files to {folder}")


def collected() -> list[dict[str, str]]:
    """The warnings of this command so far: code and message."""
    return [dict(entry) for entry in _collected]


@contextmanager
def collecting() -> Iterator[None]:
    """Print and keep warnings about the model while a command runs; other warnings are handled as usual."""
    _collected.clear()
    with warnings.catch_warnings():
        for category in CODED:
            warnings.simplefilter("always", category)
        usual = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *more: Any, **named: Any) -> None:
            if isinstance(message, CODED):
                collect(message)
            else:
                usual(message, category, *more, **named)

        warnings.showwarning = show
        yield


def collect(warning: ModelWarning | SceneWarning) -> None:
    """Keep and print a warning that is new."""
    entry = {"code": warning.code, "message": str(warning)}
    if entry not in _collected and sum(other["code"] == warning.code for other in _collected) < MOST:
        _collected.append(entry)
        click.echo(f"warning: {warning}", err=True)


def source_of(file: Path) -> dict[str, str]:
    """Name and hash of an input file and the versions of the program, as shown on a page."""
    from contact.version import versions

    return {"file": file.name, "sha256": hashlib.sha256(read_bytes(file)).hexdigest(), **versions()}
