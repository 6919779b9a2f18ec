"""The terms of a modal model over a window of lines, as real columns.

    H(omega) = sum_k a_k (j x)^q w_k^2/(w_k^2 - x^2 + 2 j zeta_k w_k x) + (j x)^q sum_i c_i T_i,

x and w_k in units of the window's mean frequency; q = 0, 1, 2 for receptance, mobility, accelerance. a_k are real
where damping is proportional, complex otherwise; the Chebyshev polynomials T_i stand for modes outside the window.

An average of random blocks under a Hann window leaks: it is H smoothed by the window's power spectrum (Bendat and
Piersol, Random Data, 4th ed., 2010, section 8.5), whose moments are those of 1/6, 2/3, 1/6 on three lines.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from casingfem.io.arrays import Array, BoolArray, FloatArray, freeze

TERMS = 4  # polynomials
FLOOR = 3e-4  # of a window's rms: a model is not better than that
HANN = (-1.0, 1.0 / 6.0), (0.0, 2.0 / 3.0), (1.0, 1.0 / 6.0)  # lines away, share of the power


def floor_of(H: Array) -> float:
    """Least deviation of an entry's real or imaginary part that counts in a window of responses."""
    return FLOOR * float(np.sqrt(0.5 * np.mean(np.abs(H) ** 2)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Window:
    """Lines and channels of one fit: freq [Hz] (lines,), Y (2 lines, channels) real over imaginary, weighted.

    `power` is q above; `residues` "real" or "complex"; `weight` (channels,) what Y was multiplied by; `floor` the
    least rms deviation per entry of Y that counts: models are never better than that; `along` (lines,) what each line
    of Y was multiplied by, 0 where a line is missing; `leak` the distance of lines [Hz] over which a Hann window leaks,
    0 where nothing does.
    """

    freq: FloatArray
    Y: FloatArray
    power: int
    residues: str
    weight: FloatArray
    floor: float
    along: FloatArray
    leak: float = 0.0

    def __post_init__(self) -> None:
        freeze(self, "freq", "Y", "weight", "along")

    @property
    def columns(self) -> int:
        """Real columns of each pole, or polynomial."""
        return 1 if self.residues == "real" else 2

    @property
    def scale(self) -> float:
        """Mean frequency [Hz]."""
        return float(self.freq.mean())

    @property
    def as_complex(self) -> Array:
        """The data as complex numbers, (lines, channels)."""
        half = len(self.freq)
        return np.asarray(self.Y[:half] + 1j * self.Y[half:])

    @property
    def entries(self) -> int:
        """Numbers of Y that are not missing."""
        return 2 * int(self.Y.shape[1]) * int(np.count_nonzero(self.along))

    def cut(self, lines: slice | BoolArray) -> Window:
        """Some of the lines."""
        data = np.concatenate([part[lines] for part in np.split(self.Y, 2)])
        return replace(self, freq=self.freq[lines], Y=data, along=self.along[lines])

    def resonances(self, f: FloatArray, zeta: FloatArray) -> FloatArray:
        """Columns (2 lines, poles x columns) of unit residue at poles f [Hz], zeta."""
        return self.as_real(self.values(f, zeta))

    def slopes(self, f: FloatArray, zeta: FloatArray) -> FloatArray:
        """Derivatives of `resonances` by ln f of all poles, then by ln zeta, (2 lines, 2 poles x columns)."""
        return self.as_real(np.concatenate(self.peaks(f, zeta)[1], axis=1))

    def values(self, f: FloatArray, zeta: FloatArray) -> Array:
        """Complex resonances (lines, poles) of unit residue."""
        x, w = self.places()[0][:, None], f / self.scale
        return self._seen((1j * x) ** self.power * (w**2 * _compliance(x, w, zeta)))

    def peaks(self, f: FloatArray, zeta: FloatArray) -> tuple[Array, tuple[Array, Array]]:
        """Complex resonances (lines, poles) of unit residue, and their derivatives by ln f and ln zeta."""
        x, w = self.places()[0][:, None], f / self.scale
        inverse = _compliance(x, w, zeta)
        g = (1j * x) ** self.power * (w**2 * inverse)
        inverse *= g
        by_zeta: Array = inverse * x
        by_zeta *= -2j * zeta * w
        inverse *= w**2
        by_freq = g - inverse
        by_freq *= 2.0
        by_freq += by_zeta
        return self._seen(g), (self._seen(by_freq), self._seen(by_zeta))

    def residuals(self) -> FloatArray:
        """Columns (2 lines, TERMS x columns) of modes outside the window."""
        return self.as_real(self.polynomials())

    def polynomials(self) -> Array:
        """The same, complex (lines, TERMS)."""
        x = self.freq[:, None] / self.scale
        span = (2.0 * self.freq - self.freq[0] - self.freq[-1]) / (self.freq[-1] - self.freq[0])
        scaled = self.along[:, None] * (1j * x) ** self.power
        return np.asarray(scaled * np.polynomial.chebyshev.chebvander(span, TERMS - 1))

    def as_real(self, columns: Array) -> FloatArray:
        """Complex columns (lines, n) as real ones; for complex residues with j times each beside it."""
        if self.columns == 2:
            columns = np.stack([columns, 1j * columns], axis=2).reshape(len(columns), -1)
        return np.concatenate([columns.real, columns.imag])

    def as_columns(self, columns: Array) -> Array:
        """Complex columns (lines, n) as they are for complex residues; elsewhere real ones (2 lines, n)."""
        return columns if self.columns == 2 else np.concatenate([columns.real, columns.imag])

    def places(self) -> tuple[FloatArray, int]:
        """Where terms are computed, over the mean frequency, (places,): lines, and those from which they leak.

        And how many places apart the shares of a leak lie, 0 where nothing leaks.
        """
        if not self.leak:
            return self.freq / self.scale, 0
        if np.abs(np.diff(self.freq) - self.leak).max() < 1e-6 * self.leak:  # none is left out between them
            at = np.concatenate([[self.freq[0] - self.leak], self.freq, [self.freq[-1] + self.leak]])
            return at / self.scale, 1
        return np.concatenate([self.freq + by * self.leak for by, _ in HANN]) / self.scale, len(self.freq)

    def _seen(self, terms: Array) -> Array:
        """Terms at `places` as the lines show them, (lines, poles): leaked and weighted."""
        count, apart = len(self.freq), self.places()[1]
        if apart:
            shown = HANN[1][1] * terms[apart : apart + count]
            shown += HANN[0][1] * (terms[:count] + terms[2 * apart :])
            terms = shown
        terms *= self.along[:, None]
        return terms


def _compliance(x: FloatArray, w: FloatArray, zeta: FloatArray) -> Array:
    """1/(w^2 - x^2 + 2 j zeta w x), (places, poles)."""
    below = np.empty((len(x), len(w)), complex)
    below.real = w**2 - x**2
    below.imag = 2.0 * zeta * w * x
    return np.asarray(np.reciprocal(below, out=below))
