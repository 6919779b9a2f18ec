"""Shapes of universal files, set 55: values at nodes with the frequency, or with data of another analysis."""

import math
from dataclasses import dataclass

import numpy as np

from casingfem.experiment.uff.numbers import Columns, check_lines, integers, reals, series
from casingfem.experiment.uff.split import RawSet
from casingfem.io.arrays import Array, IntArray, freeze

TEXTS = 5
NORMAL_MODE, COMPLEX_MODE, RESPONSE, COMPLEX_MODE_2 = 2, 3, 5, 7
VALUES = {1: 1, 2: 3, 3: 6, 4: 6, 5: 9}  # values a node, by data characteristic
REAL, COMPLEX = 2, 5
PER_LINE = 6


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shape:
    """Values at nodes, (nodes, values), real or complex, as in the file.

    Parameters
    ----------
    text : the five lines of text above the values
    model, analysis : kind of model (1 structural), of analysis (1 static, 2 normal mode, 3 and 7 complex mode, ...)
    characteristic, quantity : 2 translations, 3 translations and rotations, ...; 8 displacement, 11 velocity, ...
    integers, reals : data of the analysis: load case, mode number; frequency, modal mass, dampings
    nodes, values : labels (nodes,) and values

    Examples
    --------
    >>> import numpy as np
    >>> found = Shape(text=("mode 1",) * 5, model=1, analysis=2, characteristic=2, quantity=8, integers=(1, 1),
    ...               reals=(120.0, 1.0, 0.0, 0.0), nodes=np.array([1, 2]), values=np.zeros((2, 3)))
    >>> found.freq_hz
    120.0
    """

    text: tuple[str, ...]
    model: int
    analysis: int
    characteristic: int
    quantity: int
    integers: tuple[int, ...]
    reals: tuple[float, ...]
    nodes: IntArray
    values: Array

    def __post_init__(self) -> None:
        freeze(self, "nodes", "values")

    @property
    def freq_hz(self) -> float:
        """Frequency [Hz], |s|/(2 pi) for a complex mode; nan if the analysis has none."""
        if self.analysis in (NORMAL_MODE, RESPONSE) and self.reals:
            return self.reals[0]
        if self.analysis in (COMPLEX_MODE, COMPLEX_MODE_2) and len(self.reals) > 1:
            return math.hypot(*self.reals[:2]) / (2.0 * math.pi)
        return float("nan")

    def __repr__(self) -> str:
        return f"Shape({self.freq_hz:g} Hz, {self.values.shape[0]} nodes of {self.values.shape[1]} values)"


def read_shape(raw: RawSet) -> Shape:
    """Read a complete data set 55.

    Raises
    ------
    InputError
        The data set deviates from its format or its own header.
    """
    check_lines(raw, 0, TEXTS + 3, "header")
    model, analysis, characteristic, quantity, form, count = integers(raw, [TEXTS], Columns(0, 10, 6))[0].tolist()
    if form not in (REAL, COMPLEX):
        raise raw.error(TEXTS, f"data type {form}", "2 (real) or 5 (complex)")
    if not 0 <= characteristic <= 6:
        raise raw.error(TEXTS, f"data characteristic {characteristic}", "0 to 6")
    if count < 1 or VALUES.get(characteristic, count) != count:
        expected = f"{VALUES.get(characteristic, '1 or more')}, by data characteristic {characteristic}"
        raise raw.error(TEXTS, f"{count} values a node", expected)
    whole, numbers, row = _analysis(raw, analysis)
    nodes, values = _values(raw, row, count * (2 if form == COMPLEX else 1))
    return Shape(
        text=tuple(line.rstrip() for line in raw.lines[:TEXTS]),
        model=model,
        analysis=analysis,
        characteristic=characteristic,
        quantity=quantity,
        integers=whole,
        reals=numbers,
        nodes=nodes,
        values=values[:, ::2] + 1j * values[:, 1::2] if form == COMPLEX else values,
    )


def _analysis(raw: RawSet, analysis: int) -> tuple[tuple[int, ...], tuple[float, ...], int]:
    """Records 7 and 8: numbers of integers and reals (2I10), the integers (6I10), the reals (6E13.5).

    Returns the next line too.
    """
    row = TEXTS + 1
    many, reals_count = integers(raw, [row], Columns(0, 10, 2), last=False)[0].tolist()
    if not (0 <= many <= 6 and 0 <= reals_count <= 12):
        raise raw.error(row, f"{many} integers and {reals_count} reals", "up to 6 and 12")
    least = {NORMAL_MODE: (2, 4), COMPLEX_MODE: (2, 6), RESPONSE: (2, 1), COMPLEX_MODE_2: (2, 6)}.get(analysis, (0, 0))
    if many < least[0] or reals_count < least[1]:
        found = f"{many} integers and {reals_count} reals"
        raise raw.error(row, found, f"at least {least[0]} and {least[1]} for analysis type {analysis}")
    whole = integers(raw, [row], Columns(20, 10, many))[0].tolist() if many else []
    row += 1
    numbers = series(raw, row, reals_count, Columns(0, 13, PER_LINE), reals, "reals") if reals_count else np.empty(0)
    return tuple(whole), tuple(numbers.tolist()), row + max(1, -(-reals_count // PER_LINE))


def _values(raw: RawSet, start: int, count: int) -> tuple[IntArray, Array]:
    """Records 9 and 10 for every node: label (I10), `count` reals (6E13.5)."""
    stop = max((k for k, line in enumerate(raw.lines) if line.strip()), default=0) + 1
    each = 1 - (-count // PER_LINE)
    if stop <= start:
        raise raw.error(start, "no values", "the values of at least one node")
    if (stop - start) % each:
        found = f"{stop - start} lines of values"
        raise raw.error(stop - 1, found, f"{each} lines for every node: its label, {count} numbers")
    heads = range(start, stop, each)
    nodes = integers(raw, heads, Columns(0, 10, 1))[:, 0]
    parts = [
        reals(raw, range(start + k, stop, each), Columns(0, 13, min(PER_LINE, count - PER_LINE * (k - 1))))
        for k in range(1, each)
    ]
    repeated = np.setdiff1d(np.arange(nodes.size), np.unique(nodes, return_index=True)[1])
    if repeated.size or nodes.min() < 1:
        index = int(repeated[0]) if repeated.size else int(np.argmax(nodes < 1))
        raise raw.error(heads[index], f"node {nodes[index]}", "nodes from 1, each once")
    return nodes, np.concatenate(parts, axis=1)
