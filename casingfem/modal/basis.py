"""The reduced modal basis: plain arrays in a file, the only input that contact gets.

    q'' + 2 zeta omega q' + omega^2 q = rows^T lam,    u = rows q + S lam

with mass-normalised modes, u the interface displacements by channel and S the static compliance of all omitted modes.
"""

import json
import os
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.io.npz import read_npz
from contact.io.names import names_fault
from contact.io.npz import compliance_fault, whole, write_npz
from contact.io.reported import Reported

FORMAT = "casingfem-modal-basis-1"
TEXTS = ("format", "channels", "kind", "outputs", "provenance")
ARRAYS = (
    "omega", "zeta", "rows", "S", "recovery", "recovery_S", "recovery_points", "recovery_cells", "lines",
    "line_thickness", "output_rows", "output_S", "gyroscopic", "stiffness_by_speed", "gyroscopic_higher",
    "stiffness_higher", "damping", "stiffness", "participation", "out_of_roundness", "known_speeds",
)  # fmt: skip


@dataclass(frozen=True, eq=False, kw_only=True)
class ModalBasis(Reported):
    """A reduced body with its interface.

    Attributes
    ----------
    omega, zeta
        Angular frequencies [rad/s] and damping ratios, (modes,).
    channels
        Names of the interface displacements, (channels,).
    rows
        Interface displacement of each mode, (channels, modes).
    S
        Residual compliance [m/N], (channels, channels), symmetric.
    kind
        "rim": Fourier amplitudes around an edge; "point": displacements of one place.
    n_max, radius, thickness
        Of a rim: highest harmonic, mean radius of its lines and least thickness of the wall there [m], 0 if that is
        unknown.
    recovery, recovery_S, recovery_points, recovery_cells
        Displacements elsewhere, u = recovery q + recovery_S lam: (3 points, modes), (3 points, channels), (points, 3);
        the cells between the points, each with its VTK cell type and nodes; empty unless requested.
    lines
        Of a rim: axial place and radius of each of its lines [m], (lines, 2).
    line_thickness
        Of a rim: least thickness of the wall on each of its lines [m], (lines,); empty if that is unknown.
    outputs, output_rows, output_S
        Names of displacements and strains at chosen places, and output_rows q + output_S lam that gives them.
    gyroscopic, stiffness_by_speed, spin
        For a body that rotates at Omega [rad/s], in its own frame: the left side of the equation gets Omega gyroscopic
        q', and its stiffness (Omega^2 - spin^2) stiffness_by_speed, both (modes, modes). `spin` is the speed [rad/s] at
        which the modes were computed. Omega is positive from x to y about the axis of a casing, for other parts in the
        direction of the study's rotation.
    known_speeds
        Lowest and highest speed [rad/s] at which `stiffness_by_speed` is valid, (2,), for a part whose steady shape
        depends on the speed; empty if it is valid at every speed. Contact refuses other speeds.
    damping, stiffness
        Damping [1/s] and stiffness [1/s^2] that couple the modes, (modes, modes). A reduced structure has no `damping`,
        and `stiffness` only with modes at a speed: the effect of its Coriolis forces through omitted motions.
    participation
        Modal force per acceleration of the whole body, Phi^T M e [sqrt(kg)], along x, y and the axis of a casing, along
        span, flap and chord of a blade, (3, modes); empty if unknown.
    sectors
        Of a wheel: number of sectors, with channels sector0.*, sector1.*, ...; else 0.
    out_of_roundness
        Of a rim: deviation of each line's radius from its mean [m], cos0 .. cosN, sin1 .. sinN, (lines, 2 n_max + 1).
    provenance
        Origin: method, versions, hash of the matrices.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=6, rows=2, around=1))
    >>> basis = cf.reduce(plate, cf.Tip(), modes=4, zeta=0.002)
    >>> basis.channels, basis.rows.shape, basis.kind
    (('span', 'flap'), (2, 4), 'point')
    """

    omega: FloatArray
    zeta: FloatArray
    channels: tuple[str, ...]
    rows: FloatArray
    S: FloatArray
    kind: str
    n_max: int = 0
    sectors: int = 0
    radius: float = 0.0
    thickness: float = 0.0
    recovery: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    recovery_S: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    recovery_points: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    recovery_cells: IntArray = field(default_factory=lambda: np.zeros((0, 0), dtype=np.int64))
    lines: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    line_thickness: FloatArray = field(default_factory=lambda: np.zeros(0))
    outputs: tuple[str, ...] = ()
    output_rows: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    output_S: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    gyroscopic: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    stiffness_by_speed: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    gyroscopic_higher: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))
    stiffness_higher: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))
    damping: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    stiffness: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    participation: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    out_of_roundness: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    known_speeds: FloatArray = field(default_factory=lambda: np.zeros(0))
    spin: float = 0.0
    provenance: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        Reported.__post_init__(self)
        modes, channels = np.size(self.omega), len(self.channels)
        shapes = {"omega": (modes,), "zeta": (modes,), "rows": (channels, modes), "S": (channels, channels)}
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                raise InputError(f"{name}: found the shape {getattr(self, name).shape}, expected {shape}")
        for name in ("omega", "zeta", "rows", "S"):
            if not np.all(np.isfinite(getattr(self, name))):
                raise InputError(f"{name}: found nan or infinity, expected finite numbers")
        if len(self) and float(self.omega.min()) < 0.0:
            raise InputError(f"omega: found {self.omega.min():g} rad/s, expected every frequency >= 0")
        for key in ("channels", "outputs"):
            if fault := names_fault(getattr(self, key)):
                raise InputError(f"{key}: found {fault}")
        if fault := compliance_fault(self.S):
            raise InputError(f"S: found {fault}")
        if self.kind not in ("rim", "point"):
            raise InputError(f'kind must be "rim" or "point", found {self.kind!r}')

    def __len__(self) -> int:
        """Return the number of modes."""
        return len(self.omega)

    @property
    def freq(self) -> FloatArray:
        """Frequencies [Hz]."""
        return self.omega / (2.0 * np.pi)

    @property
    def compliance(self) -> FloatArray:
        """Static compliance of the interface [m/N]: rows diag(1/omega^2) rows^T + S."""
        return np.asarray((self.rows / self.omega**2) @ self.rows.T + self.S)

    def records(self) -> list[dict[str, Any]]:
        """One plain dictionary for each mode: number, frequency, damping, and participation if known."""
        names = [f"participation_{k}" for k in range(1, 1 + len(self.participation))]
        shares = self.participation.T.tolist() or [()] * len(self)
        rows = zip(self.freq.tolist(), self.zeta.tolist(), shares, strict=True)
        return [
            {"mode": k, "freq_hz": freq, "zeta": zeta, **dict(zip(names, parts, strict=False))}
            for k, (freq, zeta, parts) in enumerate(rows, 1)
        ]

    def columns(self) -> dict[str, Any]:
        """One row for each mode: the columns of `records`, and the displacement of each interface channel."""
        return {**super().columns(), **dict(zip(self.channels, self.rows, strict=True))}

    def arrays(self) -> dict[str, Any]:
        """Plain arrays by name: the contents of a file, and the arguments of `ct.ModalBody.of`."""
        own = {field.name: np.array(getattr(self, field.name)) for field in fields(self) if field.name != "provenance"}
        own["outputs"] = np.array(self.outputs, dtype=np.str_)
        provenance = np.array(json.dumps(self.provenance, sort_keys=True))
        return {"format": np.array(FORMAT), **own, "provenance": provenance}

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write an npz of plain arrays, whole or not at all; returns the path."""
        return write_npz(path, self.arrays())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> "ModalBasis":
        """Read a file written by `save`.

        Raises
        ------
        InputError
            If the file is missing, is not a modal basis, or lacks an array.
        """
        data = read_npz(path, kinds=dict.fromkeys(TEXTS, "text"))
        if str(data.get("format")) != FORMAT:
            raise InputError(f"{path}: expected format {FORMAT!r}, found {str(data.get('format'))!r}")
        if missing := {"omega", "zeta", "channels", "rows", "S", "kind"} - data.keys():
            raise InputError(f"{path}: found no arrays {', '.join(sorted(missing))}, expected a whole modal basis")
        values: dict[str, Any] = {name: data[name] for name in ARRAYS if name in data}
        try:
            values |= {name: float(data.get(name, 0.0)) for name in ("radius", "thickness", "spin")}
            return cls(
                channels=tuple(str(name) for name in data["channels"]),
                kind=str(data["kind"]),
                n_max=whole(data, "n_max"),
                sectors=whole(data, "sectors"),
                outputs=tuple(str(name) for name in data.get("outputs", ())),
                provenance=json.loads(str(data.get("provenance", "{}"))),
                **values,
            )
        except (TypeError, ValueError, RecursionError) as error:
            raise InputError(f"{path}: {error}") from error

    def __repr__(self) -> str:
        """One line: modes, band, channels, share of S in the compliance."""
        if len(self) == 0:
            return f"ModalBasis({self.kind}, no modes, {len(self.channels)} channels)"
        share = np.trace(self.S) / np.trace(self.compliance)
        return (
            f"ModalBasis({self.kind}, {len(self)} modes {self.freq[0]:.1f}-{self.freq[-1]:.1f} Hz, "
            f"{len(self.channels)} channels, S has {100.0 * share:.1f} % of the static compliance)"
        )
