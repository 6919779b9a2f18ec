"""Find rows of a table that contradict all others: the mean-shift outlier model on the linearised fit.

A wrong row r shifts the residuals along u_r, their derivative with respect to the measured value: a frequency, the
split of a pair, its orientation. For a set S of shifts delta (Cook & Weisberg, Residuals and Influence in Regression,
1982, 2.2.2)

    chi^2(S) = min |r + J d + U_S delta|^2 = |P r|^2 - b^T (U_S^T P U_S)^-1 b,   b = U_S^T P r,   P = 1 - J J^+,

with J and r including the priors. Sets grow by one shift at a time. Each member is exchanged for any other that fits
better, so that wrong rows do not mask each other. The result is the largest set whose members are all significant given
the rest: Student's t of its shift, at LEVEL over the number of tried shifts, with the remaining scatter, or the stated
sigma if larger.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.special import stdtr

from casingfem.experiment.correlation.matches import Match
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray
from casingfem.modal.mode_set import ModeSet
from casingfem.updating.targets import has_angle, is_doublet, values

LEVEL = 0.01  # chance of a false alarm in a table without wrong rows
SHARE = 5  # rows of the table for each row that may be wrong
STEP = 1e-6  # relative, or in degrees: of the differences that give u_r, which is all but constant
FREE = 3  # degrees of freedom that must be left
Kind = Literal["frequency", "split", "orientation"]


@dataclass(frozen=True, slots=True)
class Shift:
    """A possible error of a table: rows, their wrong number, and the change of the residuals."""

    kind: Kind
    rows: tuple[int, ...]
    change: FloatArray


@dataclass(frozen=True, slots=True)
class Found:
    """A shift with its size, in the number's own unit, and its significance [standard deviations]."""

    kind: Kind
    rows: tuple[int, ...]
    shift: float
    deviation: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Outlier:
    """Outlier rows that the update excluded: mode numbers, their wrong number, and its error.

    `shift` is relative for frequencies and splits (of the frequency), in degrees for orientations; `deviation` is in
    standard deviations.
    """

    modes: tuple[int, ...]
    n: int
    kind: Kind
    shift: float
    deviation: float

    def __repr__(self) -> str:
        """One sentence for the report."""
        rows = " and ".join(map(str, self.modes))
        label = f", n = {self.n}" if self.n >= 0 else ""
        size = f"{abs(self.shift):.3g} deg" if self.kind == "orientation" else f"{100.0 * abs(self.shift):.2g} %"
        what = "" if self.kind == "frequency" else f" in {self.kind}"
        many = "s" if len(self.modes) > 1 else ""
        return f"row{many} {rows}{label}: {size}{what} from what the other rows predict ({self.deviation:.1f} sigma)"


def named(found: Sequence[Found], table: FrequencyTable) -> tuple[Outlier, ...]:
    """The shifts with the table's own numbers of modes."""
    return tuple(
        Outlier(
            modes=tuple(table.mode[list(one.rows)].tolist()),
            n=int(table.n[one.rows[0]]),
            kind=one.kind,
            shift=one.shift / (1.0 if one.kind == "orientation" else float(table.freq_hz[one.rows[0]])),
            deviation=one.deviation,
        )
        for one in found
    )


def shifts_of(modes: ModeSet, table: FrequencyTable, matches: Sequence[Match]) -> list[Shift]:
    """Every shift that a pairing allows: each frequency, each doublet's split and, if measured, its orientation."""
    base = values(modes, table, matches)

    def changed(rows: Sequence[int], steps: Sequence[float], name: str = "freq_hz") -> FloatArray:
        numbers = getattr(table, name).copy()
        numbers[list(rows)] += steps
        size = float(np.abs(steps).max())
        return (values(modes, replace(table, **{name: numbers}), matches) - base) / size

    found: list[Shift] = []
    for match in matches:
        steps = STEP * table.freq_hz[list(match.rows)]
        found += [Shift("frequency", (row,), changed([row], [h])) for row, h in zip(match.rows, steps, strict=True)]
        if is_doublet(match):
            step = float(steps[0])
            found.append(Shift("split", match.rows, changed(match.rows, [-0.5 * step, 0.5 * step]) / 2.0))
        if has_angle(match, table):
            found.append(Shift("orientation", match.rows, changed(match.rows, [STEP, STEP], "angle_deg")))
    return found


