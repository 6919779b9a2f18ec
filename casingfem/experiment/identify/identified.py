"""Result of an identification: modes with uncertainties, and a frequency table."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.experiment.frf.sensor_grid import SensorGrid
from casingfem.experiment.identify.identified_file import read_fields, write_fields
from casingfem.experiment.identify.lscf import Stabilisation
from casingfem.experiment.identify.mode_columns import COLUMNS
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray, freeze
from contact.io.columns import table_lines
from contact.io.reported import Reported

if TYPE_CHECKING:
    from casingfem.experiment.identify.mode import Mode


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Identified(Reported):
    """Modes found in frequency responses, or in responses alone, ascending; arrays are read-only.

    Attributes
    ----------
    freq, sigma_freq
        Frequencies and their standard uncertainties [Hz], (modes,); of the mean over the set-ups if `shift` > 0.
    shift
        Standard deviation of a mode's ln frequency between set-ups; 0 for a single set-up.
    zeta, sigma_zeta
        Damping ratios and their uncertainties.
    n, purity
        Nodal diameters, -1 if the sensors have no angles, and their share of the shape's energy.
    angle_deg, sigma_angle
        Antinode, in [0, 180/n), and its uncertainty [deg]; nan where n < 1.
    shapes, sigma_shapes
        Real shapes of unit norm at the sensors, (sensors, modes).
    residues
        Complex residues (sensors, references, modes) of unit (j omega)^q w_k^2/(w_k^2 - omega^2 + 2 j zeta w_k omega)
        with omega in (j omega)^q in units of `residue_scale` [Hz], (modes,).
    collinearity
        Share of a shape's energy that is in phase: 1 for a normal mode.
    signal
        Peak of the mode's response over the noise of a line, both rms over the channels.
    doublets
        Index pairs (lower, upper) of the same n, a quarter wave apart.
    unresolved
        Modes whose residues contain two shapes at one frequency.
    split_bound
        Largest relative split of a partner that the data would not show; nan if a partner was found or n = 0.
    sensors
        Sensors of the shapes.
    lines, fitted, measured
        Frequencies used [Hz], (lines,); responses at these lines, fitted (nan on lines without a fit) and measured,
        both (channels, lines).
    diagram
        Poles of all orders.
    reasons
        Reason why each mode is doubtful, "" for a sure mode.
    notes
        Notes on modes that cannot be distinguished, and on data that were left out.
    card
        Source lines.

    Examples
    --------
    >>> import numpy as np
    >>> import casingfem as cf
    >>> theta, x = np.arange(8) * np.pi / 4, np.arange(80.0, 120.0, 0.1)
    >>> H = np.cos(2 * theta)[:, None] * 100.0**2 / (100.0**2 - x**2 + 2j * 0.004 * 100.0 * x)
    >>> frfs = cf.frf.FrfSet.from_arrays(kind="frf", x=x, responses=H, unit="m/N", response_point=np.arange(8))
    >>> found = cf.identify(frfs, angles=dict(enumerate(np.degrees(theta))))
    >>> found.freq.round(2).tolist(), found.sure.tolist()
    ([100.0], [True])
    """

    COLUMNS: ClassVar = COLUMNS

    freq: FloatArray
    sigma_freq: FloatArray
    zeta: FloatArray
    sigma_zeta: FloatArray
    n: IntArray
    purity: FloatArray
    angle_deg: FloatArray
    sigma_angle: FloatArray
    shapes: FloatArray
    sigma_shapes: FloatArray
    residues: Array
    residue_scale: FloatArray
    collinearity: FloatArray
    signal: FloatArray
    doublets: tuple[tuple[int, int], ...]
    unresolved: tuple[int, ...]
    split_bound: FloatArray
    sensors: SensorGrid
    lines: FloatArray
    fitted: Array
    measured: Array
    diagram: Stabilisation
    reasons: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    card: tuple[str, ...] = ()
    seconds: float = 0.0
    shift: float = 0.0

    def __post_init__(self) -> None:
        freeze(self, *(name for name in self.__slots__ if isinstance(getattr(self, name), np.ndarray)))

    def __len__(self) -> int:
        return len(self.freq)

    @classmethod
    def of(
        cls, modes: Sequence[Mode], doublets: tuple[tuple[int, int], ...], sensors: SensorGrid, **further: Any
    ) -> Identified:
        """The columns of some modes, and `further` fields that are not of single modes."""

        def column(name: str) -> FloatArray:
            return np.array([getattr(mode, name) for mode in modes], float)

        count = len(sensors), len(sensors.references)
        names = ("freq", "sigma_freq", "zeta", "sigma_zeta", "purity", "collinearity", "signal", "residue_scale")
        members = {k for pair in doublets for k in pair}
        bound = np.array([np.nan if k in members or mode.n == 0 else mode.split_bound for k, mode in enumerate(modes)])
        columns: dict[str, Any] = {name: column(name) for name in names}
        return cls(
            **columns,
            n=np.array([mode.n for mode in modes], np.int64),
            angle_deg=np.degrees(column("angle")),
            sigma_angle=np.degrees(column("sigma_angle")),
            shapes=np.array([mode.shape for mode in modes]).reshape(-1, count[0]).T,
            sigma_shapes=np.array([mode.sigma_shape for mode in modes]).reshape(-1, count[0]).T,
            residues=np.array([mode.residues for mode in modes], complex).reshape(-1, *count).transpose(1, 2, 0),
            split_bound=bound.reshape(-1),
            doublets=doublets,
            unresolved=tuple(k for k, mode in enumerate(modes) if mode.unresolved),
            reasons=tuple(mode.reason for mode in modes),
            sensors=sensors,
            **further,
        )

    @property
    def sure(self) -> BoolArray:
        """Whether each mode is sure, (modes,)."""
        return np.array([not (self.reasons and self.reasons[k]) for k in range(len(self))], bool)

    @property
    def splits(self) -> FloatArray:
        """Relative split (f_upper - f_lower)/mean of each doublet, in the order of `doublets`."""
        pairs = self.freq[np.array(self.doublets, dtype=int).reshape(-1, 2)]
        return np.asarray(np.diff(pairs, axis=1)[:, 0] / pairs.mean(axis=1))

    @property
    def sigma_setup(self) -> FloatArray:
        """Standard uncertainty [Hz] of a frequency in one further set-up, (modes,): the table's sigma."""
        return np.asarray(np.hypot(self.sigma_freq, self.shift * self.freq))

    def doublet_of(self, mode: int) -> int:
        """Index into `doublets`, or -1 for a mode without partner."""
        return next((k for k, pair in enumerate(self.doublets) if mode in pair), -1)

    @property
    def deviation(self) -> float:
        """Rms of measured minus fitted responses over the rms of the measured ones, on lines with a fit."""
        there = ~np.isnan(self.fitted[0])
        error = self.measured[:, there] - self.fitted[:, there]
        return float(np.linalg.norm(error) / np.linalg.norm(self.measured[:, there])) if there.any() else float("nan")

    def table(self, card: Sequence[str] = ()) -> FrequencyTable:
        """Return the frequency table for the updater, marked SYNTHETIC if the responses were.

        Its sigma is `sigma_setup`: it includes the difference to the structure without the moved mass.
        """
        if not len(self):
            raise ValueError("table: found no identified modes, expected at least one")
        stated = any(line.startswith("identified from") for line in self.card)
        made = () if stated else ("identified from frequency responses: p-LSCF poles, refined by maximum likelihood",)
        return FrequencyTable.from_arrays(
            freq_hz=self.freq,
            sigma_hz=self.sigma_setup,
            n=self.n,
            angle_deg=self.angle_deg,
            zeta=self.zeta,
            card=(*self.card, *card, *made, *self.doubtful(), *self.notes),
            path="identified",
        )

    def doubtful(self) -> tuple[str, ...]:
        """Describe the doubtful modes and why they are doubtful."""
        return tuple(f"mode {k + 1} is doubtful: {self.reasons[k]}" for k in np.flatnonzero(~self.sure).tolist())

    def save(self, path: str | os.PathLike[str], *, responses: bool = True) -> Path:
        """Write an npz file of plain arrays, complete or not at all; `load` reads it.

        Without `responses` the file contains modes, shapes, sensors and notes, but no responses and no diagram.
        """
        kept = self if responses else self.bare()
        return write_fields(path, {field.name: getattr(kept, field.name) for field in fields(kept)})

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Identified:
        """Read a file of `save`, without pickle.

        Raises
        ------
        InputError
            Another file, arrays that are missing or do not belong together, shapes that are not finite.
        """
        return cls(**read_fields(path, {field.name for field in fields(cls)}))

    def bare(self) -> Identified:
        """The same modes without responses and diagram."""
        nothing, few = np.zeros(0), np.zeros((len(self.measured), 0), complex)
        empty = Stabilisation(freq=nothing, zeta=nothing, order=nothing.astype(int), stable=nothing.astype(bool))
        return replace(self, lines=nothing, fitted=few, measured=few, diagram=empty)

    def __repr__(self) -> str:
        """The columns as a table, under a summary, above the doubtful modes and the notes."""
        pairs = f", {len(self.doublets)} doublets" if self.doublets else ""
        left = ", without responses" if not len(self.lines) else ""
        left = f", deviation {100.0 * self.deviation:.2g} %" if np.isfinite(self.deviation) else left
        doubtful = int(np.sum(~self.sure))
        verdict = f", {doubtful} doubtful" if doubtful else ""
        lines = table_lines(self.COLUMNS, self.records())
        return "\n".join(
            [f"Identified({len(self)} modes{verdict}{pairs}{left})", *lines, *self.doubtful(), *self.notes]
        )
