"""Splits and orientations of the pairs of many casings of one family at once, to third order in the imperfections.

Pairs mix, so the wanted pairs and some above them form one small matrix for each casing (`window`). A casing's motion
is real, so K[-b, -a] is the conjugate of K[b, a], and the matrices on cosine and sine members are real. Arrays contain
all casings of a lot; there is no loop over casings.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.family.expansion import Expansion
from casingfem.modal.family.family import Family, coefficients, frequencies, terms_of
from casingfem.modal.family.window import Window, derivatives_of, window_of
from casingfem.structure.field.field import Field, SumField
from casingfem.structure.field.random import RandomField
from casingfem.structure.shell.shell import Shell
from contact.io.brief import brief

LOT = 128  # casings at once: their products fit into the cache


class Splits(NamedTuple):
    """Pairs of many casings, (casings, pairs).

    Attributes
    ----------
    freq
        Mean of the two frequencies [Hz].
    split
        (f_upper - f_lower)/mean.
    angle_deg
        Angle of an antinode of the lower member, from 0 to 180/n.
    share
        Energy share of the pair's waves in the two modes. If two pairs mix it is low, and the pair is not meaningful.
    third
        Relative effect of the third-order terms on the frequencies of the pair, the larger of both.
    """

    freq: FloatArray
    split: FloatArray
    angle_deg: FloatArray
    share: FloatArray
    third: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SplitMap:
    """Map from the Fourier series of a casing's imperfections to the splits of its pairs.

    Attributes
    ----------
    family : the casings
    n, rank : nodal diameters and meridional rank (from 1) of the pairs, ascending by frequency, (pairs,)
    freq : frequencies of the perfect casing [Hz], (pairs,)
    window : matrices between them and the pairs above them

    Examples
    --------
    >>> import casingfem as cf
    >>> lab = cf.field.RandomField.example(thickness=0.01, radius=0.5, seed=7, scale=0.1, p_max=8)
    >>> tube = cf.Shell(chart=cf.Cylinder(radius=0.5, height=0.3), thickness=0.01, supports={"base": cf.Clamped()},
    ...                 material=cf.Material(E=210e9, nu=0.3, rho=7800.0), radius_defect=lab,
    ...                 mesh=cf.ShellMesh(order=5, rows=1, around=9))
    >>> pairs = cf.modal.SplitMap.of(tube, 8)
    >>> pairs.n.tolist(), pairs.splits(pairs.series([{"radius": lab.redrawn(k)} for k in range(3)])).split.shape
    ([5, 6, 4, 7], (3, 4))
    """

    family: Family
    n: IntArray
    rank: IntArray
    freq: FloatArray
    window: Window

    __repr__ = brief

    @classmethod
    def of(cls, shell: Shell, count: int) -> "SplitMap | None":
        """The map of a casing, for all values of its fields; None if there is no family.

        Parameters
        ----------
        shell
            One of the casings. The quantities, highest harmonics and spectra of its fields are used.
        count
            The pairs are those that the lowest `count` modes of the perfect casing complete.
        """
        family = Family.of(shell, count)
        if family is None:
            return None
        own = family.expansion
        size = np.array([field_size(shell.defects[name], own.p_max) for name in own.quantities])
        order = np.lexsort((own.waves.n, np.abs(own.waves.n), own.waves.value))
        place = np.argsort(order)
        forth = order[own.waves.n[order] > 0]
        back = np.array([opposite(own, wave) for wave in forth])
        wanted = int(np.count_nonzero(np.maximum(place[forth], place[back]) < count))
        freq = frequencies(own.waves.value[forth[:wanted]])
        window = window_of(own, derivatives_of(own), forth, back, size, wanted)
        n, rank = own.waves.n[forth[:wanted]], own.waves.rank[forth[:wanted]] + 1
        return cls(family=family, n=n, rank=rank, freq=freq, window=window)

    def series(self, casings: "list[dict[str, Field]]") -> Array:
        """Series F of casings from their fields, (casings, l, 2 p_max + 1), p from -p_max to p_max."""
        own = self.family.expansion
        return np.array([[coefficients(fields[name], own.p_max) for name in own.quantities] for fields in casings])

    def splits(self, series: Array) -> Splits:
        """Pairs of casings with the series F (casings, l, 2 p_max + 1), p from -p_max to p_max."""
        lots = [self.lot(series[first : first + LOT]) for first in range(0, len(series), LOT)]
        return Splits(*(np.concatenate(part) for part in zip(*lots, strict=True)))

    def lot(self, series: Array) -> Splits:
        """Pairs of some casings."""
        return answered(self.window, np.ascontiguousarray(series.reshape(len(series), -1).T))


def answered(own: Window, x: Array) -> Splits:
    """The wanted pairs of a window, for casings with coefficients x (l (2 p_max + 1), casings)."""
    whole, last = matrices(own, x)
    value, y = np.linalg.eigh(whole)
    pairs, at = len(own.n), np.arange(own.own)
    shares = (y[:, :pairs] ** 2 + y[:, pairs:] ** 2)[:, : own.own]  # (casings, pairs, modes)
    both = np.sort(np.argsort(-shares, axis=-1, kind="stable")[..., :2], axis=-1)
    freq = frequencies(np.take_along_axis(value[:, None], both, axis=-1))
    lower = np.take_along_axis(y, both[:, None, :, 0], axis=2)
    cosine, sine = lower[:, at, at], lower[:, pairs + at, at]
    n, mean = own.n[: own.own], freq.mean(axis=-1)
    angle = np.degrees(np.arctan2(sine, cosine) / n) % (180.0 / n)
    share = np.take_along_axis(shares, both, axis=-1).min(axis=-1)
    added = np.abs(np.sum(y * (last @ y), axis=1)) / np.maximum(value, np.finfo(float).tiny)
    third = 0.5 * np.take_along_axis(added[:, None], both, axis=-1).max(axis=-1)
    return Splits(mean, (freq[..., 1] - freq[..., 0]) / mean, angle, share, third)


def matrices(own: Window, x: Array) -> tuple[FloatArray, FloatArray]:
    """K of a window after reduction of the mass to 1, and its third-order part, (casings, 2 pairs, 2 pairs).

    Cosine members come before sine members.
    """
    pairs, cases = len(own.n), x.shape[1]
    parts = np.zeros((3, cases, 2, pairs, pairs), dtype=complex)  # K to second order, M, third order
    for each in own.between:
        *low, last = (power.sums(x).reshape(2, len(each.b), cases) for power in each.powers)
        for part, sums in zip(parts, (*np.add.reduce(low), last[0]), strict=True):
            part[:, each.sense, each.a, each.b] = np.where(each.sense, sums.T, sums.T.conj())
            part[:, each.sense, each.b, each.a] = sums.T
    stiffness, E, last = map(real_form, parts)
    both, one = np.arange(2 * pairs), np.eye(2 * pairs)
    stiffness += last
    stiffness[:, both, both] += np.tile(own.value, 2)
    root = one - E @ (0.5 * one - E @ (0.375 * one - 0.3125 * E))  # (1 + E)^(-1/2)
    return np.asarray(root @ stiffness @ root), last


def real_form(waves: Array) -> FloatArray:
    """Symmetric matrices on cosine and sine members, from those between waves (casings, sense, b, a)."""
    full, turned = waves[:, 0], waves[:, 1]
    top = np.concatenate([full.real + turned.real, full.imag - turned.imag], axis=2)
    bottom = np.concatenate([-full.imag - turned.imag, full.real - turned.real], axis=2)
    return np.concatenate([top, bottom], axis=1)


def opposite(own: Expansion, wave: int) -> int:
    """The wave that travels in the opposite direction."""
    return int(np.flatnonzero((own.waves.n == -own.waves.n[wave]) & (own.waves.rank == own.waves.rank[wave]))[0])


def field_size(field: Field, p_max: int) -> FloatArray:
    """Root mean square of the coefficients F[p] of a field over its draws, (2 p_max + 1,)."""
    parts = field.fields if isinstance(field, SumField) else (field,)
    square = np.zeros(2 * p_max + 1)
    for part in parts:
        if isinstance(part, SumField):
            square += field_size(part, p_max) ** 2
        elif isinstance(part, RandomField):
            size = 0.5 * part.spectrum.rms
            np.add.at(square, p_max + part.spectrum.p, size**2)
            np.add.at(square, p_max - part.spectrum.p, size**2)
        elif terms_of(part) is not None:
            square += np.abs(coefficients(part, p_max)) ** 2
    return np.sqrt(square)
