"""A wheel for engine-order response: its stiffness in waves, one channel of each blade, mistuning, air.

Coordinates are mass-normalised waves a (D,). Blade j with relative frequency deviation delta_j adds
((1 + delta_j)^2 - 1) E_j, where E_j is the elastic energy of that blade. The aerodynamic force on blade j is

    -sum_k (k_k + i w c_k) x_{j+k},   with the motion x of the channel,

from the influence coefficients of the blades at offsets k (F. Lane, J. Aeronaut. Sci. 23, 1956, 65).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import csc_array

from casingfem.errors import InputError, ModelError
from casingfem.io import strict_csv
from casingfem.io.arrays import Array, FloatArray, IntArray, frozen
from casingfem.modal.cyclic.mistuned import Deviations, checked_deviations, richer
from casingfem.modal.cyclic.modes import solved
from casingfem.modal.cyclic.waves import wheel_waves
from casingfem.modal.interface.kinds import AtNodes, Interface, Rim
from casingfem.modal.interface.view import view
from casingfem.structure.imported.cyclic.sector import CyclicSector, CyclicSystem, assemble_cyclic
from casingfem.structure.imported.cyclic.wheel import blade_stiffness

FAINT = 1e-3  # of the largest force of a blade
HEADER = ("offset", "stiffness", "damping")


@dataclass(frozen=True, eq=False, kw_only=True)
class Influence:
    """Influence coefficients of the air: forces on a blade due to the motion of the blade `offset` places ahead.

    `stiffness` [N/m] and `damping` [N s/m] oppose the motion; offset 0 is the blade's own motion.

    >>> air = Influence(offset=[-1, 0, 1], stiffness=[20.0, 100.0, -20.0], damping=[0.0, 0.3, 0.0])
    >>> complex(air.of_diameter(0, 8, 1000.0))
    (100+300j)
    """

    offset: IntArray
    stiffness: FloatArray
    damping: FloatArray

    def __post_init__(self) -> None:
        offset = np.asarray(self.offset)
        sizes = {np.shape(values) for values in (offset, self.stiffness, self.damping)}
        if offset.ndim != 1 or len(sizes) != 1 or not np.issubdtype(offset.dtype, np.integer):
            raise InputError(
                "influence", found=f"shapes {sizes}", expected="one stiffness and one damping for each offset"
            )
        if len(set(offset.tolist())) != offset.size:
            raise InputError("influence.offset", found=f"{offset.tolist()}", expected="each offset once")
        object.__setattr__(self, "offset", frozen(offset))
        for name in ("stiffness", "damping"):
            values = np.asarray(getattr(self, name), dtype=float)
            if not np.isfinite(values).all():
                raise InputError(f"influence.{name}", found="a number that is not finite", expected="finite numbers")
            object.__setattr__(self, name, frozen(values))

    @staticmethod
    def from_csv(path: str | Path) -> "Influence":
        """Read the columns offset, stiffness [N/m], damping [N s/m]; raises InputError with the line."""
        table = strict_csv.read(Path(path))
        if set(table.header) != set(HEADER):
            raise table.refuse_header(found=",".join(table.header), expected=",".join(HEADER))
        return Influence(
            offset=table.integers("offset"), stiffness=table.numbers("stiffness"), damping=table.numbers("damping")
        )

    def of_diameter(self, n: int, blades: int, omega: float) -> complex:
        """Aerodynamic stiffness of a wave e^(2 pi i n j/N) at omega [rad/s], [N/m]."""
        values = self.stiffness + 1j * omega * self.damping
        return complex(np.sum(values * np.exp(2j * np.pi * n * self.offset / blades)))

    def between(self, blades: int, omega: float) -> Array:
        """Force on blade j due to the motion of blade l at omega, with reversed sign, (N, N) [N/m]."""
        found = np.zeros((blades, blades), dtype=np.complex128)
        values = self.stiffness + 1j * omega * self.damping
        own = np.arange(blades)
        for offset, value in zip(self.offset.tolist(), values.tolist(), strict=True):
            found[own, (own + offset) % blades] += value
        return found


@dataclass(frozen=True, eq=False, kw_only=True)
class BladedWheel:
    """A tuned wheel of N blades and its mistuning terms.

    Attributes
    ----------
    stiffness
        K (D, D) [1/s^2] of mass-normalised coordinates.
    rows
        Motion of the channel of each blade, (N, D).
    energy
        E_j of each blade, (N, D, D).
    freq, diameters
        Tuned frequencies [Hz] and their nodal diameters, (modes,).

    Examples
    --------
    >>> wheel = BladedWheel.chain(blades=12, freq_hz=100.0, mass=0.2, coupling=0.01)
    >>> wheel.freq[:2].round(3).tolist(), wheel.diameters[:2].tolist()
    ([100.0, 100.134], [0, 1])
    """

    stiffness: FloatArray
    rows: FloatArray
    energy: FloatArray
    freq: FloatArray
    diameters: IntArray

    @property
    def blades(self) -> int:
        """N."""
        return len(self.rows)

    @staticmethod
    def chain(*, blades: int, freq_hz: float, mass: float, coupling: float) -> "BladedWheel":
        """Make N masses, each on its own spring, joined in a ring by springs `coupling` times as stiff.

        Frequencies of n nodal diameters: f sqrt(1 + 4 coupling sin^2(pi n/N)).
        """
        if blades < 2 or not (freq_hz > 0.0 and mass > 0.0 and coupling >= 0.0):
            found = f"blades = {blades}, freq_hz = {freq_hz:g}, mass = {mass:g}, coupling = {coupling:g}"
            raise ModelError("cyclic-mistuning", f"chain: found {found}, expected 2 or more blades, positive numbers")
        own, unit = (2.0 * np.pi * freq_hz) ** 2, np.eye(blades)
        K = own * ((1.0 + 2.0 * coupling) * unit - coupling * (np.roll(unit, 1, 0) + np.roll(unit, -1, 0)))
        n = np.arange(blades // 2 + 1)
        return BladedWheel(
            stiffness=K, rows=unit / np.sqrt(mass), energy=own * unit[:, :, None] * unit[:, None, :],
            freq=freq_hz * np.sqrt(1.0 + 4.0 * coupling * np.sin(np.pi * n / blades) ** 2), diameters=n,
        )  # fmt: skip

    @staticmethod
    def of(sector: CyclicSector, interface: Interface, *, channel: str = "flap", modes: int = 2,
           blade: str | None = None) -> "BladedWheel":  # fmt: skip
        """The wheel of one meshed sector, with a tip channel for motion and force.

        `modes` is the number of modes of each nodal diameter. The waves have twice as many, and the static responses to
        a force at the tip and to a change of the blade's stiffness. Raises the ModelErrors of `cyclic_reduce`, and one
        for a channel that the tip does not have.
        """
        if isinstance(interface, Rim | AtNodes):
            raise ModelError("interface-edge", f"found {type(interface).__name__}, expected a Tip or TipNodes")
        system = assemble_cyclic(sector)
        seen = view(system.system, interface)
        names = [name for name in seen.channels if name == channel or name.endswith(f".{channel}")]
        if not names:
            found = f"response.channel: found {channel!r}, expected one of {', '.join(seen.channels)}"
            raise ModelError("interface-edge", found)
        at = [seen.channels.index(names[0])]
        stiff = blade_stiffness(sector.structure, system.system, blade)
        pushes = np.column_stack([seen.loads[:, at], blade_forces(system, stiff, modes)])
        waves = wheel_waves(system, richer(modes), pushes, stiff)
        shown = waves.modes & (waves.partner >= np.arange(len(waves.n)))
        order = np.lexsort((waves.omega[shown], waves.n[shown]))
        return BladedWheel(
            stiffness=np.diag(waves.omega**2),
            rows=np.concatenate([waves.turned(waves.places[:1], j) for j in range(sector.sectors)]),
            energy=np.stack([waves.blade_energy(j) for j in range(sector.sectors)]),
            freq=waves.omega[shown][order] / (2.0 * np.pi), diameters=waves.n[shown][order],
        )  # fmt: skip

    def mistuned(self, deviations: Deviations | None) -> FloatArray:
        """K of blades whose frequencies deviate, (D, D)."""
        if deviations is None:
            return self.stiffness
        factor = (1.0 + checked_deviations(deviations, self.blades)) ** 2 - 1.0
        return self.stiffness + np.tensordot(factor, self.energy, axes=1)

    def load(self, order: int) -> Array:
        """Modal forces (D,) of an engine order with one newton on each blade, e^(2 pi i r j/N)."""
        phase = np.exp(2j * np.pi * (order % self.blades) * np.arange(self.blades) / self.blades)
        return np.asarray(self.rows.T @ phase)

    def air(self, influence: Influence | None, omega: float) -> Array | float:
        """Aerodynamic addition to K at omega [rad/s], (D, D)."""
        if influence is None:
            return 0.0
        return np.asarray(self.rows.T @ influence.between(self.blades, omega) @ self.rows)


def blade_forces(system: CyclicSystem, stiff: csc_array, count: int) -> FloatArray:
    """Forces in sector 0 due to a stiffer blade in the first modes of all diameters, (free, forces).

    The basis omits only forces below FAINT of the largest.
    """
    moved = [solved(system, n, count).vectors[:, :count] for n in system.sector.diameters]
    forces = stiff @ np.hstack([part for X in moved for part in (X.real, X.imag)])
    basis, size, _ = np.linalg.svd(forces, full_matrices=False)
    return np.asarray(basis[:, size > FAINT * size[0]])


def excited(order: int, blades: int) -> int:
    """The nodal diameter that an engine order excites; orders beyond N/2 are aliased.

    >>> [excited(order, 12) for order in (3, 6, 9, 12, 15)]
    [3, 6, 3, 0, 3]
    """
    rest = order % blades
    return min(rest, blades - rest)


def whitehead(blades: int) -> float:
    """Whitehead's bound (1 + sqrt(N))/2 for the amplification of a mistuned wheel (J. Mech. Eng. Sci. 8, 1966, 15).

    It holds for small deviations: a soft blade moves further by itself.

    >>> whitehead(25)
    3.0
    """
    return 0.5 * (1.0 + float(np.sqrt(blades)))
