"""Measured functions of many channels over one abscissa: frequency responses, spectra, time records."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.experiment.frf.forms import FORMS, form_of_codes, quantity_of, unit_of
from casingfem.experiment.uff.read import read_uff
from casingfem.experiment.uff.set_58 import Axes, Axis, Channel, Function
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray, frozen
from casingfem.io.npz import read_npz
from casingfem.io.strict_csv import StrictCsv, read
from contact.io.npz import ArrayKind, write_npz
from contact.io.outfiles import write_atomic

Kind = Literal["frf", "time", "spectrum"]
PLACES = ("response_point", "response_direction", "reference_point", "reference_direction")
TIME, FREQUENCY = 17, 18  # what an abscissa shows, in universal files
_KINDS: dict[Kind, tuple[int, ...]] = {"frf": (4,), "time": (1,), "spectrum": (2, 3, 9, 10, 12)}
_HOW = ": divide the cross spectrum of force and response by the spectrum of the force (scipy.signal.csd, welch)"
_EVEN = 1e-9  # steps equal to this part are written as an even abscissa


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FrfSet:
    """Measured functions over one abscissa; arrays are read-only.

    Parameters
    ----------
    kind
        "frf" or "spectrum" over frequencies [Hz], or "time" over seconds.
    x
        Abscissa (lines,), ascending.
    responses
        (channels, lines), complex; real for time records. Over frequencies, nan means a missing number.
    response_point, response_direction, reference_point, reference_direction
        Place of response and reference of each channel, (channels,): node; and direction 1, 2, 3 for x, y, z, 4, 5, 6
        for rotations, 0 without direction, with sign.
    unit
        Unit of the responses, as in the file.
    form
        "receptance", "mobility" or "accelerance" if the file states it besides a unit, else "".
    card
        Source lines.
    path
        The file that was read.

    Raises
    ------
    InputError
        Arrays do not belong together, values are not finite, or the abscissa does not ascend.

    Examples
    --------
    >>> FrfSet.from_arrays(kind="frf", x=[10.0, 20.0], responses=[[1 + 1j, 2 - 1j]], unit="(m/s^2)/N")
    FrfSet(frf, 1 channel, 2 lines, 10 to 20 Hz, (m/s^2)/N)
    """

    kind: Kind
    x: FloatArray
    responses: Array
    response_point: IntArray
    response_direction: IntArray
    reference_point: IntArray
    reference_direction: IntArray
    unit: str
    form: str = ""
    card: tuple[str, ...] = ()
    path: str = "functions"

    def __post_init__(self) -> None:
        forms: dict[str, Any] = {"x": np.float64, "responses": np.float64 if self.kind == "time" else np.complex128}
        for name in ("x", "responses", *PLACES):
            if name == "responses" and self.kind == "time" and np.iscomplexobj(self.responses):
                raise InputError(self.path, found="a complex time record", expected="real values")
            given = np.asarray(getattr(self, name))
            fits = name not in PLACES or given.dtype.kind in "iu"
            if not fits and not (
                given.dtype.kind == "f" and np.all((given % 1 == 0) & (np.abs(given.astype(np.float64)) < 1e15))
            ):
                raise InputError(self.path, found=f"{name} that are not whole numbers", expected="those of points")
            object.__setattr__(self, name, frozen(np.asarray(given, forms.get(name, np.int64))))
        self._check()

    def _check(self) -> None:
        _kind(self.kind, self.path)
        if self.form not in ("", *FORMS):
            raise InputError(self.path, found=f"form {self.form!r}", expected=" or ".join(FORMS))
        channels = self.responses.shape[:1]
        fit = self.responses.ndim == 2 and self.responses.size and self.x.shape == self.responses.shape[1:]
        if not fit or any(getattr(self, name).shape != channels for name in PLACES):
            found = ", ".join(f"{name} {getattr(self, name).shape}" for name in ("x", "responses", *PLACES))
            expected = "x (lines,), responses (channels, lines), places (channels,)"
            raise InputError(self.path, found=found, expected=expected)
        spoilt = np.isinf(self.responses) if self.kind != "time" else ~np.isfinite(self.responses)
        if not np.isfinite(self.x).all() or spoilt.any():
            raise InputError(self.path, found=self._spoilt(spoilt), expected="finite numbers, or nan for missing ones")
        if np.any(np.diff(self.x) <= 0.0):
            index = int(np.argmax(np.diff(self.x) <= 0.0))
            found = f"{self.x[index + 1]:g} after {self.x[index]:g}"
            raise InputError(self.path, found=found, expected="an abscissa that ascends")

    def _spoilt(self, spoilt: BoolArray) -> str:
        if not spoilt.any():
            return "nan or infinity in the abscissa"
        lines = np.flatnonzero(spoilt.any(axis=0))
        where = f"on {len(lines)} of {len(self.x)} lines, first at {self.x[lines[0]]:g}"
        return f"nan or infinity in {int(spoilt.any(axis=1).sum())} of {len(spoilt)} channels, {where}"

    @classmethod
    def from_arrays(
        cls,
        *,
        kind: Kind,
        x: ArrayLike,
        responses: ArrayLike,
        unit: str,
        response_point: ArrayLike = 0,
        response_direction: ArrayLike = 0,
        reference_point: ArrayLike = 0,
        reference_direction: ArrayLike = 0,
        form: str = "",
        card: Sequence[str] = (),
        path: str = "functions",
    ) -> FrfSet:
        """Build from arrays; places may be scalars."""
        values = np.atleast_2d(np.asarray(responses))
        given = (response_point, response_direction, reference_point, reference_direction)
        places: dict[str, Any] = {
            name: np.broadcast_to(np.asarray(value), values.shape[:1]) if np.ndim(value) == 0 else value
            for name, value in zip(PLACES, given, strict=True)
        }
        at = np.asarray(x, np.float64)
        return cls(kind=kind, x=at, responses=values, unit=unit, form=form, card=tuple(card), path=path, **places)

    @classmethod
    def from_uff(cls, path: str | os.PathLike[str], kind: Kind = "frf") -> FrfSet:
        """All functions of one kind in a universal file; they must share abscissa and unit. Its header is the card.

        Raises
        ------
        InputError, InputError
            The file cannot be read completely, has no such functions, or its functions do not belong to one set.
        """
        file = read_uff(path)
        found = file.functions
        chosen = [function for function in found if function.kind in _KINDS[kind]]
        if not chosen:
            there = ", ".join(sorted({function.word for function in found}))
            raise InputError(
                str(path), found=there or f"no functions, but {file.contents}",
                expected=f"functions of kind {kind!r}{_HOW if kind == 'frf' and there else ''}",
            )  # fmt: skip
        card = tuple(line for line in file.header if line)
        return replace(cls.from_functions(chosen, kind, str(path)), card=card)

    @classmethod
    def from_functions(cls, functions: Sequence[Function], kind: Kind, path: str = "functions") -> FrfSet:
        """Combine functions of a universal file into a set."""
        first = functions[0]
        units = [unit_of(each) or (quantity_of(each) if kind == "frf" else "") for each in functions]
        forms = [form_of_codes(each) if kind == "frf" else "" for each in functions]
        for k, function in enumerate(functions):
            _check_abscissa(function, kind, k, path)
            if not np.array_equal(function.x, first.x):
                raise InputError(
                    path, found=f"function {k + 1} over other abscissas", expected="the abscissas of the first function"
                )
            if units[k] != units[0]:
                raise InputError(path, found=f"function {k + 1} in {units[k]!r}", expected=f"{units[0]!r} as the first")
            if forms[k] != forms[0]:
                found = f"function {k + 1} of code {function.axes.ordinate.kind} ({forms[k] or 'unknown'})"
                expected = f"{first.axes.ordinate.kind} ({forms[0] or 'unknown'}) as the first"
                raise InputError(path, found=found, expected=expected)
        ends = [(f.response.node, f.response.direction, f.reference.node, f.reference.direction) for f in functions]
        places = dict(zip(PLACES, np.array(ends, np.int64).T, strict=True))
        values = np.stack([function.values for function in functions])
        return cls(kind=kind, x=first.x, responses=values, unit=units[0], form=forms[0], path=path, **places)

    @classmethod
    def from_csv(cls, path: str | os.PathLike[str]) -> FrfSet:
        """Read rows of freq_hz (or time_s), the four places, real, imag; a card line `unit: ...` is required.

        Empty cells of real and imag are missing values. Rows of a channel are consecutive. A card line `kind: spectrum`
        makes them spectra; `form: mobility` states the form of responses if the unit does not.

        Raises
        ------
        InputError
            Every deviation from such a table, with file, line and column.
        """
        csv = read(path)
        entries = dict(part.split(":", 1) for part in csv.card if ":" in part)
        entries = {key.strip(): value.strip() for key, value in entries.items()}
        if "unit" not in entries:
            raise csv.refuse(found="no card line 'unit: ...'", expected="the unit, such as '# unit: (m/s^2)/N'")
        timed = "time_s" in csv.header
        kind = "time" if timed else entries.get("kind", "frf")
        columns = ("time_s" if timed else "freq_hz", *PLACES, "real", *(() if timed else ("imag",)))
        for name in (*csv.header, *columns):
            if name not in csv.header or name not in columns:
                found = "no such column" if name in columns else "an unknown column"
                raise csv.refuse_header(column=name, found=found, expected=",".join(columns))
        missing = None if timed else np.nan
        x, values = csv.numbers(columns[0]), csv.numbers("real", blank=missing)
        complete = values if timed else values + 1j * csv.numbers("imag", blank=missing)
        places = np.column_stack([csv.integers(name) for name in PLACES])
        starts = np.flatnonzero(np.r_[True, np.any(np.diff(places, axis=0) != 0, axis=1)])
        lines = _common_lines(csv, x, starts)
        return cls(
            kind=_kind(kind, csv.path),
            x=x[:lines],
            responses=complete.reshape(len(starts), lines),
            unit=entries["unit"],
            form=entries.get("form", ""),
            card=csv.card,
            path=csv.path,
            **dict(zip(PLACES, places[starts].T, strict=True)),
        )

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write the table, whole or not at all; reading it back gives every number bit for bit."""
        timed = self.kind == "time"
        card = [line for line in self.card if line.partition(":")[0].strip() not in ("unit", "kind", "form")]
        said = [f"unit: {self.unit}", f"kind: {self.kind}", *([f"form: {self.form}"] if self.form else [])]
        lines = [f"# {line}".rstrip() for line in (*card, *said)]
        lines.append(",".join(("time_s" if timed else "freq_hz", *PLACES, "real", *(() if timed else ("imag",)))))
        for channel, values in enumerate(self.responses.tolist()):
            place = ",".join(str(getattr(self, name)[channel]) for name in PLACES)
            parts = (f"{v!r}" if timed else "," if np.isnan(v) else f"{v.real!r},{v.imag!r}" for v in values)
            lines += [f"{at!r},{place},{part}" for at, part in zip(self.x.tolist(), parts, strict=True)]
        return write_atomic(Path(path), "\n".join(lines) + "\n")

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> FrfSet:
        """Read a file written by `save`, without pickle."""
        wanted = {"kind", "x", "responses", *PLACES, "unit", "card"}
        texts: dict[str, ArrayKind] = dict.fromkeys(("kind", "unit", "form", "card"), "text")
        kinds: dict[str, ArrayKind] = texts | {"responses": "complex"}
        stored = read_npz(path, wanted, "what FrfSet.save wrote", kinds)
        arrays = {name: stored[name] for name in ("x", "responses", *PLACES)}
        kind, unit, card = _kind(str(stored["kind"]), str(path)), str(stored["unit"]), tuple(stored["card"].tolist())
        return cls(kind=kind, unit=unit, form=str(stored.get("form", "")), card=card, path=str(path), **arrays)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write an npz file of plain arrays, whole or not at all."""
        arrays = {field.name: np.asarray(getattr(self, field.name)) for field in fields(self) if field.name != "path"}
        arrays["card"] = np.asarray(self.card, dtype=np.str_)
        return write_npz(path, arrays)

    def functions(self, *, double: bool = True) -> tuple[Function, ...]:
        """The channels as functions of a universal file, for `write_uff(path, functions=..., binary=True)`."""
        steps = np.diff(self.x)
        even = steps.size > 0 and bool(np.ptp(steps) <= _EVEN * steps.mean())
        timed = self.kind == "time"
        what = Axis(TIME, label="time", unit="s") if timed else Axis(FREQUENCY, label="frequency", unit="Hz")
        axes = Axes(what, Axis(label="response", unit=self.unit))
        return tuple(
            Function(
                kind=12 if self.kind == "spectrum" else _KINDS[self.kind][0],
                text=(),
                response=Channel("", int(self.response_point[k]), int(self.response_direction[k])),
                reference=Channel("", int(self.reference_point[k]), int(self.reference_direction[k])),
                x=self.x,
                values=values,
                step=float((self.x[-1] - self.x[0]) / steps.size) if even else 0.0,
                double=double,
                axes=axes,
            )
            for k, values in enumerate(self.responses)
        )

    def __len__(self) -> int:
        return len(self.responses)

    def __repr__(self) -> str:
        count = f"{len(self)} channel" + "s" * (len(self) != 1)
        unit = "s" if self.kind == "time" else "Hz"
        span = f"{self.x[0]:g} to {self.x[-1]:g} {unit}"
        return f"FrfSet({self.kind}, {count}, {len(self.x)} lines, {span}, {self.unit})"


def _kind(word: str, path: str) -> Kind:
    for kind in _KINDS:
        if kind == word:
            return kind
    raise InputError(path, found=f"kind {word!r}", expected=" or ".join(_KINDS))


def _common_lines(csv: StrictCsv, x: FloatArray, starts: IntArray) -> int:
    """Number of lines of every channel; all must have the same abscissas."""
    ends = np.r_[starts[1:], len(x)]
    lines = int(ends[0])
    for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
        if not np.array_equal(x[start:end], x[:lines]):
            found = f"{end - start} rows of a channel over other abscissas"
            raise csv.refuse(row=start, found=found, expected=f"the {lines} abscissas of the first channel, in order")
    return lines


def _check_abscissa(function: Function, kind: Kind, k: int, path: str) -> None:
    """Refuse functions over anything except seconds or Hz."""
    axis = function.axes.abscissa
    wanted, number, unit, *more = ("time", TIME, "s", "sec") if kind == "time" else ("frequency", FREQUENCY, "Hz")
    if axis.kind not in (0, number) or axis.unit.lower() not in ("", "none", unit.lower(), *more):
        found = f"function {k + 1} over {axis.label!r} in {axis.unit!r} (kind {axis.kind})"
        raise InputError(path, found=found, expected=f"{wanted} in {unit}")
