"""All modes of a perfect casing, harmonic by harmonic, as waves e^(i n theta) at the points of its meridian."""

from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.family.point_forms import Places
from casingfem.structure.mesh.element import gauss, lagrange
from casingfem.structure.mesh.jet_form import JET
from casingfem.structure.shell.axisymmetric import HOOP, SPIN, harmonic_matrices
from casingfem.structure.shell.shell import Shell

MIRROR = np.array([1.0, -1.0, 1.0, 1.0, -1.0])[:, None]  # a wave that travels the other way: hoop motions change sign


class Waves(NamedTuple):
    """Modes u e^(i n theta)/sqrt(2 pi) of a perfect casing, mass-normalised, n of both signs.

    Attributes
    ----------
    n, rank : nodal diameters with sign, number among the waves of one n, (waves,)
    value : omega^2 [rad^2/s^2], (waves,)
    motion : u with its phases, (nodes, 5, waves)
    jets : (u, d_z u, d_theta u) at the points, (points 15, waves)
    """

    n: IntArray
    rank: IntArray
    value: FloatArray
    motion: Array
    jets: Array

    def chosen(self, which: IntArray) -> "Waves":
        """Some of the waves."""
        return Waves(self.n[which], self.rank[which], self.value[which], self.motion[..., which], self.jets[:, which])


def waves_of(shell: Shell, n_max: int, places: Places) -> Waves:
    """All modes of the meridian's mesh, harmonics -n_max to n_max, ascending by n."""
    one_way = [harmonic(shell, n) for n in range(n_max + 1)]
    parts = []
    for n in range(-n_max, n_max + 1):
        value, motion = one_way[abs(n)]
        motion = HOOP[:, None] * (MIRROR * motion if n < 0 else motion) / np.sqrt(2.0 * np.pi)
        number = np.full(len(value), n)
        parts.append(Waves(number, np.arange(len(value)), value, motion, wave_jets(shell, n, motion, places)))
    return Waves(*(np.concatenate(part, axis=-1) for part in zip(*parts, strict=True)))


def harmonic(shell: Shell, n: int) -> tuple[FloatArray, FloatArray]:
    """Eigenvalues and real meridian shapes (nodes, 5, modes) of n nodal diameters, unit mass per angle."""
    meridian = harmonic_matrices(shell, n)
    root = 1.0 / np.sqrt(meridian.mass)
    value, vectors = eigh(root[:, None] * meridian.K * root)
    return value, meridian.expand(root[:, None] * vectors)


def wave_jets(shell: Shell, n: int, motion: Array, places: Places) -> Array:
    """Motions of a meridian (nodes, 5, k) and their derivatives at all points, at theta = 0, (points 15, k)."""
    order, rows = shell.mesh.order, len(shell.mesh.breaks) - 1
    size = np.ptp(np.real(shell.chart.bounds[0])) * np.diff(shell.mesh.breaks)
    values, slopes = lagrange(order, gauss(order + 1)[0])
    elements = motion[np.arange(rows)[:, None] * order + np.arange(order + 1)]
    at = np.einsum("fq,efck->eqck", values, elements).reshape(-1, *motion.shape[1:])
    along = np.einsum("fq,efck,e->eqck", slopes, elements, 1.0 / size).reshape(at.shape)
    ends = motion[[end for *_, end in places.edges]]  # springs act on the motion alone
    at, along = np.concatenate([at, ends]), np.concatenate([along, 0.0 * ends])
    around = 1j * n * at + np.einsum("cd,qdk->qck", SPIN, at)
    jets = np.stack([at, along, around], axis=1).reshape(len(at) * JET, -1)
    return np.asarray(jets)
