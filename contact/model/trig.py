"""Trigonometric polynomials of the contact angle, and sparse sums of its waves for the compiled loops."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, Indices, readonly

PRUNE = 1e-13  # of the largest value: below this a coefficient is round-off


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Trig:
    """p(phi) = sum_j cos[j] cos(harmonic[j] phi) + sin[j] sin(harmonic[j] phi), without negligible terms."""

    harmonic: Indices
    cos: Array
    sin: Array

    def __call__(self, phi: float) -> float:
        """Value at one angle [rad]."""
        return float(self.cos @ np.cos(self.harmonic * phi) + self.sin @ np.sin(self.harmonic * phi))

    def at(self, angles: Array) -> Array:
        """Values at many angles [rad]."""
        phases = angles[:, None] * self.harmonic
        return np.asarray(np.cos(phases) @ self.cos + np.sin(phases) @ self.sin)

    @property
    def degree(self) -> int:
        """Highest harmonic."""
        return int(self.harmonic.max(initial=0))

    @property
    def largest(self) -> float:
        """Largest coefficient."""
        return float(np.maximum(np.abs(self.cos), np.abs(self.sin)).max(initial=0.0))


def trig(cos: Array, sin: Array) -> Trig:
    """Trigonometric polynomial from coefficients by harmonic 0, 1, ..., pruned at round-off.

    >>> trig(np.array([1.0, 0.0, 2.0]), np.array([0.0, 0.0, 1e-16])).harmonic.tolist()
    [0, 2]
    """
    size = np.maximum(np.abs(cos), np.abs(sin))
    kept = np.flatnonzero(size > PRUNE * size.max(initial=0.0))
    return Trig(harmonic=kept.astype(np.int64), cos=readonly(cos[kept]), sin=readonly(sin[kept]))


def pruned(polynomial: Trig, noise: float) -> Trig:
    """The same polynomial without coefficients up to `noise`.

    >>> pruned(trig(np.array([1.0, 1e-9]), np.array([0.0, 1e-3])), 1e-8).cos.tolist()
    [1.0, 0.0]
    """
    cos, sin = (np.where(np.abs(part) > noise, part, 0.0) for part in (polynomial.cos, polynomial.sin))
    kept = (cos != 0.0) | (sin != 0.0)
    return Trig(harmonic=polynomial.harmonic[kept], cos=readonly(cos[kept]), sin=readonly(sin[kept]))


def harmonics(n_max: int, phi: Array | float) -> Array:
    """Interface functions h(phi) = (1, cos phi .. cos N phi, sin phi .. sin N phi), shape (..., 2N + 1)."""
    phases = np.multiply.outer(phi, np.arange(n_max + 1))
    return np.concatenate([np.cos(phases), np.sin(phases[..., 1:])], axis=-1)


def harmonics_by_powers(n_max: int, phi: Array) -> Array:
    """`harmonics` of many angles from powers of e^(i phi): three times as fast, with errors of n times round-off.

    The argument n phi of `harmonics` is rounded, so that its error grows with the angle; this one does not.

    >>> phi = np.random.default_rng(7).uniform(-np.pi, np.pi, 300)
    >>> apart = [np.abs(harmonics_by_powers(N, phi) - harmonics(N, phi)).max() for N in (0, 1, 2, 3, 8, 41, 200)]
    >>> bool(max(apart) < 1e-13)
    True
    """
    powers = np.empty((n_max + 1, phi.size), dtype=complex)
    powers[0] = 1.0
    if n_max:
        powers[1].real, powers[1].imag = np.cos(phi), np.sin(phi)
    made = 1
    while made < n_max:  # from the first `made` powers as many again
        more = min(made, n_max - made)
        np.multiply(powers[1 : more + 1], powers[made], out=powers[made + 1 : made + more + 1])
        made += more
    return np.concatenate([powers.real, powers[1:].imag]).T


def turned_back(waves: Array, by: Array) -> Array:
    """h(phi - by) from h(phi) for every angle `by`, (by, ..., 2N + 1), by the addition theorem.

    Faster than `harmonics`.

    >>> bool(np.allclose(turned_back(harmonics(2, 1.0), np.array([0.7])), harmonics(2, 0.3)))
    True
    """
    n_max = waves.shape[-1] // 2
    h = harmonics(n_max, by).reshape(by.shape + (1,) * (waves.ndim - 1) + (-1,))
    c, s = h[..., 1 : n_max + 1], h[..., n_max + 1 :]
    cos, sin = waves[..., 1 : n_max + 1], waves[..., n_max + 1 :]
    found = np.empty((*by.shape, *waves.shape))
    found[..., 0] = waves[..., 0]
    found[..., 1 : n_max + 1] = cos * c + sin * s
    found[..., n_max + 1 :] = sin * c - cos * s
    return found


def quadratic(block: Array, n_max: int) -> Trig:
    """h(phi)^T block h(phi) as a polynomial of degree 2N: sampled and transformed, exact to round-off.

    >>> quadratic(np.eye(3), 1)(0.3)
    2.0
    """
    points = 4 * n_max + 4
    angles = 2.0 * np.pi * np.arange(points) / points
    h = harmonics(n_max, angles)
    values = np.sum(h @ block * h, axis=1)
    spectrum = np.fft.rfft(values) / points
    cos, sin = 2.0 * spectrum.real[: 2 * n_max + 1], -2.0 * spectrum.imag[: 2 * n_max + 1]
    cos[0] /= 2.0
    noise = PRUNE * float(np.abs(block).max(initial=0.0))
    clean = np.maximum(np.abs(cos), np.abs(sin)) > noise
    return trig(np.where(clean, cos, 0.0), np.where(clean, sin, 0.0))


def fourier(terms: list[tuple[int, float, float]]) -> Trig:
    """Trigonometric polynomial from (harmonic, cos, sin) terms, repeated harmonics added."""
    top = max((p for p, _, _ in terms), default=0)
    cos, sin = np.zeros(top + 1), np.zeros(top + 1)
    for p, a, b in terms:
        cos[p] += a
        sin[p] += b
    return trig(cos, sin)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Terms:
    """Sum i = sum_j value[j] wave_{wave[j]}(phi), j = start[i] .. start[i + 1] - 1; zeros are left out.

    Wave 2 n is cos n phi, wave 2 n + 1 is sin n phi; a symmetric mode uses half of them.
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
        """The sum each term belongs to."""
        return np.repeat(np.arange(self.sums), np.diff(self.start))

    def equals(self, other: Terms) -> bool:
        """Whether these are the same sums, bit by bit."""
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in ("value", "wave", "start"))

    def first(self, sums: int) -> Terms:
        """The first sums, as many as given."""
        start = self.start[: sums + 1]
        return Terms(start=start, wave=self.wave[: start[-1]], value=self.value[: start[-1]])

    def followed_by(self, other: Terms) -> Terms:
        """These sums, then those of the other."""
        return Terms(
            start=np.concatenate([self.start[:-1], other.start + self.value.size]),
            wave=np.concatenate([self.wave, other.wave]), value=np.concatenate([self.value, other.value]),
        )  # fmt: skip

    def full(self, waves: int) -> Array:
        """Dense table (sums, waves)."""
        table = np.zeros((self.sums, waves))
        table[self.owner, self.wave] = self.value
        return table


def terms(owner: Indices, harmonic: Indices, cos: Array, sin: Array, sums: int) -> Terms:
    """Terms of sums by harmonics; entries are by `owner`, then by harmonic.

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
