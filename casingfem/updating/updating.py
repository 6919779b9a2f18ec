"""Least-squares updating of a shell against a frequency table.

    min over x of |r(x)|^2 + |(x - x0)/sigma_prior|^2,  lower <= x <= upper

with r from `targets.py`, exact Jacobians from `sensitivity.py`, and steps by `solve.py`. The covariance is
(J^T J)^-1 at the solution, J with the prior rows.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from casingfem.errors import InputError, ModelError, warn
from casingfem.experiment.correlation.frequency_unit import require_hz, require_scale
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import count_below, modes
from casingfem.structure.imported.assembly import MeshStructure, require_structure
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System
from casingfem.updating.outliers import Outlier, Shift, named, outlying, shifts_of, step_without
from casingfem.updating.parameters import Parameter, check_parameters
from casingfem.updating.problem import Problem, Progress
from casingfem.updating.regularisation import Regularisation
from casingfem.updating.result import UpdateResult, weak_priors
from casingfem.updating.shapes import SensorShapes
from casingfem.updating.solve import WAYS, covariance, require_enough, solve, solve_regularised, stepped
from casingfem.updating.targets import with_model_error
from contact.io.notebook import notebook_progress
from contact.io.threads import with_one_thread

FAR = 6  # modes below the highest row for each row: from this ratio on, the table's unit may be wrong
MOST_MODES = 500  # more modes are computed only on request: each fit would take minutes
LOOKS = 5  # rounds in which rows may be set aside or taken back


def mode_count(table: FrequencyTable, shell: Shell | MeshStructure, system: System | None) -> int:
    """Modes to compute so that every row has a candidate: all up to 15 % past the table, and a few more."""
    return max(count_below(shell, 1.15 * float(table.freq_hz.max()), system), len(table)) + 4


def require_few(table: FrequencyTable, count: int) -> None:
    """Refuse a row that needs more than MOST_MODES modes, for example one with an extra digit.

    Raises
    ------
    InputError
        The row, and the row below it.
    """
    if count > MOST_MODES:
        *lower, highest = np.sort(table.freq_hz)
        beside = f", the next row {lower[-1]:.6g} Hz" if lower else ""
        raise InputError(
            table.path, column="freq_hz", where=f"mode {table.mode[table.freq_hz.argmax()]}",
            found=f"{highest:.6g} Hz{beside}; up to it the model has about {count} modes, the table {len(table)} rows",
            expected=f"at most {MOST_MODES} modes; correct the row, or give the number of modes (count) if it is right",
        )  # fmt: skip


def update(
    structure: Shell | MeshStructure,
    table: FrequencyTable,
    vary: Sequence[Parameter],
    *,
    count: int | None = None,
    reach: float = 0.5,
    model_error: float = 0.0,
    shapes: SensorShapes | None = None,
    regularise: Regularisation | None = None,
    max_iterations: int = 30,
    progress: Progress | None = None,
    outliers: Literal["set-aside", "keep"] = "set-aside",
) -> UpdateResult:
    """Fit named numbers of a shell to a frequency table.

    Rows that contradict all others beyond chance are excluded. The result names them and includes the fit with them.

    Parameters
    ----------
    structure
        The model; its present values are the start and the centres of the priors. An imported part is fitted to its
        frequencies, means and splits of pairs; not to shapes nor to the angles of pairs, which need a chart.
    table
        Measured frequencies with their sigma; doublets and orientations are used if given.
    vary
        Parameters that may change, with their bounds.
    count
        Modes computed at each step; by default enough to reach 15 % above the table; more than MOST_MODES are
        refused.
    reach
        Largest relative frequency error at which a row may pair with a mode.
    model_error
        Relative frequency error of the model itself, added to each sigma in squares; 0 for an exact model.
    shapes
        Mode shapes at sensors, a column for each row of the table; they pair rows and are fitted too.
    regularise
        Regularise ill-posed parameters, usually many harmonics, with a weight that the data determine; their priors
        give the relative widths only.
    max_iterations
        Largest number of evaluations of a run; a second run follows if rows pair better after the first.
    progress
        Called after each evaluation with its number and the RMS of the weighted residuals.
    outliers
        "keep" fits all rows, also those that contradict all others.

    Raises
    ------
    InputError
        A parameter that does not exist, is named twice, or starts outside its bounds.
    InputError
        Nothing pairs, fewer residuals than parameters, rigid motions among the modes, shapes of another table; a
        table in another unit, or by another factor beyond the reach of all modes; a row above more than MOST_MODES
        modes where no `count` is given.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=200e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=7, rows=2, around=2))
    >>> measured = cf.FrequencyTable.from_arrays(freq_hz=cf.modes(plate, 3).freq * 1.01, sigma_hz=0.01)
    >>> fit = cf.update(plate, measured, [cf.Parameter(name="material.E", lower=150e9, upper=250e9)])
    >>> round(fit.value[0] / 200e9, 4)  # frequencies are 1 % higher
    1.0201
    """
    if not vary:
        raise InputError("vary: found no parameters, expected at least one")
    if not 0.0 <= model_error < 1.0:
        raise InputError(f"model_error must lie in [0, 1), found {model_error!r}")
    if not isinstance(structure, Shell):
        require_structure(structure, "update")
        table = fitted_to_mesh(table, shapes)
    check_parameters(structure, vary)
    system = None
    if count is None:
        system = assemble(structure) if isinstance(structure, Shell) else None
        count = mode_count(table, structure, system)
        if count > FAR * len(table):
            lowest = modes(structure, 2 * len(table))
            many = count > MOST_MODES
            require_hz(table, lowest.freq, getattr(lowest, "nodal_diameters", None), reach, any_factor=many)
            require_few(table, count)
    if shapes is not None and (columns := shapes.shapes.shape[1]) != len(table):
        raise InputError(f"shapes: found {columns} columns, expected {len(table)}, one for each row of the table")
    if outliers not in ("set-aside", "keep"):
        raise InputError(f'outliers: found {outliers!r}, expected "set-aside" or "keep"')
    progress = progress or notebook_progress("update", "{} evaluations, rms {:.3g} sigma".format)
    data = with_model_error(table, model_error)
    problem = Problem(structure, data, vary, count, reach, progress, shapes, system=system)
    if outliers == "keep":
        return fitted(problem, table, regularise, max_iterations)
    first = fitted(problem, table, regularise, max_iterations, ways=WAYS[:1])
    fit = without_outliers(problem, first, regularise, max_iterations)
    if fit.arrived:
        return fit
    again = fitted(problem, table, regularise, max_iterations)
    other = without_outliers(problem, again, regularise, max_iterations)
    return min(fit, other, key=lambda one: one.misfit)


@with_one_thread
def fitted(
    problem: Problem,
    table: FrequencyTable,
    regularise: Regularisation | None,
    max_iterations: int,
    begin: tuple[FloatArray, FloatArray] | None = None,
    ways: Sequence[float] = WAYS,
) -> UpdateResult:
    """Solve a problem; `table` is its table without the model's error, `begin` a solved point and a step from it."""
    vary = problem.vary
    lower = np.array([p.to_internal(p.lower) for p in vary])
    upper = np.array([p.to_internal(p.upper) for p in vary])
    before = problem.state(problem.start)
    if before.modes.rigid:
        found = f"found {before.modes.rigid} rigid-body modes of the structure, expected none"
        raise InputError(f"update: {found}; support it before updating")
    if begin is None:
        require_scale(table, before.modes, before.pairing, problem.reach)
    require_enough(len(problem.fun(problem.start)), len(vary))
    if regularise is None:
        first = None if begin is None else stepped(problem, *begin)
        x, stopped = solve(problem, lower, upper, max_iterations, first, ways)
        regularised = None
    else:
        x, stopped, regularised = solve_regularised(problem, regularise, lower, upper, max_iterations)
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
        regularised=regularised,
        x=x,
        lower=lower,
        upper=upper,
        given=problem.given,
    )


