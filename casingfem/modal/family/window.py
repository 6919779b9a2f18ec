"""Pairs of a family's casings with close frequencies: their stiffness and mass to third order in the imperfections.

Trial motions are the waves u_a with their first-order response, v_a = u_a + sum_k F_l[k - n_a] X_(l,k,a)
(`expansion`). With D = K - w^2 M of a casing, the terms of v_b^H D v_a by powers of F are

    1  <u_b|D_1|u_a>
    2  <u_b|D_2|u_a> + <u_b|D_1|X_a> + <X_b|D_1|u_a> + <X_b|D_0|X_a>
    3  <u_b|D_3|u_a> + <u_b|D_2|X_a> + <X_b|D_2|u_a> + <X_b|D_1|X_a>

each a sum over the intermediate harmonics between a and b. K and M have separate terms of the first and second power.
In the third power w^2 is the mean of both waves. The minimum of Rayleigh's quotient is then accurate to third order.
"""

from dataclasses import dataclass
from itertools import product
from typing import NamedTuple, TypeAlias

import numpy as np

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.family.expansion import Expansion, between, second_order
from casingfem.modal.family.monomials import Monomials, collected
from casingfem.modal.family.point_forms import (
    Forms,
    Slot,
    first_derivatives,
    forms_at,
    second_derivatives,
    slots_of,
    third_derivatives,
)
from casingfem.modal.family.waves import Waves
from casingfem.structure.mesh.jet_form import JET
from casingfem.structure.shell.axisymmetric import HOOP

PHASE = np.concatenate([HOOP, HOOP, 1j * HOOP])  # of the components of a jet
Two: TypeAlias = tuple[Array, Array]  # of stiffness and of mass


class Columns(NamedTuple):
    """Motions at the points, (points 15, columns), and the shape of the array of columns."""

    jets: Array
    shape: tuple[int, ...]


class Alike(NamedTuple):
    """Numbers between pairs b and a of a window that are sums of the same products of harmonics.

    Each is from wave +n_a (sense 0, n_b >= n_a) or -n_a (sense 1) to +n_b. The difference of nodal diameters is the
    sum of the harmonics in every product.

    Attributes
    ----------
    b, a, sense : (numbers,)
    powers : products of one, two and three harmonics; their sums are K of all numbers, then M
    """

    b: IntArray
    a: IntArray
    sense: IntArray
    powers: tuple[Monomials, ...]


class Window(NamedTuple):
    """Pairs that mix, ascending by frequency.

    Attributes
    ----------
    n : nodal diameters, (pairs,)
    value : omega^2 of the perfect casing, (pairs,)
    own : number of wanted pairs, the lowest; the others only mix with them
    between : numbers between the pairs
    """

    n: IntArray
    value: FloatArray
    own: int
    between: tuple[Alike, ...]


class Derivatives(NamedTuple):
    """Forms of the perfect casing and their derivatives by slots, up to the third.

    `second` are complex, the others `real`.
    """

    slots: tuple[Slot, ...]
    none: Forms
    first: list[Forms]
    second: dict[tuple[int, int], Forms]
    turned: dict[tuple[int, int], Forms]
    third: dict[tuple[int, int, int], Forms]


def derivatives_of(own: Expansion) -> Derivatives:
    """The derivatives for the expansion's casing."""
    slots = slots_of(own.quantities)
    given = own.shell, own.quantities
    about = np.zeros(len(slots))
    second = second_derivatives(*given, own.places)

    def real(form: Forms, *at: int) -> Forms:
        return real_form(form, sum(slots[each].order for each in at))

    return Derivatives(
        slots,
        real(Forms(*(part.real for part in forms_at(*given, about, own.places)))),
        [real(form, s) for s, form in enumerate(first_derivatives(*given, own.places, about))],
        second,
        {at: real(form, *at) for at, form in second.items()},
        {at: real(form, *at) for at, form in third_derivatives(*given, own.places).items()},
    )


def real_form(form: Forms, order: int) -> Forms:
    """A form on real jets, times i^order: hoop motions and derivatives around are in quadrature (`PHASE`)."""
    turned = (1j**order * PHASE.conj()[: part.shape[-1], None] * part * PHASE[: part.shape[-1]] for part in form)
    return Forms(*(np.ascontiguousarray(part.real) for part in turned))


