"""Real matrices of many casings on the members of a window, and their solution.

A casing's motion is real, so K[-b, -a] is the conjugate of K[b, a], and the matrices on cosine and sine members are
real. Arrays contain all casings of a lot; there is no loop over casings.
"""

from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, FloatArray
from casingfem.modal.family.window import Window


class Solved(NamedTuple):
    """All modes of some casings on the members of a window.

    Attributes
    ----------
    value
        omega^2, ascending, (casings, modes).
    y
        Modes of the matrices with the mass reduced to 1, (casings, members, modes).
    root
        Coordinates of the modes are root @ y, (casings, members, members).
    third
        Relative effect of the third-order terms on the frequencies, (casings, modes).
    """

    value: FloatArray
    y: FloatArray
    root: FloatArray
    third: FloatArray


def solved(own: Window, x: Array) -> Solved:
    """The modes of casings with coefficients x (l (2 p_max + 1), casings)."""
    whole, root, last = matrices(own, x)
    value, y = np.linalg.eigh(whole)
    added = np.abs(np.sum(y * (last @ y), axis=1))
    return Solved(value, y, root, 0.5 * added / np.maximum(np.abs(value), np.finfo(float).tiny))


def matrices(own: Window, x: Array) -> tuple[FloatArray, FloatArray, FloatArray]:
    """K of a window after reduction of the mass to 1, M^(-1/2), third-order part of K, (casings, members, members)."""
    waves, cases = len(own.n), x.shape[1]
    parts = np.zeros((3, cases, 2, waves, waves), dtype=complex)  # K to second order, M, third order
    for each in own.between:
        *low, last = (power.sums(x).reshape(2, len(each.b), cases) for power in each.powers)
        for part, sums in zip(parts, (*np.add.reduce(low), last[0]), strict=True):
            part[:, each.sense, each.a, each.b] = np.where(each.sense, sums.T, sums.T.conj())
            part[:, each.sense, each.b, each.a] = sums.T
    stiffness, E, third = (real_form(part, own) for part in parts)
    both, one = np.arange(len(own.kept)), np.eye(len(own.kept))
    stiffness += third
    stiffness[:, both, both] += own.value[own.of]
    root = one - E @ (0.5 * one - E @ (0.375 * one - 0.3125 * E))  # (1 + E)^(-1/2)
    return np.asarray(root @ stiffness @ root), root, third


def real_form(waves: Array, own: Window) -> FloatArray:
    """Symmetric matrices on the members, from those between waves (casings, sense, b, a)."""
    full, turned = waves[:, 0], waves[:, 1]
    top = np.concatenate([full.real + turned.real, full.imag - turned.imag], axis=2)
    bottom = np.concatenate([-full.imag - turned.imag, full.real - turned.real], axis=2)
    size = np.where(own.n[own.of] > 0, 1.0, np.sqrt(0.5))  # (u + u*)/sqrt(2) is sqrt(2) u of a real wave
    both: FloatArray = np.concatenate([top, bottom], axis=1)
    return np.asarray(both[:, own.kept[:, None], own.kept] * np.outer(size, size))
