"""Modes of a rotating shell with Coriolis forces, which split the doublets of a casing into travelling waves.

In the rotating frame M x'' + Omega G x' + K(Omega) x = 0 with M, K symmetric and G skew. With (x, v = x') the inverse
problem (x, v) -> (-K^-1 (M v + Omega G x), x) has the eigenvalues 1/(i omega): one factorisation of K and Arnoldi's
largest ones. While K is positive definite all omega are real, and K + i omega Omega G - omega^2 M has as many negative
eigenvalues as there are frequencies between 0 and omega: the count that verifies them (K. Veselic, Damped Oscillations
of Linear Systems, 2011).
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import ArpackError, LinearOperator, eigs

from casingfem.errors import ModelError, NumericsError
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.eigen import gap_after
from casingfem.linalg.factor import factorise
from casingfem.linalg.krylov import START_SEED
from casingfem.modal.campbell import spin_from_rest
from casingfem.modal.harmonics import Rings, ring_content
from casingfem.modal.mesh_modes import projected
from casingfem.modal.mode_set import frequency_scale
from casingfem.structure.geometry.chart import is_axisymmetric
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.assembly import MeshStructure, MeshSystem
from casingfem.structure.imported.revolution import round_about_z
from casingfem.structure.imported.turning_structure import rotation_of
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System
from contact.io.columns import Column, known
from contact.io.reported import Reported

SENSES = {1: "forward", -1: "backward", 0: "none"}
COLUMNS = (
    Column("mode", "Number of the mode, from 1.", lambda found: range(1, 1 + len(found)), format="d"),
    Column("freq_hz", "Frequency for an observer who turns with the structure.", lambda found: found.freq,
           head="turning", unit="Hz", format=".3f"),
    Column("freq_fixed_hz", "Frequency for an observer at rest.", lambda found: found.freq_fixed, head="at rest",
           unit="Hz", format=".3f"),
    Column("n", "Nodal diameters; none where the structure is not of revolution about its axis.",
           lambda found: known(found.nodal_diameters), format="d"),
    Column("sense", "1 for a wave that runs with the rotation, -1 for one against it, 0 for none.",
           lambda found: found.sense, head="wave", format=SENSES.__getitem__),
)  # fmt: skip


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class WhirlModes(Reported):
    """Modes of a rotating shell or imported part in the rotating frame, ascending.

    Attributes
    ----------
    freq
        Frequencies in the rotating frame [Hz], (modes,).
    fields
        Complex shapes at the nodes, (nodes, 3 or 5, modes): the motion is the real part of shape times e^(i omega t).
    nodal_diameters
        Dominant n of a casing of revolution that rotates about z, else -1, (modes,).
    sense
        1 for a wave that travels with the rotation, -1 for one against it, 0 for none (n = 0, open shells), (modes,).
    sturm_count
        Modes up to the last one, by inertia.

    Examples
    --------
    >>> import casingfem as cf
    >>> drum = cf.Shell(chart=cf.Cylinder(radius=0.2, height=0.1), thickness=2e-3, supports={"base": cf.Clamped()},
    ...                 material=cf.Material(E=210e9, nu=0.3, rho=7800.0), rotation=cf.Rotation(omega=300.0),
    ...                 mesh=cf.ShellMesh(order=6, rows=2, around=9))
    >>> low = cf.whirl_modes(drum, 2)  # waves with and against the rotation
    >>> low.sense.tolist(), bool(low.freq[1] > low.freq[0])
    ([1, -1], True)
    """

    COLUMNS: ClassVar = COLUMNS

    shell: Shell | MeshStructure
    freq: FloatArray
    fields: Array
    nodal_diameters: IntArray
    sense: IntArray
    sturm_count: int

    def __len__(self) -> int:
        """Return the number of modes."""
        return len(self.freq)

    @property
    def freq_fixed(self) -> FloatArray:
        """Frequencies [Hz] of the waves on a casing in the fixed frame: |f + sense n Omega/2 pi|, (modes,)."""
        return freq_at_rest(self.freq, self.sense * self.nodal_diameters, rotation_of(self.shell))


def freq_at_rest(freq: FloatArray, waves: IntArray, rotation: Rotation | None) -> FloatArray:
    """Frequencies [Hz] in the fixed frame: |f + s n Omega/2 pi|, for `waves` s n that travel with the rotation."""
    turns = 0.0 if rotation is None else abs(rotation.omega) / (2.0 * np.pi)
    return np.abs(freq + waves * turns)


def whirl_modes(shell: Shell | MeshStructure, count: int = 10) -> WhirlModes:
    """Lowest `count` modes of a rotating structure, Coriolis forces included, complete by a count of inertia.

    Parameters
    ----------
    shell
        A supported shell, or imported part, with a `rotation`.
    count
        Number of modes; each doublet of a casing gives a forward and a backward wave.

    Raises
    ------
    ModelError
        `rotation-none` for a shell at rest, `rotation-unstable` if K(Omega) is not positive definite.
    NumericsError
        If the modes cannot be computed or verified.

    Examples
    --------
    >>> import casingfem as cf
    >>> drum = cf.Shell(chart=cf.Cylinder(radius=0.2, height=0.1), thickness=2e-3, supports={"base": cf.Clamped()},
    ...                 material=cf.Material(E=210e9, nu=0.3, rho=7800.0), rotation=cf.Rotation(omega=300.0),
    ...                 mesh=cf.ShellMesh(order=6, rows=2, around=9))
    >>> low = cf.whirl_modes(drum, 2)
    >>> low.nodal_diameters.tolist(), low.sense.tolist()
    ([7, 7], [1, -1])
    """
    if isinstance(shell, Shell) and shell.rotation is None:
        raise ModelError("rotation-none", "whirl_modes: found a shell without rotation, expected one with")
    system, added = spin_from_rest(shell, "whirl_modes")
    rotation = rotation_of(shell)
    assert rotation is not None  # or spin_from_rest would have refused it
    K = csc_array(system.K + added.stiffness(rotation.omega))
    if isinstance(system, System):
        root = diags_array(1.0 / np.sqrt(system.mass))
        A, G = csc_array(root @ K @ root), csc_array(rotation.omega * (root @ added.G @ root))
        values, vectors, certified = gyroscopic_modes(A, G, count, scale=frequency_scale(system.shell))
        vectors = root @ vectors
    else:
        G = csc_array(rotation.omega * added.G)
        values, vectors, certified = gyroscopic_modes(K, G, count, scale=system.frequency_scale, mass=system.M)
    fields = expand_complex(system, vectors)[:, :, :count]
    n, sense = wave_labels(system, rotation, fields)
    freq = values[:count] / (2.0 * np.pi)
    return WhirlModes(shell=shell, freq=freq, fields=fields, nodal_diameters=n, sense=sense, sturm_count=certified)


def gyroscopic_modes(
    A: csc_array, G: csc_array, count: int, scale: float, extra: int = 4, mass: csc_array | None = None
) -> tuple[FloatArray, Array, int]:
    """Frequencies [rad/s] ascending and complex shapes of M x'' + G x' + A x = 0, up to a gap at or after `count`.

    M is 1 by default. For a Hermitian A and a skew-Hermitian G, those with motion x e^(i omega t), omega > 0.
    """
    size = A.shape[0]
    M = csc_array(diags_array(np.ones(size))) if mass is None else mass
    if not 1 <= count < size // 2 - extra:
        raise NumericsError(f"count must lie between 1 and {size // 2 - extra - 1}, found {count}")
    factor = factorise(A)
    if factor.negative():
        text = f"whirl_modes: found {factor.negative()} negative eigenvalues of the stiffness, expected none"
        raise ModelError("rotation-unstable", text)

    def inverse(state: Array) -> Array:
        x, v = np.split(np.ravel(state), 2)  # v represents x'/scale
        return np.concatenate([-factor.solve(scale * (M @ v) + G @ x), x / scale])

    operator = LinearOperator((2 * size, 2 * size), matvec=inverse, dtype=A.dtype)
    start = np.random.default_rng(START_SEED).standard_normal(2 * size)
    wanted = 2 * (count + extra)
    try:
        found, states = eigs(operator, wanted, v0=start.astype(A.dtype))
    except ArpackError as error:
        found, states = getattr(error, "eigenvalues", ()), getattr(error, "eigenvectors", None)
        if len(found) < wanted:  # scipy 1.14 may hand over all of them with this error; they are counted below
            text = f"whirl_modes: ARPACK did not converge to {count + extra} modes ({error}); ask for fewer modes"
            raise NumericsError(text) from error
    upper = np.flatnonzero(found.imag < 0.0)  # 1/(i omega), omega > 0
    upper = upper[np.argsort(-np.abs(found[upper]))]
    omega = 1.0 / np.abs(found[upper])
    below, sigma = gap_after(omega, count)
    shifted = csc_array(A + 1j * sigma * G - sigma**2 * M)
    certified = factorise(shifted).negative()
    if certified != below:
        raise NumericsError(f"{certified} modes lie below {sigma / 2 / np.pi:.6g} Hz, {below} were found")
    return omega[:below], states[:size, upper[:below]], certified


def expand_complex(system: System | MeshSystem, vectors: Array) -> Array:
    """Nodal fields (nodes, dofs, modes) with largest displacement 1, from free dofs (free, modes)."""
    fields = system.expand(vectors)
    flat = fields[:, :3].reshape(-1, fields.shape[2])
    return np.asarray(fields / flat[np.abs(flat).argmax(axis=0), np.arange(fields.shape[2])])


def wave_labels(system: System | MeshSystem, rotation: Rotation, fields: Array) -> tuple[IntArray, IntArray]:
    """Nodal diameters and sense of the waves on a casing of revolution that rotates about z, each (modes,).

    e^(i n theta) e^(i omega t) travels towards smaller theta, e^(-i n theta) e^(i omega t) towards larger.
    """
    both = (fields.conj(), fields)
    about_z = bool(np.abs(rotation.direction[2]) > 1.0 - 1e-9 and not np.any(rotation.centre[:2]))
    if isinstance(system, System) and about_z and is_axisymmetric(system.shell.chart):
        waves = [ring_content(system.shell.chart, system.grid, part) for part in both]
    elif isinstance(system, MeshSystem) and about_z and round_about_z(system.structure.mesh):
        waves = [projected(system.structure, part) for part in both]
    else:
        return np.full(fields.shape[2], -1), np.zeros(fields.shape[2], dtype=np.int64)
    return wave_sense(waves, float(np.sign(rotation.omega * rotation.direction[2])))


def wave_sense(waves: list[Rings], turning: float) -> tuple[IntArray, IntArray]:
    """Nodal diameters and sense from the contents of the conjugate shapes and of the shapes, each (modes,)."""
    energy = np.stack([np.einsum("nrcm,r->nm", np.abs(wave.amplitudes) ** 2, wave.weights) for wave in waves])
    n = energy.sum(axis=0).argmax(axis=0)
    forward, backward = energy[:, n, np.arange(len(n))]
    sense = np.where(n > 0, np.sign(forward - backward) * turning, 0.0)
    return n, sense.astype(np.int64)
