"""Sets of frequency responses and of coherence from the averages of a hammer or shaker test."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.records.take import Take
from casingfem.io.arrays import Array, FloatArray, IntArray


def sets_of(
    take: Take, freq: FloatArray, H: Array, coherence: FloatArray, *, response: tuple[IntArray, IntArray],
    reference: tuple[IntArray, IntArray], card: tuple[str, ...],
) -> tuple[FrfSet, FrfSet]:  # fmt: skip
    """Frequency responses and coherence of a test, with the units of a record.

    Parameters
    ----------
    take
        Gives the units, and the name for messages.
    freq
        Lines [Hz] (lines,).
    H, coherence
        Responses (rows, lines); coherence (channels, lines) of the first rows. There are fewer channels than rows if
        several forces act at once.
    response, reference
        Points and directions, (rows,) each.
    card
        Header lines of both sets.

    Raises
    ------
    InputError
        All responses are zero.
    """
    if not np.any(np.abs(H) > 0.0):
        raise InputError(take.name, found="no channel with a signal", expected="a response")
    frfs = FrfSet.from_arrays(
        kind="frf", x=freq, responses=H, unit=_unit(take), card=card, path=take.name,
        response_point=response[0], response_direction=response[1],
        reference_point=reference[0], reference_direction=reference[1],
    )  # fmt: skip
    count = len(coherence)
    return frfs, replace(
        frfs, kind="spectrum", responses=np.clip(coherence, 0.0, 1.0).astype(complex), unit="",
        response_point=frfs.response_point[:count], response_direction=frfs.response_direction[:count],
        reference_point=frfs.reference_point[:count], reference_direction=frfs.reference_direction[:count],
        card=(*card, "multiple coherence") if count < len(H) else card,
    )  # fmt: skip


def _unit(take: Take) -> str:
    """Unit of a response over a force, "" if the responses have none."""
    unit = take.response.unit
    over = take.force.unit or "N"
    return f"({unit})/{over}" if "/" in unit else f"{unit}/{over}" if unit else ""
