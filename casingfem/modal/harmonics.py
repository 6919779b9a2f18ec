"""Circumferential content of mode shapes: nodal diameters, purity, orientation, partners.

On every ring of nodes the cylindrical displacements are interpolated to four times as many equally spaced angles, and
Fourier transformed: u(theta) = Re sum_n c_n e^(i n theta). The energy of each n, summed over the rings and the three
components, labels the mode; its share is the purity. On a closed chart that is not axisymmetric theta is 2 pi times the
arc length around over its total, halfway along the chart, and the components are those along the chart's own
directions: the label does not depend on the parameters.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.structure.geometry.chart import Chart, is_axisymmetric
from casingfem.structure.mesh.element import lobatto
from casingfem.structure.mesh.place import ring_transform
from casingfem.structure.mesh.shell_mesh import Grid, ShellMesh
from contact.io.brief import brief

ARC = 1025  # samples of the arc length around
DOUBLE = 1e-7  # a pair closer than this, relative, has no orientation of its own


@dataclass(frozen=True, slots=True, eq=False)
class Rings:
    """Fourier amplitudes of modes on the rings of a casing.

    `amplitudes` is (n, rings, 3, modes) complex, for (radial, hoop, axial); `weights` (rings,) sum to 1.
    """

    amplitudes: Array
    weights: FloatArray

    __repr__ = brief

    def shares(self) -> FloatArray:
        """Share of each n in a mode's circumferential energy, (n_max + 1, modes)."""
        energy = np.einsum("nrcm,r->nm", np.abs(self.amplitudes) ** 2, self.weights)
        energy[0] *= 2.0  # a cosine's mean square is one half, a constant's is one
        return np.asarray(energy / energy.sum(axis=0))

    def first(self, modes: int) -> "Rings":
        """Harmonics of the first modes, as many as given."""
        return Rings(self.amplitudes[..., :modes], self.weights)

    def label(self) -> tuple[IntArray, FloatArray]:
        """Nodal diameters with the largest energy, and that energy's share, each (modes,)."""
        shares = self.shares()
        n = shares.argmax(axis=0)
        return n, shares[n, np.arange(len(n))]

    def profile(self, mode: int, n: int) -> Array:
        """Weighted amplitudes of one mode at one n: (3 rings,) complex, radial first."""
        return (self.amplitudes[n, :, :, mode] * np.sqrt(self.weights)[:, None]).T.ravel()


def ring_content(chart: Chart, grid: Grid, fields: Array, n_max: int | None = None) -> Rings:
    """Fourier amplitudes of nodal fields (nodes, 5, modes) up to n_max, by default as far as the nodes resolve."""
    n_max = n_max or max(2, grid.mesh.order * grid.mesh.columns // 3)
    rings, transform = ring_transform(chart, grid, n_max, None if is_axisymmetric(chart) else arc_places(chart))
    if is_axisymmetric(chart):
        theta = grid.nodes[1]
        c, s = np.cos(theta)[:, None], np.sin(theta)[:, None]
        x, y, axial = fields[:, 0], fields[:, 1], fields[:, 2]
        cylindrical = np.stack([x * c + y * s, y * c - x * s, axial], axis=1)
    else:
        cylindrical = np.einsum("din,nik->ndk", np.real(chart.directions(*grid.nodes)), fields[:, :3])
    parts = np.concatenate([transform.real, transform.imag])  # products of real numbers: half of those of complex ones
    on_rings = np.matmul(parts, cylindrical[rings].reshape(*rings.shape, -1))
    waves = on_rings[:, : n_max + 1] + 1j * on_rings[:, n_max + 1 :]
    amplitudes = waves.swapaxes(0, 1).reshape(n_max + 1, len(rings), 3, -1)
    return Rings(amplitudes=amplitudes, weights=ring_weights(grid.mesh))


def ring_weights(mesh: ShellMesh) -> FloatArray:
    """Weights of a mesh's rings of nodes, (rings,), which sum to 1: the Lobatto rule along the first parameter."""
    _, w = lobatto(mesh.order)
    weights = np.zeros((len(mesh.breaks) - 1) * mesh.order + 1)
    for row, width in enumerate(np.diff(mesh.breaks)):
        weights[row * mesh.order :][: len(w)] += width * w
    return weights


def arc_places(chart: Chart) -> Callable[[FloatArray], FloatArray]:
    """The second parameter of a closed chart at angles 2 pi s/L; s: arc length around at mid-height, L: its total."""
    (a0, a1), (b0, b1) = np.real(np.array(chart.bounds, dtype=complex))
    b = np.linspace(b0, b1, ARC)
    speed = np.linalg.norm(np.real(chart.surface(np.full(ARC, 0.5 * (a0 + a1)), b, None).x2), axis=0)
    arc = np.append(0.0, np.cumsum(speed[1:] + speed[:-1]))
    turns = arc / arc[-1]
    return lambda angle: np.interp(np.mod(angle / (2.0 * np.pi), 1.0), turns, b)


def orientation(profile: Array, n: int) -> float:
    """Angle of an antinode of the radial displacement [rad], in [0, pi/n); nan for n = 0.

    u_r ~ cos n (theta - psi) has amplitude e^(-i n psi); squaring removes the rings' signs.
    """
    if n == 0:
        return float("nan")
    radial = profile[: len(profile) // 3]
    angle = -np.angle(np.sum(radial**2)) / (2.0 * n)
    angle = float(np.mod(angle, np.pi / n))
    return angle if np.pi / n - angle > 1e-9 else 0.0


def quadrature(a: Array, b: Array) -> float:
    """Agreement of b with a rotated by a quarter wave: 1 for the members of a perfect pair."""
    return float(abs(np.real(np.vdot(1j * a, b))) / (np.linalg.norm(a) * np.linalg.norm(b)))


def find_doublets(rings: Rings, n: IntArray) -> list[tuple[int, int]]:
    """Pairs of modes that belong together: equal n >= 1, a quarter wave apart, nearest in frequency."""
    pairs = []
    for label in np.unique(n[n > 0]):
        waiting = np.flatnonzero(n == label).tolist()
        while waiting:
            mode = waiting.pop(0)
            own = rings.profile(mode, label)
            partner = next((k for k in waiting if quadrature(own, rings.profile(k, label)) > 0.5), None)
            if partner is not None:
                waiting.remove(partner)
                pairs.append((mode, partner))
    return sorted(pairs)


def align_pair(first: Array, second: Array) -> FloatArray:
    """Rotation (2, 2) of a degenerate pair into its cosine and sine members.

    The cosine member has the least imaginary part; columns are (cosine, sine), with positive peaks.
    """
    profiles = np.stack([first, second], axis=1)
    radial = profiles[: len(profiles) // 3]
    _, turn = np.linalg.eigh(radial.imag.T @ radial.imag)
    peak = np.abs(radial @ turn[:, 0]).argmax()
    signs = np.sign([(radial @ turn[:, 0])[peak].real, -(radial @ turn[:, 1])[peak].imag])
    return np.asarray(turn * np.where(signs == 0.0, 1.0, signs))
