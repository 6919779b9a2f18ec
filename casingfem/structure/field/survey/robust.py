"""Outliers and repeats of a survey: weights that set stray points aside, and the scatter of points measured twice."""

from __future__ import annotations

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.field.survey.points import SurveyPoints

HUBER = 0.05  # in standard deviations: so small that Huber's loss is all but |r|, which a third of outliers cannot move
BISQUARE = 4.685  # in standard deviations: 95 % efficient on Gaussian noise
NORMAL = 1.4826  # standard deviation over median absolute deviation, Gaussian
EXACT = 1e-12  # relative: residuals below this are round-off
HUBER_STEPS, MOST_STEPS = 30, 90


def least_squares(design: FloatArray, values: FloatArray, weights: FloatArray | None = None) -> FloatArray:
    """Coefficients (unknowns,) of the weighted fit of values (points,) by the columns of a design (points, unknowns).

    By the normal matrix, whose condition a survey's fit is checked for, and one step of refinement: for a scan of many
    points a tenth of the time of orthogonal factors.
    """
    root = np.ones(len(values)) if weights is None else np.sqrt(weights)
    scaled = design if weights is None else design * root[:, None]
    try:
        factor = cho_factor(scaled.T @ scaled)
    except LinAlgError:  # weights may leave too few points
        return np.asarray(np.linalg.lstsq(scaled, root * values, rcond=None)[0])
    x = cho_solve(factor, scaled.T @ (root * values))
    return np.asarray(x + cho_solve(factor, scaled.T @ (root * (values - design @ x))))


def robust_weights(design: FloatArray, values: FloatArray) -> FloatArray:
    """Weights (points,) by iterated least squares: Huber's first, then Tukey's bisquare, which may reach 0.

    Scale: 1.4826 med |r|, raised by sqrt(points/(points - unknowns)) for what the fit itself takes out. Huber's problem
    is convex and brings the start near, whatever the plain fit was; the bisquare then forgets points beyond 4.685
    scales altogether (P. Huber, Robust Statistics, 1981; A. Beaton & J. Tukey, Technometrics 16, 1974, 147).

    Parameters
    ----------
    design, values
        Columns (points, unknowns) of the fit, and what they fit (points,).
    """
    points, unknowns = design.shape
    weights = np.ones(points)
    lost = np.sqrt(points / max(points - unknowns, 1))
    for step in range(MOST_STEPS):
        residual = np.abs(values - design @ least_squares(design, values, weights))
        u = residual / max(NORMAL * lost * float(np.median(residual)), EXACT)
        soft = np.minimum(1.0, HUBER / np.maximum(u, HUBER))
        new = soft if step < HUBER_STEPS else np.maximum(1.0 - (u / BISQUARE) ** 2, 0.0) ** 2
        moved, weights = float(np.abs(new - weights).max()), new
        if step > HUBER_STEPS and moved < 1e-6:
            break
    return weights


def pure_error(points: SurveyPoints) -> tuple[float | None, int]:
    """Standard deviation [m] of points measured more than once at one place, and how many repeats there are.

    s^2 = sum (r - mean of its place)^2 / (points - places): noise of the measurement, whatever the fit. None without
    repeats. Points within .001 deg and .01 mm share a place.
    """
    turn = np.round(np.mod(points.theta, 2.0 * np.pi) / np.radians(1e-3)).astype(np.int64) % 360_000
    place = np.stack([turn, np.round(points.z / 1e-5).astype(np.int64)])
    _, at, counts = np.unique(place, axis=1, return_inverse=True, return_counts=True)
    where: IntArray = at.ravel()
    repeats = int(np.sum(counts - 1))
    if repeats == 0:
        return None, 0
    mean = np.bincount(where, points.value) / counts
    return float(np.sqrt(np.sum((points.value - mean[where]) ** 2) / repeats)), repeats
