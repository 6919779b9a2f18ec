"""Waves that describe a wheel's motion: tuned modes of all diameters, and residual shapes of forces at its channels.

The modes of each diameter are supplemented by the sector's residual attachment r = (K^-1 - Phi Lambda^-1 Phi^H) T^H P.
It is K- and M-orthogonal to the modes, so its few combinations that are K- and M-orthogonal to each other are further
waves. With them the static response at the channels is exact, and that of a mistuned wheel is accurate to second order.

A pair z with 0 < n < N/2 has two real amplitudes: u_j = sqrt(2/N) Re(z e^(i n alpha j) (c - i s)) in sector j.
"""

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag
from scipy.sparse import csc_array

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.factor import factorise
from casingfem.modal.cyclic.modes import solved
from casingfem.structure.imported.cyclic.sector import CyclicSystem

NOTHING = 1e-10  # of the largest energy: an attachment that the others already make


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Waves:
    """Real coordinates of the wheel, D of them: by diameter, cosines before sines.

    Attributes
    ----------
    sectors
        N.
    n
        Diameter of each coordinate, (D,).
    omega
        Tuned frequency of each [rad/s], (D,); those of attachments are far above.
    modes
        Whether each coordinate is a mode, not an attachment, (D,).
    partner, sign
        Index of the sine of a cosine and vice versa, its own for n = 0 and N/2, (D,); and the factor of its part, (D,).
    places
        Motion of the channels of sector 0, with the real part before the imaginary one for a pair, (channels, D).
    blade
        Elastic energy of the blade of sector 0 between the coordinates, (D, D); empty unless requested.
    added, gyroscopic
        Modal stiffness that each (rad/s)^2 adds, and the Coriolis matrix per rad/s about the axis of the rotation,
        (D, D) each; empty without rotation.
    """

    sectors: int
    n: IntArray
    omega: FloatArray
    modes: Array
    partner: IntArray
    sign: FloatArray
    places: FloatArray
    blade: FloatArray
    added: FloatArray
    gyroscopic: FloatArray

    def turned(self, table: FloatArray, j: int) -> FloatArray:
        """A table (..., D) of sector 0 rotated to sector j."""
        phase = 2.0 * np.pi * j * self.n / self.sectors
        own = self.partner == np.arange(len(self.n))
        sine = np.where(own, 0.0, self.sign * np.sin(phase))
        return np.asarray(table * np.cos(phase) + table[..., self.partner] * sine)

    def rows(self) -> FloatArray:
        """Motion of the channels of every sector, (N channels, D)."""
        return np.concatenate([self.turned(self.places, j) for j in range(self.sectors)])

    def blade_energy(self, j: int) -> FloatArray:
        """Elastic energy of the blade of sector j between the coordinates, (D, D)."""
        return self.turned(self.turned(self.blade, j).T, j).T


def wheel_waves(system: CyclicSystem, count: int, loads: FloatArray | None, blade: csc_array | None) -> Waves:
    """The waves of a wheel: `count` modes of each diameter, attachments of `loads` (free, channels), a blade's energy.

    Raises
    ------
    NumericsError
        If modes cannot be computed, or a stiffness is singular.
    """
    sector = system.sector
    P = np.zeros((system.system.size, 0)) if loads is None else loads
    held = np.unique(blade.nonzero()[0]) if blade is not None else np.zeros(0, dtype=np.int64)
    parts = defaultdict[str, list[Array]](list)
    added: list[FloatArray] = []
    gyroscopic: list[FloatArray] = []
    first = 0
    for n in sector.diameters:
        omega, Z, modes = waves_of(system, n, count, P)
        scale, size = np.sqrt(sector.count(n) / sector.sectors), len(omega)
        copies = sector.count(n)
        for name, values in (("n", np.full(size, n)), ("omega", omega), ("modes", modes)):
            parts[name] += [values] * copies
        own = first + np.arange(size * copies)
        parts["partner"].append(np.roll(own, size) if copies == 2 else own)
        parts["sign"] += [np.full(size, -1.0), np.ones(size)][:copies]
        for name, values in (("places", scale * (P.T @ Z)), ("shapes", scale * Z[held])):
            parts[name] += [values.real, values.imag][:copies]
        if system.spin is not None:
            added.append(between(Z, system.spin.K1, copies))
            gyroscopic.append(between(Z, system.spin.G, copies))
        first += size * copies
    joined = {name: np.concatenate(part, axis=-1) for name, part in parts.items()}
    shapes = joined.pop("shapes")
    energy = np.zeros((0, 0)) if blade is None else shapes.T @ (blade[held][:, held] @ shapes)
    stiff, G = (block_diag(*blocks) if blocks else np.zeros((0, 0)) for blocks in (added, gyroscopic))
    even, skew = 0.5 * (stiff + stiff.T), 0.5 * (G - G.T)
    return Waves(sectors=sector.sectors, blade=energy, added=even, gyroscopic=skew, **joined)


def between(Z: Array, A: csc_array, copies: int) -> FloatArray:
    """A real matrix of the wheel between the real amplitudes of its waves: Re(a^H Z^H A Z a') for a = c - i s."""
    H = Z.conj().T @ (A @ Z)
    return np.asarray(np.block([[H.real, H.imag], [-H.imag, H.real]]) if copies == 2 else H.real)


def waves_of(system: CyclicSystem, n: int, count: int, P: FloatArray) -> tuple[FloatArray, Array, Array]:
    """Frequencies, vectors on the sector's free dofs with x^H M x = 1, and marks of modes, for one diameter."""
    found = solved(system, n, count)
    omega, X = np.sqrt(found.eigenvalues[:count]), found.vectors[:, :count]
    if not P.shape[1]:
        return omega, X, np.ones(len(omega), dtype=bool)
    K, _, T = system.matrices(n)
    attached = T @ factorise(K).solve(np.asarray(T.conj().T @ P))
    r = attached - X @ ((X.conj().T @ P) / omega[:, None] ** 2)
    stiff = r.conj().T @ (system.system.K @ r)
    energy, turn = np.linalg.eigh(0.5 * (stiff + stiff.conj().T))
    kept = energy > NOTHING * energy.max(initial=0.0)
    r = r @ (turn[:, kept] / np.sqrt(energy[kept]))
    inertia = r.conj().T @ (system.system.M @ r)
    squares, turn = np.linalg.eigh(0.5 * (inertia + inertia.conj().T))  # 1/omega^2
    r = r @ (turn / np.sqrt(squares))
    modes = np.concatenate([np.ones(len(omega), dtype=bool), np.zeros(len(squares), dtype=bool)])
    return np.concatenate([omega, 1.0 / np.sqrt(squares)]), np.hstack([X, r]), modes
