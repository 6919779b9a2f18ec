"""Least-squares updating of a shell against a frequency table.

    min over x of |r(x)|^2 + |(x - x0)/sigma_prior|^2,  lower <= x <= upper

with r from `targets.py`, exact Jacobians from `sensitivity.py`, and scipy's trust-region reflective solver. The
covariance is (J^T J)^-1 at the solution, J with the prior rows.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import least_squares

from casingfem.arrays import FloatArray
from casingfem.experiment.correlation import Pairing
from casingfem.experiment.measurement import FrequencyTable
from casingfem.modal.modes import Modes, count_below, modes
from casingfem.structure.shell import Shell
from casingfem.updating.labels import Rows, followed, keeps, paired_rows
from casingfem.updating.parameters import Parameter, ParameterError, check_parameters, get_value, with_value
from casingfem.updating.result import UpdateResult, weak_priors
from casingfem.updating.sensitivity import eigen_derivatives
from casingfem.updating.targets import Residual, residuals

Progress = Callable[[int, float], None]  # (evaluation, RMS of the weighted residuals)


class UpdateError(ValueError):
    """An update that cannot be set up: nothing pairs, no data for the parameters, start outside the bounds."""


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """One evaluated point: structure, modes, pairing, residuals."""

    shell: Shell
    modes: Modes
    pairing: Pairing
    residual: Residual


def mode_count(table: FrequencyTable, shell: Shell) -> int:
    """Modes to compute so that every row has a candidate: all up to 15 % past the table, and a few more."""
    return max(count_below(shell, 1.15 * float(table.freq_hz.max())), len(table)) + 4


@dataclass(eq=False)
class Problem:
    """Residuals and Jacobian as least_squares wants them, remembering the last point and the history."""

    shell: Shell
    table: FrequencyTable
    vary: Sequence[Parameter]
    count: int
    reach: float
    model_error: float = 0.0
    progress: Progress | None = None
    start: FloatArray = field(init=False)
    history: list[tuple[FloatArray, float]] = field(default_factory=list)
    rows: Rows | None = None  # that should keep pairing
    _key: bytes = b""
    _state: State | None = None

    def __post_init__(self) -> None:
        self.start = np.array([p.to_internal(get_value(self.shell, p.name)) for p in self.vary], dtype=float)

    def structure(self, x: FloatArray) -> Shell:
        """The shell at solver variables x."""
        shell = self.shell
        for parameter, value in zip(self.vary, x, strict=True):
            shell = with_value(shell, parameter.name, float(parameter.from_internal(value)))
        return shell

    def state(self, x: FloatArray) -> State:
        """Modes, pairing and residuals at x; the last point is kept, for the Jacobian follows the residual."""
        key = np.asarray(x, dtype=float).tobytes()
        if self._state is None or key != self._key:
            shell = self.structure(x)
            found = modes(shell, self.count)
            found, pairing = followed(found, self.table, self.reach, self.rows)
            if not pairing.matches:
                raise UpdateError(
                    f"no row of {self.table.path} pairs with a computed mode within {self.reach:.0%}: "
                    f"measured {self.table.freq_hz.min():.1f} to {self.table.freq_hz.max():.1f} Hz, "
                    f"computed {found.freq[0]:.1f} to {found.freq[-1]:.1f} Hz"
                )
            G = eigen_derivatives(found, list(self.vary))
            ordered = sorted(pairing.matches, key=lambda match: match.rows)
            if self.rows is not None and keeps(pairing, self.rows):
                ordered = [match for match in ordered if match.rows in self.rows]
            residual = residuals(found, self.table, ordered, G, self.model_error)
            self._key, self._state = key, State(shell, found, pairing, residual)
            rms = float(np.sqrt(np.mean(residual.values**2)))
            self.history.append((np.array(x, dtype=float), rms))
            if self.progress is not None:
                self.progress(len(self.history), rms)
        return self._state

    def forget(self) -> None:
        """Let all rows pair again that can."""
        if self.rows is not None:
            self.rows, self._state = None, None

    def _prior(self) -> tuple[FloatArray, FloatArray]:
        """Rows that hold parameters with a sigma to their start: selector over sigma, and its columns."""
        known = [k for k, p in enumerate(self.vary) if p.sigma is not None]
        rows = np.zeros((len(known), len(self.vary)))
        for i, k in enumerate(known):
            rows[i, k] = 1.0 / float(self.vary[k].sigma or 1.0)
        return rows, rows @ self.start

    def fun(self, x: FloatArray) -> FloatArray:
        """Weighted residuals, the prior's last."""
        rows, offset = self._prior()
        return np.concatenate([self.state(x).residual.values, rows @ x - offset])

    def jac(self, x: FloatArray) -> FloatArray:
        """Their derivatives."""
        return np.vstack([self.state(x).residual.jacobian, self._prior()[0]])


