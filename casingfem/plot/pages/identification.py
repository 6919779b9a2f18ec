"""The page on an identification: modes, doubtful modes with reasons, and the fit to the measured responses."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from casingfem.experiment.correlation.mac import mac
from casingfem.experiment.identify.identified import Identified
from casingfem.plot.page import Cell, Picture, Section, Table, Verdict, origin, render_page
from casingfem.plot.poles import picking_diagram
from casingfem.plot.style import Drawn

MOST_SHAPES = 20  # of a table of all pairs of modes
LIKE = 0.2  # modal assurance from which a pair of many modes is listed
POLES = (
    "Poles over model order, stable ones green. Behind: the complex mode indicator (CMIF, singular values over the"
    " references). Red lines: modes found, dashed where doubtful."
)
CHANNEL = " Below: one channel with its fit, magnitude and phase."
PICKING = {
    False: POLES + CHANNEL,
    True: POLES + " Click poles, save them, and run casingfem identify with --pick picks.csv." + CHANNEL,
}
SYNTHETIC = "SYNTHETIC: the responses were made by a program; nobody measured them."


def identification_page(
    name: str,
    found: Identified,
    source: Mapping[str, Any],
    drawn: Mapping[str, Drawn],
    coherent: bool = False,
    pick: bool = True,
) -> str:
    """HTML of the page on modes found in the responses of a file of this name, with its pictures.

    `drawn` contains the figures "fit", "responses" and "stabilisation"; the first shows the coherence if `coherent`.
    With `pick` the reader may choose poles for `casingfem identify --pick`.
    """
    captions = {
        "fit": "All lines: the mode indicator with sure (solid) and doubtful (dashed) modes, and the rms over the "
        "channels of the measured responses, the fit and the residual" + (", and the coherence." if coherent else "."),
        "responses": "The channel with the largest response, measured and fitted.",
        "stabilisation": "Poles over model order, stable ones green; the grey curve behind is the mode indicator, "
        "lines are the modes chosen, numbers above them their nodal diameters.",
    }
    pictures = [Picture.of(drawn[key], caption) for key, caption in captions.items()]
    if found.lines.size:
        pictures[-1] = picking_diagram(found, name, PICKING[pick], pictures[-1], pick=pick)
    doubtful = tuple(f"{words[0].upper()}{words[1:]}." for words in found.doubtful())
    notes = tuple(f"{note[:1].upper()}{note[1:]}." for note in found.notes)
    table = Table.of("Modes found; ± is one standard uncertainty.", found.COLUMNS, found.records())
    sections = [
        Section("Modes", doubtful + notes, tables=(table,)),
        Section("Fit", figures=tuple(pictures)),
        *_alike(found),
        Section("Source", preformatted="\n".join(found.card)),
    ]
    synthetic = bool(found.card) and found.card[0].startswith("SYNTHETIC")
    return render_page(
        f"Modes in {name}", sections, verdict=identification_verdict(found), source=origin(source),
        notice=SYNTHETIC if synthetic else "",
    )  # fmt: skip


def _alike(found: Identified) -> tuple[Section, ...]:
    """The modal assurance criterion between the identified modes, with its values."""
    seen = np.flatnonzero(np.linalg.norm(found.shapes, axis=0) > 0.0)
    if len(seen) < 2 or len(found.shapes) < 2:
        return ()
    values = mac(found.shapes[:, seen], found.shapes[:, seen])
    if len(seen) <= MOST_SHAPES:
        columns = ("mode", *(str(k + 1) for k in seen.tolist()))
        rows: tuple[tuple[Cell, ...], ...] = tuple(
            (int(k) + 1, *(f"{value:.2f}" for value in row))
            for k, row in zip(seen.tolist(), values.tolist(), strict=True)
        )
        caption = "Modal assurance criterion (MAC) of every mode with every other: 1 where two shapes are equal."
    else:
        columns = ("mode", "frequency [Hz]", "mode", "frequency [Hz]", "MAC")
        pairs = np.argwhere(np.triu(values, 1) > LIKE).tolist()
        rows = tuple(
            (
                int(seen[i]) + 1, f"{found.freq[seen[i]]:.2f}", int(seen[j]) + 1, f"{found.freq[seen[j]]:.2f}",
                f"{values[i, j]:.2f}",
            )
            for i, j in pairs
        )  # fmt: skip
        caption = f"Pairs of modes whose modal assurance criterion (MAC) is above {LIKE:g}."
    words = (
        "The sensors cannot distinguish modes whose MAC is near 1. Add sensors, or move some, where that matters."
        if rows
        else f"The modal assurance criterion (MAC) of every pair of modes is below {LIKE:g}: the sensors "
        "distinguish all modes."
    )
    return (Section("Similarity of the shapes", (words,), tables=(Table(caption, columns, rows),) if rows else ()),)


def identification_verdict(found: Identified) -> Verdict:
    """Summary of an identification: number of modes, quality of the fit, next steps."""
    doubtful = int(np.sum(~found.sure))
    first = f"{len(found)} modes from {found.freq[0]:.2f} to {found.freq[-1]:.2f} Hz" if len(found) else "No mode"
    pairs = f", {len(found.doublets)} pairs among them" if found.doublets else ""
    sure = f"{len(found) - doubtful} are sure, {doubtful} doubtful. "
    if np.isfinite(found.deviation):
        sure += f"The residual of the fit is {100.0 * found.deviation:.2g} % of the measured responses (rms)."
    if found.unresolved:
        further = "Excite another point or measure finer lines: some pairs could not be separated."
    elif doubtful:
        further = (
            "Check the doubtful modes in the pictures below. `casingfem identify --pick` takes poles that you choose."
        )
    else:
        further = "Fit a model to these modes: identified.csv is a table for [update] of a study."
    state = "bad" if not len(found) else "open" if doubtful or found.unresolved else "good"
    return Verdict(found=f"{first}{pairs}.", sure=sure, further=further, state=state)
