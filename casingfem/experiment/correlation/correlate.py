"""Measured shapes against a model's modes: pairs, similarity, differences by sensor, and complete shapes.

Shapes pair by frequency and shape together (`correlation.pair`): |log f_measured/f_computed| + 1 - MAC, with the MAC in
the plane of a doublet, and a frequency error of at most `reach`. A shape with a very low MAC is left unpaired.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.correlation.expansion import Expansion, expand, guyan_mass, serep_mass
from casingfem.experiment.correlation.mac import comac, ecomac, mac, nearest_in_plane, subspace_mac
from casingfem.experiment.correlation.matches import Match, Pairing, listed
from casingfem.experiment.correlation.measured_shapes import MeasuredShapes
from casingfem.experiment.correlation.pairing import pair
from casingfem.experiment.correlation.sensors import Sensors, sensors_of
from casingfem.io.arrays import FloatArray
from casingfem.modal.mesh_modes import MeshModes
from casingfem.modal.mode_set import Modes, ModeSet
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.shell.system import System
from contact.io.columns import Column, table_lines
from contact.io.reported import Reported

DIFFERENT = 0.9  # COMAC below this is worth a check


COLUMNS = (
    Column("row", "Number of the measured shape, from 1.", lambda found: range(1, 1 + len(found.measured.freq_hz)),
           format="d"),
    Column("measured_hz", "Measured frequency.", lambda found: found.measured.freq_hz, head="measured", unit="Hz",
           format=".3f"),
    Column("mode", "Computed mode that the shape pairs with, from 1.",
           lambda found: found.of_pairs(lambda row, mode, n, plane: mode + 1), format="d"),
    Column("n", "Nodal diameters of the pair.",
           lambda found: found.of_pairs(lambda row, mode, n, plane: n if n >= 0 else None), format="d"),
    Column("computed_hz", "Computed frequency.",
           lambda found: found.of_pairs(lambda row, mode, n, plane: float(found.modes.freq[mode])), head="computed",
           unit="Hz", format=".3f"),
    Column("mac", "Modal assurance criterion of the two shapes.",
           lambda found: found.of_pairs(lambda row, mode, n, plane: float(found.mac[row, mode])), head="MAC",
           format=".3f"),
    Column("subspace_mac", "Modal assurance criterion of the planes of two doublets.",
           lambda found: found.of_pairs(lambda row, mode, n, plane: plane), head="plane", format=".3f"),
    Column("nco", "Normalised cross-orthogonality of the two shapes.",
           lambda found: found.of_pairs(lambda row, mode, n, plane: float(found.nco[row, mode])), head="NCO",
           format=".3f"),
    Column("left_out_error", "Rms error of predicting each sensor from the others, over the rms of the shape.",
           lambda found: np.sqrt(np.nanmean(found.expansion.left_out**2, axis=0)), head="left out", format=".3f"),
    Column("collinearity", "Share of the measured shape that is in phase.",
           lambda found: found.measured.collinearity, where="files"),
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False, kw_only=True, repr=False)
class Correlation(Reported):
    """Correlation of measured shapes with computed modes.

    Attributes
    ----------
    modes, measured, sensors
        Both sides, and the positions of the sensors on the shell.
    pairing
        Matches, and the unpaired modes of both sides.
    mac
        Of every measured shape with every computed mode, (measured, modes).
    alike
        MAC of each match: for a doublet that of the planes, (matches,).
    nco
        Normalised cross-orthogonality with the model's mass reduced to the sensors, (measured, modes).
    mass_by
        Method of this reduction: "SEREP" or "Guyan".
    comac, ecomac
        Of every channel over the paired shapes, (channels,).
    expansion
        The measured shapes expanded in the model's modes.

    Examples
    --------
    >>> import casingfem as cf
    >>> shell = cf.Shell(chart=cf.Cylinder(radius=0.3, height=0.1), thickness=4e-3, supports={"base": cf.Clamped()},
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=6, rows=2, around=9))
    >>> model = cf.modes(shell, 2)
    >>> theta, n = np.arange(24) * np.pi / 12, int(model.nodal_diameters[0])
    >>> out = np.column_stack([np.cos(theta), np.sin(theta), 0.0 * theta])
    >>> at = np.column_stack([0.3 * out[:, :2], np.full(24, 0.1)])
    >>> values = np.column_stack([np.cos(n * theta + 0.3), np.sin(n * theta + 0.3)])  # a pair, turned
    >>> test = cf.correlation.MeasuredShapes.from_arrays(freq_hz=model.freq, values=values, points=at, directions=out)
    >>> cf.correlate(model, test).alike.round(4).tolist()
    [1.0]
    """

    COLUMNS: ClassVar = COLUMNS

    modes: Modes | MeshModes
    measured: MeasuredShapes
    sensors: Sensors
    pairing: Pairing
    mac: FloatArray
    alike: FloatArray
    nco: FloatArray
    mass_by: str
    comac: FloatArray
    ecomac: FloatArray
    expansion: Expansion

    def paired(self) -> dict[int, tuple[int, int, float]]:
        """Row of each paired shape -> its mode, n and the MAC of the planes; rows and modes from 0."""
        return {
            row: (mode, match.n, plane)
            for match, plane in zip(self.pairing.matches, self.alike.tolist(), strict=True)
            for row, mode in zip(match.rows, match.modes, strict=True)
        }

    def of_pairs(self, value: Callable[[int, int, int, float], Any]) -> list[Any]:
        """A value for each measured shape, from its row, mode, n and plane; None for a shape without a mode."""
        paired = self.paired()
        return [value(row, *paired[row]) if row in paired else None for row in range(len(self.measured.freq_hz))]

    def to_json(self) -> dict[str, object]:
        """Plain lists and numbers for JSON."""
        at = self.sensors
        columns = at.labels.astype(int), at.directions.round(6), at.distance, self.comac, self.ecomac
        channels = [
            dict(zip(("sensor", "direction", "distance_m", "comac", "ecomac"), channel, strict=True))
            for channel in zip(*(column.tolist() for column in columns), strict=True)
        ]
        return {
            "shapes": self.records(),
            "unpaired_modes": [mode + 1 for mode in self.pairing.unpaired_modes],
            "channels": channels,
            "mass_by": self.mass_by,
            "expansion": {"modes": (self.expansion.modes + 1).tolist(), "condition": self.expansion.condition},
        }

    def __repr__(self) -> str:
        """Table: measured, computed, MAC, subspace MAC, NCO; then sensors and expansion."""
        lines = table_lines(self.COLUMNS, self.records())
        rows, rest = self.pairing.unpaired_rows, self.pairing.unpaired_modes
        lines.append(f"unpaired: {len(rows)} measured, {len(rest)} computed; NCO by {self.mass_by}")
        lines.append(f"sensors up to {1e3 * self.sensors.distance.max():.2g} mm from the wall; {self.expansion!r}")
        low = np.unique(self.sensors.labels[self.comac < DIFFERENT]).tolist()
        lines.append(f"COMAC below {DIFFERENT}: sensors {listed(low) or 'none'}")
        return "\n".join(lines)


def correlate(
    modes: Modes | MeshModes,
    measured: MeasuredShapes,
    *,
    reach: float = 0.2,
    mass: str = "SEREP",
    system: System | MeshSystem | None = None,
) -> Correlation:
    """Correlate measured shapes with the modes of a shell, or of an imported part at its nearest nodes.

    Parameters
    ----------
    reach
        Largest relative frequency error of a pair.
    mass
        "SEREP", exact for the modes of the expansion, or "Guyan", which needs the assembled `system`.

    Raises
    ------
    ModelError
        sensor-far, sensor-twice or expansion-modes.
    InputError
        No shape pairs with a mode.
    ValueError
        The mass is neither of these, or "Guyan" without a system.

    Examples
    --------
    >>> from casingfem.modal.modes import modes
    >>> from casingfem.structure.geometry.chart import Frustum
    >>> from casingfem.structure.material import Material
    >>> from casingfem.structure.mesh.shell_mesh import ShellMesh
    >>> from casingfem.structure.shell.shell import Shell
    >>> from casingfem.structure.edge.support import Clamped
    >>> shell = Shell(chart=Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3, supports={"base": Clamped()},
    ...               material=Material(E=210e9, nu=0.3, rho=7800.0), mesh=ShellMesh(order=6, rows=1, around=9))
    >>> found = modes(shell, 6, method="shell")
    >>> theta = np.arange(24) * np.pi / 12
    >>> out = np.column_stack([np.cos(theta), np.sin(theta), 0.0 * theta])
    >>> at = np.column_stack([0.45 * out[:, :2], np.full(24, 0.25)])
    >>> sensors = sensors_of(found, at, out)
    >>> values = sensors.shapes(found.fields)
    >>> test = MeasuredShapes.from_arrays(freq_hz=found.freq, values=values, points=at, directions=out)
    >>> correlate(found, test).alike.round(6).tolist()
    [1.0, 1.0, 1.0]
    """
    if mass not in ("SEREP", "Guyan") or (mass == "Guyan" and system is None):
        raise ValueError(f'mass must be "SEREP", or "Guyan" with the assembled system, found {mass!r}')
    sensors = sensors_of(modes, measured.points, measured.directions, measured.labels)
    computed, shapes = sensors.shapes(modes.fields), measured.real
    likeness = seen_mac(shapes, computed)
    pairing = pair(modes, measured.table(), reach=reach, shape_mac=likeness)
    if not pairing.matches:
        near = f"one within {reach:.2g} of a mode's frequency and like it"
        raise InputError(measured.path, found="no shape that pairs with a mode", expected=near)
    expansion = expand(shapes, computed, measured.labels)
    if mass == "Guyan" and system is not None:
        reduced = guyan_mass(system, sensors)
    else:
        reduced = serep_mass(computed[:, expansion.modes])
    first, second = partners(pairing.matches, modes, shapes, computed)
    return Correlation(
        modes=modes,
        measured=measured,
        sensors=sensors,
        pairing=pairing,
        mac=likeness,
        alike=np.array([alike(match, modes, shapes, computed) for match in pairing.matches]),
        nco=seen_mac(shapes, computed, reduced),
        mass_by=mass,
        comac=comac(first, second),
        ecomac=ecomac(first, second),
        expansion=expansion,
    )


def seen_mac(measured: FloatArray, computed: FloatArray, mass: FloatArray | None = None) -> FloatArray:
    """MAC (measured, modes); 0 for modes without motion at the sensors.

    With the mass reduced to the sensors, (channels, channels), it is the normalised cross-orthogonality

        NCO_ij = |a_i^T M_s b_j|^2/((a_i^T M_s a_i) (b_j^T M_s b_j)),

    0 for modes without reduced mass, such as those that SEREP left out.
    """
    size = np.linalg.norm(computed, axis=0) if mass is None else np.einsum("ci,cd,di->i", computed, mass, computed)
    seen = size > 1e-9 * size.max()
    found = np.zeros((measured.shape[1], computed.shape[1]))
    found[:, seen] = mac(measured, computed[:, seen], mass)
    return found


def plane_of(match: Match, modes: ModeSet) -> list[int]:
    """The modes of a match, with the other members of doublets."""
    whole = {mode for pair in modes.doublets if set(pair) & set(match.modes) for mode in pair}
    return sorted(whole | set(match.modes))


def alike(match: Match, modes: ModeSet, measured: FloatArray, computed: FloatArray) -> float:
    """MAC of a match; for a doublet that of the planes."""
    return subspace_mac(measured[:, list(match.rows)], computed[:, plane_of(match, modes)])


def partners(
    matches: tuple[Match, ...], modes: ModeSet, measured: FloatArray, computed: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Paired shapes: measured ones of unit length, and the nearest ones in the planes of their modes."""
    rows = [measured[:, list(match.rows)] for match in matches]
    near = [nearest_in_plane(part, computed[:, plane_of(k, modes)]) for part, k in zip(rows, matches, strict=True)]
    lengths = [np.linalg.norm(part, axis=0) for part in rows]
    first = np.hstack([part / size for part, size in zip(rows, lengths, strict=True)])
    return first, np.hstack([part / size for part, size in zip(near, lengths, strict=True)])
