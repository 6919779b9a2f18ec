"""Points of a survey that contradict the surface through all others, and passes that contradict each other."""

from __future__ import annotations

import numpy as np
from scipy.special import stdtr, stdtrit

from casingfem.io.arrays import BoolArray, FloatArray
from casingfem.structure.field.survey.points import SurveyPoints
from casingfem.structure.field.survey.robust import least_squares, robust_weights

LEVEL = 0.01  # chance of a false alarm in a survey without stray points
SHARE = 0.1  # of the points at most
SEARCHED = 2000  # points: of more, a search for one after the other takes minutes
FREE = 5  # degrees of freedom that must be left
SURE = 5.0  # standard deviations: of what two passes differ by
FEW = 12  # places measured twice, below which nothing is said


def stray_points(design: FloatArray, residual: FloatArray) -> BoolArray:
    """Which points contradict all others beyond chance, (points,), by the design and the residuals of a plain fit."""
    if len(residual) > SEARCHED:
        return beyond(design, residual, robust_weights(design, residual) > 0.0)
    stray = shifted_points(design, residual)
    if stray.any():  # those beside them may have been taken for them: a robust fit knows the candidates
        candidates = stray | (robust_weights(design, residual) == 0.0)
        if candidates.sum() <= len(residual) - design.shape[1] - FREE:  # of more, none can be judged
            return significant(design, residual, candidates)
    return stray


def beyond(design: FloatArray, residual: FloatArray, kept: BoolArray) -> BoolArray:
    """Which points lie off the fit of those kept, (points,), by more than chance puts one of all points.

    For scans: with many points to an unknown none bends the fit towards itself. Student's t of a point that took no
    part, t = r/(s sqrt(1 + x^T (X^T X)^-1 x)).
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
    """Which points a shift of their own explains beyond chance, (points,); the plain fit stays as it is.

    Point i alone off by delta leaves the residual P_ii delta of itself, P = 1 - Q Q^T of the design, and moves all
    others. The largest (P r)_i^2/P_ii is taken first, then the largest of what that leaves, up to SHARE of the points
    (mean-shift outliers: Cook & Weisberg, Residuals and Influence in Regression, 1982, 2.2.2). As many count as are all
    significant by Student's t, at LEVEL over the number of points, against the scatter without them.
    """
    points = len(residual)
    span = np.linalg.qr(design)[0]
    left, r = np.maximum(1.0 - np.sum(span**2, axis=1), 0.0), residual - span @ (span.T @ residual)
    free = points - design.shape[1]
    order: list[int] = []
    gains: list[float] = []
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
    """Those of the candidates whose shifts are significant given each other: the least goes, one at a time.

    By the residual of a plain fit; there must be degrees of freedom left beside the candidates.
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
    """How the second measurements of places differ from the first beyond chance; empty where they do not.

    White noise has no mean, and differences of neighbours in theta whose mean square is twice their variance (J. von
    Neumann, Ann. Math. Stat. 12, 1941, 367); an offset shows in the one, a turn or another shape in the other.
    """
    first: dict[tuple[int, int], int] = {}
    pairs: list[tuple[int, int]] = []
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
    what = f"by {1e6 * mean:+.3g} um on average" if offset else f"by {1e6 * scatter:.3g} um, not at random"
    return f"the second measurements of {len(apart)} places differ from the first {what}"
