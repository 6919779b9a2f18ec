"""Nonlinear least squares within bounds: the steps of an update.

Each step minimises a quadratic model of the sum of squares,

    min over d of |r + J d|^2 + d^T S d + mu |D d|^2,   lower <= x + d <= upper

D are the largest column norms of J so far (Moré, LNM 630, 1978, 105). The damping mu follows the gain, the ratio of the
actual to the predicted decrease (Nielsen, IMM-REP-1999-05, Technical University of Denmark). S approximates the sum of
r_i times the Hessian of r_i, which matters where residuals stay large: without it the last steps overshoot. Each step
updates it by the structured secant of Dennis, Gay & Welsch (ACM Trans. Math. Softw. 7, 1981, 348),

    S+ d = y,   y = (J+ - J)^T r+,

with their sizing. The next step uses S near a minimum, where the last step lowered the sum of squares little, and if
the model with S predicted this decrease better than the model without. Far from a minimum the residuals are large
because they are still to fall, and S would lead to other valleys.

The step is the exact solution of the bounded problem, so that a bound is reached in one step. A point that cannot be
evaluated counts as a step without gain. The iteration ends when the best step predicts no further decrease, without
another evaluation.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear

from casingfem.io.arrays import FloatArray
from contact.io.progress import tell

DAMPING = 0.1
PREDICTED_DECREASE = 1e-7  # of the sum of squares: less is the modes' own round-off
FLOOR = 1e-10  # of one squared standard deviation
LEAST = 1e-3  # gain from which a step is taken
SMALL = 1e-12  # of the bounds' distance: a step that moves nothing
NEAR = 0.1  # part of the sum of squares; a step that lowers it by less is one near a minimum
CONVEX = 1e-8  # least over largest curvature of a model with S that is used

Residuals = Callable[[FloatArray], FloatArray]


class End(NamedTuple):
    """Where an iteration ended: the point, the reason for stopping, and S there."""

    x: FloatArray
    stopped: str
    S: FloatArray


def levenberg_marquardt(
    fun: Residuals,
    jac: Residuals,
    x: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
    max_evaluations: int,
    damping: float = DAMPING,
    enough: float = 0.0,
    decrease: float = PREDICTED_DECREASE,
    S: FloatArray | None = None,
) -> End:
    """Minimise |fun(x)|^2 within bounds.

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
        The iteration ends below this sum of squares; it then does without S, which only the last steps need.
    decrease
        It ends if the next step is predicted to lower the sum of squares by less than this part.
    S
        Second-order terms at the start, if they are known from a similar problem.

    >>> bowl = np.diag([1.0, 10.0])
    >>> end = levenberg_marquardt(lambda x: bowl @ (x - 3.0), lambda x: bowl, np.zeros(2), np.zeros(2),
    ...                           np.array([2.0, 5.0]), 20)
    >>> end.x.round(6).tolist()
    [2.0, 3.0]
    """
    r, J = fun(x), jac(x)
    scale = np.linalg.norm(J, axis=0)
    S = used = np.zeros((len(x), len(x))) if S is None else S
    growth = 2.0
    for k in range(max_evaluations):
        squares = float(r @ r)
        rms = math.sqrt(squares / len(r))
        tell(f"step {k + 1} of at most {max_evaluations}, rms {rms:.3g} sigma", k / max_evaluations, most=True)
        if squares < enough:
            return End(x, f"converged: chi^2 is below {enough:g}, which round-off explains", S)
        scale = np.maximum(scale, np.linalg.norm(J, axis=0))
        unit = np.where(scale > 0.0, scale, 1.0)
        if not convex(J / unit, used / np.outer(unit, unit), damping):
            used = np.zeros_like(S)
        rows = damped_model(r, J / unit, used / np.outer(unit, unit), damping)
        step = bounded_step(*rows, (lower - x) * unit, (upper - x) * unit) / unit
        straight = squares - float(np.sum((r + J @ step) ** 2))
        predicted = straight - float(step @ used @ step)
        if predicted <= decrease * squares + FLOOR:
            return End(x, "converged: no step is predicted to lower chi^2", S)
        trial = np.clip(x + step, lower, upper)
        try:
            new = fun(trial)
            actual = squares - float(new @ new)
            gain = actual / predicted
        except ValueError:  # a lost mode; or no such structure: springs turned negative, for example
            gain = -1.0
        if gain > LEAST:
            there = jac(trial)
            bent = straight - float(step @ S @ step)
            near = not enough and actual < NEAR * squares and abs(actual - bent) <= abs(actual - straight)
            S = secant(S, step, there.T @ new - J.T @ r, (there - J).T @ new)
            used = S if near else np.zeros_like(S)
            x, r, J = trial, new, there
            damping, growth = damping * max(0.03, 1.0 - (2.0 * gain - 1.0) ** 3), 2.0
        elif np.all(np.abs(step) <= SMALL * (upper - lower)):
            return End(x, "not converged: even steps far below the range of the parameters do not lower chi^2", S)
        else:
            damping, growth = damping * growth, 2.0 * growth
    return End(x, f"not converged after {max_evaluations} evaluations", S)


def secant(S: FloatArray, step: FloatArray, slope: FloatArray, change: FloatArray) -> FloatArray:
    """S after a step; `slope` is the change of the gradient J^T r, `change` the part of it due to the change of J.

    S is first scaled down to the curvature found along the step. Without positive curvature there it stays as it is.
    """
    along, size = float(step @ slope), abs(float(step @ S @ step))
    if along <= 0.0:
        return S
    sized = S * min(1.0, abs(float(step @ change)) / size) if size > 0.0 else S
    miss = change - sized @ step
    both = np.outer(miss, slope) / along
    return np.asarray(sized + both + both.T - float(step @ miss) * np.outer(slope, slope) / along**2)


def convex(J: FloatArray, S: FloatArray, damping: float) -> bool:
    """Whether the model of unit-scaled variables has a minimum that round-off does not hide; S may be zero."""
    curvature = np.linalg.eigvalsh(J.T @ J + S) + damping
    return bool(curvature[0] > CONVEX * curvature[-1])


def damped_model(r: FloatArray, J: FloatArray, S: FloatArray, damping: float) -> tuple[FloatArray, FloatArray]:
    """A and b with |A d - b|^2 equal to the model of unit-scaled variables but for a constant."""
    A, b = np.vstack([J, np.sqrt(damping) * np.eye(len(S))]), np.append(-r, np.zeros(len(S)))
    if not S.any():
        return A, b
    L = np.linalg.cholesky(A.T @ A + S)
    return L.T, np.asarray(solve_triangular(L, -(J.T @ r), lower=True))


def bounded_step(A: FloatArray, b: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """The step d of least |A d - b|^2 within its bounds."""
    free = np.linalg.lstsq(A, b, rcond=None)[0]
    if np.all((free >= lower) & (free <= upper)):
        return np.asarray(free)
    room = np.maximum(upper, np.nextafter(lower, np.inf))  # a parameter may sit on a bound, but needs some room
    return np.asarray(np.clip(lsq_linear(A, b, bounds=(lower, room), method="bvls").x, lower, upper))
