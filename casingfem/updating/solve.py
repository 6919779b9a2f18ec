"""Solve the least-squares problem of an update: steps within bounds, new pairing, counted modes, regularisation.

Each step is one of Levenberg and Marquardt's method within bounds,

    min over d of |r + J d|^2 + mu |D d|^2,   lower <= x + d <= upper

D are the largest column norms of J so far (Moré, LNM 630, 1978, 105). The damping mu follows the gain, the ratio of the
actual to the predicted decrease (Nielsen, IMM-REP-1999-05, Technical University of Denmark). The step is the exact
solution of the bounded linear problem, so that a bound is reached in one step. A point that cannot be evaluated counts
as a step without gain. The iteration ends when the best step predicts no further decrease, without another evaluation.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import lsq_linear

from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray
from casingfem.updating.following import paired_rows
from casingfem.updating.problem import Problem, State
from casingfem.updating.regularisation import Regularisation, Regularised, chosen_weight, trade_off
from casingfem.updating.result import POOR
from contact.io.progress import tell

WAYS = (0.1, 1.0, 0.01)  # dampings to begin with: long first steps and short ones end in different valleys
SHORTER = (1.0, 0.5, 0.25, 0.125)  # of a step whose end cannot be evaluated
ROUNDS = 8  # solutions until a weight must have settled
SETTLED = 0.06  # two of the weights tried, which are .058 apart in logarithm
DAMPING = 0.1
PREDICTED_DECREASE = 1e-7  # of the sum of squares: less is the modes' own round-off
FLOOR = 1e-10  # of one squared standard deviation
LEAST = 1e-3  # gain from which a step is taken
SMALL = 1e-12  # of the bounds' distance: a step that moves nothing

Residuals = Callable[[FloatArray], FloatArray]


def levenberg_marquardt(
    fun: Residuals,
    jac: Residuals,
    x: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
    max_evaluations: int,
    damping: float = DAMPING,
    enough: float = 0.0,
) -> tuple[FloatArray, str]:
    """Minimise |fun(x)|^2 within bounds; return the minimum and the reason for stopping.

    Parameters
    ----------
    fun
        Residuals; raises ValueError at a point that cannot be evaluated.
    jac
        Derivatives of the residuals; evaluated only after an accepted step.
    x, lower, upper
        Start and bounds, (parameters,).
    max_evaluations
        Largest number of evaluations of `fun` after the start.
    damping
        Initial value of mu.
    enough
        The iteration ends below this sum of squares.

    >>> bowl = np.diag([1.0, 10.0])
    >>> x, _ = levenberg_marquardt(lambda x: bowl @ (x - 3.0), lambda x: bowl, np.zeros(2), np.zeros(2),
    ...                            np.array([2.0, 5.0]), 20)
    >>> x.round(6).tolist()
    [2.0, 3.0]
    """
    r, J = fun(x), jac(x)
    scale = np.linalg.norm(J, axis=0)
    growth = 2.0
    for k in range(max_evaluations):
        squares = float(r @ r)
        rms = math.sqrt(squares / len(r))
        tell(f"step {k + 1} of at most {max_evaluations}, rms {rms:.3g} sigma", k / max_evaluations, most=True)
        if squares < enough:
            return x, f"converged: chi^2 is below {enough:g}, which round-off explains"
        scale = np.maximum(scale, np.linalg.norm(J, axis=0))
        unit = np.where(scale > 0.0, scale, 1.0)
        step = bounded_step(r, J / unit, damping, (lower - x) * unit, (upper - x) * unit) / unit
        predicted = squares - float(np.sum((r + J @ step) ** 2))
        if predicted <= PREDICTED_DECREASE * squares + FLOOR:
            return x, "converged: no step is predicted to lower chi^2"
        trial = np.clip(x + step, lower, upper)
        try:
            new = fun(trial)
            gain = (squares - float(new @ new)) / predicted
        except ValueError:  # a lost mode; or no such structure: springs turned negative, for example
            gain = -1.0
        if gain > LEAST:
            x, r, J = trial, new, jac(trial)
            damping, growth = damping * max(0.03, 1.0 - (2.0 * gain - 1.0) ** 3), 2.0
        elif np.all(np.abs(step) <= SMALL * (upper - lower)):
            return x, "not converged: even steps far below the range of the parameters do not lower chi^2"
        else:
            damping, growth = damping * growth, 2.0 * growth
    return x, f"not converged after {max_evaluations} evaluations"


def bounded_step(r: FloatArray, J: FloatArray, damping: float, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """The damped step of unit-scaled variables within its bounds."""
    count = J.shape[1]
    A, b = np.vstack([J, np.sqrt(damping) * np.eye(count)]), np.append(-r, np.zeros(count))
    free = np.linalg.lstsq(A, b, rcond=None)[0]
    if np.all((free >= lower) & (free <= upper)):
        return np.asarray(free)
    room = np.maximum(upper, np.nextafter(lower, np.inf))  # a parameter may sit on a bound, but needs some room
    return np.asarray(np.clip(lsq_linear(A, b, bounds=(lower, room), method="bvls").x, lower, upper))


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
        x, message = descend(problem, lower, upper, max_iterations, damping, begin)
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
) -> tuple[FloatArray, str]:
    """Minimise with the rows that pair at the start; repeat from the end if the rows pair better there.

    With shapes the frequencies are fitted first, if there are enough, until they agree within their noise. Far from the
    solution shapes of modes that mix cause many local minima. Frequencies below their noise add such minima where
    shapes determine more.

    The modes at the end are counted. If one was missed, the update is repeated and every point is solved without a
    restart.
    """
    x, message = np.clip(problem.start if begin is None else begin, lower, upper), ""
    problem.paired_anew(x)
    if problem.shapes is not None and begin is None:
        problem.shapes_wait = True
        rows = float(len(problem.paired_anew(x).values))
        if rows >= len(x):
            x, _ = levenberg_marquardt(problem.fun, problem.jac, x, lower, upper, max_iterations, damping, enough=rows)
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
    """Whether a new pairing has more rows, or as many with smaller residuals, than the rows tracked so far."""
    rows = [sum(map(len, paired_rows(state.pairing))) for state in (old, new)]
    return rows[1] > rows[0] or (rows[1] == rows[0] and new.pairing.rms < 0.999 * old.pairing.rms)
