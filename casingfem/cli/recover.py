"""`casingfem recover DIR`: complete, restore or remove files of a killed writer in a folder."""

from pathlib import Path

import click

from casingfem.cli.running import deliver, with_exit_codes
from contact.io.publication.recovery import Recovery
from contact.io.publication.recovery import recover as recovered

FORMER = ".new"  # folder of the new files of a set that an earlier version wrote
SHOWN = 6  # names of files


@click.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="One JSON document on stdout, nothing else.")
@with_exit_codes
def recover(folder: Path, as_json: bool) -> None:
    """Complete the set of result files in DIR whose writer was killed, or restore the previous files.

    Old files are restored if a new one is damaged. Only files that the manifest of the set names are changed, and none
    if one was modified since.
    """
    found = recovered(folder)
    former = (folder / FORMER).is_dir() and not (folder / FORMER).is_symlink()
    document = {
        "action": found.action,
        "files": list(found.files),
        "damaged": list(found.damaged),
        "removed": list(found.removed),
        "left": [FORMER] if former else [],
    }
    deliver(document, words(folder, found, former), as_json=as_json, out=None, files={})


def words(folder: Path, found: Recovery, former: bool) -> str:
    """A line that lists which files were recovered and which were not."""
    lines = {
        "finished": [f"{folder}: completed a set of {len(found.files)} files: {listed(found.files)}"],
        "put back": [
            f"{folder}: restored the former files of a set of {len(found.files)}: {listed(found.files)}",
            f"damaged or missing files of the set: {listed(found.damaged)}; run the command that wrote it again",
        ],
        "nothing": [] if found.removed else [f"{folder}: every set is complete"],
    }[found.action]
    if found.removed:
        lines.append(f"{folder}: removed {len(found.removed)} files of killed programs: {listed(found.removed)}")
    if former:
        lines.append(f"{folder / FORMER}: not changed, since no manifest names its files: move them by hand")
    return "\n".join(lines)


def listed(names: tuple[str, ...]) -> str:
    """Some names, and the number of further ones."""
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return ", ".join(names[:SHOWN]) + more
