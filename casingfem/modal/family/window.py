"""The lowest waves of a family's casings: their stiffness and mass to third order in the imperfections.

Trial motions are the waves u_a with their first-order response, v_a = u_a + sum_k F_l[k - n_a] X_(l,k,a)
(`expansion`). With D = K - w^2 M of a casing, the terms of v_b^H D v_a by powers of F are

    1  <u_b|D_1|u_a>
    2  <u_b|D_2|u_a> + <u_b|D_1|X_a> + <X_b|D_1|u_a> + <X_b|D_0|X_a>
    3  <u_b|D_3|u_a> + <u_b|D_2|X_a> + <X_b|D_2|u_a> + <X_b|D_1|X_a>

each a sum over the intermediate harmonics between a and b. K and M have separate terms of the first and second power.
The third power is computed between wanted waves alone: between others its effect is of fourth order. In it w^2 is the
mean of both waves. The minimum of Rayleigh's quotient is then accurate to third order.
"""

from dataclasses import dataclass
from itertools import product
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from scipy.sparse import csr_array

from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray
from casingfem.modal.family.expansion import Expansion, between, second_order
from casingfem.modal.family.members import members_from
from casingfem.modal.family.monomials import Monomials, collected, weights
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
    """Numbers between waves b and a of a window that are sums of the same products of harmonics.

    Each is from wave +n_a (sense 0, n_b >= n_a) or its complex conjugate -n_a (sense 1) to +n_b. The difference of
    nodal diameters is the sum of the harmonics in every product.

    Attributes
    ----------
    first, second : products of one and two harmonics; their sums are K of all numbers, then M
    third : products of three; their sums are K - w^2 M of the numbers between wanted waves, in single precision
    """

    first: Monomials
    second: Monomials
    third: Monomials

    def low(self, x: Array) -> Array:
        """K and M to second order of casings with coefficients x, (2, numbers, casings)."""
        both = self.first.sums(x) + self.second.sums(x)
        return both.reshape(2, -1, x.shape[1])


class Window(NamedTuple):
    """Waves that mix, ascending by frequency, and their real members.

    A wave with n > 0 has a cosine member and a sine member. A wave with n = 0 has one: its cosine, or the sine of a
    torsion, whose wave is imaginary.

    Attributes
    ----------
    waves : their indices in the expansion, n >= 0, (waves,)
    n : nodal diameters, (waves,)
    value : omega^2 of the perfect casing, (waves,)
    own : number of wanted waves, the lowest; the others only mix with them
    kept : members, cosine k as k and sine k as waves + k, ascending, (members,)
    between : numbers between the waves
    members, members_of_third : from these numbers, and from those of the third power, to matrices on the members
    """

    waves: IntArray
    n: IntArray
    value: FloatArray
    own: int
    kept: IntArray
    between: tuple[Alike, ...]
    members: csr_array
    members_of_third: csr_array

    @property
    def of(self) -> IntArray:
        """The wave of each member, (members,)."""
        return self.kept % len(self.n)

    @property
    def pairs(self) -> IntArray:
        """The wanted waves with n > 0."""
        return np.flatnonzero(self.n[: self.own] > 0)


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
        real(Forms(*(part[0].real for part in forms_at(*given, about[None], own.places)))),
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
    """The window of the waves `forth` and their conjugates `back`; the first `answers` of them are wanted.

    `size` (l, 2 p_max + 1) is the root mean square of the fields' harmonics; terms that are small with it are omitted.
    """
    n, torsion = own.waves.n[forth], torsional(own.waves, forth)
    turn = np.concatenate([np.ones(len(n)), np.where(torsion, -1.0, 1.0)])
    terms = Terms.of(own, forms, np.concatenate([forth, back]), len(forth), answers, turn)
    alike: dict[int, list[tuple[int, int, int]]] = {}
    for b, a in product(range(len(n)), repeat=2):
        if (n[b], b) >= (n[a], a):
            alike.setdefault(int(n[b] - n[a]), []).append((b, a, 0))
            alike.setdefault(int(n[b] + n[a]), []).append((b, a, 1))
    between = tuple(alike_of(terms, np.array(entries), size.ravel()) for entries in alike.values())
    kept = np.concatenate([np.flatnonzero(~torsion), len(n) + np.flatnonzero((n > 0) | torsion)])
    numbers = np.concatenate([np.array(entries) for entries in alike.values()])
    members, members_of_third = (members_from(part, n, kept) for part in (numbers, numbers[terms.wanted(numbers)]))
    return Window(forth, n, own.waves.value[forth], answers, kept, between, members, members_of_third)


def torsional(waves: Waves, which: IntArray) -> BoolArray:
    """Whether waves have n = 0 and are imaginary."""
    motion = waves.motion[..., which].reshape(-1, len(which))
    imaginary = np.linalg.norm(motion.imag, axis=0) > np.linalg.norm(motion.real, axis=0)
    return np.asarray((waves.n[which] == 0) & imaginary)


