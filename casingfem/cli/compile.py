"""`casingfem compile`: compile all contact loops before they are needed, into a directory that others may read."""

import os
import time
from pathlib import Path
from typing import Any

import click

from casingfem.cli.progress import ProgressMessage
from casingfem.cli.running import BAD_INPUT, deliver, fail, with_exit_codes
from casingfem.io.side_by_side import usable_cores


@click.command(name="compile")
@click.option(
    "--into", "into", type=click.Path(file_okay=False, path_type=Path), metavar="DIR",
    help="Directory for the machine code; the one that runs write to if left out.",
)  # fmt: skip
@click.option(
    "--kind", "kinds", multiple=True, metavar="KIND", help="Compile only this kind of run (rub, ...); repeatable."
)
@click.option(
    "--workers", type=click.IntRange(min=1), help="Number of processes; one for each usable core if left out."
)
@click.option("--json", "as_json", is_flag=True, help="One JSON document on stdout, nothing else.")
@with_exit_codes
def compile_loops(into: Path | None, kinds: tuple[str, ...], workers: int | None, as_json: bool) -> None:
    """Compile the contact loops of all kinds of run now, so that no first run has to wait.

    With --into, set NUMBA_CACHE_DIR to that directory wherever the loops are used; there it may be read-only.
    """
    if into is not None:
        into = into.absolute()
        into.mkdir(parents=True, exist_ok=True)
        os.environ["NUMBA_CACHE_DIR"] = str(into)  # before numba is imported, and for the workers
    from contact.ahead import KINDS, compiled_ahead
    from contact.jit import machine_code

    written = machine_code.writable()
    if written is None or (into is not None and written != into):
        tried = into or ", ".join(map(str, machine_code.directories()))
        fail(f"{tried}: found no writable directory, expected one for the machine code (--into)", BAD_INPUT)
    began, made = time.perf_counter(), []
    with ProgressMessage("compile") as working:
        for each in compiled_ahead(kinds or tuple(KINDS), workers=workers or usable_cores()):
            working.say(f"compile: {each.kind}", each.done)
            made.append(each)
    document: dict[str, Any] = {
        "directory": str(written),
        "kinds": [{"kind": each.kind, "seconds": each.seconds} for each in made],
        "seconds": time.perf_counter() - began,
        "files": machine_code.kept_in(written),
    }
    lines = [f"{each.seconds:8.1f} s  {each.kind}" for each in sorted(made, key=lambda each: -each.seconds)]
    words = f"{written}: {document['files']} files of machine code, {document['seconds']:.1f} s"
    if into is not None:
        words += f"\nset NUMBA_CACHE_DIR={written} where the loops are used; it may be read-only there"
    deliver(document, "\n".join([*lines, words]), as_json=as_json, out=None, files={})
