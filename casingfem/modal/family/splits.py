"""Modes, splits and orientations of many casings of one family, to third order in the imperfections.

Waves mix, so the wanted ones and some above them form one small matrix for each casing (`window`, `matrices`). Arrays
contain all casings of a lot.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.affine import AffineModes, modes_by_coordinates
from casingfem.modal.family.expansion import Expansion, expanded
from casingfem.modal.family.family import coefficients, is_family, perfect_shell, terms_of
from casingfem.modal.family.matrices import Solved, solved
from casingfem.modal.family.window import Window, derivatives_of, window_of
from casingfem.modal.harmonics import Rings, ring_weights
from casingfem.modal.modes import modes
from casingfem.structure.field.field import Field, SumField
from casingfem.structure.field.random import RandomField
from casingfem.structure.shell.shell import Shell
from contact.io.brief import brief

LOT = 128  # casings at once: their products fit into the cache
FEWEST = 12  # modes beyond those wanted, at least
OWN = 0.5  # of a mode's energy in wanted waves: below, terms of third order are missing
TURN = 2.0 * np.pi


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


class Near(NamedTuple):
    """The lowest modes of one casing, and their reliability.

    Attributes
    ----------
    modes
        Labelled; `fields` are left out.
    estimate
        Largest relative effect of the terms of third order on a frequency; the error is usually smaller.
    complete
        Whether all of them consist of wanted waves, and no mode outside the window can be below the last one.
    """

    modes: AffineModes
    estimate: float
    complete: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SplitMap:
    """Map from the Fourier series of a casing's imperfections to its modes and the splits of its pairs.

    Attributes
    ----------
    expansion : the waves of the perfect casing
    n, rank : nodal diameters and meridional rank (from 1) of the pairs, ascending by frequency, (pairs,)
    freq : frequencies of the perfect casing [Hz], (pairs,)
    window : matrices between the waves
    rings : circumferential content of the window's members
    rigid : number of rigid motions

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

    expansion: Expansion
    n: IntArray
    rank: IntArray
    freq: FloatArray
    window: Window
    rings: Rings
    rigid: int

    __repr__ = brief

    @classmethod
    def of(cls, shell: Shell, count: int, beyond: int | None = None) -> "SplitMap | None":
        """The map of a casing, for all values of its fields; None if the casing is of no family (`is_family`).

        Parameters
        ----------
        shell
            One of the casings. The quantities, highest harmonics and spectra of its fields are used.
        count
            The pairs are those that the lowest `count` modes of the perfect casing complete.
        beyond
            Number of modes above these that mix with them. By default a third of `count`, at least 12: as the number
            of modes goes with the square of frequency, they reach 15 % higher.
        """
        if not is_family(shell):
            return None
        bare = perfect_shell(shell)
        more = count + (beyond or max(FEWEST, count // 3))
        known = modes(bare, more)
        p_max = max(int(term.p.max()) for field in shell.defects.values() for term in terms_of(field) or ())
        n_max = int(known.nodal_diameters.max())
        own = expanded(bare, tuple(shell.defects), p_max, more, n_max, count)
        size = np.array([field_size(shell.defects[name], p_max) for name in own.quantities])
        order = np.lexsort((own.waves.n, np.abs(own.waves.n), own.waves.value))
        place = np.argsort(order)
        forth = order[own.waves.n[order] >= 0]
        back = np.array([opposite(own, wave) for wave in forth])
        wanted = int(np.count_nonzero(np.maximum(place[forth], place[back]) < count))
        window = window_of(own, derivatives_of(own), forth, back, size, wanted)
        pairs = window.pairs
        return cls(
            expansion=own,
            n=window.n[pairs],
            rank=own.waves.rank[forth[pairs]] + 1,
            freq=frequencies(window.value[pairs]),
            window=window,
            rings=content(own, window, bare),
            rigid=known.rigid,
        )

    def series(self, casings: "list[dict[str, Field]]") -> Array:
        """Series F of casings from their fields, (casings, l, 2 p_max + 1), p from -p_max to p_max."""
        own = self.expansion
        return np.array([[coefficients(fields[name], own.p_max) for name in own.quantities] for fields in casings])

    def splits(self, series: Array) -> Splits:
        """Pairs of casings with the series F (casings, l, 2 p_max + 1), p from -p_max to p_max."""
        lots = [splits_of(self.window, self.lot(series[first : first + LOT])) for first in range(0, len(series), LOT)]
        return Splits(*(np.concatenate(part) for part in zip(*lots, strict=True)))

    def near(self, series: Array, count: int) -> list[Near]:
        """The lowest `count` modes of each casing with the series F (casings, l, 2 p_max + 1)."""
        found = self.lot(series)
        bare, above = frequencies(np.sort(self.window.value[self.window.of])), frequencies(self.expansion.above)
        freq, elastic, wanted = frequencies(found.value), slice(self.rigid, count), self.window.of < self.window.own
        estimate = found.third[:, elastic].max(axis=1, initial=0.0)
        moved = np.abs(freq[:, elastic] / bare[elastic] - 1.0).max(axis=1, initial=0.0)
        own = np.sum(found.y[:, wanted, :count] ** 2, axis=1).min(axis=1)
        complete = (own > OWN) & (freq[:, count - 1] * (1.0 + moved) < (1.0 - moved) * above)
        return [
            Near(modes_by_coordinates(f[:count], z, self.rings, rigid=self.rigid), float(most), bool(whole))
            for f, z, most, whole in zip(freq, found.root @ found.y[..., :count], estimate, complete, strict=True)
        ]

    def lot(self, series: Array) -> Solved:
        """The matrices of some casings, solved."""
        return solved(self.window, np.ascontiguousarray(series.reshape(len(series), -1).T))


def splits_of(own: Window, found: Solved) -> Splits:
    """The wanted pairs of a window's casings."""
    pairs, y = own.pairs, found.y
    cosine, sine = (np.searchsorted(own.kept, first + pairs) for first in (0, len(own.n)))
    shares = y[:, cosine] ** 2 + y[:, sine] ** 2  # (casings, pairs, modes)
    both = np.sort(np.argsort(-shares, axis=-1, kind="stable")[..., :2], axis=-1)
    freq = frequencies(np.take_along_axis(found.value[:, None], both, axis=-1))
    lower = np.take_along_axis(y, both[:, None, :, 0], axis=2)
    at, n, mean = np.arange(len(pairs)), own.n[pairs], freq.mean(axis=-1)
    angle = np.degrees(np.arctan2(lower[:, sine, at], lower[:, cosine, at]) / n) % (180.0 / n)
    share = np.take_along_axis(shares, both, axis=-1).min(axis=-1)
    third = np.take_along_axis(found.third[:, None], both, axis=-1).max(axis=-1)
    return Splits(mean, (freq[..., 1] - freq[..., 0]) / mean, angle, share, third)


def content(own: Expansion, window: Window, shell: Shell) -> Rings:
    """Circumferential content of a window's members without their responses, as in `ring_content`."""
    n, motion = window.n[window.of], own.waves.motion[:, :3, window.waves[window.of]]
    sine = window.kept >= len(window.n)
    zero = np.where(sine, motion.imag, motion.real)
    member = np.where(n > 0, np.sqrt(2.0) * np.where(sine, -1j, 1.0) * motion, zero)
    amplitudes = np.zeros((int(n.max()) + 1, *member.shape), dtype=complex)
    amplitudes[n, :, :, np.arange(len(n))] = np.moveaxis(member, -1, 0)
    return Rings(amplitudes=amplitudes, weights=ring_weights(shell.mesh))


def frequencies(value: FloatArray | float) -> FloatArray:
    """Frequencies [Hz] from omega^2; 0 if round-off makes that of a rigid motion negative."""
    return np.asarray(np.sqrt(np.maximum(value, 0.0)) / TURN)


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
