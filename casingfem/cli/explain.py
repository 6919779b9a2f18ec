"""`casingfem explain`: what a code means and what helps."""

from pathlib import Path

import click

from casingfem.cli.running import deliver, options
from casingfem.faults import CATALOGUE
from contact.io.names import hint
from contact.io.outfiles import json_text


@click.command()
@click.argument("code", required=False, shell_complete=lambda *given: [c for c in CATALOGUE if c.startswith(given[2])])
@options
def explain(code: str | None, as_json: bool, out: Path | None) -> None:
    """The cause of an error or warning by its CODE, and what helps; all codes if left out."""
    wanted = list(CATALOGUE) if code is None else [code.strip("[]")]
    for name in wanted:
        if name not in CATALOGUE:
            near = hint(name, CATALOGUE, most=3)
            raise click.UsageError(f"found {name!r}, expected a code such as shell-thickness{near}")
    document = {name: {"cause": CATALOGUE[name].cause, "remedy": CATALOGUE[name].remedy} for name in wanted}
    text = "\n".join(
        f"{name}\n  cause:  {fault['cause']}\n  remedy: {fault['remedy']}" for name, fault in document.items()
    )
    deliver({"faults": document}, text, as_json=as_json, out=out, files={"errors.json": json_text(document, indent=1)})
