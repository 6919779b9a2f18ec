"""Move a set into place, or back, in an order in which old and new files never mix."""

from __future__ import annotations

import errno
import os
from dataclasses import replace

from contact.io.publication.manifest import Publication, require_no_links, seen
from contact.io.publication.staging import HALF, clear_staging, write_manifest

NO_LINKS = (errno.EPERM, errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOTSUP, errno.EMLINK)


def commit(publication: Publication) -> None:
    """Move a complete set into place; if that fails, restore the previous state. The folder is locked meanwhile."""
    entries = [replace(entry, replaces=seen(publication.place(entry))) for entry in publication.entries]
    publication = replace(publication, entries=tuple(entries))
    write_manifest(publication)
    announce(publication)
    finish(publication)


def announce(publication: Publication) -> None:
    """Put the manifest where readers search for it; raises FileExistsError where another one is."""
    listed = publication.folder / publication.staging / "manifest.json"
    try:
        os.link(listed, publication.manifest)
    except OSError as error:
        if os.path.lexists(publication.manifest):
            found = "found files that another program is writing, expected its end: try again"
            raise FileExistsError(errno.EEXIST, found, str(publication.folder)) from None
        if error.errno not in NO_LINKS:
            raise
        copy = listed.with_name(HALF[1])
        copy.write_bytes(listed.read_bytes())
        os.replace(copy, publication.manifest)


def finish(publication: Publication) -> None:
    """Move an announced set into place; if that fails, restore the previous state."""
    try:
        move(publication)
    except OSError:
        move_back(publication)
        withdraw(publication)
        raise
    withdraw(publication)


def move(publication: Publication) -> None:
    """Move the replaced files away first, so that old and new never mix; then move the new ones in."""
    staged = [entry for entry in publication.entries if os.path.lexists(publication.new(entry))]
    for entry in staged:
        require_no_links(publication.folder, entry.name)
        place = publication.place(entry)
        place.parent.mkdir(parents=True, exist_ok=True)
        if place.is_dir() and not place.is_symlink():
            raise IsADirectoryError(errno.EISDIR, "found a folder, expected a file or none", str(place))
        if os.path.lexists(place):
            os.replace(place, publication.old(entry))
    for entry in staged:
        os.replace(publication.new(entry), publication.place(entry))


def move_back(publication: Publication) -> None:
    """Move the new files back into the staging folder; then move the old ones back."""
    moved = [entry for entry in publication.entries if not os.path.lexists(publication.new(entry))]
    for entry in moved:
        if os.path.lexists(publication.place(entry)):
            os.replace(publication.place(entry), publication.new(entry))
    for entry in publication.entries:
        if os.path.lexists(publication.old(entry)):
            os.replace(publication.old(entry), publication.place(entry))


def withdraw(publication: Publication) -> None:
    """Remove manifest and staging folder, after the set is in place or the previous state restored."""
    publication.manifest.unlink()
    clear_staging(publication.folder / publication.staging)
