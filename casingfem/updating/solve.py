"""The ways down to the least squares of an update: rows paired anew, modes counted, the weight of a regularisation."""

from collections.abc import Sequence

import numpy as np

from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray
from casingfem.updating.following import paired_rows
from casingfem.updating.levenberg import levenberg_marquardt
from casingfem.updating.problem import Problem, State
from casingfem.updating.regularisation import Regularisation, Regularised, chosen_weight, trade_off
from casingfem.updating.result import POOR

WAYS = (0.1, 1.0, 0.01)  # dampings to begin with: long first steps and short ones end in different valleys
SHORTER = (1.0, 0.5, 0.25, 0.125)  # of a step whose end cannot be evaluated
ROUNDS = 8  # solutions until a weight must have settled
SETTLED = 0.06  # two of the weights tried, which stand .058 apart in logarithm


def require_enough(residuals: int, parameters: int, without: str = "") -> None:
    """Refuse to fit more parameters than there are residuals, priors among them; `without` names what is left out."""
    if residuals < parameters:
        raise InputError(
            f"{without}{residuals} residuals cannot determine {parameters} parameters: "
            "measure more modes, vary less, or give priors"
        )


def covariance(jacobian: FloatArray) -> FloatArray:
    """(J^T J)^-1 with columns scaled to one first; directions the data do not see are left at zero."""
    norms = np.linalg.norm(jacobian, axis=0)
    scale = 1.0 / np.where(norms > 0.0, norms, 1.0)
    columns = jacobian * scale
    return np.asarray(np.linalg.pinv(columns.T @ columns, hermitian=True) * np.outer(scale, scale))


def solve_regularised(
    problem: Problem, by: Regularisation, lower: FloatArray, upper: FloatArray, max_iterations: int
) -> tuple[FloatArray, str, Regularised]:
    """Solve, choose the weight at the solution, and solve again from there until the weight stands still."""
    inverse = by.among(problem.vary)
    held = np.where(inverse > 0.0, 0.0, problem.prior)
    weight, x = 1.0, problem.start
    for _ in range(ROUNDS):
        problem.prior = held + weight * inverse
        x, message = solve(problem, lower, upper, max_iterations, begin=x)
        state, away = problem.state(x), x - problem.start
        curve = trade_off(problem.data_jacobian(x), state.values, away, held, inverse)
        before = weight
        weight, rule, note = chosen_weight(by.rule, curve, len(state.values))
        if abs(np.log(weight / before)) < SETTLED:
            break
    names = tuple(p.name for p, w in zip(problem.vary, inverse, strict=True) if w > 0.0)
    return x, message, Regularised(rule=rule, weight=before, names=names, curve=curve, note=note)


def solve(
    problem: Problem,
    lower: FloatArray,
    upper: FloatArray,
    max_iterations: int,
    begin: FloatArray | None = None,
    ways: Sequence[float] = WAYS,
) -> tuple[FloatArray, str]:
    """The best of the ways down, one if it arrives: modes that mix make a landscape of several valleys."""
    ends: list[tuple[float, FloatArray, str, State]] = []
    for damping in ways:
        x, message = descend(problem, lower, upper, max_iterations, damping, begin)
        r = problem.fun(x)
        ends.append((float(np.sqrt(np.mean(r**2))), x, message, problem.state(x)))
        if ends[-1][0] <= POOR and message.startswith("converged"):
            break
    _, x, message, state = min(ends, key=lambda end: end[0])
    problem.adopt(x, state)
    return x, message


def stepped(problem: Problem, x: FloatArray, step: FloatArray) -> FloatArray:
    """Where a step ends, halved until there is a structure that can be solved: not all within the bounds is one.

    Where even its eighth is too long, x itself.
    """
    for share in SHORTER:
        try:
            problem.state(x + share * step)
        except ValueError:  # a lost mode, rows that pair with nothing, springs turned negative
            continue
        return np.asarray(x + share * step)
    return x


def descend(
    problem: Problem,
    lower: FloatArray,
    upper: FloatArray,
    max_iterations: int,
    damping: float,
    begin: FloatArray | None = None,
) -> tuple[FloatArray, str]:
    """Descend with the rows that pair at the start; again from the end where they pair better there.

    With shapes the frequencies go first, if there are enough, until they agree to their noise: shapes that mix on the
    way are a maze from far away, frequencies within their noise are one where shapes know more.

    The modes at the end are counted. Should one have been missed on the way, the update is done once more with every
    point from nothing.
    """
    x, message = np.clip(problem.start if begin is None else begin, lower, upper), ""
    problem.paired_anew(x)
    if problem.shapes is not None and begin is None:
        problem.shapes_wait = True
        rows = len(problem.paired_anew(x).values)
        if rows >= len(x):
            x, _ = levenberg_marquardt(
                problem.fun, problem.jac, x, lower, upper, max_iterations, damping, enough=float(rows)
            )
        problem.shapes_wait = False
        problem.paired_anew(x)
    for _ in range(4):
        x, message = levenberg_marquardt(problem.fun, problem.jac, x, lower, upper, max_iterations, damping)
        end = problem.counted(x)
        if end is None:
            problem.solve_afresh()
            problem.paired_anew(x)
            continue
        if not lower_misfit(end, problem.paired_anew(x)):
            problem.adopt(x, end)
            break
    return x, message


def lower_misfit(old: State, new: State) -> bool:
    """Whether rows paired anew are more, or as many and nearer, than those followed so far."""
    rows = [sum(map(len, paired_rows(state.pairing))) for state in (old, new)]
    return rows[1] > rows[0] or (rows[1] == rows[0] and new.pairing.rms < 0.999 * old.pairing.rms)
