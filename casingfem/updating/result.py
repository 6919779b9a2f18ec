"""Result of an update: values with uncertainties, frequencies before and after, and undetermined parameters."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, ClassVar

import numpy as np
from scipy.optimize import brentq
from scipy.special import chdtri

from casingfem.experiment.correlation.matches import modes_of, unpaired_words
from casingfem.experiment.correlation.pairing import Pairing
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray
from casingfem.modal.mesh_modes import MeshModes
from casingfem.modal.mode_set import Modes, ModeSet
from casingfem.structure.imported.assembly import MeshStructure
from casingfem.structure.shell.shell import Shell
from casingfem.updating.columns import PAIRS, PARAMETERS, PairedRows
from casingfem.updating.identifiability import Identifiability, identifiability
from casingfem.updating.outliers import Outlier, named, shifts_of, strongest
from casingfem.updating.parameters import Parameter
from casingfem.updating.problem import Given, Problem, State
from casingfem.updating.regularisation import Regularised
from casingfem.updating.shapes import redundant
from casingfem.updating.targets import residual_count
from contact.io.columns import records_of, table_lines
from contact.io.reported import Reported

POOR = 2.0  # rms of the weighted residuals above which a fit is tried on other ways
ALIKE = 0.95  # correlations above this: the data cannot distinguish the two
UNINFORMED = 0.9  # a posterior sigma above this part of the prior's: the data state little


def weak_priors(vary: Sequence[Parameter], jacobian: FloatArray) -> tuple[bool, ...]:
    """Parameters whose prior constrains them more than the data do."""
    information = np.sum(jacobian**2, axis=0)
    return tuple(
        p.sigma is not None and info < (1.0 / p.sigma**2) * (1.0 / UNINFORMED**2 - 1.0)
        for p, info in zip(vary, information, strict=True)
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class UpdateResult(Reported):
    """An updated structure and the uncertainty of its parameters.

    Attributes
    ----------
    structure
        The shell at the solution.
    start, value
        Parameter values before and after, in their own units.
    covariance
        (J^T J)^-1 in the solver's variables (decades for log parameters), (parameters, parameters).
    at_bound
        Parameters that ended on a bound, which indicates a wrong model or a wrong bound.
    values, jacobian
        Weighted residuals of the data at the solution, and their derivatives with respect to the solver's variables.
    history
        RMS of the weighted residuals at each evaluation.
    lost
        Rows of the table whose mode could not be tracked in a rejected step; usually empty.
    seconds
        Run time of each part [s].
    regularised
        The weight of the regularisation and the rule that chose it; None without regularisation.
    x, lower, upper, given
        Solution and bounds in the solver's variables, and the inputs of the problem. `leave_one_out`, `laplace` and
        `sample_posterior` use them.
    outliers, plain
        Rows excluded because they contradict all others, and the fit of all rows; usually empty and None.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=200e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=7, rows=2, around=2))
    >>> measured = cf.FrequencyTable.from_arrays(freq_hz=cf.modes(plate, 3).freq * 1.01, sigma_hz=0.01)
    >>> fit = cf.update(plate, measured, [cf.Parameter(name="material.E", lower=150e9, upper=250e9)])
    >>> fit.arrived, bool(fit.rms_after < 1e-4 < fit.rms_before)
    (True, True)
    """

    COLUMNS: ClassVar = PARAMETERS

    structure: Shell | MeshStructure
    parameters: tuple[Parameter, ...]
    start: tuple[float, ...]
    value: tuple[float, ...]
    covariance: FloatArray
    at_bound: tuple[bool, ...]
    prior_only: tuple[bool, ...]
    before: Modes | MeshModes
    after: Modes | MeshModes
    table: FrequencyTable
    pairing_before: Pairing
    pairing: Pairing
    values: FloatArray
    jacobian: FloatArray
    history: tuple[float, ...]
    stopped: str
    lost: tuple[int, ...]
    seconds: dict[str, float]
    regularised: Regularised | None
    x: FloatArray
    lower: FloatArray
    upper: FloatArray
    given: Given = field(repr=False)
    outliers: tuple[Outlier, ...] = ()
    plain: "UpdateResult | None" = field(default=None, repr=False)

    @property
    def problem(self) -> Problem:
        """Set up the least-squares problem again.

        Its modes are tracked from the solution, which is solved on first use.
        """
        problem = self.given.problem()
        problem.anchor = State(self.structure, self.after, None, self.pairing, self.values)
        return problem

    @property
    def measured(self) -> FrequencyTable:
        """The measured table with the excluded rows; `table` contains the others."""
        return self.table if self.plain is None else self.plain.table

    @property
    def set_aside(self) -> tuple[int, ...]:
        """Mode numbers of the excluded rows of the measured table."""
        return tuple(mode for mode in self.measured.mode.tolist() if mode not in self.table.mode)

    @property
    def chi2(self) -> float:
        """Sum of squared weighted residuals of the data."""
        return float(np.sum(self.values**2))

    @property
    def residuals(self) -> int:
        """Number of residuals of the data."""
        return len(self.values)

    @property
    def sigma(self) -> FloatArray:
        """Standard deviations (parameters,), in decades for log parameters.

        Multiplied by the misfit if that exceeds chance.
        """
        return self.inflation * self.stated_sigma

    @property
    def stated_sigma(self) -> FloatArray:
        """Standard deviations if the model and the stated sigma are right, (parameters,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def inflation(self) -> float:
        """The misfit if chance gives so large a chi^2 in less than 1 of 20 fits, else 1."""
        return self.misfit if self.chi2 > chdtri(self.free, 0.05) else 1.0

    @property
    def arrived(self) -> bool:
        """Whether the fit has converged with small residuals, so that no other start of the solver is tried."""
        return float(np.sqrt(np.mean(self.values**2))) <= POOR and self.stopped.startswith("converged")

    @property
    def overstated(self) -> bool:
        """Whether chance gives so small residuals in less than 1 of 100 fits, if the stated sigma are right."""
        return bool(self.chi2 < chdtri(self.free, 0.99))

    @property
    def correlation(self) -> FloatArray:
        """Correlation matrix of the parameters."""
        sigma = np.where(self.stated_sigma > 0.0, self.stated_sigma, 1.0)
        return np.asarray(self.covariance / np.outer(sigma, sigma))

    @property
    def misfit(self) -> float:
        """sqrt(chi^2 / degrees of freedom): 1 if model and stated sigma agree; above 1, multiply sigma by it."""
        return float(np.sqrt(self.chi2 / self.free))

    @property
    def free(self) -> int:
        """Degrees of freedom: residuals minus parameters and minus redundant shape residuals; at least 1."""
        idle = redundant(self.after, self.given.shapes, self.pairing.matches) if isinstance(self.after, Modes) else 0
        return max(self.residuals - idle - len(self.parameters), 1)

    @property
    def model_floor(self) -> float:
        """Relative error of the model that explains the residual scatter beyond the stated sigma; 0 for none.

        If s f is added in squares to the sigma of every frequency f, chi^2 equals the degrees of freedom.
        """
        table = self.given.table
        frequencies = self.values[: sum(self.residuals_of())]
        free = max(len(frequencies) - len(self.parameters), 1)
        noise = np.array([np.sum(table.sigma_hz[list(match.rows)] ** 2) for match in self.pairing.matches])
        level = np.array([np.sum(table.freq_hz[list(match.rows)] ** 2) for match in self.pairing.matches])
        noise, level = (np.repeat(part, self.residuals_of()) for part in (noise, level))

        def excess(s: float) -> float:
            return float(np.sum(frequencies**2 * noise / (noise + s**2 * level)) / free - 1.0)

        return float(brentq(excess, 0.0, 10.0)) if excess(0.0) > 0.0 else 0.0

    @property
    def identifiability(self) -> Identifiability:
        """Identifiability from the table: singular values and directions of the data's Jacobian."""
        return identifiability(self.parameters, self.jacobian)

    @property
    def saturated(self) -> tuple[str, ...]:
        """Parameters that ended on a bound, each with the bound."""
        low = self.x - self.lower < self.upper - self.x
        ends = [("lower", p.lower) if k else ("upper", p.upper) for p, k in zip(self.parameters, low, strict=True)]
        found = zip(self.parameters, ends, self.at_bound, strict=True)
        return tuple(f"{p.name} at its {side} bound {value:.6g}" for p, (side, value), bound in found if bound)

    def worst(self) -> tuple[int, float]:
        """Mode number of the row that alone explains most of the misfit, and its deviation [sigma]."""
        found = self.worst_shift
        return found.modes[0], -float(np.sign(found.shift)) * found.deviation

    @property
    def worst_shift(self) -> Outlier:
        """The change of one frequency, split or orientation that would lower chi^2 most."""
        shifts = shifts_of(self.after, self.given.table, self.pairing.matches)
        residual, jacobian = self.given.with_priors(self.x, self.values, self.jacobian)
        free = ~np.array(self.at_bound)  # what is on a bound gives no way
        return named([strongest(shifts, residual, jacobian * free)], self.table)[0]

    def residuals_of(self) -> list[int]:
        """Number of residuals of each match without those of shapes, which come after them."""
        return [residual_count(match, self.table) for match in self.pairing.matches]

    def rows(self, pairing: Pairing, modes: ModeSet) -> dict[int, float]:
        """Computed frequency [Hz] of each paired row of the table."""
        pairs = [pair for match in pairing.matches for pair in zip(match.rows, match.modes, strict=False)]
        return {row: float(modes.freq[mode]) for row, mode in pairs}

    def rms(self, pairing: Pairing, modes: ModeSet) -> float:
        """RMS relative frequency error over the rows that pair before and after; nan if there are none."""
        both = self.rows(self.pairing_before, self.before).keys() & self.rows(self.pairing, self.after).keys()
        errors = [f / self.table.freq_hz[row] - 1.0 for row, f in self.rows(pairing, modes).items() if row in both]
        return float(np.sqrt(np.mean(np.square(errors)))) if errors else float("nan")

    @property
    def rms_before(self) -> float:
        """RMS relative frequency error of the model before the update."""
        return self.rms(self.pairing_before, self.before)

    @property
    def rms_after(self) -> float:
        """RMS relative frequency error of the updated model."""
        return self.rms(self.pairing, self.after)

    @property
    def unpaired(self) -> tuple[int, ...]:
        """Mode numbers of the table's rows without a computed mode: they are not fitted."""
        return modes_of(self.table, self.pairing.unpaired_rows)

    def paired(self) -> PairedRows:
        """Paired rows of the table, in ascending order."""
        before, after = self.rows(self.pairing_before, self.before), self.rows(self.pairing, self.after)
        sure = {row: match.confidence for match in self.pairing.matches for row in match.rows}
        rows, table = np.array(sorted(after), dtype=int), self.table
        return PairedRows(
            mode=table.mode[rows], n=table.n[rows], measured=table.freq_hz[rows],
            before=np.array([before.get(row, np.nan) for row in rows.tolist()]),
            after=np.array([after[row] for row in rows.tolist()]), sigma=table.sigma_hz[rows],
            confidence=np.array([sure[row] for row in rows.tolist()]),
        )  # fmt: skip

    def pairs(self) -> list[dict[str, Any]]:
        """A dictionary for each paired row: mode, n, measured_hz, before_hz, after_hz, sigma_hz, confidence, errors."""
        return records_of(PAIRS, self.paired())

    def indistinct(self) -> list[tuple[str, str, float]]:
        """Pairs of parameters whose correlation exceeds .95 in magnitude."""
        names, R = [p.name for p in self.parameters], self.correlation
        return [(names[i], names[j], float(R[i, j])) for i in range(len(R)) for j in range(i) if abs(R[i, j]) > ALIKE]

    def outlier_words(self) -> list[str]:
        """Lines on excluded outliers, and the parameters with and without them."""
        if self.plain is None:
            return []
        values = ", ".join(
            f"{p.name} = {value:.5g} (with {'it' if len(self.outliers) == 1 else 'them'} {other:.5g})"
            for p, value, other in zip(self.parameters, self.value, self.plain.value, strict=True)
        )
        return [*(f"outlier, excluded: {outlier!r}" for outlier in self.outliers), f"without outliers: {values}"]

    def records(self) -> list[dict[str, Any]]:
        """One plain dictionary for each parameter; `pairs` has those of the paired rows."""
        return records_of(self.COLUMNS, self)

    def to_json(self) -> dict[str, object]:
        """Plain data, as `casingfem update --json` prints it (without the run time)."""
        return {
            "parameters": self.records(),
            "pairs": self.pairs(),
            "rms_before": self.rms_before,
            "rms_after": self.rms_after,
            "misfit": self.misfit,
            "iterations": len(self.history),
            "correlation": self.correlation.tolist(),
            "unpaired": list(self.unpaired),
            "stopped": self.stopped,
            "saturated": list(self.saturated),
            "lost": [int(self.table.mode[row]) for row in self.lost],
            "worst": dict(zip(("mode", "sigma"), self.worst(), strict=True)),
            "model_floor": self.model_floor,
            "inflation": self.inflation,
            "overstated": self.overstated,
            "outliers": [asdict(outlier) for outlier in self.outliers],
            "with_outliers": None if self.plain is None else list(self.plain.value),
            "identifiability": self.identifiability.to_json(),
            "regularised": None
            if self.regularised is None
            else {name: getattr(self.regularised, name) for name in ("rule", "weight", "names", "note")},
            "seconds_by_part": self.seconds,
        }

    def __repr__(self) -> str:
        """Parameters with sigma, the before/after table, and warnings."""
        lines = [*table_lines(self.COLUMNS, self.records()), *table_lines(PAIRS, self.pairs())]
        lines.append(
            f"RMS {100.0 * self.rms_before:.3f} % -> {100.0 * self.rms_after:.3f} %, "
            f"misfit {self.misfit:.2f} sigma, {len(self.history)} evaluations"
        )
        lines += unpaired_words(self.unpaired)
        if self.misfit > 1.5:
            lines.append(
                f"the model has an error of {100.0 * self.model_floor:.2g} % that the stated sigma do not explain; "
                f"largest: {self.worst_shift!r}"
            )
        if self.inflation > 1.0:
            lines.append(
                f"the residuals are {self.inflation:.2f} times what the stated sigma explain; all sigma of parameters "
                f"were multiplied by {self.inflation:.2f}"
            )
        if self.overstated:
            lines.append(
                f"misfit {self.misfit:.2g}: the residuals are much smaller than the stated sigma; "
                "these are too large, or the table was computed with this model"
            )
        lines += self.outlier_words()
        lines.append(f"stopped: {self.stopped}")
        if self.regularised is not None:
            lines.append(repr(self.regularised))
        lines += [f"saturated: {words}" for words in self.saturated]
        if self.lost:
            modes = ", ".join(str(int(self.table.mode[row])) for row in self.lost)
            lines.append(f"a step was rejected because mode {modes} of the table could not be followed")
        unseen = self.identifiability.unseen
        if unseen:
            lines.append(f"the table contains almost no information on {', '.join(unseen)}")
        lines += [f"the data cannot separate {a} from {b} (correlation {r:+.2f})" for a, b, r in self.indistinct()]
        known = zip(self.parameters, self.prior_only, strict=True)
        lines += [f"{p.name}: only its prior determines it, not the data" for p, weak in known if weak]
        return "\n".join(lines)
