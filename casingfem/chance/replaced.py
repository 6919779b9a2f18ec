"""Draws whose pairs the map does not give reliably: solved in full.

The map's error is of fourth order in the imperfections. A draw is flagged where the terms of third order are large. For
28 draws with terms from 5e-4 to 6e-3 of a frequency, the map's error was below these terms, with a median of a third of
them. Rayleigh's quotient (`family.near`) cannot replace the map: its error had a median of 2.6 times the map's.
"""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from casingfem.chance.casings import Casings
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.family.splits import Splits
from casingfem.modal.mode_set import ModeSet
from casingfem.modal.modes import modes
from casingfem.structure.field.fourier import FourierField

FLAG = 3e-3  # of a frequency: terms of third order above which a draw is replaced
PURE = 0.7  # of the energy of both modes in a pair's waves: below, the pair is mixed with another
BY_MAP, IN_FULL = range(2)


class Replaced(NamedTuple):
    """Pairs of draws, and how each draw was solved: 0 by the map, 1 in full, (draws,)."""

    pairs: Splits
    by: IntArray


def replaced(own: Casings, series: Array, pairs: Splits) -> Replaced:
    """The pairs of casings with series F (draws, l, 2 p_max + 1); flagged draws are solved again."""
    by = np.zeros(len(series), dtype=np.int64)
    found = Splits(*(part.copy() for part in pairs))
    for draw in np.flatnonzero(~(pairs.third.max(axis=1) <= FLAG)).tolist():
        put(own, found, draw, in_full(own, series[draw]))
        by[draw] = IN_FULL
    return Replaced(found, by)


def checked(own: Casings, series: Array, found: Replaced, draw: int) -> tuple[Replaced, float]:
    """One draw solved in full, and the difference of its splits relative to its largest one, without mixed pairs."""
    pairs, by = Splits(*(part.copy() for part in found.pairs)), found.by.copy()
    put(own, pairs, draw, in_full(own, series[draw]))
    by[draw] = IN_FULL
    clear = np.minimum(pairs.share[draw], found.pairs.share[draw]) >= PURE
    apart = np.abs(pairs.split[draw] - found.pairs.split[draw])[clear]
    return Replaced(pairs, by), float(apart.max(initial=0.0) / pairs.split[draw].max())


def in_full(own: Casings, series: Array) -> ModeSet:
    """The lowest modes of a casing by a full solution."""
    fields: dict[str, Any] = {f"{name}_defect": field for name, field in fields_of(own, series).items()}
    return modes(replace(own.shell, **fields), own.modes, method="shell")


def fields_of(own: Casings, series: Array) -> dict[str, FourierField]:
    """The fields of a series F (l, 2 p_max + 1) by quantity."""
    top = series.shape[-1] // 2
    size = np.where(np.arange(top + 1) > 0, 2.0, 1.0)[:, None]
    first = int(not series[:, top].any())  # a mean, where one is given

    def field(line: FloatArray) -> FourierField:
        ahead = size * line[top:, None]
        return FourierField(p=np.arange(first, top + 1), cos=ahead.real[first:], sin=-ahead.imag[first:])

    return {name: field(line) for name, line in zip(own.random.quantities, series, strict=True)}


def put(own: Casings, pairs: Splits, draw: int, found: ModeSet) -> None:
    """Replace the pairs of a draw by those of some modes; pairs that are not among them count as mixed."""
    pairs.share[draw] = 0.0
    n, rank = found.nodal_diameters, found.meridional
    for (low, high), split in zip(found.doublets, found.splits, strict=True):
        for k in np.flatnonzero((own.pairs.n == n[low]) & (own.pairs.rank == rank[low])).tolist():
            pairs.freq[draw, k] = 0.5 * (found.freq[low] + found.freq[high])
            pairs.split[draw, k], pairs.angle_deg[draw, k] = split, np.nan_to_num(found.angle_deg[low])
            pairs.share[draw, k] = found.purity[[low, high]].min()
