"""What the rig's own modes are, as a table: what an identification of its records should find."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.experiment.rig.rig import SYNTHETIC, Rig
from casingfem.experiment.rig.scan import circle_content

EXACT = 1e-9  # relative uncertainty that a table must have


def truth(rig: Rig, circle: Sequence[int] = (), card: Sequence[str] = ()) -> FrequencyTable:
    """Frequencies, damping and, by the shapes on a circle of probes, n and antinodes of the rig's modes.

    They are those of the structure with all its sensors on. Without a circle there are no labels.

    >>> truth(Rig.of(omega=[600.0], zeta=0.01, rows=[[1.0]])).zeta.tolist()
    [0.01]
    """
    n = np.full(len(rig), -1)
    angle = np.full(len(rig), np.nan)
    if len(circle):
        orders, transform = circle_content(rig, circle)
        content = (transform @ rig.rows[list(circle)])[orders >= 0]
        n = np.abs(content).argmax(axis=0)
        phase = np.angle(content[n, np.arange(len(rig))])
        with np.errstate(divide="ignore", invalid="ignore"):
            angle = np.where(n > 0, np.mod(np.degrees(-phase) / n, 180.0 / n), np.nan)
    return FrequencyTable.from_arrays(
        freq_hz=rig.freq,
        sigma_hz=EXACT * rig.freq,
        n=n,
        angle_deg=angle,
        zeta=rig.zeta,
        card=(SYNTHETIC, "the rig's own modes, which its records are made of: the truth, not a test's result", *card),
    )
