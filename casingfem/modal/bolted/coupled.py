"""Harmonics of a casing coupled by its bolts: unknowns, stiffness of the bolts, and one group of coupled harmonics.

Bolts of the density p(theta) add the energy

    1/2 int p x^T D x dtheta,   x = sum_n Re(z_n e^(i n theta)),   P(k) = int p e^(i k theta) dtheta,

which couples n and m by P(n - m) and P(n + m): equal bolts evenly around only where their number divides n - m or
n + m.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eigh
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.bolted.condensed import Condensed, Interface, ShortWaves

COUPLED = 1e-12  # of a patch's mean: what couples two harmonics


class Dofs(NamedTuple):
    """Unknowns of coupled harmonics: n, motion of the edges or (from their number on) fixed mode, and the phase.

    The motion of an unknown y is Re(phase y e^(i n theta)) in each component that is in phase, Re(i phase y
    e^(i n theta)) in quadrature, and both are mass-normalised: phase is 1/sqrt(pi) or -i/sqrt(pi).
    """

    n: IntArray
    column: IntArray
    phase: Array

    def of(self, which: IntArray) -> "Dofs":
        """Some of them."""
        return Dofs(self.n[which], self.column[which], self.phase[which])


def dofs_of(n: int, columns: IntArray) -> Dofs:
    """The cosine and sine unknowns of the columns of a harmonic; at n = 0 each column once, in phase."""
    if n == 0:
        return Dofs(np.zeros(len(columns), dtype=int), columns, np.full(len(columns), 1.0 / np.sqrt(2.0 * np.pi) + 0j))
    phase = np.repeat([1.0, -1j], len(columns)) / np.sqrt(np.pi)
    return Dofs(np.full(2 * len(columns), n), np.tile(columns, 2), phase)


def joined(parts: Sequence[Dofs]) -> Dofs:
    """All unknowns in one list."""
    none = dofs_of(0, np.zeros(0, dtype=int))
    return Dofs(*(np.concatenate([part[k] for part in (none, *parts)]) for k in range(3)))


def placed(dofs: Dofs, blocks: Mapping[int, FloatArray]) -> FloatArray:
    """The matrix that couples unknowns of the same n and phase by the blocks of their harmonics."""
    total = np.zeros((len(dofs.n), len(dofs.n)))
    for n, block in blocks.items():
        own = np.flatnonzero(dofs.n == n)
        for member in (own[dofs.phase[own].imag == 0.0], own[dofs.phase[own].imag != 0.0]):
            if len(member):
                total[np.ix_(member, member)] = block
    return total


def waves_of(dofs: Dofs, amplitudes: FloatArray) -> dict[int, Array]:
    """Complex amplitudes of the columns of each harmonic from its cosine and sine unknowns."""
    waves = {}
    for n in np.unique(dofs.n).tolist():
        own = np.flatnonzero(dofs.n == n)
        wave = np.zeros(1 + dofs.column[own].max(), dtype=complex)
        np.add.at(wave, dofs.column[own], dofs.phase[own] * amplitudes[own])
        waves[n] = wave
    return waves


class Coupling(NamedTuple):
    """Bolts of a casing: stiffness of one on the motions of its edge, and P(k) for k up to twice the highest n."""

    interface: Interface
    stiffness: Sequence[FloatArray]
    spectra: Array

    def waves(self, dofs: Dofs) -> Array:
        """Complex amplitude of the motion of each unknown, which must be one of the edges."""
        hoop = np.where(dofs.n > 0, self.interface.hoop[dofs.column], 0)
        return np.asarray(dofs.phase * 1j**hoop)

    def matrix(self, dofs: Dofs) -> FloatArray:
        """Stiffness of all bolts on unknowns that are motions of the edges."""
        waves, edge, part = self.waves(dofs), self.interface.edge[dofs.column], self.interface.part[dofs.column]
        total = np.zeros((len(waves), len(waves)))
        for number, (D, spectrum) in enumerate(zip(self.stiffness, self.spectra, strict=True)):
            on = np.flatnonzero(edge == number)
            n, wave = dofs.n[on], waves[on]
            apart, shift = n[:, None] + n, n[:, None] - n
            difference = np.where(shift < 0, spectrum[np.abs(shift)].conj(), spectrum[np.abs(shift)])
            product = wave[:, None] * (wave.conj() * difference + wave * spectrum[apart])
            total[np.ix_(on, on)] = 0.5 * D[np.ix_(part[on], part[on])] * product.real
        return total

    def groups(self, highest: int) -> list[IntArray]:
        """Harmonics from 0 to `highest` that the bolts couple, each group by itself."""
        n = np.arange(highest + 1)
        size = np.abs(self.spectra) / np.abs(self.spectra[:, :1])
        tied = np.any((size[:, np.abs(n[:, None] - n)] > COUPLED) | (size[:, n[:, None] + n] > COUPLED), axis=0)
        number, group = connected_components(csr_array(tied), directed=False)
        return [np.flatnonzero(group == k) for k in range(number)]


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Coupled harmonics: long waves with their modes, and short ones that follow them statically.

    A motion has the unknowns y of long waves and z + F y of short ones, with the energy 1/2 y^T K y + 1/2 z^T k z. K
    and M (long, long) include what follows, `follow` is F (short, long), `short_K` and `short_M` (short, short) are k
    and the mass of the short waves.
    """

    long: Dofs
    short: Dofs
    K: FloatArray
    M: FloatArray
    follow: FloatArray
    short_K: FloatArray
    short_M: FloatArray

    @property
    def dofs(self) -> Dofs:
        """All unknowns, the long waves first."""
        return joined([self.long, self.short])

    def modes(self, most: float) -> tuple[FloatArray, FloatArray]:
        """Eigenvalues up to `most`, and vectors (long, modes)."""
        if not len(self.long.n):
            return np.zeros(0), np.zeros((0, 0))
        values, vectors = eigh(self.K, self.M, subset_by_value=(-np.inf, most))
        return values, vectors

    def waves(self, long: FloatArray, short: FloatArray) -> list[dict[int, Array]]:
        """Amplitudes n -> (columns,) of motions y (long, motions) and z (short, motions)."""
        dofs, columns = self.dofs, np.vstack([long, self.follow @ long + short])
        return [waves_of(dofs, column) for column in columns.T]