def real_jets(jets: Array) -> FloatArray:
    """Jets (..., points 15, columns) without the phases of their components."""
    whole = jets.reshape(*jets.shape[:-2], -1, JET, jets.shape[-1])
    return np.ascontiguousarray((whole * PHASE.conj()[:, None]).real).reshape(jets.shape)


def window_of(
    own: Expansion, forms: Derivatives, forth: IntArray, back: IntArray, size: FloatArray, answers: int
) -> Window:
    """The window of some pairs, waves `forth` and `back`; the first `answers` of them are wanted.

    `size` (l, 2 p_max + 1) is the root mean square of the fields' harmonics; terms that are small with it are omitted.
    """
    terms, n = Terms.of(own, forms, np.concatenate([forth, back]), len(forth), answers), own.waves.n[forth]
    alike: dict[int, list[tuple[int, int, int]]] = {}
    for b, a in product(range(len(n)), repeat=2):
        if (n[b], b) >= (n[a], a):
            alike.setdefault(int(n[b] - n[a]), []).append((b, a, 0))
            alike.setdefault(int(n[b] + n[a]), []).append((b, a, 1))
    between = tuple(alike_of(terms, np.array(entries), size.ravel()) for entries in alike.values())
    return Window(n, own.waves.value[forth], answers, between)


