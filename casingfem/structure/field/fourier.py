"""Fields as Fourier series around, polynomials or splines along the axis."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, IntArray
from casingfem.structure.field.field import Field, FieldValues, SumField
from casingfem.structure.field.reach import Reach
from casingfem.structure.field.spline import Spline

Coefficient: TypeAlias = float | complex
MOST = 10_000  # harmonics that a mesh can have, and far more


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FourierField:
    """Fourier series around, polynomial or spline along the axis.

    f(z, theta) = sum_hd (cos[h,d] cos p_h theta + sin[h,d] sin p_h theta) zeta^d,  zeta = (z - z_mid)/z_half

    With a `spline` its functions B_d(z) replace zeta^d; "the constant part" of a harmonic is then its
    mean from end to end, without one the coefficient of zeta^0.

    Coefficients have the unit of the field (none for relative defects). They may be complex: the evaluation is analytic
    in them, so that the imaginary part of a result from a coefficient ``c + 1e-30j`` is a derivative to machine
    precision.

    Parameters
    ----------
    p : (H,) integers >= 0, each once
    cos, sin : (H, D), coefficient of zeta^d or B_d; a sine at p = 0 must be zero
    z_mid, z_half : m, the axial coordinate's origin and scale
    spline : D B-splines along z instead of powers
    reach : heights at which the field is valid, and the rule outside; valid everywhere if None

    Raises
    ------
    ModelError
        Shapes do not agree, harmonics are negative, fractional or repeated, or values are not finite.

    Examples
    --------
    >>> field = FourierField.of({8: 0.004, 4: (0.0, 0.0006)})
    >>> round(float(field.derivatives(z=0.1, theta=0.0).value), 6)
    0.004
    >>> field.amplitude(4), field.max_harmonic
    (0.0006, 8)
    >>> field.with_harmonic(4, sin=0.0)
    FourierField(2 harmonics, |f| <= 4.00e-03)
      p   amplitude  crest [deg]
      8   4.000e-03         0.00
      4   0.000e+00         0.00
    """

    p: IntArray
    cos: Array
    sin: Array
    z_mid: float = 0.0
    z_half: float = 1.0
    spline: Spline | None = None
    reach: Reach | None = None

    def __post_init__(self) -> None:
        p, cos, sin = _harmonics(self.p), _coefficients("cos", self.cos), _coefficients("sin", self.sin)
        if cos.shape != sin.shape or cos.shape[0] != p.size:
            found = f"found cos of shape {cos.shape} and sin of shape {sin.shape}"
            expected = f"expected one row for each of the {p.size} harmonics, (harmonics, degrees), in both"
            raise ModelError("field-coefficients", f"FourierField: {found}, {expected}")
        if self.spline is not None and cos.shape[1] != self.spline.size:
            found = f"found cos of shape {cos.shape}, expected ({p.size}, {self.spline.size}), as the spline has"
            raise ModelError("field-coefficients", f"FourierField: {found}")
        if np.any(sin[p == 0]):
            found = "FourierField: sin at p = 0 multiplies sin(0) = 0; use cos for the mean"
            raise ModelError("field-harmonics", found)
        if not (np.isfinite(self.z_mid) and np.isfinite(self.z_half) and self.z_half > 0.0):
            found = f"found z_mid = {self.z_mid!r}, z_half = {self.z_half!r}, expected finite numbers, z_half above 0"
            raise ModelError("field-coefficients", f"FourierField: {found}")
        for name, array in (("p", p), ("cos", cos), ("sin", sin)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @classmethod
    def of(cls, harmonics: Mapping[int, Coefficient | tuple[Coefficient, Coefficient]]) -> FourierField:
        """Build from {p: cos} or {p: (cos, sin)}, constant along z.

        Examples
        --------
        >>> FourierField.of({8: 0.004, 4: (0.0019, 0.0006)}).harmonics
        (8, 4)
        """
        pairs = [c if isinstance(c, tuple) else (c, 0.0) for c in harmonics.values()]
        if any(len(pair) != 2 for pair in pairs):
            bad = next(pair for pair in pairs if len(pair) != 2)
            found = f"FourierField.of: found {bad}, expected one number (cos) or a pair (cos, sin) for each harmonic"
            raise ModelError("field-coefficients", found)
        table = np.array(pairs).reshape(len(pairs), 2, 1)
        return cls(p=np.array(list(harmonics)), cos=table[:, 0], sin=table[:, 1])

    def derivatives(self, z: ArrayLike, theta: ArrayLike) -> FieldValues:
        """Evaluate f and its exact derivatives; cost: one cosine and sine per harmonic and theta."""
        z, z_of = distinct(z)
        theta, theta_of = distinct(theta)
        angle = theta[..., None] * self.p
        c, s = np.cos(angle), np.sin(angle)
        cos, sin, p = self.cos, self.sin, self.p[:, None]
        parts = (c @ cos + s @ sin,  # (theta.shape, D): the polynomial's coefficients at each theta
                 c @ (p * sin) - s @ (p * cos), -(c @ (p**2 * cos) + s @ (p**2 * sin)))  # fmt: skip
        around, around_1, around_2 = (part[theta_of] for part in parts)
        at = z if self.reach is None else self.reach.held(z)
        powers = self._powers(at) if self.spline is None else self.spline.evaluate(at)
        if self.reach is not None:
            powers = self.reach.bounded(z, powers)
        along, along_1, along_2 = (power[z_of] for power in powers)
        first = _contract(around, along), _contract(around, along_1), _contract(around_1, along)
        second = _contract(around, along_2), _contract(around_1, along_1), _contract(around_2, along)
        return FieldValues(*first, *second)

    def _powers(self, z: Array) -> tuple[Array, Array, Array]:
        """zeta^d and its first and second z-derivatives, (z.shape, D) each."""
        d = np.arange(self.cos.shape[1])
        zeta = (z[..., None] - self.z_mid) / self.z_half
        power = zeta**d
        first = d * zeta ** np.maximum(d - 1, 0) / self.z_half
        second = d * (d - 1) * zeta ** np.maximum(d - 2, 0) / self.z_half**2
        return power, first, second

    def rotated(self, angle: float) -> FourierField:
        """Rotate the field by +angle [rad] about the axis: a crest at theta moves to theta + angle."""
        c, s = np.cos(self.p * angle)[:, None], np.sin(self.p * angle)[:, None]
        return replace(self, cos=self.cos * c - self.sin * s, sin=self.cos * s + self.sin * c)

    def with_harmonic(self, p: int, *, cos: Coefficient | None = None, sin: Coefficient | None = None) -> FourierField:
        """Replace the z-constant (d = 0) coefficients of harmonic p; None keeps one, a new p is added.

        Examples
        --------
        >>> FourierField.of({4: (0.1, 0.2)}).with_harmonic(4, cos=0.3).coefficients(4)
        (0.3, 0.2)
        """
        held = np.flatnonzero(self.p == p)
        if held.size == 0:
            none = np.zeros((1, 1 if self.spline is None else self.spline.size))
            zero = FourierField(p=np.array([p]), cos=none, sin=none, spline=self.spline)
            return _merged(self, zero).with_harmonic(p, cos=cos, sin=sin)
        new_cos, new_sin = (
            array if value is None else array.astype(np.result_type(array, value))
            for array, value in ((self.cos, cos), (self.sin, sin))
        )
        constant, mean = self._constant
        for old, new, value in ((self.cos, new_cos, cos), (self.sin, new_sin, sin)):
            if new is not old:
                row = new[held[0]]
                new[held[0]] = row - constant * (mean @ row) + constant * value
        return replace(self, cos=new_cos, sin=new_sin)

    @property
    def _constant(self) -> tuple[Array, Array]:
        """Coefficients (D,) of a constant 1, and the functional (D,) that gives a row's constant part."""
        if self.spline is not None:
            return np.ones(self.spline.size), self.spline.means
        unit = np.eye(1, self.cos.shape[1])[0]
        return unit, unit

    def coefficients(self, p: int) -> tuple[Coefficient, Coefficient]:
        """(cos, sin) of harmonic p at d = 0; zeros if the field does not contain it."""
        held = np.flatnonzero(self.p == p)
        if held.size == 0:
            return 0.0, 0.0
        mean = self._constant[1]
        return (mean @ self.cos[held[0]]).item(), (mean @ self.sin[held[0]]).item()

    def amplitude(self, p: int) -> float:
        """sqrt(cos^2 + sin^2) of harmonic p at d = 0 (real parts), 0 if absent."""
        cos, sin = self.coefficients(p)
        return math.hypot(cos.real, sin.real)

    @property
    def harmonics(self) -> tuple[int, ...]:
        """The circumferential harmonics present, in the given order."""
        return tuple(self.p.tolist())

    @property
    def max_harmonic(self) -> int:
        """The highest circumferential harmonic present, 0 for an empty field."""
        return max(self.harmonics, default=0)

    def __add__(self, other: Field) -> Field:
        if isinstance(other, FourierField) and _same_scaling(self, other):
            return _merged(self, other)
        return SumField((self, other))

    def __repr__(self) -> str:
        amplitudes = np.hypot(self.cos.real, self.sin.real)
        title = f"FourierField({self.p.size} harmonics, |f| <= {amplitudes.sum():.2e}"
        if self.spline is not None:
            title += f", {self.spline.size} splines along z from {self.spline.z_low:g} to {self.spline.z_high:g} m"
        elif self.cos.shape[1] > 1:
            title += f", degree {self.cos.shape[1] - 1} along z on {self.z_mid:g} +- {self.z_half:g} m"
        lines = [title + ")"]
        if self.p.size:
            lines.append("  p   amplitude  crest [deg]")
        order = np.argsort(-amplitudes[:, :1].sum(axis=1), kind="stable")
        for h in order[:12]:
            phase = math.atan2(self.sin[h, 0].real, self.cos[h, 0].real)
            crest = math.degrees(phase / max(int(self.p[h]), 1))
            lines.append(f"{self.p[h]:3d}   {amplitudes[h, 0]:9.3e} {crest:12.2f}")
        if len(order) > 12:
            lines.append(f"  ... and {len(order) - 12} smaller ones")
        return "\n".join(lines)