def group_of(group: IntArray, coupling: Coupling, long_waves: Sequence[Condensed], short_waves: ShortWaves) -> Group:
    """One group of harmonics that the bolts couple, after static condensation of its short waves."""
    edges = np.arange(len(coupling.interface.part))
    kept = [long_waves[n] for n in group.tolist() if n < len(long_waves)]
    long = joined([dofs_of(each.n, np.arange(len(each.K))) for each in kept])
    K, M = (placed(long, {each.n: getattr(each, name) for each in kept}) for name in "KM")
    moving = np.flatnonzero(long.column < len(edges))
    above = group[group >= len(long_waves)]
    short = joined([dofs_of(n, edges) for n in above.tolist()])
    at = above - short_waves.n[0]
    own, inert = (
        placed(short, dict(zip(above.tolist(), blocks[at], strict=True))) for blocks in (short_waves.K, short_waves.M)
    )
    bolted, split_at = coupling.matrix(joined([long.of(moving), short])), len(moving)
    K[np.ix_(moving, moving)] += bolted[:split_at, :split_at]
    follow = np.zeros((len(short.n), len(long.n)))
    if len(short.n):
        own = own + bolted[split_at:, split_at:]
        follow[:, moving] = -cho_solve(cho_factor(own), bolted[split_at:, :split_at])
        K[np.ix_(moving, moving)] += bolted[:split_at, split_at:] @ follow[:, moving]
        M += follow.T @ inert @ follow
    return Group(long, short, K, M, follow, own, inert)


def merged(parts: Sequence[Mapping[int, Array]]) -> dict[int, Array]:
    """One motion from those of groups that share no harmonic."""
    return reduce(lambda known, more: known | dict(more), parts, {})
