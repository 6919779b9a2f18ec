"""The least-squares fit of a survey: parameters that the points determine, and the resulting cone and defect."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from casingfem.errors import InputError
from casingfem.io.arrays import BoolArray, FloatArray
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.field.survey.points import SurveyPoints
from casingfem.structure.field.survey.stray import least_squares, robust_weights, stray_points

_MOST_HARMONICS = 40
_MARGIN = 0.8  # default of a fit: part of the Nyquist harmonic, and of the number of points
_WORST_CONDITION = 100.0  # largest amplification of noise
_WIDEST_GAP_DEG = 90.0
_MOST_NUMBERS = 5e8  # of points times unknowns: 4 GB, and as much again for a weighted copy
_LEAST_KEPT = 0.7  # of the points: what a robust fit must keep


class SurveyFit(NamedTuple):
    """The relative defect, the mean a + b z [m, -], and the residual of each point, relative to the mean."""

    field: FourierField
    mean: tuple[float, float]
    residual: FloatArray
    kept: BoolArray  # points that took part; a robust fit sets stray ones aside
    gap_deg: float
    heights: int
    stray: BoolArray | None = None  # points that a plain fit took in and that contradict all others
    without: FourierField | None = None  # the fit without them
    apart: FloatArray | None = None  # deviation of each point from that fit, relative to its mean


def resolved_harmonic(gap_deg: float) -> int:
    """The largest p with p < 180/gap: more than two points in a wave.

    Examples
    --------
    >>> resolved_harmonic(5.0)
    35
    """
    return max(math.ceil(180.0 / gap_deg * (1 - 1e-9)) - 1, 0)


def fit_points(
    points: SurveyPoints, n_max: int | None, degree: int | None, robust: bool, search: bool = True
) -> SurveyFit:
    """Choose a fit that the points determine, or check the requested one, and make it.

    A robust fit reduces weights by the residuals; points with weight zero count neither for the gap in theta nor for
    the determination of parameters. Without `search` all points count equally.

    Raises
    ------
    InputError
        A gap in theta exceeds 90 deg or half a wave of n_max, or points are too few or badly distributed.
    ValueError
        n_max or degree is not a whole number.
    """
    gap, heights = points.coverage()
    _check_coverage(points, gap, n_max, degree)
    n = min(int(_MARGIN * 180.0 / gap), resolved_harmonic(gap), _MOST_HARMONICS) if n_max is None else n_max
    d = (0 if heights == 1 else 1 if heights < 4 else 2) if degree is None else degree
    unknowns = (2 * n + 1) * (d + 1)
    if len(points) * unknowns > _MOST_NUMBERS:
        every, most = math.ceil(len(points) * unknowns / _MOST_NUMBERS), _MOST_NUMBERS / unknowns
        found = f"{len(points):,} points for {unknowns} unknowns"
        expected = f"at most {most:,.0f} points; keep one line of every {every}, or fit fewer harmonics (n_max)"
        raise InputError(points.path, found=found, expected=expected)
    while not (problem := _Problem(points, heights, n, d)).determined(margin=n_max is None):
        if degree is None and d > 0:
            d -= 1
        elif n_max is None and n > 1:
            n -= 1
        else:
            expected = f"more points, or a fit with n_max below {n} or degree below {d}"
            raise InputError(points.path, found=problem.weakness(), expected=expected)
    whole, design = SurveyFit(*problem.solved(), np.ones(len(points), bool), gap, heights), problem.design(1.0)
    if not search:
        return whole
    if not robust:
        stray = stray_points(design, whole.residual)
        if not stray.any() or not _Problem(points.at(~stray), heights, n, d).determined(margin=False):
            return whole
        without, _, apart = problem.solved((~stray).astype(float))
        return whole._replace(stray=stray, without=without, apart=apart)
    weights = robust_weights(design, whole.residual)
    kept = weights > 0.0
    if np.mean(kept) < _LEAST_KEPT:
        found = f"{np.sum(~kept)} of {len(points)} points far from the smooth surface through the others"
        raise InputError(points.path, found=found, expected=f"at least {_LEAST_KEPT:.0%} of the points close to it")
    remaining = points.at(kept)
    if not _Problem(remaining, heights, n, d).determined(margin=False):
        found = f"{np.sum(~kept)} outliers, and too few other points near them for n_max = {n}, degree = {d}"
        raise InputError(points.path, found=found, expected="more points there, or a lower n_max or degree")
    return SurveyFit(*problem.solved(weights), kept, remaining.coverage()[0], heights)


def _check_coverage(points: SurveyPoints, gap: float, n_max: int | None, degree: int | None) -> None:
    for name, value, least in (("n_max", n_max, 1), ("degree", degree, 0)):
        if value is not None and (value != int(value) or value < least):
            raise ValueError(f"{name} must be a whole number >= {least}, not {value!r}")
    if gap > _WIDEST_GAP_DEG:
        hint = " (are these radians?)" if gap > 350.0 else ""
        expected = f"points all around, with gaps of at most {_WIDEST_GAP_DEG:g} deg"
        raise InputError(points.path, found=f"a gap of {gap:.4g} deg in theta{hint}", expected=expected)
    if n_max is not None and gap > 360.0 / (2 * n_max) * (1 + 1e-9):
        expected = f"at most {180.0 / n_max:.4g} deg for n_max = {n_max}"
        expected += f" (these points resolve harmonic {resolved_harmonic(gap)})"
        raise InputError(points.path, found=f"a gap of {gap:.4g} deg in theta", expected=expected)


class _Problem:
    """The least-squares problem of one (n, degree): mean columns and defect columns at the points."""

    def __init__(self, points: SurveyPoints, heights: int, n: int, degree: int) -> None:
        low, high = float(points.z.min()), float(points.z.max())
        self.points, self.n, self.degree = points, n, degree
        spread = heights > 1 and points.rings().any()  # a robust fit may leave one of the heights
        self.z_mid, self.z_half = (low + high) / 2, (high - low) / 2 if spread else 1.0
        zeta = (points.z - self.z_mid) / self.z_half
        angle = points.theta[:, None] * np.arange(1, n + 1)
        around = np.concatenate([np.cos(angle), np.sin(angle)], axis=1)
        power = zeta[:, None] ** np.arange(degree + 1)
        self.tapered = points.quantity == "thickness"  # a taper belongs to the field, not to the mean
        trend = degree if self.tapered else int(heights > 1)
        self.mean_columns = zeta[:, None] ** np.arange(trend + 1)
        self.columns = (around[:, :, None] * power[:, None, :]).reshape(len(points), -1)

    def design(self, mean: FloatArray | float) -> FloatArray:
        """Columns for value = mean_columns alpha + mean (columns beta)."""
        scale = np.broadcast_to(mean, len(self.points))[:, None]
        return np.concatenate([self.mean_columns, scale * self.columns], axis=1)

    def weakness(self) -> str:
        """Reason why the points cannot determine the fit."""
        points, unknowns = self.design(1.0).shape
        if points < unknowns:
            return f"{points} points for {unknowns} unknowns"
        return f"{points} points at places that do not determine {unknowns} unknowns"

    def determined(self, margin: bool) -> bool:
        """Whether the points are enough and well distributed, from the condition of the normal matrix."""
        design = self.design(1.0)
        points, unknowns = design.shape
        if unknowns > (_MARGIN if margin else 1.0) * points:
            return False
        spectrum = np.linalg.eigvalsh(design.T @ design)
        return bool(spectrum[0] > spectrum[-1] / _WORST_CONDITION**2)

    def solved(self, weights: FloatArray | None = None) -> tuple[FourierField, tuple[float, float], FloatArray]:
        """Fit r = alpha + beta z + c(z) f, where c is the cone itself: linear, repeated until c converges."""
        value, trend = self.points.value, self.mean_columns.shape[1]
        cone = np.full(len(self.points), np.median(value))
        for _ in range(20):
            x = least_squares(self.design(cone), value, weights)
            alpha, beta = x[:trend], x[trend:]
            last, cone = cone, np.full_like(cone, alpha[0]) if self.tapered else self.mean_columns @ alpha
            if np.max(np.abs(cone - last)) <= 1e-14 * alpha[0]:
                break
        residual = (value - self.design(cone) @ x) / cone
        slope = 0.0 if self.tapered or trend == 1 else float(alpha[1]) / self.z_half
        return self._field(alpha, beta), (float(alpha[0]) - slope * self.z_mid, slope), residual

    def _field(self, alpha: FloatArray, beta: FloatArray) -> FourierField:
        p = np.arange(1, self.n + 1)
        cos, sin = beta.reshape(2, self.n, self.degree + 1)
        if self.tapered and self.degree > 0:
            taper = np.concatenate([[0.0], alpha[1:] / alpha[0]])[None, :]
            p, cos, sin = np.append(0, p), np.concatenate([taper, cos]), np.concatenate([0 * taper, sin])
        return FourierField(p=p, cos=cos, sin=sin, z_mid=self.z_mid, z_half=self.z_half)
