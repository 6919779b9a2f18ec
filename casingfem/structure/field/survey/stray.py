"""Outliers and repeats of a survey: robust weights, points that contradict all others, repeated passes.

Points measured twice show the scatter; second measurements may differ significantly from the first.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve
from scipy.special import stdtr, stdtrit

from casingfem.errors import InputError
from casingfem.io.arrays import BoolArray, FloatArray, IntArray
from casingfem.io.together import together
from casingfem.structure.field.survey.points import SurveyPoints

HUBER = 0.05  # in standard deviations: nearly the loss |r|, which a third of outliers cannot shift
BISQUARE = 4.685  # in standard deviations: 95 % efficient on Gaussian noise
NORMAL = 1.4826  # standard deviation over median absolute deviation, Gaussian
EXACT = 1e-12  # relative: residuals below this are round-off
HUBER_STEPS, MOST_STEPS = 30, 90
LARGEST: dict[str, float] = {"radius": 0.1, "thickness": 1.0}
"""Largest relative deviation of an imperfection; a larger one is another design, which belongs in the chart."""


def least_squares(design: FloatArray, values: FloatArray, weights: FloatArray | None = None) -> FloatArray:
    """Coefficients (unknowns,) of the weighted fit of values (points,) by the columns of a design (points, unknowns).

    It uses the normal matrix, whose condition is checked, and one step of refinement: for a scan of many points a tenth
    of the time of orthogonal factors.
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

    Scale: 1.4826 med |r|, multiplied by sqrt(points/(points - unknowns)) for the degrees of freedom of the fit. Huber's
    problem is convex and gives a good start from any plain fit; the bisquare then gives zero weight beyond 4.685 scales
    (P. Huber, Robust Statistics, 1981; A. Beaton & J. Tukey, Technometrics 16, 1974, 147).

    Parameters
    ----------
    design, values
        Columns (points, unknowns) of the fit, and the fitted values (points,).
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
    """Standard deviation [m] of points measured repeatedly at the same place, and the number of repeats.

    s^2 = sum (r - mean of its place)^2 / (points - places): the noise of the measurement, independent of the fit. None
    without repeats. Points within .001 deg and .01 mm share a place.
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


LEVEL = 0.01  # chance of a false alarm in a survey without stray points
SHARE = 0.1  # of the points at most
SEARCHED = 2000  # points: a search one by one among more would take minutes
FREE = 5  # degrees of freedom that must be left
SURE = 5.0  # standard deviations: of what two passes differ by
FEW = 12  # places measured twice, below which nothing is stated


def stray_points(design: FloatArray, residual: FloatArray) -> BoolArray:
    """Outliers (points,), which contradict the others significantly, from the residuals of a plain fit."""
    if len(residual) > SEARCHED:
        return beyond(design, residual, robust_weights(design, residual) > 0.0)
    stray = shifted_points(design, residual)
    if stray.any():  # those beside them may have been taken for them: a robust fit knows the candidates
        candidates = stray | (robust_weights(design, residual) == 0.0)
        if candidates.sum() <= len(residual) - design.shape[1] - FREE:  # of more, none can be judged
            return significant(design, residual, candidates)
    return stray


def refuse_impossible(points: SurveyPoints, relative: FloatArray, stray: BoolArray) -> None:
    """Refuse outliers that no imperfection explains: a mistyped or misplaced number bends the fit of the whole casing.

    `relative` is the deviation of each point from the surface through the points that are not `stray`, (points,).

    Raises
    ------
    InputError
        With the line and place of each such point.
    """
    most = LARGEST[points.quantity]
    wrong = np.flatnonzero(stray & (np.abs(relative) > most)).tolist()
    if not wrong:
        return
    expected = f"at most {100.0 * most:.0f} % of an imperfection: correct the point, or leave it out by robust = true"
    raise together(
        [
            InputError(
                points.path,
                line=None if points.lines is None else int(points.lines[k]),
                where=f"point {k + 1}" if points.lines is None else "",
                found=f"a {points.quantity} of {points.value[k]:.4g} m at theta {np.degrees(points.theta[k]):.4g} deg, "
                f"z {points.z[k]:.4g} m, {100.0 * relative[k]:+.3g} % from the surface through the other points",
                expected=expected,
            )
            for k in wrong
        ]
    )


def beyond(design: FloatArray, residual: FloatArray, kept: BoolArray) -> BoolArray:
    """Points (points,) whose distance from the fit of the kept points is significant for any single point.

    For scans with many points per unknown, where no point influences the fit. Student's t of a point outside the fit is
    t = r/(s sqrt(1 + x^T (X^T X)^-1 x)).
    """
    own, free = design[kept], int(kept.sum()) - design.shape[1]
    left = residual - design @ least_squares(own, residual[kept])
    out = np.flatnonzero(~kept)
    leverage = np.sum(np.linalg.solve(own.T @ own, design[out].T) * design[out].T, axis=0)
    scale = np.sqrt(np.sum(left[kept] ** 2) / free * (1.0 + leverage))
    stray = np.zeros(len(residual), bool)
    far = -float(stdtrit(free, 0.5 * LEVEL / len(residual))) * scale
    stray[out] = np.abs(left[out]) > np.maximum(far, 1e-9)
    return stray


def shifted_points(design: FloatArray, residual: FloatArray) -> BoolArray:
    """Points (points,) with a significant individual shift; the plain fit is not repeated.

    A shift delta of only point i causes the residual P_ii delta there, with P = 1 - Q Q^T of the design, and changes
    all others. The point with the largest (P r)_i^2/P_ii is taken first, then the largest of the remaining residual, up
    to SHARE of the points (mean-shift outliers: Cook & Weisberg, Residuals and Influence in Regression, 1982, 2.2.2).
    The largest set counts whose shifts are all significant by Student's t, at LEVEL over the number of points, against
    the scatter without them.
    """
    points = len(residual)
    span = np.linalg.qr(design)[0]
    left, r = np.maximum(1.0 - np.sum(span**2, axis=1), 0.0), residual - span @ (span.T @ residual)
    free = points - design.shape[1]
    order, gains = list[int](), list[float]()
    for _ in range(min(int(SHARE * points) + 1, free - FREE)):
        gain = np.where(left > 1e-6, r**2 / np.maximum(left, 1e-6), 0.0)
        k = int(gain.argmax())
        if gain[k] == 0.0:  # nothing is left that a shift could explain
            break
        column = -span @ span[k]
        column[k] += 1.0  # P e_k, of length sqrt(P_kk)
        column /= np.sqrt(left[k])
        order.append(k)
        gains.append(float(gain[k]))
        r = r - column * (column @ r)
        left = np.maximum(left - column**2, 0.0)
        left[order] = 0.0
        span = np.column_stack([span, column])
    total = float(np.sum(r**2))
    after = total + np.append(np.cumsum(gains[::-1])[::-1][1:], 0.0)  # chi^2 left when the first 1, 2, ... are out
    stray = np.zeros(points, bool)
    for count in range(len(order), 0, -1):
        scale = np.sqrt(max(after[count - 1], 1e-300) / (free - count))
        t = np.sqrt(min(gains[:count])) / scale
        if 2.0 * stdtr(free - count, -t) < LEVEL / points and np.sqrt(min(gains[:count])) > 1e-9:
            stray[order[:count]] = True
            break
    return stray


def significant(design: FloatArray, residual: FloatArray, candidates: BoolArray) -> BoolArray:
    """Those candidates whose shifts are significant in the presence of the others: the least is removed, one at a time.

    It uses the residual of a plain fit, with degrees of freedom beyond the candidates.
    """
    span = np.linalg.qr(design)[0]
    members = np.flatnonzero(candidates)
    free = len(residual) - design.shape[1]
    while members.size:
        columns = -span @ span[members].T
        columns[members, np.arange(members.size)] += 1.0  # P e_k
        inverse = np.linalg.pinv(columns[members], hermitian=True)  # of e_j P e_k
        delta = inverse @ (columns.T @ residual)
        chi2 = float(np.sum((residual - columns @ delta) ** 2))
        t = np.abs(delta) / np.sqrt(np.maximum(np.diag(inverse), 1e-300) * chi2 / (free - members.size))
        least = int(t.argmin())
        if 2.0 * stdtr(free - members.size, -t[least]) < LEVEL / len(residual):
            break
        members = np.delete(members, least)
    found = np.zeros(len(residual), bool)
    found[members] = True
    return found


def passes_words(points: SurveyPoints) -> str:
    """Sentence on repeated measurements that differ significantly from the first; empty if they do not.

    White noise has no mean, and differences of neighbours in theta whose mean square is twice their variance (J. von
    Neumann, Ann. Math. Stat. 12, 1941, 367); an offset shows in the mean, a rotation or another shape in the
    differences.
    """
    first, pairs = dict[tuple[int, int], int](), list[tuple[int, int]]()
    turn = np.round(np.degrees(np.mod(points.theta, 2.0 * np.pi)) / 1e-3).astype(np.int64) % 360_000
    for k, place in enumerate(zip(turn.tolist(), np.round(points.z / 1e-5).astype(int).tolist(), strict=True)):
        if place in first:
            pairs.append((first.pop(place), k))
        else:
            first[place] = k
    if len(pairs) < FEW:
        return ""
    one, two = np.array(pairs).T
    order = np.lexsort((points.theta[one], np.round(points.z[one], 5)))
    apart = (points.value[two] - points.value[one])[order]
    mean, scatter = float(apart.mean()), float(apart.std(ddof=1))
    drift = 1.0 - 0.5 * float(np.mean(np.diff(apart) ** 2)) / max(scatter**2, 1e-300)
    offset = abs(mean) * np.sqrt(len(apart)) > SURE * scatter and abs(mean) > 1e-9
    drifts = drift * np.sqrt(len(apart)) > SURE and scatter > 1e-9
    if not (offset or drifts):
        return ""
    what = f"{1e6 * mean:+.3g} um on average" if offset else f"{1e6 * scatter:.3g} um (rms), and not at random"
    return f"{len(apart)} places were measured twice; the second measurements differ from the first by {what}"
