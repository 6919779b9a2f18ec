"""Whirl of a rotor over its speed: frequencies and growth, critical speeds, unbalance response."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.base.arrays import Array, readonly
from contact.base.errors import InputError
from contact.io.columns import Column
from contact.io.reported import Reported
from contact.model.rotor.rotor import Rotor

SLOW = 1e-9  # of the largest |s|: an eigenvalue without oscillation
ROUND = 1e-3  # share of one sense beyond the other below which a motion is planar
SAME = 1e-9  # of the square of a critical speed: two that differ by less are equal
REAL = 1e-6  # imaginary part of a critical speed that is round-off

WHIRL = (
    Column("speed_hz", "Speed of rotation.", lambda found: found.speed_hz, head="speed", unit="Hz", format=".6g"),
    Column("mode", "Number of the mode at its speed, from 1 by frequency.", lambda found: found.mode, format="d"),
    Column("freq_hz", "Whirl frequency, in the frame that does not turn.", lambda found: found.freq_hz,
           head="frequency", unit="Hz", format=".6g"),
    Column("sense", "forward: the orbit runs with the rotation; backward: against it; planar: neither.",
           lambda found: found.sense),
    Column("growth_1_s", "Growth rate of the free motion; a positive rate is unstable.",
           lambda found: found.growth, head="growth", unit="1/s", format=".5g"),
)  # fmt: skip
RESPONSE = (
    Column("speed_hz", "Speed of rotation.", lambda found: found.speed_hz, head="speed", unit="Hz", format=".6g"),
    Column("radius_m", "Radius of the forward part of the steady orbit.", lambda found: np.abs(found.forward),
           head="radius", unit="m", format=".5g"),
    Column("largest_m", "Largest distance of the steady orbit from its centre.",
           lambda found: np.abs(found.forward) + np.abs(found.backward), head="largest", unit="m", format=".5g"),
    Column("lag_deg", "Lag of the forward part behind the unbalance, 0 to 360.", lambda found: found.lag_deg,
           head="lag", unit="degrees", format=".4f"),
)  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True, repr=False)
class RotorCampbell(Reported):
    """Whirl modes of a rotor, a row for each speed and mode: all arrays have the shape (rows,).

    >>> import contact as ct
    >>> shaft = ct.rotor.Rotor.of(ct.rotor.Jeffcott(mass=1.0, stiffness=100.0), 1.0)
    >>> found = ct.rotor.campbell(shaft, [0.0, 1.0])
    >>> sorted(set(found.sense)), bool(np.allclose(2.0 * np.pi * found.freq_hz, 10.0))
    (['planar'], True)
    """

    COLUMNS: ClassVar = WHIRL

    speed_hz: Array
    mode: NDArray[np.int64]
    freq_hz: Array
    sense: tuple[str, ...]
    growth: Array

    def of(self, sense: str) -> list[Array]:
        """Frequencies [Hz] of one whirl sense, an array for each speed in ascending order."""
        at = np.array([one == sense for one in self.sense])
        return [np.sort(self.freq_hz[at & (self.speed_hz == hz)]) for hz in np.unique(self.speed_hz)]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True, repr=False)
class UnbalanceResponse(Reported):
    """Steady orbit x + i y = forward e^(i Omega t) + backward e^(-i Omega t) [m] at each speed, (speeds,).

    >>> import contact as ct
    >>> moment = ct.rotor.Unbalance(moment=1e-3)
    >>> shaft = ct.rotor.Rotor.of(ct.rotor.Jeffcott(mass=1.0, stiffness=100.0, zeta=0.05), 1.0, unbalance=moment)
    >>> found = ct.rotor.unbalance_response(shaft, [10.0 / (2.0 * np.pi)])
    >>> round(float(abs(found.forward[0])), 6), found.lag_deg.round(3).tolist()  # moment/(2 zeta mass) at resonance
    (0.01, [90.0])
    """

    COLUMNS: ClassVar = RESPONSE

    speed_hz: Array
    forward: NDArray[np.complex128]
    backward: NDArray[np.complex128]
    lag_deg: Array


def campbell(rotor: Rotor, speed_hz: ArrayLike) -> RotorCampbell:
    """Whirl frequencies, senses and growth at each speed [turns/s]; modes that do not oscillate are left out.

    Eigenvalues s of s^2 + s (C + Omega G) + K + Omega H = 0. The sense is the sign of the area that the orbits of all
    nodes enclose: forward is the sense of rotation, from x to y for a speed > 0.

    >>> from contact.model.rotor import Jeffcott
    >>> found = campbell(Rotor.of(Jeffcott(mass=1.0, stiffness=400.0), 1.0), [0.0])
    >>> [round(2.0 * np.pi * f, 6) for f in found.freq_hz.tolist()]
    [20.0, 20.0]
    """
    rows: list[tuple[float, int, float, str, float]] = []
    for hz in _speeds(speed_hz).tolist():
        s, shape = modes_at(rotor, 2.0 * math.pi * hz)
        turning = sense_of(rotor, shape, math.copysign(1.0, hz))
        rows += [
            (hz, k + 1, abs(s[k].imag) / (2.0 * math.pi), turning[k], s[k].real)
            for k in range(s.size)
        ]  # fmt: skip
    speed, mode, freq, sense, growth = zip(*rows, strict=True) if rows else ((), (), (), (), ())
    return RotorCampbell(
        speed_hz=readonly(speed), mode=np.array(mode, dtype=np.int64), freq_hz=readonly(freq), sense=tuple(sense),
        growth=readonly(growth),
    )  # fmt: skip


def modes_at(rotor: Rotor, omega: float) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Eigenvalues [1/s] with Im s > 0 by ascending frequency, and their shapes (m, modes), at a speed [rad/s]."""
    C, K = rotor.matrices(omega)
    m = len(C)
    s, X = np.linalg.eig(np.block([[np.zeros((m, m)), np.eye(m)], [-K, -C]]))
    kept = np.flatnonzero(s.imag > SLOW * np.abs(s).max(initial=0.0))
    kept = kept[np.argsort(s.imag[kept], kind="stable")]
    return s[kept].astype(np.complex128), X[:m, kept].astype(np.complex128)


