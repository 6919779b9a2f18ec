"""The lowest waves of a perfect casing and their response to imperfections, to first order.

With the fields f_l = sum_p F_l[p] e^(i p theta), p of both signs, first order couples a wave a of n_a nodal diameters
with b only through p = n_b - n_a: K_ba = w_a^2 d_ba + F_l[n_b - n_a] K_1[l, b, a], M alike. The response of the waves j
outside to wave a through the intermediate harmonic k = n_j is

    X_a = -sum_j r_ja/(w_j^2 - w_a^2) u_j,   r_ja = K_1[l, j, a] - w_a^2 M_1[l, j, a]

times F_l[k - n_a]. In r and in the denominators, w_a of a wave above those wanted is the highest w wanted. All numbers
are real, since a perfect casing is symmetric under reflection. `window` continues to third order.
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
    """The lowest waves of a perfect casing and their responses.

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
    answers: Array

    __repr__ = brief


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
    answers = np.empty((len(quantities), len(k), len(waves.jets), len(low.n)), dtype=complex)
    for way, number in enumerate(k):
        own = waves.n == number
        for line in range(len(quantities)):
            answers[line, way] = -waves.jets[:, own] @ W[line][own]
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
