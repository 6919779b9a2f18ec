"""Solve the least-squares problem of an update: new pairing, counted modes, regularisation.

The steps are those of `least_squares`.
"""

import time
import warnings
from collections.abc import Sequence

import numpy as np

from casingfem.errors import InputError, ModelWarning, NumericsError
from casingfem.io.arrays import FloatArray
from casingfem.updating.coarse import coarse_problem
from casingfem.updating.following import paired_rows
from casingfem.updating.least_squares import PREDICTED_DECREASE, End, levenberg_marquardt
from casingfem.updating.problem import Problem, State
from casingfem.updating.regularisation import Regularisation, Regularised, chosen_weight, trade_off
from casingfem.updating.result import POOR

WAYS = (0.1, 1.0, 0.01)  # dampings to begin with: long first steps and short ones end in different valleys
SHORTER = (1.0, 0.5, 0.25, 0.125)  # of a step whose end cannot be evaluated
ROUNDS = 8  # solutions until a weight must have settled
ROUGH = 1e-3  # predicted decrease of the squares at which a coarse model is near enough to its solution
CLOSE = 1e-4  # damping to begin with at its solution, from where no valley is to be chosen
SETTLED = 0.06  # two of the weights tried, which are .058 apart in logarithm


def require_enough(residuals: int, parameters: int, without: str = "") -> None:
    """Refuse to fit more parameters than residuals, priors included; `without` names the omitted data."""
    if residuals < parameters:
        raise InputError(
            f"{without}found {residuals} residuals for {parameters} parameters, expected at least as many: "
            "measure more modes, vary fewer parameters, or give priors (sigma)"
        )


def covariance(jacobian: FloatArray) -> FloatArray:
    """(J^T J)^-1, with columns scaled to one first; 0 for directions that the data do not determine."""
    norms = np.linalg.norm(jacobian, axis=0)
    scale = 1.0 / np.where(norms > 0.0, norms, 1.0)
    columns = jacobian * scale
    return np.asarray(np.linalg.pinv(columns.T @ columns, hermitian=True) * np.outer(scale, scale))


def solve_regularised(
    problem: Problem, by: Regularisation, lower: FloatArray, upper: FloatArray, max_iterations: int
) -> tuple[FloatArray, str, Regularised]:
    """Solve, choose the weight at the solution, and solve again from there until the weight is constant."""
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
    """Solve from several initial dampings unless the first solution is good, and return the best.

    Mixed modes cause local minima.
    """
    ends: list[tuple[float, FloatArray, str, State]] = []
    for damping in ways:
        x, message, _ = descend(problem, lower, upper, max_iterations, damping, begin)
        r = problem.fun(x)
        ends.append((float(np.sqrt(np.mean(r**2))), x, message, problem.state(x)))
        if ends[-1][0] <= POOR and message.startswith("converged"):
            break
    _, x, message, state = min(ends, key=lambda end: end[0])
    problem.adopt(x, state)
    return x, message


def stepped(problem: Problem, x: FloatArray, step: FloatArray) -> FloatArray:
    """End of a step, halved until the structure there can be solved: some points within the bounds have no solution.

    If an eighth of the step is still too long, x itself is returned.
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
    decrease: float = PREDICTED_DECREASE,
) -> End:
    """Minimise with the rows that pair at the start; repeat from the end if the rows pair better there.

    With shapes the frequencies are fitted first, if there are enough, until they agree within their noise. Far from the
    solution shapes of modes that mix cause many local minima. Frequencies below their noise add such minima where
    shapes determine more. Without shapes a coarse model of a large one is fitted first.

    The modes at the end are counted. If one was missed, the update is repeated and every point is solved without a
    restart.
    """
    at, S = np.clip(problem.start if begin is None else begin, lower, upper), None
    problem.paired_anew(at)
    if problem.shapes is not None and begin is None:
        problem.shapes_wait = True
        rows = float(len(problem.paired_anew(at).values))
        if rows >= len(at):
            fun, jac = problem.fun, problem.jac
            at, *_ = levenberg_marquardt(fun, jac, at, lower, upper, max_iterations, damping, enough=rows)
        problem.shapes_wait = False
        problem.paired_anew(at)
    if begin is None and (near := from_coarse(problem, lower, upper, max_iterations, damping)) is not None:
        at, S, damping = near.x, near.S, CLOSE
        problem.paired_anew(at)
    for _ in range(4):
        fun, jac = problem.fun, problem.jac
        end = levenberg_marquardt(fun, jac, at, lower, upper, max_iterations, damping, decrease=decrease, S=S)
        at, S = end.x, None
        counted = problem.counted(at)
        if counted is None:
            problem.solve_afresh()
            problem.paired_anew(at)
            continue
        if not lower_misfit(counted, problem.paired_anew(at)):
            problem.adopt(at, counted)
            break
    return end


def from_coarse(
    problem: Problem, lower: FloatArray, upper: FloatArray, max_iterations: int, damping: float
) -> End | None:
    """Solve the coarse problem; end there, or on the part of the way that the given mesh can solve.

    None without a coarse problem, and if the residuals of the given mesh do not fall.
    """
    started = time.perf_counter()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ModelWarning)  # of the coarse mesh, which no result is of
            small = coarse_problem(problem)
            if small is None:
                return None
            end = descend(small, lower, upper, max_iterations, damping, decrease=ROUGH)
    except (ValueError, NumericsError):  # rows that pair with nothing there, a lost mode, springs turned negative
        return None
    problem.seconds["coarse"] += time.perf_counter() - started
    before, most = problem.state(problem.start), mean_square(problem, problem.start)
    near = stepped(problem, problem.start, end.x - problem.start)
    if mean_square(problem, near) < most:
        return end._replace(x=near)
    problem.adopt(problem.start, before)
    return None


def mean_square(problem: Problem, x: FloatArray) -> float:
    """Mean of the squared residuals, priors included."""
    return float(np.mean(problem.fun(x) ** 2))


def lower_misfit(old: State, new: State) -> bool:
    """Whether a new pairing has more rows, or as many with smaller residuals, than the rows tracked so far."""
    rows = [sum(map(len, paired_rows(state.pairing))) for state in (old, new)]
    return rows[1] > rows[0] or (rows[1] == rows[0] and new.pairing.rms < 0.999 * old.pairing.rms)
