"""The virtual test rig: modes at probes, and simulated measurements there. Its records are SYNTHETIC.

    H_rs(omega) = sum_k phi_rk phi_sk/(omega_k^2 - omega^2 + 2 i zeta_k omega_k omega) + S_rs

with mass-normalised modes and the static compliance S of all omitted modes (Ewins, Modal Testing, 2nd ed., 2000,
section 2.7 and residuals of 4.4). A probe is a place and a direction: an accelerometer, a laser spot, a shaker or a
hammer. Every probe can measure and excite. The measuring chain adds noise with a stated ratio and quantisation, both
seeded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.experiment.frf.frf_set import PLACES, FrfSet
from casingfem.io.arrays import Array, FloatArray, frozen

Quantity = Literal["receptance", "mobility", "accelerance"]
UNITS: dict[Quantity, str] = {"receptance": "m/N", "mobility": "(m/s)/N", "accelerance": "(m/s^2)/N"}
DERIVATIVES: dict[Quantity, int] = {"receptance": 0, "mobility": 1, "accelerance": 2}
SYNTHETIC = "SYNTHETIC: made by casingfem's virtual test rig, not measured"
BITS = (4, 32)
LEAST_ZETA = 1e-9  # of a mode: the best quartz resonators have no less damping


class Probe(NamedTuple):
    """A place and a direction.

    Node number, position [m], angle about the axis [rad], direction number of universal files.

    Directions: 1, 2, 3 radial, hoop, axial at a node of a closed casing (x, y, z on an open part), signed; 0 for
    others.

    >>> Probe(node=1, direction=-1, point=(0.45, 0.0, 0.25), angle=0.0).direction  # radially inwards
    -1
    """

    node: int
    direction: int
    point: tuple[float, float, float]
    angle: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Rig:
    """Modes at probes; arrays are read-only.

    Attributes
    ----------
    omega, zeta
        Angular frequencies [rad/s], ascending, and damping ratios, (modes,).
    rows
        Displacement of each probe in each mass-normalised mode [kg^-1/2], (probes, modes).
    S
        Compliance of the omitted modes [m/N], (probes, probes), symmetric.
    probes
        Places and directions, in the order of the rows.

    Raises
    ------
    InputError
        Arrays do not belong together, or frequencies or damping are out of range.

    Examples
    --------
    >>> rig = Rig.of(omega=[100.0], zeta=[0.01], rows=[[2.0]])
    >>> float(abs(rig.receptance([0], [0], [100.0 / (2.0 * np.pi)])[0, 0, 0]).round(9))  # 4/(2 zeta omega^2)
    0.02
    """

    omega: FloatArray
    zeta: FloatArray
    rows: FloatArray
    S: FloatArray
    probes: tuple[Probe, ...]

    def __post_init__(self) -> None:
        for field in fields(self)[:4]:
            object.__setattr__(self, field.name, frozen(np.asarray(getattr(self, field.name), np.float64)))
        modes, probes = self.omega.size, len(self.probes)
        shapes = {"omega": (modes,), "zeta": (modes,), "rows": (probes, modes), "S": (probes, probes)}
        for name, shape in shapes.items():
            array = getattr(self, name)
            if array.shape != shape or not np.isfinite(array).all():
                found = f"shape {array.shape}" if array.shape != shape else "nan or infinity"
                raise InputError(f"{name}: found {found}, expected finite numbers of shape {shape}")
        if modes == 0 or self.omega.min() <= 0.0 or np.any(np.diff(self.omega) < 0.0):
            raise InputError(
                "omega: expected at least one frequency, all above 0 (the body must be supported) and ascending"
            )
        if self.zeta.min() < LEAST_ZETA or self.zeta.max() >= 1.0:
            found = self.zeta[(self.zeta < LEAST_ZETA) | (self.zeta >= 1.0)][0]
            expected = f"damping ratios from {LEAST_ZETA:g} to below 1, not per cent"
            raise InputError(f"zeta: found {found:g}, expected {expected}")

    @classmethod
    def of(
        cls,
        *,
        omega: ArrayLike,
        zeta: ArrayLike,
        rows: ArrayLike,
        S: ArrayLike | None = None,
        probes: Sequence[Probe] = (),
    ) -> Rig:
        """Build from plain arrays; by default probes are numbered from 1 and S is zero."""
        values = np.asarray(rows, np.float64)
        if values.ndim != 2:
            raise InputError(f"rows: found shape {values.shape}, expected (probes, modes)")
        count = len(values)
        named = tuple(probes) or tuple(Probe(k + 1, 0, (0.0, 0.0, 0.0), 0.0) for k in range(count))
        rest: Any = np.zeros((count, count)) if S is None else S
        damping = np.broadcast_to(np.asarray(zeta, np.float64), np.shape(omega))
        return cls(omega=np.asarray(omega, np.float64), zeta=damping, rows=values, S=rest, probes=named)

    def __len__(self) -> int:
        return len(self.omega)

    @property
    def freq(self) -> FloatArray:
        """Undamped frequencies [Hz]."""
        return self.omega / (2.0 * np.pi)

    def taking(self, probes: Sequence[int]) -> Rig:
        """The rig with only these probes, in this order."""
        chosen = self.checked(probes)
        rows, S = self.rows[chosen], self.S[np.ix_(chosen, chosen)]
        return replace(self, rows=rows, S=S, probes=tuple(self.probes[k] for k in chosen))

    def checked(self, probes: Sequence[int]) -> list[int]:
        """Indices of probes; unknown ones are refused."""
        chosen = [int(k) for k in probes]
        if not chosen or not all(0 <= k < len(self.probes) for k in chosen):
            raise InputError(f"probes {chosen}: expected at least one, each from 0 to {len(self.probes) - 1}")
        return chosen

    def receptance(self, sensors: Sequence[int], drives: Sequence[int], freq: ArrayLike) -> Array:
        """H [m/N] at frequencies [Hz], (sensors, drives, lines)."""
        to, by = self.checked(sensors), self.checked(drives)
        at = 2.0 * np.pi * np.asarray(freq, np.float64)
        residues = self.rows[to][:, None, :] * self.rows[by][None, :, :]
        return np.asarray(residues @ resonances(self, at) + self.S[np.ix_(to, by)][:, :, None])

    def frfs(
        self,
        freq: ArrayLike,
        *,
        sensors: Sequence[int],
        drives: Sequence[int],
        quantity: Quantity = "accelerance",
        card: Sequence[str] = (),
    ) -> FrfSet:
        """Frequency responses, exact for the modes and S: each sensor to the first drive, then to the next.

        Raises
        ------
        InputError
            A probe or a quantity is unknown.
        """
        if quantity not in get_args(Quantity):
            raise InputError(f"quantity: found {quantity!r}, expected {' or '.join(get_args(Quantity))}")
        at = np.asarray(freq, np.float64)
        H = self.receptance(sensors, drives, at) * (2j * np.pi * at) ** DERIVATIVES[quantity]
        return FrfSet.from_arrays(
            kind="frf",
            x=at,
            responses=H.transpose(1, 0, 2).reshape(-1, len(at)),
            unit=UNITS[quantity],
            card=(SYNTHETIC, *card),
            **self.places(sensors, drives),
        )

    def places(self, sensors: Sequence[int], drives: Sequence[int]) -> dict[str, Any]:
        """Places of channels, all sensors for each drive in turn, by their names in an `FrfSet`."""
        ends = [(*self.probes[r][:2], *self.probes[s][:2]) for s in drives for r in sensors]
        return dict(zip(PLACES, np.array(ends).T, strict=True))

    def __repr__(self) -> str:
        low, high = self.freq[[0, -1]].tolist()
        return f"Rig({len(self)} modes {low:.1f}-{high:.1f} Hz, {len(self.probes)} probes)"


def resonances(rig: Rig, omega: FloatArray) -> Array:
    """1/(omega_k^2 - omega^2 + 2 i zeta_k omega_k omega) [s^2], (modes, lines)."""
    own, damping = rig.omega[:, None], rig.zeta[:, None]
    return np.asarray(1.0 / (own**2 - omega**2 + 2j * damping * own * omega))


def noise(values: Array, snr_db: float, rng: np.random.Generator) -> Array:
    """Gaussian noise for each row with 10^(-snr_db/20) of the row's rms; complex for complex values.

    >>> values = np.ones((1, 4000))
    >>> float(np.sqrt(np.mean(noise(values, 20.0, np.random.default_rng(7)) ** 2)).round(2))
    0.1
    """
    if not np.isfinite(snr_db):
        raise InputError(f"snr_db: found {snr_db!r}, expected the ratio of signal to noise in dB")
    rms = np.sqrt(np.mean(np.abs(values) ** 2, axis=-1, keepdims=True)) * 10.0 ** (-snr_db / 20.0)
    if not np.iscomplexobj(values):
        return np.asarray(rms * rng.standard_normal(values.shape))
    parts = rng.standard_normal((2, *values.shape))
    return np.asarray(rms * (parts[0] + 1j * parts[1]) / np.sqrt(2.0))


def noisy(frfs: FrfSet, snr_db: float, *, seed: int) -> FrfSet:
    """The set with noise on every channel, `snr_db` below the channel's rms over its lines; the comment lines state it.

    >>> rig = Rig.of(omega=[600.0], zeta=[0.01], rows=[[1.0]])
    >>> noisy(rig.frfs([80.0, 95.0, 110.0], sensors=[0], drives=[0]), 40.0, seed=5).card[-1]
    'noise: 40 dB below the rms of each channel, seed 5'
    """
    added = frfs.responses + noise(frfs.responses, snr_db, np.random.default_rng(seed))
    note = f"noise: {snr_db:g} dB below the rms of each channel, seed {seed}"
    return replace(frfs, responses=added, card=(*frfs.card, note))


@dataclass(frozen=True, slots=True, kw_only=True)
class Converter:
    """An analogue-digital converter of `bits` over +-`full_scale`, with rounding, and clipping at the ends.

    For a signal that varies by many steps, the error is uniform with variance LSB^2/12 (Widrow & Kollar,
    Quantization Noise, 2008, chapter 1).

    >>> Converter(bits=4, full_scale=8.0).convert(np.array([0.4, 0.6, 99.0])).tolist()
    [0.0, 1.0, 7.0]
    """

    bits: int
    full_scale: float

    def __post_init__(self) -> None:
        if not BITS[0] <= self.bits <= BITS[1]:
            raise InputError(f"bits: found {self.bits!r}, expected {BITS[0]} to {BITS[1]}")
        if not (np.isfinite(self.full_scale) and self.full_scale > 0.0):
            raise InputError(
                f"full_scale: found {self.full_scale!r}, expected the largest value of the converter, a number above 0"
            )

    @property
    def lsb(self) -> float:
        """The smallest step, 2 full_scale/2^bits."""
        return float(2.0 * self.full_scale / 2.0**self.bits)

    def convert(self, values: FloatArray) -> FloatArray:
        """The values after quantisation."""
        half = 2.0 ** (self.bits - 1)
        return np.asarray(np.clip(np.rint(values / self.lsb), -half, half - 1.0) * self.lsb)