class SeriesBehind:
    """A field that evaluates its Fourier series `fit`, which is fitted to a survey or drawn at random."""

    __slots__ = ()
    fit: FourierField

    def derivatives(self, z: ArrayLike, theta: ArrayLike) -> FieldValues:
        """Evaluate the series and its derivatives."""
        return self.fit.derivatives(z, theta)

    def rotated(self, angle: float) -> FourierField:
        """Rotate the series by +angle [rad] about the axis."""
        return self.fit.rotated(angle)

    def with_harmonic(self, p: int, *, cos: Coefficient | None = None, sin: Coefficient | None = None) -> FourierField:
        """Replace one harmonic; an updater varies only the series."""
        return self.fit.with_harmonic(p, cos=cos, sin=sin)

    @property
    def max_harmonic(self) -> int:
        """The highest harmonic of the series."""
        return self.fit.max_harmonic


def distinct(places: ArrayLike) -> tuple[Array, IntArray]:
    """The different values among points, and the index of each point's value, since mesh points lie in rows."""
    given = 1.0 * np.asarray(places)
    values, of = np.unique(given, return_inverse=True)
    return values, of.reshape(given.shape)


def _contract(around: Array, along: Array) -> Array:
    """Sum over the polynomial degree, the last axis of both, with broadcasting of the rest."""
    product: Array = np.einsum("...d,...d->...", around, along)
    return product


