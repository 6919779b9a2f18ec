"""Distance of the residues of one mode, measured in several set-ups, from a common shape.

Residues over sensors o and references r are phi_o psi_r. Round a circle phi = a cos n theta + b sin n theta, with the n
that fits best; elsewhere phi is free, and set-ups can be compared if they share sensors, or if they share two or more
references. The weight of a channel follows from its deviation from the shapes of all modes: an inverted, exchanged or
dead channel has a small weight.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.circle.orientation import Circle, harmonic
from casingfem.experiment.frf.sensor_grid import SensorGrid, radial_signs
from casingfem.experiment.identify.mode import Found
from casingfem.io.arrays import Array, FloatArray, IntArray

FIRST, LEAST, MOST = 0.3, 0.05, 3.0  # deviation of a channel, of the size of the shape: before it is estimated, bounds
WHOLE = 3  # modes that all set-ups show, from which deviations of channels are estimated
SWEEPS = 4


class Member(NamedTuple):
    """A mode of one set-up, and the reasons why it is doubtful."""

    found: Found
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shapes:
    """Members of each set-up, its channels, the sensors, their waves (orders, sensors, 2) or None.

    `deviation` (channels,) is that of a residue from the shape, relative to the size of the shape.
    """

    members: list[list[Member]]
    channels: list[IntArray]
    grid: SensorGrid
    waves: FloatArray | None
    deviation: FloatArray

    @classmethod
    def of(
        cls, members: list[list[Member]], channels: list[IntArray], grid: SensorGrid, circle: Circle | None
    ) -> Shapes:
        """Shapes with equal weights of all channels."""
        waves = None
        if circle is not None and circle.orders:
            parts = [radial_signs(grid)[:, None] * harmonic(grid.theta, n) for n in circle.orders]
            waves = np.array([np.pad(part, ((0, 0), (0, 2 - part.shape[1]))) for part in parts])
        deviation = np.full(grid.channels.size, FIRST)
        return cls(members=members, channels=channels, grid=grid, waves=waves, deviation=deviation)

    @property
    def silent(self) -> bool:
        """Whether shapes give no information: one reference, and no circle of sensors."""
        return self.waves is None and self.grid.channels.shape[1] == 1

    def joined(self, row: tuple[int, ...]) -> Array:
        """Residues of a row at all channels, nan where the row has none."""
        values = np.full(self.grid.channels.size, complex(np.nan, np.nan))
        for setup, k in enumerate(row):
            if k >= 0:
                values[self.channels[setup]] = self.members[setup][k].found.residues.values
        return values

    def rest(self, row: tuple[int, ...], sweeps: int = 0) -> tuple[Array, FloatArray, float]:
        """Residues minus the best-fitting shape (sensors, references), their weights, and the size of the shape.

        With `sweeps` the fit minimises the sum of the absolute deviations instead of their squares.
        """
        values, noise = self.joined(row), np.ones(self.grid.channels.size)
        for setup, k in enumerate(row):
            if k >= 0:
                residues = self.members[setup][k].found.residues
                noise[self.channels[setup]] = 2.0 * residues.direct + np.sum(np.abs(residues.moved) ** 2, axis=1)
        there = ~np.isnan(values)
        A = np.where(there, values, 0.0)
        size = float(np.median(np.abs(A[there]))) + 1e-300
        weight = np.where(there, 1.0 / ((self.deviation * size) ** 2 + noise), 0.0)
        A, weight = A[self.grid.channels], weight[self.grid.channels]
        if self.waves is None:
            return A - _free(A, weight), weight, size
        rest = A - _waves(A, np.broadcast_to(weight, (len(self.waves), *weight.shape)), self.waves)
        for _ in range(sweeps):
            rest = A - _waves(A, weight / (np.abs(rest) / size + LEAST), self.waves)
        best = int(np.argmin(np.sum(weight * np.abs(rest) ** (1 if sweeps else 2), axis=(1, 2))))
        return rest[best], weight, size

    def cost(self, row: tuple[int, ...]) -> float:
        """Half of N ln(1 + chi^2/N) for N real numbers."""
        if self.silent:
            return 0.0
        rest, weight, _ = self.rest(row)
        count = 2.0 * np.count_nonzero(weight)
        return float(0.5 * count * np.log1p(2.0 * np.sum(weight * np.abs(rest) ** 2) / count))

    def learned(self, rows: list[tuple[int, ...]]) -> Shapes:
        """The shapes with channel deviations estimated from the rows of all set-ups."""
        whole = [row for row in rows if min(row) >= 0]
        if self.silent or len(whole) < WHOLE:
            return self
        shapes = self
        for sweep in range(SWEEPS):
            square = np.zeros((len(whole), len(self.deviation)))
            for each, row in zip(square, whole, strict=True):
                rest, _, size = shapes.rest(row, 0 if sweep else 2 * SWEEPS)
                each[self.grid.channels] = np.abs(rest / size) ** 2
            deviation = np.sqrt(np.median(square, axis=0) / np.log(2.0))  # |x|^2 of complex noise is exponential
            shapes = replace(shapes, deviation=np.clip(deviation, LEAST, MOST))
        return shapes


def _waves(A: Array, weight: FloatArray, W: FloatArray) -> Array:
    """The best W x psi^T of each order (orders, sensors, references)."""
    G = np.einsum("nsi,nsr,nsj->nrij", W, weight, W)
    G = G + (1e-9 * np.trace(G, axis1=2, axis2=3).max() + 1e-300) * np.eye(2)
    right = np.einsum("nsi,nsr->nri", W, weight * A)
    x = np.linalg.solve(G, right[..., None])[..., 0]  # (orders, references, 2)
    if A.shape[1] > 1:
        x = _one_shape(G, right, x)
    return np.asarray(np.einsum("nsi,nri->nsr", W, x))


def _one_shape(G: Array, right: Array, x: Array) -> Array:
    """Coefficients (orders, references, 2) of rank one that fit best, by alternating least squares."""
    largest = np.argmax(np.sum(np.abs(x) ** 2, axis=2), axis=1)
    shape = x[np.arange(len(x)), largest]
    psi = np.zeros(x.shape[:2], complex)
    for _ in range(SWEEPS):
        size = np.einsum("ni,nrij,nj->nr", shape.conj(), G, shape).real + 1e-300
        psi = np.einsum("ni,nri->nr", shape.conj(), right) / size
        normal = np.einsum("nr,nrij->nij", np.abs(psi) ** 2, G) + 1e-300 * np.eye(2)
        shape = np.linalg.solve(normal, np.einsum("nr,nri->ni", psi.conj(), right)[..., None])[..., 0]
    return np.asarray(psi[..., None] * shape[:, None, :])


def _free(A: Array, weight: FloatArray) -> Array:
    """The best phi psi^T, by alternating least squares (sensors, references)."""
    psi = np.linalg.svd(np.sqrt(weight) * A, full_matrices=False)[2][0]
    phi = np.zeros(len(A), complex)
    for _ in range(2 * SWEEPS):
        phi = (weight * A) @ psi.conj() / (weight @ np.abs(psi) ** 2 + 1e-300)
        psi = (weight * A).T @ phi.conj() / (weight.T @ np.abs(phi) ** 2 + 1e-300)
    return np.outer(phi, psi)