def alike_of(terms: "Terms", entries: IntArray, size: FloatArray) -> Alike:
    """Numbers (b, a, sense) with the same difference of nodal diameters, (numbers, 3)."""
    (b, a, _), step = entries.T, terms.step(entries)
    square = np.sqrt(np.maximum(terms.low.value[b] * terms.low.value[a], 0.0))
    scale, powers, every = np.zeros(len(b)), list[Monomials](), np.arange(len(b))
    plan = ((terms.first, every), (terms.second, every), (terms.third, np.flatnonzero(terms.wanted(entries))))
    for degree, (values_of, own) in enumerate(plan, 1):
        factor = products_of(step, degree, len(terms.own.quantities), terms.own.p_max)
        value = np.moveaxis(values_of(entries[own], step), 0, -1)
        scale[own] = np.maximum(scale[own], weights(factor, value, size, square[own]).max(axis=0, initial=0.0))
        powers.append(collected(factor, value, size, scale[own], square[own]))
    first, second, third = powers
    return Alike(first, second, third._replace(value=third.value.astype(np.float32)))


def products_of(step: int, degree: int, lines: int, p_max: int) -> IntArray:
    """All products of some harmonics whose sum is `step`: their places in F (l, 2 p_max + 1), (products, degree).

    Products of the same fields follow each other, by all harmonics but the second, which `remaining` gives.
    """
    p = remaining(step, degree, p_max)
    own = p[:, np.all(np.abs(p) <= p_max, axis=0)].T + p_max
    each = [own + (2 * p_max + 1) * np.array(chosen) for chosen in product(range(lines), repeat=degree)]
    return np.concatenate(each)