def fitted_to_mesh(table: FrequencyTable, shapes: SensorShapes | None) -> FrequencyTable:
    """Remove the angles of pairs, to which an imported part is not fitted, from the table; refuse shapes.

    If the table has angles, the warning `update-angles` is given.
    """
    if shapes is not None:
        raise ModelError(
            "structure-chart", "update: found shapes to fit to an imported part, expected frequencies alone"
        )
    if np.isfinite(table.angle_deg).any():
        count = int(np.isfinite(table.angle_deg).sum())
        found = f"{table.path}: found {count} angles of pairs, and an imported part"
        warn("update-angles", found)
        table = replace(table, angle_deg=np.full(len(table), np.nan))
    return table


def without_outliers(
    whole: Problem, fit: UpdateResult, regularise: Regularisation | None, max_iterations: int
) -> UpdateResult:
    """Repeat the fit without rows that contradict the others; each round examines all rows from the last fit.

    Rows are paired anew for that. If this finds nothing more, the rows are examined with the pairing of the fit: a
    wrong row may represent another mode nearby, and no other row then contradicts it. The same rows may be excluded
    twice, from two fits, since the first may have ended in another local minimum.
    """
    best = fit

    def settled(modes: tuple[int, ...]) -> bool:
        return modes == modes_of(best.outliers) or seen.count(modes) > 1

    seen: list[tuple[int, ...]] = [(), ()]
    for _ in range(LOOKS):
        state = whole.paired_anew(best.x)
        shifts = shifts_of(state.modes, whole.table, state.pairing.matches)
        aside, near = contradicting(shifts, whole.fun(best.x), whole.jac(best.x), best, whole.table)
        if settled(modes_of(aside)):
            shifts = shifts_of(best.after, best.given.table, best.pairing.matches)
            own = best.given.with_priors(best.x, best.values, best.jacobian)
            more, near = contradicting(shifts, *own, best, best.given.table)
            aside = (*best.outliers, *more)
        modes = modes_of(aside)
        if settled(modes):
            break
        seen.append(modes)
        kept = [row for row, mode in enumerate(whole.table.mode.tolist()) if mode not in modes]
        if len(kept) <= len(whole.vary):
            break
        shapes = None if whole.shapes is None else whole.shapes.only(kept)
        less = Problem(
            whole.shell, whole.table.without(*modes), whole.vary, whole.count, whole.reach, whole.progress, shapes
        )
        step = np.clip(best.x + near, fit.lower, fit.upper) - best.x
        best = fitted(less, fit.table.without(*modes), regularise, max_iterations, begin=(best.x, step))
        best = replace(best, before=fit.before, outliers=aside, plain=fit)
    return best


def contradicting(
    shifts: Sequence[Shift], residual: FloatArray, jacobian: FloatArray, fit: UpdateResult, table: FrequencyTable
) -> tuple[tuple[Outlier, ...], FloatArray]:
    """Find rows that contradict the rest of a table, and the linearised step of the fit without them."""
    free = jacobian * ~np.array(fit.at_bound)  # what is on a bound gives no way
    found = outlying(shifts, residual, free, len(table))
    return named(found, table), step_without(found, shifts, residual, free)


def modes_of(outliers: Sequence[Outlier]) -> tuple[int, ...]:
    """Mode numbers of the excluded rows, each once."""
    return tuple(sorted({mode for outlier in outliers for mode in outlier.modes}))
