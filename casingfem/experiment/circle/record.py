"""Records of a circle scan: the signal of the vibrometer, and the angle of its spot."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray, frozen
from casingfem.io.npz import read_npz
from contact.io.npz import write_npz


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ScanRecord:
    """Vibrometer record while its spot moves around the casing; arrays are read-only.

    Attributes
    ----------
    fs
        Samples a second [Hz].
    velocity
        Along the beam [m/s], (samples,).
    angle
        The spot's unwrapped angle on the casing [rad], (samples,): from `turning` or `from_tacho`.
    tones
        Frequencies of the excitation [Hz], ascending.
    force
        Excitation [N], (samples,), or None; then waves are not per newton, and their phase is relative to cos(omega t).
    card
        Source lines.

    Examples
    --------
    >>> import numpy as np
    >>> angle = 6.0 * np.pi * np.arange(2000) / 2000.0
    >>> record = ScanRecord(fs=1000.0, velocity=np.zeros(2000), angle=angle, tones=(120.0,))
    >>> round(record.seconds, 3), round(record.rate, 3)  # three turns in two seconds
    (2.0, 1.5)
    """

    fs: float
    velocity: FloatArray
    angle: FloatArray
    tones: tuple[float, ...]
    force: FloatArray | None = None
    card: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in ("velocity", "angle", "force"):
            values = getattr(self, name)
            if values is None:
                continue
            array = frozen(np.asarray(values, np.float64))
            if array.ndim != 1 or array.size != np.size(self.velocity) or not np.isfinite(array).all():
                raise InputError(f"{name}: found shape {array.shape}, expected finite numbers, one for each velocity")
            object.__setattr__(self, name, array)
        if not self.tones or min(self.tones) <= 0.0 or np.any(np.diff(self.tones) <= 0.0):
            raise InputError(f"tones: found {self.tones!r}, expected frequencies above 0 Hz, ascending")
        if not self.fs > 0.0:
            raise InputError(f"fs: found {self.fs!r}, expected samples a second")

    @property
    def seconds(self) -> float:
        """Length of the record."""
        return len(self.velocity) / self.fs

    @property
    def rate(self) -> float:
        """Mean rate of rotation of the spot on the casing [turns/s], signed."""
        return float((self.angle[-1] - self.angle[0]) / (2.0 * np.pi * (len(self.angle) - 1)) * self.fs)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write an npz file of plain arrays with its comment lines, whole or not at all."""
        names = ("fs", "velocity", "angle", "tones", *(() if self.force is None else ("force",)))
        arrays = {name: np.asarray(getattr(self, name)) for name in names}
        return write_npz(path, {"card": np.asarray(self.card, dtype=np.str_), **arrays})

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> ScanRecord:
        """Read a file written by `save`, without pickle.

        Raises
        ------
        InputError
            The file lacks an array, or is not npz.
        """
        data = read_npz(path, {"fs", "velocity", "angle", "tones", "card"}, kinds={"card": "text"})
        dims = {name: data[name].ndim for name in ("fs", "tones", "card")}
        if dims != {"fs": 0, "tones": 1, "card": 1}:
            found = ", ".join(f"{name} {data[name].shape}" for name in dims)
            raise InputError(str(path), found=found, expected="fs, one number, and lists of tones and card")
        return cls(
            fs=float(data["fs"]),
            velocity=data["velocity"],
            angle=data["angle"],
            tones=tuple(data["tones"].tolist()),
            force=data.get("force"),
            card=tuple(data["card"].tolist()),
        )

    def __repr__(self) -> str:
        tones = ", ".join(f"{tone:g}" for tone in self.tones)
        return f"ScanRecord({self.seconds:g} s at {self.fs:g} Hz, {self.rate:.4g} turns/s, tones {tones} Hz)"


def turning(rate: float, fs: float, count: int, *, first_angle: float = 0.0) -> FloatArray:
    """Angles [rad] of a spot that rotates at a known rate [turns/s], one for each of `count` samples.

    >>> turning(0.25, 1.0, 3).round(4).tolist()
    [0.0, 1.5708, 3.1416]
    """
    return np.asarray(first_angle + 2.0 * np.pi * rate / fs * np.arange(count), np.float64)


def from_tacho(
    pulses: ArrayLike, fs: float, count: int, *, per_turn: int = 1, first_angle: float = 0.0, direction: int = 1
) -> FloatArray:
    """Angles [rad] from the times [s] of a tachometer's pulses; between pulses the rotation is taken as uniform.

    Parameters
    ----------
    pulses
        Ascending; the first at or before the record's start, the last at or after its end.
    per_turn
        Pulses of one turn.
    first_angle
        Angle at the first pulse.
    direction
        1 for an increasing angle, -1 for a decreasing one.

    Raises
    ------
    InputError
        The pulses do not ascend, or do not span the record.

    Examples
    --------
    >>> from_tacho([-1.0, 1.0, 3.0], 1.0, 4).round(4).tolist()
    [3.1416, 6.2832, 9.4248, 12.5664]
    """
    at = np.asarray(pulses, np.float64)
    time = np.arange(count) / fs
    if at.ndim != 1 or len(at) < 2 or not np.isfinite(at).all() or np.any(np.diff(at) <= 0.0):
        raise InputError("tacho: expected the instants of two pulses or more, ascending")
    if at[0] > time[0] or at[-1] < time[-1]:
        found = f"pulses from {at[0]:g} to {at[-1]:g} s"
        raise InputError(f"tacho: found {found}, expected them to span the record, 0 to {time[-1]:g} s")
    turns = np.interp(time, at, np.arange(len(at)) / per_turn)
    return np.asarray(first_angle + direction * 2.0 * np.pi * turns)
