"""Least-squares updating of a shell against a frequency table.

    min over x of |r(x)|^2 + |(x - x0)/sigma_prior|^2,  lower <= x <= upper

with r from `targets.py`, exact Jacobians from `sensitivity.py`, and scipy's trust-region reflective solver. The
covariance is (J^T J)^-1 at the solution, J with the prior rows.
"""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares

from casingfem.arrays import FloatArray
from casingfem.experiment.measurement import FrequencyTable
from casingfem.modal.modes import count_below
from casingfem.structure.shell import Shell
from casingfem.updating.following import paired_rows
from casingfem.updating.parameters import Parameter, ParameterError, check_parameters
from casingfem.updating.problem import Problem, Progress, State, UpdateError
from casingfem.updating.result import UpdateResult, weak_priors
from casingfem.updating.targets import allowing

LOOSE = 0.01  # a residual of modes counted from nothing may differ by this many sigma from those followed


def mode_count(table: FrequencyTable, shell: Shell) -> int:
    """Modes to compute so that every row has a candidate: all up to 15 % past the table, and a few more."""
    return max(count_below(shell, 1.15 * float(table.freq_hz.max())), len(table)) + 4


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
    problem = Problem(structure, allowing(table, model_error), vary, count, reach, progress)
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
    after, jacobian = problem.state(x), problem.data_jacobian(x)
    return UpdateResult(
        structure=after.shell,
        parameters=tuple(vary),
        start=tuple(float(p.from_internal(v)) for p, v in zip(vary, problem.start, strict=True)),
        value=tuple(float(p.from_internal(v)) for p, v in zip(vary, x, strict=True)),
        covariance=covariance(problem.jac(x)),
        at_bound=tuple(bool(v) for v in np.minimum(x - lower, upper - x) < 1e-3 * (upper - lower)),
        prior_only=weak_priors(vary, jacobian),
        before=before.modes,
        after=after.modes,
        table=table,
        pairing_before=before.pairing,
        pairing=after.pairing,
        values=after.values,
        jacobian=jacobian,
        history=tuple(problem.history),
        stopped=stopped,
        lost=() if problem.lost is None else problem.lost.rows,
        seconds=dict(problem.seconds),
    )


def covariance(jacobian: FloatArray) -> FloatArray:
    """(J^T J)^-1 with columns scaled to one first; directions the data do not see are left at zero."""
    norms = np.linalg.norm(jacobian, axis=0)
    scale = 1.0 / np.where(norms > 0.0, norms, 1.0)
    columns = jacobian * scale
    return np.asarray(np.linalg.pinv(columns.T @ columns, hermitian=True) * np.outer(scale, scale))


def solve(problem: Problem, lower: FloatArray, upper: FloatArray, max_iterations: int) -> tuple[FloatArray, str]:
    """Run least_squares on the rows that pair at the start; again from its end where they pair better there.

    The end is solved from nothing and counted. Should that change its residuals, a mode was missed on the way, and
    the update is done once more with every point from nothing.
    """
    x, message = np.clip(problem.start, lower, upper), ""
    problem.repaired(x)
    for _ in range(4):
        x, message = descend(problem, x, lower, upper, max_iterations)
        end = problem.state(x)
        if end.solution is not None and not problem.exact:
            near, end = end, problem.counted(x)
            problem.adopt(x, end)
            if np.abs(end.values - near.values).max() > LOOSE:
                problem.exact = True
                problem.repaired(x)
                continue
        if not better(end, problem.repaired(x)):
            problem.adopt(x, end)
            break
    return x, message


def better(old: State, new: State) -> bool:
    """Whether rows paired anew are more, or as many and nearer, than those followed so far."""
    rows = [sum(map(len, paired_rows(state.pairing))) for state in (old, new)]
    return rows[1] > rows[0] or (rows[1] == rows[0] and new.pairing.rms < 0.999 * old.pairing.rms)


def descend(
    problem: Problem, x: FloatArray, lower: FloatArray, upper: FloatArray, max_iterations: int
) -> tuple[FloatArray, str]:
    """One run of least_squares from x.

    Variables are scaled to one standard deviation of the data alone, so that its step tolerance means the same
    for a modulus of 1e11 and a harmonic of 1e-3. A step that loses a mode, or leads to no possible structure, is
    refused as if it had made everything worse, and the trust region shrinks.
    """
    norms = np.linalg.norm(problem.jac(x), axis=0)
    unit = 2.0 ** -np.round(np.log2(np.where(norms > 0.0, norms, 1.0)))  # powers of two: x/unit loses no bit
    here = problem.fun(x)
    refused = np.full(len(here), 1e3 * float(np.abs(here).max() + 1.0))

    def fun(y: FloatArray) -> FloatArray:
        try:
            return problem.fun(unit * y)
        except ValueError:  # a lost mode; or no such structure: springs turned negative, say
            return refused

    found = least_squares(
        fun,
        x / unit,
        jac=lambda y: problem.jac(unit * y) * unit,
        bounds=(lower / unit, upper / unit),
        max_nfev=max_iterations,
        ftol=1e-6,
        xtol=1e-8,
        gtol=1e-10,
    )
    return unit * found.x, str(found.message)
