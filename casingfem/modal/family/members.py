"""Real matrices on cosine and sine members, from complex numbers between waves.

A casing's motion is real, so the number from wave -a to -b is the conjugate of that from a to b. With the waves
u_a = (c_a + i s_a)/sqrt(2) of members c_a and s_a, a number z = K[b, a] adds Re z to c_b c_a and s_b s_a, Im z to
c_b s_a, and -Im z to s_b c_a. A number z = K[b, -a] adds Re z to c_b c_a, -Re z to s_b s_a, and -Im z to the other two.
"""

import numpy as np
from scipy.sparse import coo_array, csr_array

from casingfem.io.arrays import Array, FloatArray, IntArray


def members_from(entries: IntArray, n: IntArray, kept: IntArray) -> csr_array:
    """Matrix (members^2, 2 numbers) from the real parts of numbers, then their imaginary parts, to those of members.

    Parameters
    ----------
    entries
        Waves b and a of each number, and 1 for the number from -a instead of a, (numbers, 3).
    n
        Nodal diameters of the waves.
    kept
        Members, cosine k as k and sine k as waves + k, ascending.

    Examples
    --------
    >>> both = members_from(np.array([[0, 0, 0], [0, 0, 1]]), np.array([3]), np.array([0, 1]))
    >>> on_members(both, np.array([[4.0], [0.5 - 0.2j]])).tolist()
    [[[4.5, 0.2], [0.2, 3.5]]]
    """
    (b, a, sense), waves, number = entries.T, len(n), np.arange(len(entries))
    sign = 1.0 - 2.0 * sense
    imaginary = len(entries) + number
    blocks = [
        (b, a, number, np.ones(len(b))),
        (waves + b, waves + a, number, sign),
        (b, waves + a, imaginary, sign),
        (waves + b, a, imaginary, -np.ones(len(b))),
    ]
    left, right, column, factor = (np.concatenate(part) for part in zip(*blocks, strict=True))
    twice = np.tile(b != a, len(blocks))  # above the diagonal and below it
    left, right = np.concatenate([left, right[twice]]), np.concatenate([right, left[twice]])
    column, factor = (np.concatenate([part, part[twice]]) for part in (column, factor))
    factor *= np.where(n > 0, 1.0, np.sqrt(0.5))[[left % waves, right % waves]].prod(axis=0)  # u of a real wave is c
    place = np.full(2 * waves, -1)
    place[kept] = np.arange(len(kept))
    left, right = place[left], place[right]
    real = (left >= 0) & (right >= 0)
    at = left[real] * len(kept) + right[real], column[real]
    return csr_array(coo_array((factor[real], at), shape=(len(kept) ** 2, 2 * len(entries))))


def on_members(members: csr_array, numbers: Array) -> FloatArray:
    """Symmetric matrices (casings, members, members) from numbers between waves, (numbers, casings)."""
    found = members @ np.concatenate([numbers.real, numbers.imag])
    size = round(np.sqrt(members.shape[0]))
    return np.ascontiguousarray(found.T).reshape(-1, size, size)