def step_without(
    found: Sequence[Found], shifts: Sequence[Shift], residual: FloatArray, jacobian: FloatArray
) -> FloatArray:
    """The step of the parameters that fits all data except the outliers, linearised."""
    changes = {(shift.kind, shift.rows): shift.change for shift in shifts}
    columns = [np.pad(c, (0, len(residual) - len(c))) for c in (changes[one.kind, one.rows] for one in found)]
    whole = np.column_stack([jacobian, *columns])
    scale = np.linalg.norm(whole, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    solution = np.linalg.lstsq(whole / scale, -residual, rcond=1e-10)[0] / scale
    return np.asarray(solution[: jacobian.shape[1]])


def strongest(shifts: Sequence[Shift], residual: FloatArray, jacobian: FloatArray) -> Found:
    """The single shift that lowers chi^2 most, significant or not; its deviation is in stated sigma.

    If the parameters can fit every shift, for example with as many residuals as parameters, the parameters are kept
    constant.
    """
    left, r, usable = projected(shifts, residual, jacobian)
    if not usable:
        left, r, usable = projected(shifts, residual, np.zeros_like(jacobian))
    (k,) = grown([], left, r, usable)
    delta, spread, _ = solved(left[:, [k]], r)
    return Found(shifts[k].kind, shifts[k].rows, -float(delta[0]), float(abs(delta[0]) / spread[0]))


def projected(
    shifts: Sequence[Shift], residual: FloatArray, jacobian: FloatArray
) -> tuple[FloatArray, FloatArray, Sequence[int]]:
    """P U, P r, and the shifts that the parameters cannot fit completely."""
    u = np.stack([np.pad(s.change, (0, len(residual) - len(s.change))) for s in shifts], axis=1)
    left, values, _ = np.linalg.svd(jacobian, full_matrices=False)
    span = left[:, values > 1e-12 * max(values[0], 1e-300)]
    apart = u - span @ (span.T @ u)
    usable = np.flatnonzero(np.linalg.norm(apart, axis=0) > 1e-6 * np.linalg.norm(u, axis=0)).tolist()
    return apart, residual - span @ (span.T @ residual), usable


def outlying(shifts: Sequence[Shift], residual: FloatArray, jacobian: FloatArray, rows: int) -> list[Found]:
    """The largest set of significant shifts; empty if there is none.

    `residual` and `jacobian` are those of the fit with the rows of its priors last; `rows` the table's.
    """
    left, r, usable = projected(shifts, residual, jacobian)
    free = len(residual) - jacobian.shape[1]
    best: list[int] = []
    answer: list[Found] = []
    for count in range(1, max(rows // SHARE, 1) + 1):
        if free - count < FREE or len(usable) <= count:
            break
        best = grown(best, left, r, usable)
        if len(best) < count:
            break
        delta, spread, chi2 = solved(left[:, best], r)
        scale = max(1.0, float(np.sqrt(chi2 / (free - count))))
        deviation = np.abs(delta) / (spread * scale)
        if np.all(2.0 * stdtr(free - count, -deviation) < LEVEL / len(usable)):
            found = zip(best, delta, deviation, strict=True)
            answer = [Found(shifts[k].kind, shifts[k].rows, -float(d), float(t)) for k, d, t in found]
    return sorted(answer, key=lambda found: found.rows)


def grown(chosen: list[int], left: FloatArray, r: FloatArray, usable: Sequence[int]) -> list[int]:
    """A set with one more shift, its members exchanged for others as long as that lowers chi^2."""
    members = [*chosen, *beside(chosen, left, r, usable)]
    for _ in range(10):
        before = solved(left[:, members], r)[2]
        for place in range(len(members)):
            rest = members[:place] + members[place + 1 :]
            members = [*members[:place], *beside(rest, left, r, usable), *members[place + 1 :]]
        if solved(left[:, members], r)[2] >= before * (1.0 - 1e-9):
            break
    return members


def beside(rest: list[int], left: FloatArray, r: FloatArray, usable: Sequence[int]) -> list[int]:
    """The shift that lowers chi^2 most in addition to `rest`, by (P u_k . r)^2/|P u_k|^2; None if all are dependent."""
    others = [int(k) for k in usable if k not in rest]
    span = np.linalg.qr(left[:, rest])[0]
    columns = left[:, others] - span @ (span.T @ left[:, others])
    norm = np.sum(columns**2, axis=0)
    apart = norm > 1e-8 * np.sum(left[:, others] ** 2, axis=0)
    gain = np.where(apart, (columns.T @ r) ** 2 / np.where(apart, norm, 1.0), -1.0)
    return [others[int(gain.argmax())]] if apart.any() else []


def solved(columns: FloatArray, r: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Best-fitting shifts, their standard deviations at unit sigma, and the remaining chi^2.

    Infinite if they are dependent.
    """
    normal = columns.T @ columns
    scale = np.sqrt(np.diag(normal))
    alike = normal / np.outer(scale, scale)
    if np.linalg.eigvalsh(alike)[0] < 1e-8:
        return np.zeros(len(scale)), np.ones(len(scale)), np.inf
    inverse = np.linalg.inv(alike) / np.outer(scale, scale)
    delta = -inverse @ (columns.T @ r)
    return delta, np.sqrt(np.diag(inverse)), float(np.sum((r + columns @ delta) ** 2))
