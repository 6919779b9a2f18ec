"""Modes of casings that differ from a perfect one by small imperfections.

Without a mesh around and without a large solution.

The perfect casing's lowest waves u_a, each with its first-order response (`expansion`), form the basis of a casing:

    v_a = u_a + sum_l sum_k F_l[k - n_a] X_(l,k,a)

In this basis the casing's own energies are integrated, exactly in the imperfection (`point_forms`), and the modes
minimise Rayleigh's quotient. So frequencies are upper bounds, with errors of fourth order. The expansion to second
order needs no integration and has errors of third order. The difference of the two exceeds the error of the better one.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

import numpy as np
from scipy.fft import ifft, next_fast_len
from scipy.linalg import eigh

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.affine import AffineModes, modes_by_coordinates
from casingfem.modal.family.expansion import Expansion, expanded
from casingfem.modal.family.point_forms import ORDERS, known_supports, point_forms
from casingfem.modal.harmonics import Rings, ring_weights
from casingfem.modal.modes import modes
from casingfem.structure.field.field import Field, SumField
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.field.random import RandomField
from casingfem.structure.mesh.jet_form import JET
from casingfem.structure.shell.shell import Shell
from contact.io.brief import brief

GUARD = 24  # waves beyond those wanted
TURN = 2.0 * np.pi


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Near:
    """Modes of one casing of a family, and their reliability.

    Attributes
    ----------
    modes : the lowest modes, labelled; `fields` are left out
    estimate : largest relative difference of a frequency between second order and Rayleigh's quotient
    complete : whether no mode outside the basis can be below the last one
    """

    modes: AffineModes
    estimate: float
    complete: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Family:
    """Casings that differ in the Fourier series of their fields.

    Attributes
    ----------
    expansion : matrices to second order, and first-order responses
    answers : responses of the waves with n >= 0, (l, ways, points 15, waves)
    rings : circumferential content of the waves: cosine members, then sine members
    rigid : number of rigid motions
    """

    expansion: Expansion
    answers: Array
    rings: Rings
    rigid: int

    __repr__ = brief

    @classmethod
    def of(cls, shell: Shell, count: int) -> "Family | None":
        """The family of a casing: all casings with other values of its fields; None if there is none (`is_family`).

        Parameters
        ----------
        shell
            One of the casings; the quantities and highest harmonics of its fields are used.
        count
            Number of modes that will be needed.
        """
        if not is_family(shell):
            return None
        bare = perfect_shell(shell)
        size = count + GUARD
        known = modes(bare, size)
        p_max = max(int(term.p.max()) for field in shell.defects.values() for term in terms_of(field) or ())
        n_max = int(known.nodal_diameters.max())
        expansion = expanded(bare, tuple(shell.defects), p_max, size, n_max, count)
        ahead = np.ascontiguousarray(expansion.answers[..., expansion.waves.n >= 0])
        return cls(expansion=expansion, answers=ahead, rings=content(expansion, bare), rigid=known.rigid)

    def near(self, defects: Mapping[str, Field], count: int) -> Near:
        """Lowest modes of the casing with these fields."""
        own = self.expansion
        series = np.array([coefficients(defects[name], own.p_max) for name in own.quantities])
        K, M = own.matrices(series)
        rough = frequencies(eigh(K, M, eigvals_only=True))
        values, y = eigh(*self.energies(series))
        freq, bare = frequencies(values), frequencies(np.sort(own.waves.value))
        elastic = slice(self.rigid, count)
        estimate = float(np.abs(rough[elastic] / freq[elastic] - 1.0).max(initial=0.0))
        moved = float(np.abs(freq[elastic] / bare[elastic] - 1.0).max(initial=0.0))
        complete = freq[count - 1] * (1.0 + moved) < (1.0 - moved) * frequencies(np.array([own.above]))[0]
        found = modes_by_coordinates(freq[:count], y[:, :count], self.rings, rigid=self.rigid)
        return Near(modes=found, estimate=estimate, complete=bool(complete))

    def energies(self, series: Array) -> tuple[FloatArray, FloatArray]:
        """Stiffness and mass of the casing with series F in its basis: cosine members, then sine members."""
        own = self.expansion
        angles = TURN * np.arange(self.angles) / self.angles
        jets = self.jets(series)
        p = np.arange(-own.p_max, own.p_max + 1)
        around = np.exp(1j * np.outer(angles, p))
        imperfection = {
            name: tuple((around @ (line * (1j * p) ** order)).real for order in range(ORDERS[name]))
            for name, line in zip(own.quantities, series, strict=True)
        }
        forms = point_forms(own.shell, imperfection, own.places)
        columns = jets.shape[-1]
        sums = []
        for form in forms:
            part = np.ascontiguousarray(jets[:, :, : form.shape[-1]])
            product = part.reshape(-1, columns).T @ np.matmul(form, part).reshape(-1, columns)
            sums.append(TURN / self.angles * 0.5 * (product + product.T))
        return sums[0], sums[1]

    @property
    def angles(self) -> int:
        """Angles for integrals around, exact for products of two motions and a field with the highest harmonics."""
        own = self.expansion
        return int(next_fast_len(2 * int(own.k.max()) + own.p_max + 1))

    def jets(self, series: Array) -> FloatArray:
        """Jets of the basis at all angles and points, (angles, points, 15, waves)."""
        own = self.expansion
        forth = np.flatnonzero(own.waves.n >= 0)
        n = own.waves.n[forth]
        step = own.k[:, None] - n
        waves = reduce(np.add, (own.at(line, step)[:, None] * X for line, X in zip(series, self.answers, strict=True)))
        waves[np.searchsorted(own.k, n), :, np.arange(len(n))] += own.waves.jets[:, forth].T
        around = np.zeros((self.angles, waves[0].size), dtype=complex)
        around[own.k % self.angles] = waves.reshape(len(own.k), -1)
        motion = ifft(around, axis=0, norm="forward", overwrite_x=True)
        return members(motion.reshape(self.angles, -1, JET, len(n)), n)


def members(waves: Array, n: IntArray) -> FloatArray:
    """Cosine members of waves (..., waves), then sine members of those with n > 0.

    A wave with n = 0 is real or, for torsion, imaginary; its single member is the sum of both parts.
    """
    paired = np.flatnonzero(n > 0)
    found = np.empty((*waves.shape[:-1], len(n) + len(paired)))
    np.multiply(waves.real, np.where(n > 0, np.sqrt(2.0), 1.0), out=found[..., : len(n)])
    found[..., np.flatnonzero(n == 0)] += waves.imag[..., n == 0]
    np.multiply(waves.imag[..., paired], np.sqrt(2.0), out=found[..., len(n) :])
    return found


def content(expansion: Expansion, shell: Shell) -> Rings:
    """Circumferential content of the basis without its responses, as in `ring_content`."""
    waves = expansion.waves
    forth = np.flatnonzero(waves.n >= 0)
    n, motion = waves.n[forth], waves.motion[:, :3, forth]
    cosine = np.where(n > 0, np.sqrt(2.0) * motion, motion.real + motion.imag)
    both = np.concatenate([cosine, -1j * np.sqrt(2.0) * motion[..., n > 0]], axis=-1)
    number = np.concatenate([n, n[n > 0]])
    amplitudes = np.zeros((int(n.max()) + 1, *both.shape), dtype=complex)
    amplitudes[number, :, :, np.arange(len(number))] = np.moveaxis(both, -1, 0)
    return Rings(amplitudes=amplitudes, weights=ring_weights(shell.mesh))


def frequencies(value: FloatArray) -> FloatArray:
    """Frequencies [Hz] from omega^2; 0 if round-off makes that of a rigid motion negative."""
    return np.sqrt(np.maximum(value, 0.0)) / TURN


def perfect_shell(shell: Shell) -> Shell:
    """The shell without any field, on the same mesh."""
    fields: dict[str, Any] = {f"{name}_defect": None for name in shell.defects}
    return replace(shell, **fields)


def is_family(shell: Shell) -> bool:
    """Whether a casing is perfect except for Fourier series around, with free, clamped or embedded edges."""
    even = all(terms_of(field) is not None for field in shell.defects.values())
    return bool(shell.defects) and even and perfect_shell(shell).axisymmetric and known_supports(shell)


def terms_of(field: Field) -> list[FourierField] | None:
    """The Fourier series whose sum is a field; None if a part is no series or varies along the axis."""
    if isinstance(field, RandomField):
        return [field.fit]
    if isinstance(field, SumField):
        parts = [terms_of(each) for each in field.fields]
        return None if None in parts else [term for part in parts for term in part or ()]
    if isinstance(field, FourierField) and field.cos.shape[1] == 1 and field.spline is None and field.reach is None:
        return [field]
    return None


def coefficients(field: Field, p_max: int) -> Array:
    """F of f = sum_p F[p] e^(i p theta), p from -p_max to p_max: (2 p_max + 1,).

    >>> coefficients(FourierField.of({2: (0.4, 0.2)}), 2).tolist()
    [(0.2+0.1j), 0j, 0j, 0j, (0.2-0.1j)]
    """
    series = np.zeros(2 * p_max + 1, dtype=complex)
    for term in terms_of(field) or ():
        half = 0.5 * (term.cos[:, 0] - 1j * term.sin[:, 0])
        np.add.at(series, p_max + term.p, half)
        np.add.at(series, p_max - term.p, half.conj())
    return series
