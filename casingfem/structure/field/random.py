"""Fields for imperfections without measurements, drawn from a spectrum of amplitudes.

The same seed gives identical bits.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtri

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, IntArray, frozen
from casingfem.structure.field.field import Field, SumField
from casingfem.structure.field.fourier import FourierField, SeriesBehind

EXAMPLE = {2: 0.24, 3: 0.168, 4: 0.169, 5: 0.138, 6: 0.147, 7: 0.062, 8: 0.057, 10: 0.031, 12: 0.019}
EXAMPLE_HIGH = {2: 0.83, 4: 0.44, 8: 0.19}
NINETY = float(ndtri(0.9))  # standard deviations between the median and the 90th percentile
RAYLEIGH = math.sqrt(math.log(10.0) / math.log(2.0))  # 90th percentile over median of a Rayleigh amplitude


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Spectrum:
    """Spectrum of a random field: the median amplitude of each harmonic, and the 90th percentile.

    Amplitudes are lognormal, independent, with uniform phases. A Rayleigh amplitude (two equal Gaussian coefficients)
    would tie the 90th percentile to 1.82 medians; the example spectrum has 2.6 to 3.5, which the lognormal reproduces
    with s = ln(high/median)/1.2816.

    Parameters
    ----------
    p : (H,) harmonics >= 1, ascending
    median, high : (H,) relative amplitudes, high >= median > 0

    Raises
    ------
    ValueError
        Harmonics are out of order, amplitudes are not positive, or a 90th percentile is below its median.

    Examples
    --------
    >>> spectrum = Spectrum.between({2: 0.24, 8: 0.06}, {2: 0.72, 8: 0.18})
    >>> spectrum.p.tolist(), spectrum.median[2].round(9).item()  # as a straight line on logarithmic scales
    ([2, 3, 4, 5, 6, 7, 8], 0.12)
    """

    p: IntArray
    median: FloatArray
    high: FloatArray

    def __post_init__(self) -> None:
        p, median, high = np.array(self.p, dtype=np.int64), *(np.array(x, float) for x in (self.median, self.high))
        if p.ndim != 1 or not p.shape == median.shape == high.shape or not p.size:
            found = f"found p of shape {p.shape}, median {median.shape}, high {high.shape}"
            raise ModelError("field-spectrum", f"Spectrum: {found}, expected three lists of equal length")
        if p[0] < 1 or np.any(np.diff(p) <= 0):
            raise ModelError("field-spectrum", f"Spectrum: harmonics must ascend from 1 or more, found {p.tolist()}")
        if not (np.all(np.isfinite(high)) and np.all(median > 0.0) and np.all(high >= median)):
            k = int(np.argmin(np.isfinite(high) & (median > 0.0) & (high >= median)))
            found = f"found median = {median[k]:g} and high = {high[k]:g} at p = {p[k]}"
            raise ModelError("field-spectrum", f"Spectrum: {found}, expected 0 < median <= high < inf")
        for name, array in (("p", p), ("median", median), ("high", high)):
            object.__setattr__(self, name, frozen(array))

    @classmethod
    def between(cls, median: dict[int, float], high: dict[int, float], *, p_max: int | None = None) -> Spectrum:
        """Interpolate given medians, and the ratios of given 90th percentiles to them, on logarithmic scales.

        From the lowest p to p_max (by default the highest given); beyond the last median its power law continues, with
        the last ratio.
        """
        p = np.arange(min(median), (p_max or max(median)) + 1)
        level = np.exp(_log_interpolated(p, median, slope=True))
        ratio = np.exp(_log_interpolated(p, {k: high[k] / median[k] for k in high}, slope=False))
        return cls(p=p, median=level, high=level * ratio)

    @classmethod
    def of_surveys(cls, fields: Sequence[FourierField], *, p_max: int | None = None) -> Spectrum:
        """Spectrum of casings like those of fitted surveys: ln a = c - b ln p + s z, z standard normal.

        c, b and s are least squares of the logarithms of all measured amplitudes from p = 2 on, of the parts that are
        constant along the axis. p = 1 is the position of the axis. The law continues to `p_max`, by default the
        highest harmonic of the surveys.

        Raises
        ------
        ModelError
            There are fewer than three amplitudes above zero.

        Examples
        --------
        >>> one = FourierField.of({2: 0.008, 4: (0.0, 0.002), 8: 0.0005})
        >>> found = Spectrum.of_surveys([one], p_max=9)
        >>> found.p.tolist(), round(float(found.median[3]), 6), bool(np.allclose(found.high, found.median))
        ([2, 3, 4, 5, 6, 7, 8, 9], 0.00128, True)
        """
        measured = [(p, a) for each in fields for p, a in _amplitudes(each) if p > 1 and a > 0.0]
        if len({p for p, _ in measured}) < 2 or len(measured) < 3:
            found = f"{len(measured)} amplitudes above zero from p = 2 on"
            raise ModelError("field-spectrum", f"Spectrum: found {found}, expected at least 3, of 2 or more harmonics")
        p, a = np.array(measured).T
        design = np.column_stack([np.ones(len(p)), -np.log(p)])
        (c, b), *_ = np.linalg.lstsq(design, np.log(a), rcond=None)
        scatter = np.sqrt(np.sum((np.log(a) - design @ (c, b)) ** 2) / (len(p) - 2))
        every = np.arange(2, (p_max or int(p.max())) + 1)
        median = np.exp(c - b * np.log(every))
        return cls(p=every, median=median, high=median * np.exp(NINETY * scatter))

    def scaled(self, factor: float) -> Spectrum:
        """The same spectrum multiplied by `factor`."""
        return replace(self, median=factor * self.median, high=factor * self.high)

    def amplitudes(self, uniform: ArrayLike) -> FloatArray:
        """Amplitudes (..., H) at given probabilities (..., H): the inverse of the distribution."""
        return np.asarray(self.median * np.exp(self.deviation * ndtri(uniform)))

    @property
    def deviation(self) -> FloatArray:
        """Standard deviation of the logarithm of each amplitude, (H,)."""
        return np.asarray(np.log(self.high / self.median) / NINETY)

    @property
    def rms(self) -> FloatArray:
        """Root mean square of each amplitude, (H,)."""
        return np.asarray(self.median * np.exp(self.deviation**2))


def _amplitudes(field: FourierField) -> list[tuple[int, float]]:
    """Harmonics of a field and the amplitudes of their parts that are constant along the axis."""
    return [(int(p), float(np.hypot(c, s))) for p, c, s in zip(field.p, field.cos[:, 0], field.sin[:, 0], strict=True)]


def _log_interpolated(p: IntArray, given: dict[int, float], *, slope: bool) -> FloatArray:
    """Ln of a quantity given at some p, linear in ln p; with `slope`, extrapolated beyond the last with its slope."""
    known = sorted(given)
    x, y = np.log(known), np.log([given[k] for k in known])
    values = np.interp(np.log(p), x, y)
    if slope and len(known) > 1:
        values += np.maximum(np.log(p) - x[-1], 0.0) * (y[-1] - y[-2]) / (x[-1] - x[-2])
    return np.asarray(values)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RandomField(SeriesBehind):
    """One draw of a random field, constant along the axis: a Fourier series with random amplitudes and phases.

    f(theta) = sum_p a_p cos(p theta - phi_p),  a_p lognormal by the spectrum, phi_p uniform

    It is a Field. `redrawn` gives others of the same kind; `casingfem.mistune` computes the modes of many. A draw
    depends only on seed, stream and draw number, not on the number or order of draws.

    Parameters
    ----------
    spectrum : amplitudes of the harmonics, relative
    seed : whole number >= 0
    draw : number of the field for this seed
    stream : distinguishes the fields of one shell (such as radius and thickness) drawn with one seed

    Examples
    --------
    >>> one, same = (RandomField.example(thickness=3e-3, radius=0.475, seed=7) for _ in range(2))
    >>> one.max_harmonic, one.amplitude(2) == same.amplitude(2), one.amplitude(2) == one.redrawn(1).amplitude(2)
    (32, True, False)
    """

    spectrum: Spectrum
    seed: int
    draw: int = 0
    stream: int = 0
    fit: FourierField = field(init=False)

    def __post_init__(self) -> None:
        if min(self.seed, self.draw, self.stream) < 0:
            found = f"seed {self.seed}, draw {self.draw}, stream {self.stream}"
            raise ModelError("field-seed", f"RandomField: found {found}, expected numbers of 0 or more")
        rng = np.random.default_rng([self.seed, self.stream, self.draw])
        size, turn = rng.random((self.spectrum.p.size, 2)).T  # row by row: more harmonics leave the first ones alone
        amplitude, phase = self.spectrum.amplitudes(size), 2.0 * np.pi * turn
        cos, sin = amplitude * np.cos(phase), amplitude * np.sin(phase)
        object.__setattr__(self, "fit", FourierField(p=self.spectrum.p, cos=cos[:, None], sin=sin[:, None]))

    @classmethod
    def example(
        cls, *, thickness: float, radius: float, seed: int, scale: float = 1.0, p_max: int = 32, stream: int = 0
    ) -> RandomField:
        """Radius defects from an example spectrum: medians 0.24 t at n = 2 to 0.019 t at n = 12, with wall thickness t.

        The values at nine harmonics and the 90th percentiles at 2, 4 and 8 have no published source: they are an
        example of how amplitudes decrease with n; use the spectrum of a survey if available. Between them amplitudes
        are interpolated; beyond 12 the power law of the last two (-2.7) is assumed to continue.
        """
        spectrum = Spectrum.between(EXAMPLE, EXAMPLE_HIGH, p_max=p_max).scaled(scale * thickness / radius)
        return cls(spectrum=spectrum, seed=seed, stream=stream)

    def redrawn(self, draw: int) -> RandomField:
        """Another field of the same spectrum and seed."""
        return replace(self, draw=draw)

    def amplitude(self, p: int) -> float:
        """Amplitude of harmonic p in this draw."""
        return self.fit.amplitude(p)

    def __add__(self, other: Field) -> SumField:
        return SumField((self, other))

    def __repr__(self) -> str:
        p = self.spectrum.p
        title = f"RandomField(harmonics {p[0]} to {p[-1]}, seed {self.seed}, draw {self.draw})"
        return f"{title}\n{self.fit!r}"


def redrawn(field: Field, draw: int) -> Field:
    """The field with new draws of its random parts; deterministic parts are kept."""
    if isinstance(field, RandomField):
        return field.redrawn(draw)
    if isinstance(field, SumField):
        return SumField(tuple(redrawn(term, draw) for term in field.fields))
    return field


def drop_random(field: Field) -> Field | None:
    """The part of a field that is not random; None if there is none."""
    if not isinstance(field, SumField):
        return None if isinstance(field, RandomField) else field
    kept = tuple(term for term in field.fields if not isinstance(term, RandomField))
    return kept[0] if len(kept) == 1 else SumField(kept) if kept else None


def typical(field: Field) -> Field:
    """The field with its random parts at the median amplitudes, for the choice of a mesh that all draws share."""
    if isinstance(field, RandomField):
        median = field.spectrum.median[:, None]
        return FourierField(p=field.spectrum.p, cos=median, sin=0.0 * median)
    if isinstance(field, SumField):
        return SumField(tuple(map(typical, field.fields)))
    return field


def is_random(field: Field) -> bool:
    """Whether any part of a field is random."""
    return isinstance(field, RandomField) or (isinstance(field, SumField) and any(map(is_random, field.fields)))
