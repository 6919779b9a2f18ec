"""Trigonometric polynomials of the contact angle: out-of-roundness and compliance at a moving point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, Indices, readonly

PRUNE = 1e-13  # of the largest value: below this a coefficient is round-off


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Trig:
    """p(phi) = sum_j cos[j] cos(harmonic[j] phi) + sin[j] sin(harmonic[j] phi); only terms that matter."""

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
    """The same without coefficients up to `noise`.

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


def turned_back(waves: Array, by: Array) -> Array:
    """h(phi - by) of h(phi) for every angle `by`, (by, ..., 2N + 1): by the addition theorem, quicker than `harmonics`.

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
