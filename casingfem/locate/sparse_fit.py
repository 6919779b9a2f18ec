"""Bounded Gauss-Newton over some of many changes, and what each further one promises."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear

from casingfem.io.arrays import FloatArray
from casingfem.locate.misfit import Point

ROUNDS = 8  # Gauss-Newton steps of a fit
SETTLED = 2e-3  # of the range of a change: a smaller step ends a fit
HALVINGS = 4

Evaluate = Callable[[FloatArray], Point]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Bounds:
    """Least and largest value of every change, (changes,) each."""

    lower: FloatArray
    upper: FloatArray

    @property
    def span(self) -> FloatArray:
        """How far a change can go."""
        return self.upper - self.lower


def fitted(evaluate: Evaluate, start: Point, active: Sequence[int], bounds: Bounds) -> Point:
    """Bounded Gauss-Newton over the active changes, all others at zero; each step is halved until it gains."""
    on = list(active)
    x = np.zeros(len(start.x))
    x[on] = start.x[on]
    best = start if np.array_equal(x, start.x) else evaluate(x)
    for _ in range(ROUNDS if on else 0):
        low, high = bounds.lower[on] - best.x[on], bounds.upper[on] - best.x[on]
        step = bounded_step(best, on, low, high)
        if step is None:
            break
        for half in range(HALVINGS):
            x = best.x.copy()
            x[on] += 0.5**half * step
            there = evaluate(x)
            if there.chi2 < best.chi2:
                break
        else:
            break
        moved = np.abs(there.x[on] - best.x[on]) / bounds.span[on]
        best = there
        if moved.max() < SETTLED:
            break
    return best


def bounded_step(at: Point, on: list[int], low: FloatArray, high: FloatArray) -> FloatArray | None:
    """The least-squares step of some changes within their bounds; None where the data do not see them."""
    A = at.jacobian[:, on]
    norms = np.linalg.norm(A, axis=0)
    if not len(at.values) or not np.any(norms):
        return None
    unit = np.where(norms > 0.0, norms, 1.0)
    width = np.maximum(high - low, 1e-300)
    found = lsq_linear(A / unit, -at.values, (unit * low - 1e-12 * unit * width, unit * high + 1e-12 * unit * width))
    return np.asarray(np.clip(found.x / unit, low, high))


def gains(at: Point, active: Sequence[int], bounds: Bounds) -> FloatArray:
    """What each change promises, (changes,): the linear fall of chi^2 by it, those active left free."""
    on = list(active)
    J, r = at.jacobian, at.values
    if on and len(r):
        Q, _ = np.linalg.qr(J[:, on])
        J, r = J - Q @ (Q.T @ J), r - Q @ (Q.T @ r)
    square, slope = np.sum(J**2, axis=0), J.T @ r
    seen = square > 1e-12 * max(float(np.sum(at.jacobian**2, axis=0).max(initial=0.0)), 1e-300)
    step = np.where(seen, -slope / np.where(seen, square, 1.0), 0.0)
    step = np.clip(step, bounds.lower - at.x, bounds.upper - at.x)
    promised = -(2.0 * step * slope + step**2 * square)
    promised[on] = -np.inf
    return np.where(seen, promised, -np.inf)
