"""Levenberg and Marquardt's method within bounds.

    min over d of |r + J d|^2 + mu |D d|^2,   lower <= x + d <= upper

D are the largest column norms of J so far (Moré, LNM 630, 1978, 105), mu follows the gain, what a step brought over
what it predicted (Nielsen, IMM-REP-1999-05, Technical University of Denmark). The step is the exact solution of the
bounded linear problem, so that a bound is met in one step. A point that cannot be evaluated is a step without gain. It
ends where the best step promises nothing more: no evaluation is spent on seeing that nothing changes.
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import lsq_linear

from casingfem.io.arrays import FloatArray

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
    """The minimum of |fun(x)|^2 within bounds, and why it stopped there.

    Parameters
    ----------
    fun
        Residuals; a ValueError where there are none.
    jac
        Their derivatives, asked for only where a step was taken.
    x, lower, upper
        Where to begin, and the bounds, (parameters,).
    max_evaluations
        Of `fun`, that of the start not counted.
    damping
        mu to begin with.
    enough
        A sum of squares that is small enough: the descent ends there.

    >>> bowl = np.diag([1.0, 10.0])
    >>> x, _ = levenberg_marquardt(lambda x: bowl @ (x - 3.0), lambda x: bowl, np.zeros(2), np.zeros(2),
    ...                            np.array([2.0, 5.0]), 20)
    >>> x.round(6).tolist()
    [2.0, 3.0]
    """
    r, J = fun(x), jac(x)
    scale = np.linalg.norm(J, axis=0)
    growth = 2.0
    for _ in range(max_evaluations):
        squares = float(r @ r)
        if squares < enough:
            return x, f"converged: chi^2 is below {enough:g}"
        scale = np.maximum(scale, np.linalg.norm(J, axis=0))
        unit = np.where(scale > 0.0, scale, 1.0)
        step = bounded_step(r, J / unit, damping, (lower - x) * unit, (upper - x) * unit) / unit
        predicted = squares - float(np.sum((r + J @ step) ** 2))
        if predicted <= PREDICTED_DECREASE * squares + FLOOR:
            return x, "converged: no step promises to lower chi^2"
        trial = np.clip(x + step, lower, upper)
        try:
            new = fun(trial)
            gain = (squares - float(new @ new)) / predicted
        except ValueError:  # a lost mode; or no such structure: springs turned negative, say
            gain = -1.0
        if gain > LEAST:
            x, r, J = trial, new, jac(trial)
            damping, growth = damping * max(0.03, 1.0 - (2.0 * gain - 1.0) ** 3), 2.0
        elif np.all(np.abs(step) <= SMALL * (upper - lower)):
            return x, "stuck: steps too small to matter do not lower chi^2"
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
