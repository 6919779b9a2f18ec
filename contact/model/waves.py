"""Sparse sums of waves of one angle: rows of many modes, or polynomials, as the compiled loops take them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, Indices


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Terms:
    """Sum i = sum_j value[j] wave_{wave[j]}(phi), j = start[i] .. start[i + 1] - 1; zeros are left out.

    Wave 2 n is cos n phi, wave 2 n + 1 is sin n phi: a mode that is symmetric has half of them.
    """

    start: Indices
    wave: Indices
    value: Array

    @property
    def sums(self) -> int:
        """Number of sums."""
        return self.start.size - 1

    @property
    def owner(self) -> Indices:
        """Which sum each term belongs to."""
        return np.repeat(np.arange(self.sums), np.diff(self.start))

    def equals(self, other: Terms) -> bool:
        """Whether these are the same sums, to the bit."""
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in ("value", "wave", "start"))

    def first(self, sums: int) -> Terms:
        """So many of the sums alone."""
        start = self.start[: sums + 1]
        return Terms(start=start, wave=self.wave[: start[-1]], value=self.value[: start[-1]])

    def followed_by(self, other: Terms) -> Terms:
        """These sums, then those of the other."""
        pairs = zip(
            (self.start[:-1], self.wave, self.value),
            (other.start + self.value.size, other.wave, other.value),
            strict=True,
        )
        start, wave, value = (np.concatenate(pair) for pair in pairs)
        return Terms(start=start, wave=wave, value=value)

    def full(self, waves: int) -> Array:
        """Dense table (sums, waves)."""
        table = np.zeros((self.sums, waves))
        table[self.owner, self.wave] = self.value
        return table


def terms(owner: Indices, harmonic: Indices, cos: Array, sin: Array, sums: int) -> Terms:
    """Terms of sums by harmonics; entries stand by `owner`, then by harmonic.

    >>> found = terms(np.array([0, 1, 1]), np.array([4, 0, 4]), np.array([1.0, 2.0, 0.0]), np.array([0.0, 0.0, 3.0]), 2)
    >>> found.start.tolist(), found.wave.tolist(), found.value.tolist()
    ([0, 1, 3], [8, 0, 9], [1.0, 2.0, 3.0])
    """
    value = np.stack([cos, sin], axis=1).ravel()
    wave = np.stack([2 * harmonic, 2 * harmonic + 1], axis=1).ravel()
    kept = value != 0.0
    count = np.bincount(np.repeat(owner, 2)[kept], minlength=sums)
    start = np.concatenate(([0], np.cumsum(count))).astype(np.int64)
    return Terms(start=start, wave=wave[kept].astype(np.int64), value=value[kept])
