"""Demodulation of a continuous circle scan: one laser spot that moves around a vibrating casing.

On a wave V(theta) = sum_n V_n e^(i n theta), excited at omega, a spot at theta(t) measures

    v(t) = Re sum_n V_n e^(i (omega t + n theta(t)))

For a spot rotating at W there are lines at omega +- n W. For a standing wave A cos n(theta - psi) e^(i phase) both are
equal, V_+-n = (A/2) e^(i phase) e^(-+i n psi), and their ratio gives the travelling part (Stanbridge & Ewins, Mech.
Syst. Signal Process. 13, 1999, 255). All lines are fitted at once by least squares at their exact frequencies, so that
a record need not contain whole turns or periods, and there is no leakage.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.experiment.circle.lines import fit_lines, require_clear
from casingfem.experiment.circle.record import ScanRecord
from casingfem.io.arrays import Array, FloatArray, IntArray, freeze
from contact.io.reported import Reported

SEEN = 4.0  # standard deviations above which a line is there
LEFT = 1.5  # times the noise that a fit may leave before the table states it
NOISE = 1e-9  # of the largest line: below it there is round-off alone


class Wave(NamedTuple):
    """The wave of one order at one tone, with standard uncertainties.

    `amplitude` [m/s, or m/s/N] is the largest around the circle; `angle_deg` of an antinode, in [0, 180/n), nan for
    n = 0; `travelling` is 0 for a standing wave, 1 for one that runs towards larger angles, -1 against them.
    """

    tone: float
    n: int
    amplitude: float
    amplitude_sigma: float
    phase_deg: float
    angle_deg: float
    angle_sigma_deg: float
    travelling: float
    travelling_sigma: float
    seen: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class CircleScan(Reported):
    """Result of a circle scan; arrays are read-only.

    Attributes
    ----------
    tones, n
        Frequencies [Hz] (tones,) and orders, negative ones first, (lines,).
    V
        Complex amplitudes V_n of each tone, (tones, lines).
    sigma
        Standard uncertainty of their real and of their imaginary parts, (tones, lines).
    floor
        Amplitude spectrum of the noise beside each line: rms in one bin of the record, (tones, lines).
    rate
        Mean rate of the spot [turns/s].
    left
        Rms of the residual over that of the noise alone; above 1.5, orders or tones that were not fitted leak into the
        fitted ones.
    card
        Source lines of the record.

    Examples
    --------
    >>> import casingfem as cf
    >>> t = np.arange(8000) / 2000.0
    >>> theta = 2.0 * np.pi * 3.0 * t
    >>> seen = np.cos(5 * theta) * np.cos(2.0 * np.pi * 401.7 * t)
    >>> scan = cf.circle.demodulate(cf.circle.ScanRecord(fs=2000.0, velocity=seen, angle=theta, tones=(401.7,)), 6)
    >>> scan.n.tolist() == list(range(-6, 7)), round(float(abs(scan.V[0, 11])), 3)
    (True, 0.5)
    """

    tones: FloatArray
    n: IntArray
    V: Array
    sigma: FloatArray
    floor: FloatArray
    rate: float
    left: float
    card: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        freeze(self, "tones", "n", "V", "sigma", "floor")

    @property
    def lines(self) -> FloatArray:
        """Frequencies of the lines, omega/2 pi + n W [Hz], (tones, lines)."""
        return np.asarray(self.tones[:, None] + self.n * self.rate)

    def wave(self, tone: int, n: int) -> Wave:
        """The wave of order n at a tone, by its index.

        Raises
        ------
        InputError
            The order was not fitted.
        """
        if n not in self.n or n < 0:
            raise InputError(f"order n = {n}: expected one of {sorted({abs(k) for k in self.n.tolist()})}")
        up, down = (int(np.flatnonzero(self.n == k)[0]) for k in (n, -n))
        return one_wave(float(self.tones[tone]), n, self.V[tone, [up, down]], self.sigma[tone, [up, down]])

    def waves(self) -> list[Wave]:
        """All waves, by tone and nodal diameters."""
        orders = sorted({abs(k) for k in self.n.tolist()})
        return [self.wave(tone, n) for tone in range(len(self.tones)) for n in orders]

    def records(self) -> list[dict[str, object]]:
        """One plain dictionary for each wave, also those within the noise (`seen` is false for them)."""
        return [wave._asdict() for wave in self.waves()]

    def shape(self, tone: int, theta: ArrayLike) -> Array:
        """The deflection V(theta) at angles [rad], complex, from the lines above the noise."""
        angles = np.asarray(theta, np.float64)
        there = np.abs(self.V[tone]) > SEEN * self.sigma[tone]
        return np.asarray(np.exp(1j * np.multiply.outer(angles, self.n)) @ np.where(there, self.V[tone], 0.0))

    def __repr__(self) -> str:
        head = f"{'tone [Hz]':>10} {'n':>3} {'amplitude':>10} {'+-':>8} {'phase':>7} {'angle':>7} {'+-':>6}"
        rows = [f"{head} {'travel':>7}"]
        for w in self.waves():
            if w.seen:
                angle, sigma = ("-", "-") if w.n == 0 else (f"{w.angle_deg:.2f}", f"{w.angle_sigma_deg:.2f}")
                rows.append(
                    f"{w.tone:>10.3f} {w.n:>3} {w.amplitude:>10.3e} {w.amplitude_sigma:>8.1e} {w.phase_deg:>7.1f}"
                    f" {angle:>7} {sigma:>6} {w.travelling:>7.3f}"
                )
        rows.append(f"{len(rows) - 1} waves above {SEEN:g} sigma of {len(self.waves())}, {self.rate:.4g} turns/s")
        if self.left > LEFT and np.median(self.floor) > NOISE * np.abs(self.V).max():
            rows.append(f"the residual is {self.left:.2g} times the noise: orders or tones that were not fitted")
        return "\n".join(rows)


def one_wave(tone: float, n: int, V: Array, sigma: FloatArray) -> Wave:
    """Amplitude, phase, orientation and travelling part of V_n, V_-n.

    2 n psi = arg V_-n - arg V_n; each arg has the uncertainty sigma/|V|.
    """
    size = np.abs(V)
    if n == 0:
        phase = float(np.degrees(np.angle(V[0])))
        seen = bool(size[0] > SEEN * sigma[0])
        return Wave(tone, 0, float(size[0]), float(sigma[0]), phase, np.nan, np.nan, 0.0, 0.0, seen)
    turn = np.angle(V[1] * np.conj(V[0])) / 2.0
    psi = float(np.mod(np.degrees(turn) / n, 180.0 / n))
    turned = np.exp(1j * n * np.radians(psi))
    phase = float(np.degrees(np.angle(V[0] * turned + V[1] * turned.conj())))
    spread = np.hypot(*(sigma / np.maximum(size, 1e-300))) / (2.0 * n)
    total = float(size.sum())
    over = max(total, 1e-300)
    relative = 2.0 * (size[::-1] / over) * (sigma / over)  # slopes of (down - up)/(down + up), times sigma
    return Wave(
        tone=tone,
        n=n,
        amplitude=total,
        amplitude_sigma=float(np.hypot(*sigma)),
        phase_deg=phase,
        angle_deg=psi,
        angle_sigma_deg=float(min(np.degrees(spread), 180.0 / n)),
        travelling=float((size[1] - size[0]) / over),
        travelling_sigma=float(np.hypot(*relative)),
        seen=bool(np.any(size > SEEN * sigma)),
    )


def demodulate(record: ScanRecord, orders: int | Sequence[int], *, runout: int = 0) -> CircleScan:
    """All waves of some orders at all tones of a record, with their uncertainty from the noise around the lines.

    Parameters
    ----------
    record
        The scan.
    orders
        Highest n, or the orders n to search for. A wave of another order leaks into these as 1/(turns of the record);
        `left` shows it.
    runout
        Highest harmonic of the turn that is also fitted, since run-out and speckle repeat every turn.

    Raises
    ------
    InputError
        Lines of different waves coincide, the record is too short to resolve lines W apart, or lines are above fs/2.

    Examples
    --------
    >>> from casingfem.experiment.circle.record import turning
    >>> t = np.arange(8000) / 2000.0
    >>> theta = turning(3.0, 2000.0, 8000)
    >>> seen = np.cos(5 * (theta - 0.1)) * np.cos(2.0 * np.pi * 401.7 * t)
    >>> found = demodulate(ScanRecord(fs=2000.0, velocity=seen, angle=theta, tones=(401.7,)), 6)
    >>> wave = found.wave(0, 5)
    >>> round(wave.amplitude, 6), round(wave.angle_deg, 4), abs(round(wave.travelling, 6))
    (1.0, 5.7296, 0.0)
    """
    asked = range(orders + 1) if isinstance(orders, int) else orders
    if not asked or min(asked) < 0:
        raise InputError(f"orders: found {orders!r}, expected numbers of nodal diameters, 0 or more")
    n = np.array(sorted({k for order in asked for k in (order, -order)}))
    require_clear(record.tones, n, record.rate, record.seconds, record.fs, runout)
    tones = np.asarray(record.tones)
    turns = np.arange(runout + 1 if runout else 0)
    omega = 2.0 * np.pi * np.r_[np.repeat(tones, len(n)), 0.0 * turns]
    order = np.r_[np.tile(n, len(tones)), turns]
    fit = fit_lines(record, omega, order)
    shape = (len(tones), len(n))
    V, sigma, floor = (values[: len(tones) * len(n)].reshape(shape) for values in fit[:3])
    found = CircleScan(
        tones=tones, n=n, V=V, sigma=sigma, floor=floor, rate=record.rate, left=fit.left, card=record.card
    )
    if record.force is None:
        return found
    force = fit_lines(replace(record, velocity=record.force), 2.0 * np.pi * tones, np.zeros(len(tones)))
    over = force.amplitude[:, None]
    return replace(found, V=V / over, sigma=sigma / np.abs(over), floor=floor / np.abs(over))