def growth(rotor: Rotor, speed_hz: ArrayLike) -> Array:
    """Largest growth rate of the free motion at each speed, (speeds,) [1/s], including modes that do not oscillate.

    >>> from contact.model.rotor import Jeffcott
    >>> rotor = Rotor.of(Jeffcott(mass=1.0, stiffness=100.0, zeta=0.02, zeta_internal=0.01), 1.0)
    >>> bool(abs(growth(rotor, 30.0 / (2.0 * np.pi))[0]) < 1e-9)  # the threshold: 10 rad/s (1 + 0.02/0.01)
    True
    """
    found = []
    for hz in _speeds(speed_hz).tolist():
        C, K = rotor.matrices(2.0 * math.pi * hz)
        m = len(C)
        found.append(np.linalg.eigvals(np.block([[np.zeros((m, m)), np.eye(m)], [-K, -C]])).real.max())
    return np.array(found)


def sense_of(rotor: Rotor, shape: NDArray[np.complex128], sign: float = 1.0) -> list[str]:
    """Whirl sense (forward, backward or planar) of each shape (m, modes), by the area of its orbits.

    `sign` of the speed.
    """
    x, y = np.moveaxis(rotor.places, 1, 0) @ shape
    area = -2.0 * (np.conj(x) * y).imag.sum(axis=0)
    size = (np.abs(x) ** 2 + np.abs(y) ** 2).sum(axis=0)
    share = sign * np.divide(area, size, out=np.zeros(area.size), where=size > 0.0)
    return ["forward" if one > ROUND else "backward" if one < -ROUND else "planar" for one in share]


