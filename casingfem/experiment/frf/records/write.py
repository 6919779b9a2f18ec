"""Responses from records as a universal file for `identify`: responses, coherence, geometry."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from textwrap import wrap

from casingfem.experiment.frf.files import COHERENCE
from casingfem.experiment.frf.records.estimated import Estimate
from casingfem.experiment.uff.nodes import HEADER_LINES, Nodes, TraceLine, Units
from casingfem.experiment.uff.write import write_uff

WIDTH = 80  # columns of a line of text
WINDOW = "exponential_window_s"


def write_estimate(
    path: str | os.PathLike[str], found: Estimate, nodes: Nodes | None = None, lines: Sequence[TraceLine] = ()
) -> Path:
    """Write data sets 151, 164, 2411, 82 and 58b, whole or not at all.

    The header has the first comment line (maybe SYNTHETIC), the line of an exponential window and the line of the
    estimate; other lines as space permits.
    """
    card = [line for line in found.frfs.card if line]
    kept = [card[-1], *(line for line in card[:-1] if line.startswith(WINDOW))]
    others = [line for line in card if line not in kept]
    header = [part for line in others for part in wrap(line, WIDTH, subsequent_indent="  ")]
    header = [*header[: HEADER_LINES - len(kept)], *kept]
    coherence = [] if found.coherence is None else found.coherence.functions()
    kind = COHERENCE[0] if len({*found.frfs.reference_point.tolist()}) == 1 or found.hits else COHERENCE[1]
    return write_uff(
        path,
        header=[line[:WIDTH] for line in header],
        units=Units(),
        nodes=nodes,
        lines=lines if nodes is not None else (),
        functions=[*found.frfs.functions(), *(replace(function, kind=kind) for function in coherence)],
        binary=True,
    )
