"""Frequencies over a range of speeds from one assembly: K(Omega) = K + Omega^2 K1 + Omega^4 K2."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.sparse import csc_array

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, frozen
from casingfem.linalg.assignment import assignment
from casingfem.modal.mode_set import ModeSet
from casingfem.modal.modes import modes
from casingfem.structure.imported.assembly import MeshStructure, MeshSystem, require_structure
from casingfem.structure.imported.turning_structure import rotation_of
from casingfem.structure.shell.assembly import assemble, spin
from casingfem.structure.shell.prestress import Spin
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System
from contact.io.columns import Column, Columns, Rows, records_of, table_lines
from contact.io.reported import Reported


def met_words(met: list[tuple[int, float]]) -> str:
    """Engine orders and the speeds [Hz] at which they cross a mode."""
    return ", ".join(f"{order} at {at:.4g} Hz" for order, at in met) or "-"


MODES = (
    Column("mode", "Number of the mode at the first speed, from 1.", lambda found: range(1, found.freq.shape[1] + 1),
           format="d"),
    Column("first_hz", "Frequency at the first speed.", lambda found: found.freq[0], head="at first speed", unit="Hz",
           format=".3f"),
    Column("last_hz", "Frequency at the last speed.", lambda found: found.freq[-1], head="at last speed", unit="Hz",
           format=".3f"),
    Column("southwell", "Slope of the squared frequency over the squared speed, at the first speed.",
           lambda found: found.southwell, head="Southwell", format=".4f"),
    Column("engine_orders", "Engine orders that meet the mode, each with its speed.", lambda found: found.met(),
           head="engine orders met", format=met_words),
)  # fmt: skip


def of_mode(k: int) -> Column:
    """Frequency of one mode over the speeds."""
    return Column(f"mode{k + 1}_hz", f"Frequency of mode {k + 1}.", lambda found: found.freq[:, k],
                  head=f"mode {k + 1}", unit="Hz", format=".3f")  # fmt: skip


SPARE = 6  # modes computed beyond those followed, so that one may leave the range and another come in


@dataclass(frozen=True, slots=True, eq=False, kw_only=True, repr=False)
class Campbell(Reported):
    """Frequencies over speed; each column follows one mode by its shape.

    Attributes
    ----------
    omega
        Speeds [rad/s], (speeds,).
    freq
        Frequencies [Hz] in the rotating frame, without Coriolis forces, (speeds, modes), ascending at the first speed.
    southwell
        d(omega_k^2)/d(Omega^2) = phi_k^T K1 phi_k for the shapes at the first speed, (modes,): Southwell coefficients,
        exact slopes if that speed is 0.
    overlap
        |phi^T M phi_before| of each mode with itself at the previous speed, (speeds, modes): 1 without mixing.

    Examples
    --------
    >>> import casingfem as cf
    >>> chart = cf.Plate(length=0.2, width=0.04)
    >>> blade = cf.Shell(chart=chart, thickness=3e-3, material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                  supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=6, rows=2, around=1),
    ...                  rotation=cf.Rotation.of_blade(chart, omega=0.0, hub_radius=0.3))
    >>> found = cf.campbell(blade, [0.0, 500.0], count=1)
    >>> found.speed_hz.round(2).tolist(), bool(found.freq[1, 0] > found.freq[0, 0])
    ([0.0, 79.58], True)
    """

    omega: FloatArray
    freq: FloatArray
    southwell: FloatArray
    overlap: FloatArray

    @property
    def speed_hz(self) -> FloatArray:
        """Speeds [Hz], (speeds,)."""
        return self.omega / (2.0 * np.pi)

    def crossings(self, order: int) -> list[tuple[int, float]]:
        """Crossings of an engine order with modes: (mode, speed [Hz]) with f = order * speed, linear between speeds.

        >>> data = Campbell(omega=np.array([0.0, 2 * np.pi * 50]), freq=np.array([[100.0], [110.0]]),
        ...                 southwell=np.zeros(1), overlap=np.ones((2, 1)))
        >>> [(mode, round(speed, 3)) for mode, speed in data.crossings(4)]
        [(0, 26.316)]
        """
        return zero_crossings(self.speed_hz, self.freq - order * self.speed_hz[:, None])

    def columns(self) -> dict[str, FloatArray]:
        """One row for each speed and one column for each mode, as arrays.

        >>> data = Campbell(omega=np.array([0.0, 2 * np.pi * 50]), freq=np.array([[100.0], [110.0]]),
        ...                 southwell=np.zeros(1), overlap=np.ones((2, 1)))
        >>> list(data.columns()), data.plot(orders=4).axes[0].get_xlabel()
        (['speed_hz', 'mode1_hz'], 'speed [Hz]')
        """
        return {column.name: np.asarray(column.values(self)) for column in self.described()}

    def __repr__(self) -> str:
        return self.table()

    def described(self) -> Columns:
        """The speed and the frequency of each mode, one row for each speed."""
        speed = Column("speed_hz", "Speed of rotation.", lambda found: found.speed_hz, head="speed", unit="Hz",
                       format=".5g")  # fmt: skip
        return (speed, *map(of_mode, range(self.freq.shape[1])))

    def met(self, orders: int = 8) -> list[list[tuple[int, float]]]:
        """For each mode, the engine orders that cross it, with the speeds [Hz]."""
        found = self._met(orders)
        return [[(order, at) for order, k, at in found if k == mode] for mode in range(self.freq.shape[1])]

    def modes_met(self, orders: int = 8) -> Rows:
        """One row for each mode, with the columns of `MODES`."""
        rows = zip(records_of(MODES, self), self.met(orders), strict=True)
        return [row | {"engine_orders": met} for row, met in rows]

    def table(self, orders: int = 8) -> str:
        """One row for each mode.

        Frequencies at first and last speed, Southwell coefficient, engine orders that cross it.
        """
        first, last = self.speed_hz[0], self.speed_hz[-1]
        return "\n".join([f"speeds {first:.4g} to {last:.4g} Hz", *table_lines(MODES, self.modes_met(orders))])

    def _met(self, orders: int) -> list[tuple[int, int, float]]:
        return [(order, k, at) for order in range(1, orders + 1) for k, at in self.crossings(order)]

    def to_json(self, orders: int = 8) -> dict[str, object]:
        """Ready for JSON: speeds, frequencies by speed, Southwell coefficients, crossings with engine orders."""
        return {
            "speed_hz": self.speed_hz.tolist(), "freq_hz": self.freq.tolist(), "southwell": self.southwell.tolist(),
            "overlap": self.overlap.tolist(),
            "crossings": [{"order": order, "mode": k + 1, "speed_hz": at} for order, k, at in self._met(orders)],
        }  # fmt: skip

    def to_csv(self) -> str:
        """One row for each speed, one column for each mode."""
        columns = self.columns()
        head = ",".join(columns)
        rows = [",".join(map(str, row)) for row in zip(*(column.tolist() for column in columns.values()), strict=True)]
        return "\n".join(["# COMPUTED: frequencies in the rotating frame", head, *rows]) + "\n"


def zero_crossings(speed: FloatArray, gap: FloatArray) -> list[tuple[int, float]]:
    """Zeros and changes of sign in columns of `gap` (speeds, modes): (mode, speed), linear between speeds.

    >>> zero_crossings(np.array([0.0, 1.0, 2.0]), np.array([[-1.0, 3.0], [3.0, 0.0], [5.0, -1.0]]))
    [(0, 0.25), (1, 1.0)]
    """
    met = []
    for k, mode in np.argwhere((gap[:-1] * gap[1:] < 0.0) | ((gap[:-1] == 0.0) & (gap[1:] != 0.0))).tolist():
        part = gap[k, mode] / (gap[k, mode] - gap[k + 1, mode])
        met.append((mode, float(speed[k] + part * (speed[k + 1] - speed[k]))))
    met += [(int(mode), float(speed[-1])) for mode in np.flatnonzero(gap[-1] == 0.0)]
    return met


def campbell(structure: Shell | MeshStructure, omega: Sequence[float] | FloatArray, count: int = 6) -> Campbell:
    """Follow the lowest `count` modes of a structure over speeds [rad/s], one assembly and one static solution for all.

    Parameters
    ----------
    structure
        A supported `Shell`, `Solid` or `MeshShell` with a `rotation`; its own speed is not used. For large
        displacements a solid is linearised about its steady shape at each speed.
    omega
        Speeds [rad/s], ascending.
    count
        Number of modes followed, the lowest at the first speed.

    Raises
    ------
    ModelError
        `rotation-none` for a structure without an axis; `rotation-unstable` if K(Omega) is not positive definite.

    Examples
    --------
    >>> import casingfem as cf
    >>> chart = cf.Plate(length=0.2, width=0.04)
    >>> blade = cf.Shell(chart=chart, thickness=3e-3, material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                  supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=6, rows=2, around=1),
    ...                  rotation=cf.Rotation.of_blade(chart, omega=0.0, hub_radius=0.3))
    >>> cf.campbell(blade, [0.0, 500.0, 1000.0], count=1).freq[:, 0].round(1).tolist()
    [63.6, 140.7, 254.8]
    """
    system, added = spin_from_rest(structure, "campbell")
    speeds = np.asarray(omega, dtype=float)
    wanted = count + SPARE
    freq, overlap = np.empty((len(speeds), count)), np.ones((len(speeds), count))
    before = southwell = np.zeros(0)
    for k, speed in enumerate(speeds):
        found = modes_at(structure, system, csc_array(system.K + added.stiffness(float(speed))), float(speed), wanted)
        collect = system.collect if isinstance(system, MeshSystem) else system.restrict
        shapes = np.asarray(collect(found.fields))
        if k == 0:
            columns = np.arange(count)
            southwell = np.einsum("fk,fk->k", shapes[:, :count], added.K1 @ shapes[:, :count])
        else:
            likeness = np.abs(before.T @ (system.M @ shapes))
            _, columns = assignment(-(likeness**2))
            overlap[k] = likeness[np.arange(count), columns]
        before = shapes[:, columns]
        freq[k] = found.freq[columns]
    return Campbell(omega=frozen(speeds), freq=frozen(freq), southwell=frozen(southwell), overlap=frozen(overlap))


def spin_from_rest(structure: Shell | MeshStructure, what: str) -> tuple[System | MeshSystem, Spin]:
    """The structure assembled at rest, and the terms that rotation about its axis adds.

    Raises
    ------
    ModelError
        `rotation-none` for a structure without an axis.
    """
    if not isinstance(structure, Shell):
        require_structure(structure, what)
    rotation = rotation_of(structure)
    if rotation is None:
        raise ModelError("rotation-none", f"{what}: found a structure without rotation, expected one with")
    if isinstance(structure, Shell):
        at_rest = assemble(replace(structure, rotation=None))
        return at_rest, spin(at_rest, rotation)
    still: Any = replace(structure, rotation=None)  # type: ignore[type-var]  # what has a rotation is a dataclass
    resting = still.assembled()
    return resting, still.spin(resting, rotation)


def modes_at(
    structure: Shell | MeshStructure, system: System | MeshSystem, K: csc_array, speed: float, count: int
) -> ModeSet:
    """Modes at a speed, with the stiffness there."""
    owner: Any = structure
    turning = replace(owner, rotation=owner.rotation.at(speed))
    if isinstance(system, System):
        return modes(turning, count, system=replace(system, shell=turning, stiffness=K))
    return modes(turning, count, system=replace(system, structure=turning, K=K))