def critical_speeds(rotor: Rotor) -> list[dict[str, Any]]:
    """Speeds [turns/s] at which the undamped rotor whirls once per turn, ascending: {speed_hz, sense}.

    K Q = Omega^2 (I - i G) Q with the symmetric part of K. Unbalance drives the forward modes, on anisotropic bearings
    also the backward ones. Of two equal speeds one is forward and one backward.

    >>> from contact.model.rotor import Jeffcott
    >>> [(round(2.0 * np.pi * one["speed_hz"], 6), one["sense"]) for one in critical_speeds(
    ...     Rotor.of(Jeffcott(mass=1.0, stiffness=400.0), 1.0))]
    [(20.0, 'forward'), (20.0, 'backward')]
    """
    from scipy.linalg import eig

    body = rotor.body
    m = body.omega.size
    K = np.diag(body.omega**2) + (0.0 if body.stiffness is None else 0.5 * (body.stiffness + body.stiffness.T))
    G = np.zeros((m, m)) if body.gyroscopic is None else body.gyroscopic
    squared, shape = eig(K, np.eye(m) - 1j * G)
    fine = np.isfinite(squared) & (squared.real > 0.0) & (np.abs(squared.imag) <= REAL * np.abs(squared))
    order = np.flatnonzero(fine)[np.argsort(squared[fine].real, kind="stable")]
    senses = sense_of(rotor, _apart(rotor, squared[order].real, shape[:, order].astype(np.complex128)))
    return [
        {"speed_hz": math.sqrt(squared[k].real) / (2.0 * math.pi), "sense": sense}
        for k, sense in zip(order.tolist(), senses, strict=True)
    ]


def _apart(rotor: Rotor, squared: Array, shape: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """The shapes (m, modes), with those of equal eigenvalues combined to the most forward and most backward ones."""
    found = shape.copy()
    equal = np.diff(squared) <= SAME * squared[1:]
    for own in np.split(np.arange(squared.size), np.flatnonzero(~equal) + 1):
        if own.size > 1:
            basis = np.linalg.qr(shape[:, own])[0]
            x, y = np.moveaxis(rotor.places, 1, 0) @ basis
            area = 1j * (x.conj().T @ y - y.conj().T @ x)
            found[:, own] = basis @ np.linalg.eigh(area)[1][:, ::-1]
    return found


def unbalance_response(rotor: Rotor, speed_hz: ArrayLike) -> UnbalanceResponse:
    """Steady orbit under the unbalance after a release, at each speed [turns/s].

    (K + Omega H - Omega^2 + i Omega (C + Omega G)) Q = U Omega^2 rows^T (1, -i).

    >>> from contact.model.rotor import Jeffcott, Unbalance
    >>> rotor = Rotor.of(Jeffcott(mass=10.0, stiffness=4e6, zeta=0.02), 80.0, unbalance=Unbalance(moment=1e-3))
    >>> found = unbalance_response(rotor, [80.0])
    >>> f"{abs(found.forward[0]):.4g}", f"{found.lag_deg[0]:.3f}"
    ('0.0001708', '4.933')
    """
    speeds, plane, U = _speeds(speed_hz), rotor.plane, rotor.unbalance.after
    found = np.zeros((2, speeds.size), dtype=np.complex128)
    for k, omega in enumerate((2.0 * math.pi * speeds).tolist()):
        C, K = rotor.matrices(omega)
        x, y = plane @ np.linalg.solve(
            K - omega**2 * np.eye(len(K)) + 1j * omega * C, U * omega**2 * (plane.T @ np.array([1.0, -1j]))
        )
        found[:, k] = 0.5 * (x + 1j * y), 0.5 * np.conj(x - 1j * y)
    lag = np.copysign(1.0, speeds) * np.degrees(np.angle(U) - np.angle(found[0])) % 360.0
    return UnbalanceResponse(speed_hz=speeds, forward=found[0], backward=found[1], lag_deg=readonly(lag))


def _speeds(speed_hz: ArrayLike) -> Array:
    speeds = readonly(np.atleast_1d(np.asarray(speed_hz, dtype=float)))
    if speeds.ndim != 1 or not np.isfinite(speeds).all():
        raise InputError(f"speed_hz: found {speed_hz!r}, expected a list of finite speeds")
    return speeds
