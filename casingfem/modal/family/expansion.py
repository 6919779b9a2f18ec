"""The lowest modes of imperfect casings to second order in the imperfections.

With the fields f_l = sum_p F_l[p] e^(i p theta), with p of both signs, first order couples a wave a of n_a nodal
diameters with b only through p = n_b - n_a. Second order couples them through each intermediate k: p = k - n_a, then q
= n_b - k. On the lowest waves

    K_ba = w_a^2 d_ba + F_l[n_b - n_a] K_1[l, b, a] + sum_k F_l[k - n_a] F_m[n_b - k] K_2[k, l, m, b, a],

M alike. K_2 contains the second derivative of the strain energy and the response of the waves j outside
(quasi-degenerate perturbation theory: P.-O. Lowdin, J. Math. Phys. 3, 1962, 969),

    -r_jb r_ja (1/(w_j^2 - w_a^2) + 1/(w_j^2 - w_b^2))/2,   r_ja = K_1[l, j, a] - w_a^2 M_1[l, j, a].

In r and in the denominators, w_a of a wave above those wanted is the highest w wanted.

These responses, X_a = -sum_k sum_j r_ja/(w_j^2 - w_a^2) u_j, are stored by k: with them a casing's own energies are
accurate to third order (`family`). All numbers K_1, K_2 are real, since a perfect casing is symmetric under reflection.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.family.point_forms import (
    Forms,
    Places,
    Slot,
    first_derivatives,
    places_of,
    second_derivatives,
    slots_of,
)
from casingfem.modal.family.waves import Waves, waves_of
from casingfem.structure.mesh.jet_form import JET
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.shell import Shell, remade
from contact.io.brief import brief

TURN = 2.0 * np.pi


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Expansion:
    """K and M of the lowest waves of a casing to second order in its imperfections.

    Attributes
    ----------
    shell : the perfect casing
    quantities : the fields' quantities l
    p_max : highest harmonic of the fields
    places : points of the meridian
    waves : the lowest waves a, with those of +-n together
    about : omega^2 at which the response of each wave is computed, its own or the highest wanted one, (a,)
    above : the lowest omitted omega^2
    k : intermediate harmonics, (ways,)
    K_1, M_1 : (l, b, a)
    K_2, M_2 : (ways, l, m, b, a)
    answers : jets of the response to wave a through k, (l, ways, points 15, a)
    """

    shell: ShellParts
    quantities: tuple[str, ...]
    p_max: int
    places: Places
    waves: Waves
    about: FloatArray
    above: float
    k: IntArray
    K_1: FloatArray
    M_1: FloatArray
    K_2: FloatArray
    M_2: FloatArray
    answers: Array

    __repr__ = brief

    def matrices(self, series: Array) -> tuple[Array, Array]:
        """Hermitian K and M of the lowest waves, for series F (l, 2 p_max + 1) from -p_max to p_max."""
        n, count = self.waves.n, range(len(self.quantities))
        ahead = np.flatnonzero(n >= 0)  # a casing is real: K[-b, -a] is the conjugate of K[b, a]
        step = n[ahead, None] - n
        first, then = self.k[:, None] - n, n[ahead] - self.k[:, None]  # to each way from a; from it to b
        K, M = (np.array(part[ahead], dtype=complex) for part in (np.diag(self.waves.value), np.eye(len(n))))
        to, back = ([self.at(line, way) for line in series] for way in (first, then))
        for line in count:
            direct = self.at(series[line], step)
            K += direct * self.K_1[line, ahead]
            M += direct * self.M_1[line, ahead]
            for other in count:
                both = back[other][:, :, None] * to[line][:, None]
                for whole, part in ((K, self.K_2), (M, self.M_2)):
                    own = part[:, line, other, ahead]
                    whole.real += np.einsum("kba,kba->ba", both.real, own)
                    whole.imag += np.einsum("kba,kba->ba", both.imag, own)
        return self.whole(K, ahead), self.whole(M, ahead)

    def whole(self, rows: Array, ahead: IntArray) -> Array:
        """A Hermitian matrix from its rows of waves with n >= 0."""
        waves = self.waves
        back = [
            int(np.flatnonzero((waves.n == -m) & (waves.rank == r))[0])
            for m, r in zip(waves.n, waves.rank, strict=True)
        ]
        found = np.empty((len(waves.n),) * 2, dtype=complex)
        found[np.array(back)[ahead]] = rows[:, back].conj()
        found[ahead] = rows
        return np.asarray(0.5 * (found + found.conj().T))

    def at(self, line: Array, p: IntArray) -> Array:
        """Coefficients of one field at harmonics p, 0 beyond the highest."""
        return np.where(np.abs(p) <= self.p_max, line[np.clip(p + self.p_max, 0, 2 * self.p_max)], 0.0)


def lowest(waves: Waves, count: int) -> tuple[IntArray, float]:
    """The `count` lowest waves or a few more, with +-n together, and the lowest omitted value."""
    order = np.lexsort((waves.n, waves.rank, np.abs(waves.n), waves.value))
    same = (np.diff(np.abs(waves.n[order])) == 0) & (np.diff(waves.rank[order]) == 0)  # as the one before
    count += int(same[count - 1])
    return order[:count], float(waves.value[order[count]])


def expanded(shell: Shell, quantities: tuple[str, ...], p_max: int, count: int, n_max: int, wanted: int) -> Expansion:
    """The expansion of a perfect casing's `count` lowest waves, with n_max nodal diameters at most.

    Waves above the `wanted` lowest ones only mix with those, so their response is computed at the highest wanted
    frequency.
    """
    bare, places, slots = remade(ShellParts, shell), places_of(shell), slots_of(quantities)
    waves = waves_of(shell, n_max + p_max, places)
    chosen, above = lowest(waves, count)
    low = waves.chosen(chosen)
    about = np.minimum(low.value, np.sort(low.value)[wanted - 1])
    first = first_derivatives(bare, quantities, places, np.zeros(len(slots)))
    K_1, M_1 = first_order(waves, low, slots, first, quantities)
    reach = np.abs(waves.n[:, None] - low.n) <= p_max
    r = (K_1 - about * M_1) * reach
    outside = np.ones(len(waves.n), dtype=bool)
    outside[chosen] = False
    W = np.where(outside[:, None], r / np.where(outside[:, None], waves.value[:, None] - about, 1.0), 0.0)
    k = np.arange(-n_max - p_max, n_max + p_max + 1)
    K_2, M_2 = second_order(low, k, slots, second_derivatives(bare, quantities, places), quantities)
    answers = np.empty((len(quantities), len(k), len(waves.jets), len(low.n)), dtype=complex)
    for way, number in enumerate(k):
        own = waves.n == number
        for line in range(len(quantities)):
            answers[line, way] = -waves.jets[:, own] @ W[line][own]
            for other in range(len(quantities)):
                K_2[way, line, other] -= 0.5 * (r[other][own].T @ W[line][own] + W[other][own].T @ r[line][own])
    return Expansion(
        shell=bare,
        quantities=quantities,
        p_max=p_max,
        places=places,
        waves=low,
        about=about,
        above=above,
        k=k,
        K_1=K_1[:, chosen],
        M_1=M_1[:, chosen],
        K_2=K_2,
        M_2=M_2,
        answers=answers,
    )


def first_order(
    left: Waves, right: Waves, slots: tuple[Slot, ...], forms: list[Forms], quantities: tuple[str, ...]
) -> tuple[FloatArray, FloatArray]:
    """K_1 and M_1 of each quantity between two sets of waves, (l, left, right)."""
    p = left.n[:, None] - right.n
    K_1, M_1 = np.zeros((2, len(quantities), *p.shape))
    for slot, form in zip(slots, forms, strict=True):
        line, factor = quantities.index(slot.quantity), (1j * p) ** slot.order
        stiffness, mass = between(left, form, right)
        K_1[line] += (factor * stiffness).real
        M_1[line] += (factor * mass).real
    return K_1, M_1


def second_order(
    low: Waves, k: IntArray, slots: tuple[Slot, ...], forms: dict[tuple[int, int], Forms], quantities: tuple[str, ...]
) -> tuple[FloatArray, FloatArray]:
    """Half the second derivatives between the lowest waves through each k, (ways, l, m, b, a)."""
    shape = (len(k), len(quantities), len(quantities), len(low.n), len(low.n))
    K_2, M_2 = np.zeros(shape), np.zeros(shape)
    first, then = (k[:, None] - low.n)[:, None, :], (low.n - k[:, None])[:, :, None]
    for (one, two), form in forms.items():
        factor = 0.5 * (1j * first) ** slots[one].order * (1j * then) ** slots[two].order
        line, other = (quantities.index(slots[each].quantity) for each in (one, two))
        stiffness, mass = between(low, form, low)
        K_2[:, line, other] += (factor * stiffness).real
        M_2[:, line, other] += (factor * mass).real
    return K_2, M_2


class Motions(Protocol):
    """Motions u with their derivatives at the points."""

    @property
    def jets(self) -> Array:
        """(u, d_z u, d_theta u) at the points, (points 15, columns)."""


def between(left: Motions, form: Forms, right: Motions) -> tuple[Array, Array]:
    """left^H form right, integrated around the circumference, for stiffness and mass, each (left, right)."""
    points = len(form.stiffness)
    sums = []
    for matrix in form:
        size = matrix.shape[-1]
        one, two = (side.jets.reshape(points, JET, -1)[:, :size] for side in (left, right))
        pushed = np.matmul(matrix, two).reshape(points * size, -1)
        sums.append(TURN * (one.reshape(points * size, -1).conj().T @ pushed))
    return sums[0], sums[1]