def _harmonics(p: ArrayLike) -> IntArray:
    given = np.array(p)
    if given.ndim != 1 or (given.size and not np.issubdtype(given.dtype, np.integer)):
        raise ModelError("field-harmonics", f"FourierField: p must be a list of whole numbers, not {p!r}")
    harmonics = given.astype(np.int64)
    if np.any(harmonics < 0):
        raise ModelError("field-harmonics", f"FourierField: harmonics must be >= 0, found {harmonics.min()}")
    if np.any(harmonics > MOST):
        raise ModelError("field-harmonics", f"FourierField: harmonics must be <= {MOST}, found {harmonics.max()}")
    numbers, counts = np.unique(harmonics, return_counts=True)
    if np.any(counts > 1):
        raise ModelError("field-harmonics", f"FourierField: harmonic {numbers[counts > 1][0]} is given twice")
    return harmonics


def _coefficients(name: str, values: ArrayLike) -> Array:
    given = np.array(values)
    array: Array = given.astype(np.result_type(given.dtype, np.float64))
    if array.ndim != 2 or array.shape[1] < 1:
        found = f"{name} must have shape (harmonics, degrees), not {array.shape}"
        raise ModelError("field-coefficients", f"FourierField: {found}")
    if not np.all(np.isfinite(np.real(array))):
        raise ModelError("field-coefficients", f"FourierField: {name} contains values that are not finite")
    return array


def _same_scaling(a: FourierField, b: FourierField) -> bool:
    if a.spline is not None or b.spline is not None:
        return a.spline == b.spline and a.reach == b.reach
    fades = any(each.reach is not None and each.reach.rule == "zero" for each in (a, b))
    if a.reach != b.reach and (fades or min(a.cos.shape[1], b.cos.shape[1]) > 1):
        return False
    constant = a.cos.shape[1] == 1 or b.cos.shape[1] == 1
    return constant or (a.z_mid, a.z_half) == (b.z_mid, b.z_half)


def _merged(a: FourierField, b: FourierField) -> FourierField:
    """Add the coefficients of two fields of equal scaling (or one of them constant along z)."""
    scale = a if a.cos.shape[1] > 1 else b
    p = list(dict.fromkeys([*a.harmonics, *b.harmonics]))
    shape = (len(p), max(a.cos.shape[1], b.cos.shape[1]))
    cos, sin = (np.zeros(shape, np.result_type(a.cos, a.sin, b.cos, b.sin)) for _ in range(2))
    for field in (a, b):
        rows = [p.index(n) for n in field.harmonics]
        cos[rows, : field.cos.shape[1]] += field.cos
        sin[rows, : field.sin.shape[1]] += field.sin
    return replace(scale, p=np.array(p), cos=cos, sin=sin)