def update(
    structure: Shell,
    table: FrequencyTable,
    vary: Sequence[Parameter],
    *,
    count: int | None = None,
    reach: float = 0.5,
    model_error: float = 0.0,
    max_iterations: int = 30,
    progress: Progress | None = None,
) -> UpdateResult:
    """Fit named numbers of a shell to a frequency table.

    Parameters
    ----------
    structure
        The model; its present values are the start and the centres of the priors.
    table
        Measured frequencies with their sigma; doublets and orientations are used where they are given.
    vary
        What may change, within which bounds.
    count
        Modes computed at each step; by default enough to reach 15 % above the table.
    reach
        Largest relative frequency error at which a row may pair with a mode.
    model_error
        Relative frequency error to allow the model itself, added to each sigma in squares: 0 trusts it fully.
    max_iterations
        Limit on evaluations.
    progress
        Called after each evaluation with its number and the RMS of the weighted residuals.

    Raises
    ------
    ParameterError
        A parameter that does not exist, is named twice, or starts outside its bounds.
    UpdateError
        Nothing pairs, fewer residuals than parameters, or rigid motions among the modes.
    """
    if not vary:
        raise ParameterError("vary: name at least one parameter")
    if not 0.0 <= model_error < 1.0:
        raise UpdateError(f"model_error must lie in [0, 1), found {model_error!r}")
    check_parameters(structure, vary)
    count = count or mode_count(table, structure)
    problem = Problem(structure, table, vary, count, reach, model_error, progress)
    lower = np.array([p.to_internal(p.lower) for p in vary])
    upper = np.array([p.to_internal(p.upper) for p in vary])
    before = problem.state(problem.start)
    if before.modes.rigid:
        raise UpdateError(f"the structure has {before.modes.rigid} rigid motions: support it before updating")
    if len(problem.fun(problem.start)) < len(vary):
        raise UpdateError(
            f"{len(problem.fun(problem.start))} residuals cannot determine {len(vary)} parameters: "
            "measure more modes, vary less, or give priors"
        )
    x, stopped = solve(problem, lower, upper, max_iterations)
    after = problem.state(x)
    return UpdateResult(
        structure=after.shell,
        parameters=tuple(vary),
        start=tuple(float(p.from_internal(v)) for p, v in zip(vary, problem.start, strict=True)),
        value=tuple(float(p.from_internal(v)) for p, v in zip(vary, x, strict=True)),
        covariance=covariance(problem.jac(x)),
        at_bound=tuple(bool(v) for v in np.minimum(x - lower, upper - x) < 1e-3 * (upper - lower)),
        prior_only=weak_priors(vary, after.residual.jacobian),
        before=before.modes,
        after=after.modes,
        table=table,
        pairing_before=before.pairing,
        pairing=after.pairing,
        chi2=float(np.sum(after.residual.values**2)),
        residuals=len(after.residual.values),
        history=tuple(rms for _, rms in problem.history),
        stopped=stopped,
    )


def covariance(jacobian: FloatArray) -> FloatArray:
    """(J^T J)^-1 with columns scaled to one first; directions the data do not see are left at zero."""
    norms = np.linalg.norm(jacobian, axis=0)
    scale = 1.0 / np.where(norms > 0.0, norms, 1.0)
    columns = jacobian * scale
    return np.asarray(np.linalg.pinv(columns.T @ columns, hermitian=True) * np.outer(scale, scale))


def solve(problem: Problem, lower: FloatArray, upper: FloatArray, max_iterations: int) -> tuple[FloatArray, str]:
    """Run least_squares on the rows that pair at the start; again from its end where more rows pair there.

    Variables are scaled to one standard deviation of the data alone, so that its step tolerance means the same
    for a modulus of 1e11 and a harmonic of 1e-3. A step that loses a row, or leads to no possible structure, is
    refused as if it had made everything worse, and the trust region shrinks; rows that begin to pair on the way wait
    for the next round.
    """
    x, message = np.clip(problem.start, lower, upper), ""
    for _ in range(4):
        problem.forget()
        rows = problem.rows = paired_rows(problem.state(x).pairing)
        refused = np.full(len(problem.fun(x)), 1e3 * float(np.abs(problem.fun(x)).max() + 1.0))
        norms = np.linalg.norm(problem.jac(x), axis=0)
        unit = 2.0 ** -np.round(np.log2(np.where(norms > 0.0, norms, 1.0)))  # powers of two: x/unit loses no bit

        def fun(y: FloatArray, rows: Rows, refused: FloatArray, unit: FloatArray) -> FloatArray:
            try:
                values = problem.fun(unit * y)
            except ValueError:  # no such structure: springs turned negative, say
                return refused
            return values if keeps(problem.state(unit * y).pairing, rows) else refused

        def jac(y: FloatArray, rows: Rows, refused: FloatArray, unit: FloatArray) -> FloatArray:
            return problem.jac(unit * y) * unit

        found = least_squares(
            fun,
            x / unit,
            jac=jac,
            bounds=(lower / unit, upper / unit),
            max_nfev=max_iterations,
            ftol=1e-6,
            xtol=1e-8,
            gtol=1e-10,
            args=(rows, refused, unit),
        )
        x, message = unit * found.x, str(found.message)
        if sum(map(len, paired_rows(problem.state(x).pairing))) <= sum(map(len, rows)):
            break
    return x, message