def alike_of(terms: "Terms", entries: IntArray, size: FloatArray) -> Alike:
    """Numbers (b, a, sense) with the same difference of nodal diameters, (numbers, 3)."""
    b, a, sense = entries.T
    scale, powers = np.zeros(len(b)), list[Monomials]()
    for terms_of in (terms.first, terms.second, terms.third):
        factor, value = zip(*(terms_of(*each) for each in entries.tolist()), strict=True)
        number, all_values = np.repeat(np.arange(len(b)), [len(part) for part in value]), np.concatenate(value)
        together = np.concatenate(factor)
        flat = together[..., 0] * (2 * terms.own.p_max + 1) + together[..., 1]
        np.maximum.at(scale, number, np.abs(all_values[:, 0]) * np.prod(size[flat], axis=1))
        powers.append(collected(flat, number, all_values, size, scale))
    return Alike(b, a, sense, tuple(powers))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Terms:
    """Coefficients of the products of harmonics between the waves of a window.

    Attributes
    ----------
    own, forms, waves : the expansion, its forms, and indices of the window's waves in it
    low : those waves
    direct : K_2 and M_2 of only the second derivatives
    between_answers : <X_b|D_0|X_a> by kind, ways, l, b, m, a; all others have X by harmonic, -p_max to p_max
    first_right, first_left : <u|D_1|X>, <X|D_1|u> for each slot: stiffness and mass
    first_both : <X|D_1|X> for each slot, with wanted pairs on the left, like all that follow
    second_right, second_left : <u|D_2|X>, <X|D_2|u> for each two slots
    third_none : <u|D_3|u> for each three slots
    """

    own: Expansion
    forms: Derivatives
    waves: IntArray
    low: Waves
    direct: tuple[FloatArray, FloatArray]
    between_answers: FloatArray
    first_right: list[Two]
    first_left: list[Two]
    first_both: list[Two]
    second_right: dict[tuple[int, int], Two]
    second_left: dict[tuple[int, int], Two]
    third_none: dict[tuple[int, int, int], Two]

    @classmethod
    def of(cls, own: Expansion, forms: Derivatives, waves: IntArray, pairs: int, answers: int) -> "Terms":
        """Terms of some waves, the first `pairs` of which are +n of the pairs."""
        low, X = own.waves.chosen(waves), real_jets(answers_of(own, waves))  # (l, ways, points 15, waves)
        near, jets, ways = by_harmonic(own, X, low.n), real_jets(low.jets), range(X.shape[1])
        right, left, u = columns(near), columns(near[..., :pairs]), Columns(jets, (len(waves),))
        own_left, own_u = columns(near[..., :answers]), Columns(jets[:, :answers], (answers,))
        u_left = Columns(jets[:, :pairs], (pairs,))
        at_way = [inner(columns(X[:, k : k + 1, :, :pairs]), forms.none, columns(X[:, k : k + 1])) for k in ways]
        parts = [np.array([pair[kind][:, 0, :, :, 0] for pair in at_way]) for kind in (0, 1)]
        return cls(
            own=own,
            forms=forms,
            waves=waves,
            low=low,
            direct=second_order(low, own.k, forms.slots, forms.second, own.quantities),
            between_answers=np.array(parts),
            first_right=[inner(u_left, form, right) for form in forms.first],
            first_left=[inner(left, form, u) for form in forms.first],
            first_both=[single(inner(own_left, form, right)) for form in forms.first],
            second_right={slots: single(inner(own_u, form, right)) for slots, form in forms.turned.items()},
            second_left={slots: single(inner(own_left, form, u)) for slots, form in forms.turned.items()},
            third_none={slots: inner(own_u, form, u) for slots, form in forms.third.items()},
        )

    @property
    def answers(self) -> int:
        """Number of wanted pairs."""
        return int(self.first_both[0][0].shape[2])

    def wave(self, pair: int, sense: int) -> int:
        """Index of the wave +n or -n of a pair."""
        return pair + sense * int(self.between_answers.shape[3])

    def lines_of(self, line: int) -> list[int]:
        """Slots of a field."""
        return [s for s, slot in enumerate(self.forms.slots) if slot.quantity == self.own.quantities[line]]

    def first(self, b: int, pair: int, sense: int) -> tuple[IntArray, FloatArray]:
        """Terms of first power, from wave a = +-n of a pair to wave b."""
        a = self.wave(pair, sense)
        p, top = int(self.low.n[b] - self.low.n[a]), self.own.p_max
        lines = [line for line in range(len(self.own.quantities)) if abs(p) <= top]
        factor = np.array([[(line, p + top)] for line in lines], dtype=np.int64).reshape(-1, 1, 2)
        at = self.waves[b], self.waves[a]
        value = np.array([(self.own.K_1[line][at], self.own.M_1[line][at]) for line in lines]).reshape(-1, 2)
        return factor, value

    def second(self, b: int, pair: int, sense: int) -> tuple[IntArray, FloatArray]:
        """Terms of second power."""
        a = self.wave(pair, sense)
        k, top, order = self.own.k, self.own.p_max, [slot.order for slot in self.forms.slots]
        p1, p2 = k - self.low.n[a], self.low.n[b] - k
        used = np.flatnonzero((np.abs(p1) <= top) & (np.abs(p2) <= top))
        factors, values = [], []
        for line, other in product(range(len(self.own.quantities)), repeat=2):
            value = np.zeros((len(used), 2))
            for kind in (0, 1):
                own = self.direct[kind][used, line, other, b, a] + self.between_answers[kind, used, other, b, line, a]
                for s in self.lines_of(other):
                    own = own + p2[used] ** order[s] * self.first_right[s][kind][b, line, p1[used] + top, a]
                for s in self.lines_of(line):
                    own = own + p1[used] ** order[s] * self.first_left[s][kind][other, top - p2[used], b, a]
                value[:, kind] = own
            one, two = np.full(len(used), line), np.full(len(used), other)
            factors.append(np.stack([np.stack([one, p1[used] + top], -1), np.stack([two, p2[used] + top], -1)], axis=1))
            values.append(value)
        return np.concatenate(factors), np.concatenate(values)

    def third(self, b: int, pair: int, sense: int) -> tuple[IntArray, FloatArray]:
        """Terms of third power, if one of both pairs is wanted; those of M are included in K."""
        if b >= self.answers > pair:
            factor, value = self.third(pair, b, sense)
            return (factor if sense else self.mirrored(factor)), value
        if b >= self.answers:
            return np.zeros((0, 3, 2), dtype=np.int64), np.zeros((0, 2))
        k, top, a = self.own.k, self.own.p_max, self.wave(pair, sense)
        square = 0.5 * float(self.low.value[a] + self.low.value[b])
        p1, p2, p3 = (k - self.low.n[a])[:, None], k - k[:, None], self.low.n[b] - k  # (first way, second way)
        used = (np.abs(p1) <= top) & (np.abs(p2) <= top) & (np.abs(p3) <= top)
        i, j = np.nonzero(used)
        p1, p2, p3 = p1[i, 0], p2[i, j], p3[j]
        factors, values = [], []
        for lines in product(range(len(self.own.quantities)), repeat=3):
            found = self.third_of(lines, (b, a), (p1, p2, p3), square)
            parts = [np.stack([np.full(len(i), f), p + top], -1) for f, p in zip(lines, (p1, p2, p3), strict=True)]
            factors.append(np.stack(parts, axis=1))
            values.append(np.stack([found, np.zeros(len(i))], axis=1))
        return np.concatenate(factors), np.concatenate(values)

    def mirrored(self, factor: IntArray) -> IntArray:
        """Harmonics -p instead of p."""
        return np.stack([factor[..., 0], 2 * self.own.p_max - factor[..., 1]], axis=-1)

    def third_of(
        self,
        lines: tuple[int, ...],
        waves: tuple[int, int],
        p: tuple[IntArray, IntArray, IntArray],
        square: float,
    ) -> FloatArray:
        """Terms of third power for three fields with harmonics p; D = K - `square` M."""
        (b, a), (first, second, third) = waves, lines
        i, j = p[0] + self.own.p_max, self.own.p_max - p[2]  # places of the answers to a and to b
        about = [[each.astype(float) ** slot.order for slot in self.forms.slots] for each in p]

        def D(parts: Two, *at: int | IntArray) -> Array:
            return np.asarray(parts[0][at] - square * parts[1][at])

        found = np.zeros(len(i))
        for s in self.lines_of(second):
            found += about[1][s] * D(self.first_both[s], third, j, b, first, i, a)
            for t in self.lines_of(third):
                found += 0.5 * about[1][s] * about[2][t] * D(self.second_right[s, t], b, first, i, a)
                for r in self.lines_of(first):
                    found += about[0][r] * about[1][s] * about[2][t] * D(self.third_none[r, s, t], b, a) / 6.0
            for r in self.lines_of(first):
                found += 0.5 * about[0][r] * about[1][s] * D(self.second_left[r, s], third, j, b, a)
        return found


