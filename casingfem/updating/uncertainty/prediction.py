"""Cross-validation of an update: each row, or doublet, of the table is left out in turn and predicted.

A model is tested by a frequency to which it was not fitted. Each update starts from the fit of all rows, keeps its
priors, and predicts the rows that were left out, with the standard deviation

    sigma^2 = sigma_measured^2 + (df/dx) C (df/dx)^T,   C the covariance of that update.

If these errors are several sigma while the residuals of the fit are small, the model has too many parameters or is
wrong.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.correlation.matches import Match
from casingfem.io.arrays import FloatArray
from casingfem.updating.following import followed
from casingfem.updating.problem import Problem, State
from casingfem.updating.result import UpdateResult
from casingfem.updating.solve import covariance, require_enough, solve
from casingfem.updating.targets import HERTZ2, rates
from contact.io.columns import Column, known, table_lines
from contact.io.reported import Reported


@dataclass(frozen=True, slots=True, kw_only=True)
class Prediction:
    """One row of the table, predicted by an update without it [Hz]; `sigma_hz` is that of the difference."""

    mode: int
    n: int
    measured_hz: float
    predicted_hz: float
    sigma_hz: float

    @property
    def error(self) -> float:
        """Relative error."""
        return self.predicted_hz / self.measured_hz - 1.0

    @property
    def deviation(self) -> float:
        """Error in standard deviations."""
        return (self.predicted_hz - self.measured_hz) / self.sigma_hz


COLUMNS = (
    Column("mode", "Mode number of the row left out.", lambda found: [row.mode for row in found.rows],
           head="left out", format="d"),
    Column("n", "Nodal diameters, where the table has them.", lambda found: known(row.n for row in found.rows),
           format="d"),
    Column("measured_hz", "Measured frequency.", lambda found: [row.measured_hz for row in found.rows],
           head="measured", unit="Hz", format=".3f"),
    Column("predicted_hz", "Frequency predicted by a fit of the other rows.",
           lambda found: [row.predicted_hz for row in found.rows], head="predicted", unit="Hz", format=".3f"),
    Column("sigma_hz", "Standard uncertainty of measurement and prediction together.",
           lambda found: [row.sigma_hz for row in found.rows], head="sigma", unit="Hz", format=".3g", where="pages"),
    Column("error", "Predicted over measured frequency, less 1.", lambda found: [row.error for row in found.rows],
           unit="%", format=".3f", scale=100.0),
    Column("deviation", "Predicted less measured frequency, in standard deviations.",
           lambda found: [row.deviation for row in found.rows], unit="sigma", format=".2f"),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class LeftOut(Reported):
    """Predictions of all rows, each by an update without it.

    >>> LeftOut(rows=()).rows
    ()
    """

    COLUMNS: ClassVar = COLUMNS

    rows: tuple[Prediction, ...]

    @property
    def rms(self) -> float:
        """RMS relative error."""
        return float(np.sqrt(np.mean([row.error**2 for row in self.rows])))

    @property
    def rms_sigma(self) -> float:
        """RMS error in standard deviations: about 1 if the model and its sigma are right."""
        return float(np.sqrt(np.mean([row.deviation**2 for row in self.rows])))

    def to_json(self) -> dict[str, object]:
        """Plain data."""
        return {"rows": self.records(), "rms": self.rms, "rms_sigma": self.rms_sigma}

    def __repr__(self) -> str:
        """A row for each prediction, and the RMS."""
        lines = table_lines(self.COLUMNS, self.records())
        lines.append(f"each row predicted from the others: RMS {100.0 * self.rms:.3f} %, {self.rms_sigma:.2f} sigma")
        return "\n".join(lines)


def leave_one_out(fit: UpdateResult, max_iterations: int = 30) -> LeftOut:
    """Predict every row that pairs by an update without it; both rows of a doublet are left out together.

    Raises
    ------
    InputError
        If the remaining rows cannot determine the parameters.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=200e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=7, rows=2, around=2))
    >>> measured = cf.FrequencyTable.from_arrays(freq_hz=cf.modes(plate, 3).freq * 1.01, sigma_hz=0.01)
    >>> fit = cf.update(plate, measured, [cf.Parameter(name="material.E", lower=150e9, upper=250e9)])
    >>> found = leave_one_out(fit)
    >>> len(found.rows), bool(found.rms < 1e-4)
    (3, True)
    """
    rows: list[Prediction] = []
    at_fit = fit.problem.state(fit.x)
    for match in fit.pairing.matches:
        rows += predicted(fit, at_fit, match, max_iterations)
    return LeftOut(rows=tuple(sorted(rows, key=lambda row: row.mode)))


def predicted(fit: UpdateResult, at_fit: State, match: Match, max_iterations: int) -> list[Prediction]:
    """Predict the rows of one match by an update without them, from the solved modes of the fit."""
    whole = fit.given
    left_out = whole.table.mode[list(match.rows)].tolist()
    without = f"{whole.table.path}: without mode {' and '.join(map(str, left_out))}: "
    if len(left_out) == len(whole.table):
        raise InputError(f"{without}found no other row, expected rows from which to predict it: measure more modes")
    table = whole.table.without(*left_out)
    shapes = whole.shapes
    if shapes is not None:
        shapes = shapes.only([row for row in range(len(whole.table)) if row not in match.rows])
    problem = replace(whole, table=table, shapes=shapes, exact=False).problem()
    problem.begin_at(fit.x, at_fit)
    require_enough(len(problem.fun(fit.x)), len(problem.vary), without)
    x, _ = solve(problem, fit.lower, fit.upper, max_iterations, begin=fit.x)
    state = problem.state(x)
    carried = followed(fit.pairing, fit.after, state.modes, whole.table)
    modes = next(other.modes for other in carried.matches if other.rows == match.rows)
    spread = mode_sigmas(state, problem, modes, covariance(problem.jac(x)))
    return [
        Prediction(
            mode=int(fit.table.mode[row]),
            n=int(fit.table.n[row]),
            measured_hz=float(fit.table.freq_hz[row]),
            predicted_hz=float(state.modes.freq[mode]),
            sigma_hz=float(np.hypot(whole.table.sigma_hz[row], sigma)),
        )
        for row, mode, sigma in zip(match.rows, modes, spread, strict=True)
    ]


def mode_sigmas(state: State, problem: Problem, modes: Sequence[int], C: FloatArray) -> FloatArray:
    """Standard deviations of computed frequencies [Hz] from the covariance of the parameters."""
    bare = replace(problem.table, angle_deg=np.full(len(problem.table), np.nan))
    G = rates(state.modes, None, problem.vary, bare, ()).G
    slopes = np.stack([G[:, mode, mode] / (2.0 * HERTZ2 * state.modes.freq[mode]) for mode in modes])
    return np.asarray(np.sqrt(np.einsum("ip,pq,iq->i", slopes, C, slopes)))
