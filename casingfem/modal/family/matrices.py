"""Matrices of many casings on the members of a window, and their solution, without a loop over casings."""

from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, FloatArray
from casingfem.modal.family.members import on_members
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
    small = x.astype(np.complex64)  # terms of third order are small themselves
    low = np.concatenate([each.low(x) for each in own.between], axis=1)
    third = on_members(own.members_of_third, np.concatenate([each.third.sums(small) for each in own.between]))
    stiffness, E = (on_members(own.members, part) for part in low)
    both, one = np.arange(len(own.kept)), np.eye(len(own.kept))
    stiffness += third
    stiffness[:, both, both] += own.value[own.of]
    root = one - E @ (0.5 * one - E @ (0.375 * one - 0.3125 * E))  # (1 + E)^(-1/2)
    return np.asarray(root @ stiffness @ root), root, third
