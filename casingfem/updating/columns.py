"""Table columns of an update: its parameters, and the paired rows with their modes."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.updating.numbers import named_numbers, unit_of
from contact.io.columns import Column, known, mark, present, word

LARGE = 1.0  # a relative change above which the table gives a factor


class PairedRows(NamedTuple):
    """Arrays (rows,) of the paired rows; nan if no computed mode was paired before the fit.

    mode of the table, n (-1 for none), measured, before, after, sigma [Hz], confidence of the pairing.
    """

    mode: IntArray
    n: IntArray
    measured: FloatArray
    before: FloatArray
    after: FloatArray
    sigma: FloatArray
    confidence: FloatArray


def changed(change: float) -> str:
    """Text for a relative change.

    >>> changed(-0.0232), changed(2999.0)
    ('-2.32 %', '3e+03 times')
    """
    return f"{100.0 * change:+.2f} %" if abs(change) < LARGE else f"{1.0 + change:.3g} times"


def units(structure: Any, names: Sequence[str]) -> list[str]:
    """Units of parameters; for a harmonic that the structure does not have, from the last word of its address."""
    known = named_numbers(structure)
    return [known.get(name) or unit_of(name) for name in names]


PARAMETERS = (
    Column("name", "Address of the parameter.", lambda fit: [p.name for p in fit.parameters], head="parameter",
           format=word),
    Column("unit", "Unit of the parameter.", lambda fit: units(fit.structure, [p.name for p in fit.parameters]),
           format=word),
    Column("start", "Value before the fit.", lambda fit: fit.start, format=".6g"),
    Column("value", "Value after the fit.", lambda fit: fit.value, format=".6g"),
    Column("change_rel", "Change over the value before the fit.",
           lambda fit: [b / a - 1.0 if a else None for a, b in zip(fit.start, fit.value, strict=True)], head="change",
           format=changed, where="pages"),
    Column("sigma", "Standard deviation; in decades for a parameter that varies in log10.", lambda fit: fit.sigma,
           format=".2g"),
    Column("log", "Whether the parameter varies in log10.", lambda fit: [p.log for p in fit.parameters],
           head="sigma in", format=mark("decades")),
    Column("lower", "Lower bound.", lambda fit: [p.lower for p in fit.parameters], format=".6g", where="pages"),
    Column("upper", "Upper bound.", lambda fit: [p.upper for p in fit.parameters], format=".6g", where="pages"),
    Column("at_bound", "Whether the parameter ended on a bound.", lambda fit: fit.at_bound, head="bound",
           format=mark("AT BOUND")),
)  # fmt: skip
PAIRS = (
    Column("mode", "Mode number of the measured table.", lambda rows: rows.mode, format="d"),
    Column("n", "Nodal diameters of the row, where the table has them.", lambda rows: known(rows.n), format="d"),
    Column("measured_hz", "Measured frequency.", lambda rows: rows.measured, head="measured", unit="Hz", format=".3f"),
    Column("before_hz", "Computed frequency before the fit.", lambda rows: present(rows.before), head="before",
           unit="Hz", format=".3f"),
    Column("error_before_rel", "Frequency before the fit over the measured one, less 1.",
           lambda rows: present(rows.before / rows.measured - 1.0), head="error before", unit="%", format="+.3f",
           scale=100.0, where="pages"),
    Column("after_hz", "Computed frequency after the fit.", lambda rows: rows.after, head="after", unit="Hz",
           format=".3f"),
    Column("error_after_rel", "Frequency after the fit over the measured one, less 1.",
           lambda rows: rows.after / rows.measured - 1.0, head="error after", unit="%", format="+.3f", scale=100.0),
    Column("sigma_hz", "Standard uncertainty of the measured frequency.", lambda rows: rows.sigma, head="sigma",
           unit="Hz", format=".3g", where="pages"),
    Column("confidence", "Confidence of the pairing, from 0 to 1.", lambda rows: rows.confidence, format=".2f"),
)  # fmt: skip
