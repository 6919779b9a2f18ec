"""The page on responses from time records: hits, windows, responses, coherence, next steps."""

from collections.abc import Mapping
from typing import Any

from casingfem.experiment.frf.records.estimated import Estimate
from casingfem.plot.page import Cell, Picture, Section, Table, Verdict, origin, render_page
from casingfem.plot.style import Drawn

CAPTIONS = {
    "hit": "Left: the force of the first hit that was used, with its window. Right: size of the responses, each over"
    " its peak, with their window.",
    "frfs": "Responses of all channels, and below them the lowest coherence of all channels at each line.",
    "hits": "Peak of the force of every hit, and the vibration that remains at the end of its record; crosses mark "
    "hits that were excluded.",
}
SYNTHETIC = "SYNTHETIC: the records were made by a program; nobody measured them."


def records_page(name: str, found: Estimate, source: Mapping[str, Any], drawn: Mapping[str, Drawn]) -> str:
    """HTML of the page on responses from the records of a file of this name, with its pictures."""
    pictures = tuple(Picture.of(picture, CAPTIONS[key]) for key, picture in drawn.items())
    notes = tuple(f"{note[:1].upper()}{note[1:]}." for note in found.notes)
    sections = [
        Section("Responses", notes, figures=pictures),
        Section("Hits" if found.hits else "Channels", tables=(rows_table(found),)),
        Section("Source", preformatted="\n".join(found.frfs.card)),
    ]
    synthetic = bool(found.frfs.card) and found.frfs.card[0].startswith("SYNTHETIC")
    return render_page(
        f"Responses from {name}", sections, verdict=records_verdict(found), source=origin(source),
        notice=SYNTHETIC if synthetic else "",
    )  # fmt: skip


def records_verdict(found: Estimate) -> Verdict:
    """Summary of responses: number, averages, coherence, next steps."""
    low, high = found.frfs.x[[0, -1]].tolist()
    step = float(found.frfs.x[1] - found.frfs.x[0]) if len(found.frfs.x) > 1 else low
    count = len(found.frfs)
    first = f"{count} response{'s' * (count > 1)} from {low:.4g} to {high:.5g} Hz, lines {step:.3g} Hz apart."
    if found.hits:
        sure = f"{len(found.kept)} of {len(found.hits)} hits are used, {found.averages} at each point. "
    else:
        sure = f"{found.averages} averages. "
    medians = [found.median_coherence(k) for k in range(count)]
    known = [value for value in medians if value is not None]
    sure += f"The median coherence of a channel is {min(known):.3f} or more." if known else "There is no coherence."
    return Verdict(found=first, sure=sure, further="Identify the modes: casingfem identify frfs.uff.")


def rows_table(found: Estimate) -> Table:
    """Every hit with the reason why it is left out, or every channel of a shaker test."""
    rows: list[tuple[Cell, ...]] = [
        tuple("yes" if cell is True else "no" if cell is False else cell for cell in row.values())
        for row in found.records()
    ]
    if found.hits:
        names = ("hit", "record", "time [s]", "peak [N]", "width [s]", "ringing left [-]", "used", "why not")
        return Table("Hits of the hammer.", names, tuple(rows))
    return Table("Channels and their median coherence.", ("channel", "point", "reference", "coherence"), tuple(rows))
