"""Free waves and modes of the bodies of a closed contact in the frame of the contact, at any speed.

In the frame of the contact a casing's wave e^(i k theta) obeys (D + i k Omega)^2 z + C_k (D + i k Omega) z + K_k z =
W_k^H lam, where C_k and K_k are the entries of `ClosedContact.matrices` between waves of k diameters at that speed.
Coriolis forces make the two senses k and -k differ. Modes of the bodies with the contact points have k = 0. Each gives
two poles, and together they are the receptance H(s) = sum_j seen_j pushed_j/(s - s_j).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array, Indices
from contact.base.groups import joined_groups
from contact.base.remembered import remembered
from contact.model.gaps.permanent import ClosedContact, equal_modes, powers

Complex = NDArray[np.complex128]
COUPLED = 1e-12  # of the largest entry of C or K: a smaller one couples no waves
TOGETHER = 64  # speeds whose poles are computed at once
DEFECT = 1e10  # condition of the eigenvectors of a wave beyond which two of its poles have become one


class FreePoles(NamedTuple):
    """Poles s [1/s, rad/s] of the free bodies in the frame of the contact points, at each of some speeds.

    `s` (speeds, 2 m), `seen` (speeds, r, 2 m), `pushed` (speeds, 2 m, r); `order` k, `sign` of the frequency in the
    body's own frame, and whether it is the `casing`'s, (2 m,). Column j is the same wave at all speeds.
    """

    s: Complex
    seen: Complex
    pushed: Complex
    order: Array
    sign: Array
    casing: NDArray[np.bool_]

    def own(self, speed: Array) -> Array:
        """Undamped frequencies |s + i k Omega| with their sign, in the body's own frame, (speeds, 2 m)."""
        return np.asarray(self.sign * np.abs(self.s + 1j * np.multiply.outer(speed, self.order)))

    def met(self, speed: Array) -> Array:
        """Undamped frequencies in the frame of the contact points, (speeds, 2 m)."""
        return np.asarray(self.own(speed) - np.multiply.outer(speed, self.order))

    @property
    def residues(self) -> Complex:
        """Residues of each pole at one contact, (speeds, 2 m)."""
        return np.asarray(self.seen[:, 0] * self.pushed[:, :, 0])


@dataclass(frozen=True, eq=False, slots=True)
class Waves:
    """Modes as waves e^(i k theta): shapes U (m, m), orders k (m,), and groups of waves that C or K couple.

    `parts` are `ClosedContact.parts` between waves, (powers, m, m) each.
    """

    contact: ClosedContact
    U: Complex
    order: Array
    groups: tuple[Indices, ...]
    parts: tuple[Complex, Complex]

    def poles(self, speed: Array, sense: float) -> FreePoles | None:
        """Poles at speeds [rad/s] of one sense of rotation; None if two of them coincide.

        At speeds for which the matrices of a body are not known, those of the nearest known speed are used.
        """
        contact, m, r = self.contact, self.order.size, len(self.contact.Q)
        first = np.concatenate([[0], 2 * np.cumsum([group.size for group in self.groups])]).astype(int)
        s = np.empty((speed.size, 2 * m), dtype=complex)
        seen, pushed = np.empty((speed.size, r, 2 * m), dtype=complex), np.empty((speed.size, 2 * m, r), dtype=complex)
        order, sign, casing = np.empty(2 * m), np.empty(2 * m), np.empty(2 * m, dtype=bool)
        rows, pushes = contact.Q @ self.U, self.U.conj().T @ contact.pushes(sense).T
        C, K = self.parts
        known, shown = np.unique(np.clip(np.abs(speed), *contact.known_speeds), return_inverse=True)
        odd, even = powers(sense * known, len(C), len(K))
        for size in sorted({group.size for group in self.groups}):
            same = [i for i, group in enumerate(self.groups) if group.size == size]
            at = np.array([self.groups[i] for i in same])  # (groups, size)
            block = at[:, :, None], at[:, None, :]
            damping, stiffness = (np.tensordot(by, part[:, *block], 1) for by, part in ((odd, C), (even, K)))
            found = _blocks(damping, stiffness, contact.rates[at])
            if found is None:
                return None
            values, vectors, left = (part[shown] for part in found)
            values = values - 1j * np.multiply.outer(speed, self.order[at[:, 0]])[:, :, None]
            place = np.array([first[i] + np.arange(2 * size) for i in same])  # (groups, 2 size)
            s[:, place] = values
            seen[:, :, place] = np.einsum("rgi,wgij->wrgj", rows[:, at], vectors[:, :, :size])
            scaled = pushes[at] / contact.rates[at][:, :, None]
            pushed[:, place] = np.einsum("wgji,gir->wgjr", left[:, :, :, size:], scaled)
            order[place] = self.order[at[:, 0]][:, None]
            sign[place] = np.repeat([-1.0, 1.0], size)
            casing[place] = (at[:, 0] < contact.casing)[:, None]
        return FreePoles(s, seen, pushed, order, sign, casing)

    def poles_each(self, speed: Array, sense: float) -> Iterator[FreePoles | None]:
        """Poles at each of many speeds [rad/s] of one sense; None if two of them coincide."""
        for first in range(0, speed.size, TOGETHER):
            part = speed[first : first + TOGETHER]
            every = self.poles(part, sense)
            for k in range(part.size):
                here = slice(k, k + 1)
                yield (
                    self.poles(part[here], sense) if every is None
                    else every._replace(s=every.s[here], seen=every.seen[here], pushed=every.pushed[here])
                )  # fmt: skip


@remembered
def waves_of(contact: ClosedContact) -> Waves:
    """Eigenvectors of G within groups of equal modes, so that each is a wave of a single mode if modes do not mix."""
    m = contact.omega.size
    U, order = np.eye(m, dtype=complex), np.zeros(m)
    for group in equal_modes(contact.omega[: contact.casing], contact.zeta[: contact.casing]):
        block = np.ix_(group, group)
        order[group], U[block] = np.linalg.eigh(-1j * contact.G[block])
    order = np.round(order)
    joined = np.zeros((m, m), dtype=bool)
    C, K = (U.conj().T @ part.astype(complex) @ U for part in contact.parts())
    for part in (*C, *K):
        size = np.abs(part)
        joined |= size > COUPLED * float(size.max(initial=0.0))
    joined &= order[:, None] == order
    return Waves(contact, U, order, joined_groups(joined), (C, K))


def _blocks(C: Complex, K: Complex, rate: Array) -> tuple[Complex, Complex, Complex] | None:
    """Eigenvalues, eigenvectors and inverses of groups of waves in the body's frame, first order, by frequency.

    C, K (speeds, groups, size, size), `rate` (groups, size) the scales of the velocities.
    """
    size = C.shape[-1]
    A = np.zeros((*C.shape[:2], 2 * size, 2 * size), dtype=complex)
    lower = np.arange(size)
    A[:, :, lower, size + lower] = rate
    A[:, :, size:, :size] = -K / rate[:, :, None]
    A[:, :, size:, size:] = -C * rate[:, None, :] / rate[:, :, None]
    values, vectors = np.linalg.eig(A if A.imag.any() else A.real)
    ascending = np.argsort(values.imag, axis=-1, kind="stable")
    values = np.take_along_axis(values, ascending, axis=-1)
    vectors = np.take_along_axis(vectors, ascending[:, :, None, :], axis=-1)
    if not np.all(np.linalg.cond(vectors) < DEFECT):
        return None
    return values, vectors, np.linalg.inv(vectors)