def remaining(step: int, degree: int, p_max: int) -> IntArray:
    """Harmonics of products of 1, 2 or 3 with the sum `step`, ascending by the first, then the third, (degree, all)."""
    p = np.arange(-p_max, p_max + 1)
    if degree == 1:
        return np.array([[step]])
    if degree == 2:
        return np.stack([p, step - p])
    first, third = (each.ravel() for each in np.meshgrid(p, p, indexing="ij"))
    return np.stack([first, step - first - third, third])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Terms:
    """Coefficients of the products of harmonics between the waves of a window.

    Attributes
    ----------
    own, forms, waves : the expansion, its forms, and indices of the window's waves in it, then of their conjugates
    low : those waves
    turn : factors of the waves; -1 for the conjugate of an imaginary wave, which has no index of its own
    direct : K_2 and M_2 of only the second derivatives
    between_answers : <X_b|D_0|X_a> by kind, ways, l, b, m, a; all others have X by harmonic, -p_max to p_max
    first_right, first_left : <u|D_1|X>, <X|D_1|u> for each slot: stiffness and mass
    first_both : <X|D_1|X> for each slot, with wanted waves on both sides, like all that follow
    second_right, second_left : <u|D_2|X>, <X|D_2|u> for each two slots
    third_none : <u|D_3|u> for each three slots
    """

    own: Expansion
    forms: Derivatives
    waves: IntArray
    low: Waves
    turn: FloatArray
    direct: tuple[FloatArray, FloatArray]
    between_answers: FloatArray
    first_right: list[Two]
    first_left: list[Two]
    first_both: list[Two]
    second_right: dict[tuple[int, int], Two]
    second_left: dict[tuple[int, int], Two]
    third_none: dict[tuple[int, int, int], Two]

    @classmethod
    def of(
        cls, own: Expansion, forms: Derivatives, waves: IntArray, pairs: int, answers: int, turn: FloatArray
    ) -> "Terms":
        """Terms of some waves, the first `pairs` of which are +n."""
        low, X = own.waves.chosen(waves), real_jets(own.answers[..., waves])  # (l, ways, points 15, waves)
        both = np.concatenate([np.arange(answers), pairs + np.arange(answers)])
        near, jets, ways = by_harmonic(own, X, low.n), real_jets(low.jets), range(X.shape[1])
        right, left, u = columns(near), columns(near[..., :pairs]), Columns(jets, (len(waves),))
        u_left = Columns(jets[:, :pairs], (pairs,))
        own_left, own_right = columns(near[..., :answers]), columns(near[..., both])
        own_u_left, own_u = Columns(jets[:, :answers], (answers,)), Columns(jets[:, both], (2 * answers,))
        at_way = [inner(columns(X[:, k : k + 1, :, :pairs]), forms.none, columns(X[:, k : k + 1])) for k in ways]
        parts = [np.array([pair[kind][:, 0, :, :, 0] for pair in at_way]) for kind in (0, 1)]
        return cls(
            own=own,
            forms=forms,
            waves=waves,
            low=low,
            turn=turn,
            direct=second_order(low, own.k, forms.slots, forms.second, own.quantities),
            between_answers=np.array(parts),
            first_right=[inner(u_left, form, right) for form in forms.first],
            first_left=[inner(left, form, u) for form in forms.first],
            first_both=[single(inner(own_left, form, own_right)) for form in forms.first],
            second_right={slots: single(inner(own_u_left, form, own_right)) for slots, form in forms.turned.items()},
            second_left={slots: single(inner(own_left, form, own_u)) for slots, form in forms.turned.items()},
            third_none={slots: inner(own_u_left, form, own_u) for slots, form in forms.third.items()},
        )

    @property
    def answers(self) -> int:
        """Number of wanted waves."""
        return int(self.first_both[0][0].shape[2])

    def wanted(self, entries: IntArray) -> BoolArray:
        """Whether both waves of numbers (b, a, sense) are wanted, (numbers,)."""
        return np.asarray(entries[:, :2].max(axis=1) < self.answers)

    def ends(self, entries: IntArray) -> tuple[IntArray, IntArray]:
        """Indices of the waves b and a of numbers (b, a, sense); with sense 1, a is the conjugate."""
        b, pair, sense = entries.T
        return b, pair + sense * self.between_answers.shape[3]

    def lines_of(self, line: int) -> list[int]:
        """Slots of a field."""
        return [s for s, slot in enumerate(self.forms.slots) if slot.quantity == self.own.quantities[line]]

    def step(self, entries: IntArray) -> int:
        """Difference of nodal diameters, from wave a = +-n to wave b, which all these numbers share."""
        b, a = self.ends(entries[:1])
        return int(self.low.n[b[0]] - self.low.n[a[0]])

    def first(self, entries: IntArray, step: int) -> FloatArray:
        """Terms of first power of K and M, for the products of `products_of`, (numbers, products, 2)."""
        b, a = self.ends(entries)
        lines = range(len(self.own.quantities) if abs(step) <= self.own.p_max else 0)
        at = self.waves[b], self.waves[a]
        value = np.array([(self.own.K_1[line][at], self.own.M_1[line][at]) for line in lines])
        return np.asarray(self.turn[a, None, None] * np.moveaxis(value.reshape(-1, 2, len(b)), 2, 0))

    def second(self, entries: IntArray, step: int) -> FloatArray:
        """Terms of second power."""
        b, a = (each[:, None] for each in self.ends(entries))
        top, order = self.own.p_max, [slot.order for slot in self.forms.slots]
        p1, p2 = remaining(step, 2, top)
        p1, p2 = p1[np.abs(p2) <= top], p2[np.abs(p2) <= top]
        way = p1 + self.low.n[a] - self.own.k[0]
        values = []
        for line, other in product(range(len(self.own.quantities)), repeat=2):
            value = np.zeros((*way.shape, 2))
            for kind in (0, 1):
                own = self.direct[kind][way, line, other, b, a] + self.between_answers[kind, way, other, b, line, a]
                for s in self.lines_of(other):
                    own = own + p2 ** order[s] * self.first_right[s][kind][b, line, p1 + top, a]
                for s in self.lines_of(line):
                    own = own + p1 ** order[s] * self.first_left[s][kind][other, top - p2, b, a]
                value[:, :, kind] = own
            values.append(value)
        return np.asarray(self.turn[a, None] * np.concatenate(values, axis=1))

    def third(self, entries: IntArray, step: int) -> FloatArray:
        """Terms of third power of D = K - w^2 M between wanted waves, (numbers, products, 1)."""
        used = np.all(np.abs(remaining(step, 3, self.own.p_max)) <= self.own.p_max, axis=0)
        used = used.reshape(2 * self.own.p_max + 1, -1)
        every = product(range(len(self.own.quantities)), repeat=3)
        values = [self.third_of(lines, entries, step)[:, used] for lines in every]
        return np.concatenate(values, axis=1)[:, :, None]

    def third_of(self, lines: tuple[int, ...], entries: IntArray, step: int) -> FloatArray:
        """Terms of third power for three fields, by the first harmonic and the third, (numbers, first, third)."""
        (b, wave), (first, second, third) = self.ends(entries), lines
        a = entries[:, 1] + entries[:, 2] * self.answers
        p = np.arange(-self.own.p_max, self.own.p_max + 1)
        square = 0.5 * (self.low.value[wave] + self.low.value[b])
        p2 = step - np.add.outer(p, p)
        powers = p ** np.arange(3)[:, None]

        def D(parts: Two, *at: Any) -> Array:
            stiffness, mass = (part[at] for part in parts)  # (numbers, ...): what indexes a wave comes first
            factor = square.astype(mass.dtype).reshape(-1, *[1] * (mass.ndim - 1))
            return np.asarray(stiffness - factor * mass)

        found = np.zeros((len(entries), *p2.shape))
        for s in self.lines_of(second):
            both = D(self.first_both[s], third, slice(None, None, -1), b, first, slice(None), a)
            own = both.transpose(0, 2, 1).astype(float)
            for t in self.lines_of(third):
                after = 0.5 * D(self.second_right[s, t], b, first, slice(None), a)
                for r in self.lines_of(first):
                    after = after + powers[self.order(r)] * (D(self.third_none[r, s, t], b, a)[:, None] / 6.0)
                own += after[:, :, None] * powers[self.order(t)]
            for r in self.lines_of(first):
                before = 0.5 * D(self.second_left[r, s], third, slice(None, None, -1), b, a)
                own += powers[self.order(r)][:, None] * before[:, None, :]
            found += p2 ** self.order(s) * own
        return np.asarray(self.turn[wave, None, None] * found)

    def order(self, slot: int) -> int:
        """Order of the derivative of a slot."""
        return self.forms.slots[slot].order


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
