"""Modes of a perfect casing: one dense meridian problem for each number of nodal diameters, doublets exact."""

import time

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eigh

from casingfem.arrays import FloatArray
from casingfem.modal.eigen import EigenError
from casingfem.modal.mode_set import Modes, frequency_scale, labelled
from casingfem.structure.axisymmetric import HOOP, Meridian, harmonic_matrices
from casingfem.structure.mesh import Grid, make_grid
from casingfem.structure.shell import Shell

SHIFT = 0.5  # shift-invert about minus the square of this part of `frequency_scale`


def fourier_modes(shell: Shell, count: int) -> Modes:
    """Lowest modes of a perfect casing, one dense meridian problem for each n, doublets exact.

    Harmonics are added until four in a row start above the band; every eigenvalue of each is known, so the
    count is complete.
    """
    started = time.perf_counter()
    grid = make_grid(shell.chart, shell.mesh)
    found: list[tuple[float, int, FloatArray]] = []
    shift = (SHIFT * frequency_scale(shell)) ** 2
    above, n, limit = 0, 0, np.inf
    while above < 4:
        meridian = harmonic_matrices(shell, n)
        values, vectors = lowest(meridian, count, shift)
        shapes = meridian.expand(vectors)
        for k in np.flatnonzero(values <= limit):
            found += [(float(values[k]), n, shapes[:, :, k])] * (1 if n == 0 else 2)
        if len(found) >= count:
            found.sort(key=lambda item: (item[0], item[1]))
            limit = found[count - 1][0] * (1.0 + 1e-12)
            found = [item for item in found if item[0] <= limit]
        above = above + 1 if values[0] > limit else 0
        n += 1
        if n > 400:
            raise EigenError(f"{count} modes reach beyond 400 nodal diameters: refine the question")
    freq = np.sqrt(np.maximum([value for value, _, _ in found], 0.0)) / (2.0 * np.pi)
    fields = np.stack(
        [
            revolve_shape(grid, shape, n, sine=n > 0 and k > 0 and found[k - 1][2] is shape)
            for k, (_, n, shape) in enumerate(found)
        ],
        axis=-1,
    )
    seconds = {"solve": time.perf_counter() - started}
    return labelled(
        shell, grid, freq, fields, count=count, sturm=len(found), dofs=n * len(meridian.free), seconds=seconds
    )


def lowest(meridian: Meridian, count: int, shift: float) -> tuple[FloatArray, FloatArray]:
    """Lowest eigenvalues and mass-normalised vectors of one harmonic, by the inverse of K + shift M.

    Small eigenvalues (rigid motions, thin free rings) would drown in the round-off of K's large ones.
    """
    root = 1.0 / np.sqrt(meridian.mass)
    size = len(root)
    factor = cho_factor(root[:, None] * meridian.K * root + shift * np.eye(size))
    flexibility = cho_solve(factor, np.eye(size))
    start = max(0, size - count)
    values, vectors = eigh(0.5 * (flexibility + flexibility.T), subset_by_index=[start, size - 1])
    return 1.0 / values[::-1] - shift, root[:, None] * vectors[:, ::-1]


def revolve_shape(grid: Grid, shape: FloatArray, n: int, *, sine: bool) -> FloatArray:
    """Spread a meridian shape (nodes on the meridian, 5) around: nodal field (nodes, 5), mass-normalised."""
    z, theta = grid.nodes
    _, row = np.unique(np.round(z / np.ptp(z), 9), return_inverse=True)
    wave = (shape * HOOP)[row] * np.exp(1j * n * theta)[:, None]
    hoop_only = np.abs(shape[:, [1, 4]]).max() > np.abs(shape[:, [0, 2, 3]]).max()
    part = wave.imag if sine or (n == 0 and hoop_only) else wave.real
    c, s = np.cos(theta), np.sin(theta)
    field = part.copy()
    field[:, 0] = part[:, 0] * c - part[:, 1] * s
    field[:, 1] = part[:, 0] * s + part[:, 1] * c
    return np.asarray(field / np.sqrt(2.0 * np.pi if n == 0 else np.pi))