def by_harmonic(own: Expansion, X: Array, n: IntArray) -> Array:
    """Responses (l, ways, points 15, waves) of waves n by p = k - n, from -p_max to p_max, instead of by k."""
    first, count = n - own.p_max - own.k[0], 2 * own.p_max + 1
    parts = [X[:, start : start + count, :, wave] for wave, start in enumerate(first.tolist())]
    return np.stack(parts, axis=-1)


def columns(X: Array) -> Columns:
    """Responses (l, ways or harmonics, points 15, waves) side by side."""
    lines, ways, points, count = X.shape
    return Columns(np.moveaxis(X, 2, 0).reshape(points, -1), (lines, ways, count))


def inner(left: Columns, form: Forms, right: Columns) -> Two:
    """left^H form right, integrated around, for stiffness and mass, with both indices of the sides."""
    stiffness, mass = (part.reshape(*left.shape, *right.shape) for part in between(left, form, right))
    return stiffness, mass


def single(both: Two) -> Two:
    """Single-precision copy, for numbers that are small themselves."""
    return both[0].astype(np.float32), both[1].astype(np.float32)


def answers_of(own: Expansion, waves: IntArray) -> Array:
    """First-order responses to some waves of an expansion, through each k: (l, ways, points 15, waves)."""
    value, about = own.waves.value, own.about[waves]
    X = own.answers[..., waves].copy()
    for j in np.setdiff1d(np.arange(len(value)), waves):
        way = int(np.searchsorted(own.k, own.waves.n[j]))
        reach = np.abs(own.waves.n[j] - own.waves.n[waves]) <= own.p_max
        r = (own.K_1[:, j, waves] - about * own.M_1[:, j, waves]) * reach / (value[j] - about)
        X[:, way] -= own.waves.jets[:, j][:, None] * r[:, None]
    return X
