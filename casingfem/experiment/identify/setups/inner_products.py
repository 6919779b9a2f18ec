"""Inner products over the lines, of the resonances of all set-ups with each other and with the data.

With c = 1/(w^2 - x^2 + 2 j zeta w x) the resonance of a pole and its slopes by ln f and ln zeta are sums of three terms

    t_1 = (jx)^q c, t_2 = t_1 c, t_3 = x t_2:   g = w^2 t_1,   2 g - 2 w^4 t_2 + h,   h = -2 j zeta w^3 t_3,

so the products of t_1, t_2, t_3 are all that lines are needed for. They are formed for a few set-ups at a time: arrays
that leave the cache, and are given back to the system after each step, cost several times what is computed in them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.poles.pole_window import HANN, Window
from casingfem.io.arrays import Array, FloatArray, IntArray

AT_ONCE = 8_000  # resonances times lines


class Problem(NamedTuple):
    """Data (setups, lines, most channels of one) across the polynomials' basis (lines, terms); 0 where none is.

    The basis is orthonormal: as complex columns are where residues are complex, elsewhere as real ones are, real parts
    over imaginary ones. `power` has each entry's share of the power, `squares` (setups,) that of each set-up; `ridge`
    (modes x columns,) as in `own_shifts.linked`.
    """

    window: Window
    setups: Sequence[IntArray]
    basis: Array
    data: Array
    power: FloatArray
    squares: FloatArray
    ridge: FloatArray = np.zeros(1)

    @classmethod
    def of(cls, window: Window, setups: Sequence[IntArray]) -> Problem:
        """Of a window and its set-ups."""
        half, Q = len(window.freq), np.linalg.qr(window.residuals())[0]
        left = window.Y - Q @ (Q.T @ window.Y)
        rest, basis = left[:half] + 1j * left[half:], Q[:half] + 1j * Q[half:]
        if window.columns == 2:
            basis = np.linalg.qr(basis[:, ::2])[0]  # each polynomial, without j times it
        data = np.zeros((len(setups), half, max(len(channels) for channels in setups)), complex)
        for one, channels in zip(data, setups, strict=True):
            one[:, : len(channels)] = rest[:, channels]
        power = data.real**2 + data.imag**2
        squares = np.asarray(power.sum(axis=(1, 2)))
        return cls(window, setups, basis, data, power / max(squares.sum(), 1e-300), squares)

    def some(self, which: IntArray) -> Problem:
        """Some of the set-ups."""
        if len(which) == len(self.setups):
            return self
        setups = [self.setups[k] for k in which]
        return self._replace(setups=setups, data=self.data[which], power=self.power[which], squares=self.squares[which])

    def products(self, p: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Inner products of resonances, slopes by ln f, then by ln zeta, with each other, and with the data.

        Polynomials are taken off; set-ups come first; p, q are ln f and ln zeta (modes, setups).
        """
        m, s, lines, unitary = len(p), self.window.columns, _Lines.of(self.window), self.basis.conj().T
        w, zeta, many = np.exp(p.T) / self.window.scale, np.exp(q.T), len(self.setups)
        own, inside = np.empty((many, 3 * m, 3 * m), complex), np.empty((many, len(unitary), 3 * m), complex)
        by_data = np.empty((many, 3 * m, self.data.shape[2]), complex)
        for some in self._parts(m):
            terms = lines.terms(w[some], zeta[some], 3).reshape(-1, 3 * m, len(self.window.freq))
            left, right = terms.conj(), terms.swapaxes(1, 2)
            np.matmul(left, right, out=own[some])
            np.matmul(unitary, right, out=inside[some])
            np.matmul(left, self.data[some], out=by_data[some])
        turn = _turn(w, zeta)
        back = turn.conj().swapaxes(1, 2)
        held = self._held(inside @ turn)
        products = _parts(_turned(back @ own @ turn - held.conj().swapaxes(1, 2) @ held, s), s)
        return products, np.asarray(_turned(back @ by_data, s).real)

    def on_peaks(self, p: FloatArray, q: FloatArray, residues: FloatArray) -> float:
        """Variance of an entry that is left where the data are high."""
        m, s, lines, whole = len(p), self.window.columns, _Lines.of(self.window), 0.0
        for some in self._parts(m):
            w, zeta = np.exp(p.T[some]) / self.window.scale, np.exp(q.T[some])
            A = residues[some].reshape(len(w), m, s, -1)
            factor = A[:, :, 0] + (1j * A[:, :, 1] if s == 2 else 0.0)
            g = (lines.terms(w, zeta, 1)[:, 0] * (w**2)[:, :, None]).swapaxes(1, 2)
            left = self.data[some] - g @ factor + self.basis @ (self._held(self.basis.conj().T @ g) @ factor)
            whole += float(np.sum((left.real**2 + left.imag**2) * self.power[some]))
        return 0.5 * whole

    def _held(self, products: Array) -> Array:
        """What of some columns the basis holds, from their products with it."""
        return products if self.window.columns == 2 else np.asarray(products.real)

    def _parts(self, modes: int) -> Iterator[slice]:
        """So many set-ups at a time that their terms stay in the cache."""
        count = max(1, AT_ONCE // max(modes * len(self.window.freq), 1))
        yield from (slice(k, k + count) for k in range(0, len(self.setups), count))


class _Lines(NamedTuple):
    """Places x over the mean frequency (places,), and (jx)^q there, times the share of a leaking line's own place.

    The shares of a leak are `apart` by so many places, of which there are as `many` each as lines; `along` (lines,) is
    what these weigh, None where all weigh 1.
    """

    x: FloatArray
    factor: Array
    many: int
    apart: int
    along: FloatArray | None

    @classmethod
    def of(cls, window: Window) -> _Lines:
        x, apart = window.places()
        along = None if np.all(window.along == 1.0) else window.along
        factor = (1j * x) ** window.power * (HANN[1][1] if apart else 1.0)
        return cls(x, factor, len(window.freq), apart, along)

    def terms(self, w: FloatArray, zeta: FloatArray, first: int) -> Array:
        """The `first` so many of the three terms as the lines show them, (setups, terms, modes, lines)."""
        x, w, zeta = self.x, w[:, :, None], zeta[:, :, None]
        below, aside = w**2 - x**2, (-2.0 * zeta * w) * x
        size = below * below
        size += aside * aside
        c = np.empty(size.shape, complex)
        np.divide(below, size, out=c.real)
        np.divide(aside, size, out=c.imag)
        terms = np.empty((len(w), first, *c.shape[1:]), complex)
        np.multiply(c, self.factor, out=terms[:, 0])
        if first > 1:
            np.multiply(terms[:, 0], c, out=terms[:, 1])
            np.multiply(terms[:, 1], x, out=terms[:, 2])
        if self.apart:
            beside = terms[..., : self.many] + terms[..., 2 * self.apart :]
            beside *= HANN[0][1] / HANN[1][1]
            beside += terms[..., self.apart : self.apart + self.many]
            terms = beside
        if self.along is not None:
            terms *= self.along
        return terms


def _turn(w: FloatArray, zeta: FloatArray) -> Array:
    """What the three terms (rows) are multiplied by to be resonances and slopes (columns), of each set-up."""
    many, m = w.shape
    turn, each = np.zeros((many, 3, m, 3, m), complex), np.arange(m)
    turn[:, 0, each, 0, each] = w**2
    turn[:, 0, each, 1, each] = 2.0 * w**2
    turn[:, 1, each, 1, each] = -2.0 * w**4
    turn[:, 2, each, 1, each] = turn[:, 2, each, 2, each] = -2j * zeta * w**3
    return turn.reshape(many, 3 * m, 3 * m)


def _parts(product: Array, s: int) -> FloatArray:
    """Real inner products, from complex ones: with the right vectors and, for s = 2, j times them beside each."""
    both = np.stack([product.real, -product.imag][:s], axis=-1)
    return both.reshape(*product.shape[:-1], -1)


def _turned(product: Array, s: int) -> Array:
    """Complex inner products, those of j times each left vector below them for s = 2."""
    both = np.stack([product, -1j * product][:s], axis=2)
    return both.reshape(len(product), -1, product.shape[2])
