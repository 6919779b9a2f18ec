"""Verification rows of closed contact: B6, two more coincidences, the disk in its casing, digging friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import contact as ct
from contact.stability.closed_contact import growth
from contact.stability.coincidence import loaded
from contact.stability.growth_map import StabilityMap
from reports.tables import Row, check


def hand(
    n: int, casing: tuple[float, float, float], blade: tuple[float, float, float], stiffness: float
) -> ct.gaps.HandPair:
    """A hand calculation: (Hz, kg, zeta) of the casing pair and of the blade mode, contact stiffness [N/m]."""
    return ct.gaps.HandPair(
        casing=ct.gaps.ModalPair(n=n, freq_hz=casing[0], modal_mass=casing[1], zeta=casing[2]),
        blade=ct.gaps.ModalPair(freq_hz=blade[0], modal_mass=blade[1], zeta=blade[2]), compliance=1.0 / stiffness,
    )  # fmt: skip


B6 = hand(8, (300.0, 1.5, 0.0), (120.0, 0.4, 0.0), 1e4)
OTHERS = {
    "n = 4, damped": hand(4, (250.0, 2.0, 2e-4), (90.0, 0.8, 5e-4), 1e4),
    "n = 12, blade damped": hand(12, (800.0, 0.9, 0.0), (410.0, 0.2, 1e-4), 5e4),
}


def around(pair: ct.gaps.HandPair, steps: int = 401) -> StabilityMap:
    """Growth map within 2 % of the loaded sum."""
    return ct.stability.of_contact(pair.contact(), loaded(pair).speed_hz * np.linspace(0.98, 1.02, steps))


def pushed_wave(pair: ct.gaps.HandPair) -> float:
    """Largest growth [1/s] just above f_c/n turns/s of an undamped pair, whose contact pushes half a wave.

    |a|/S, a = 1/(4 m_c w_c) and S = 1/k + 1/(m_b w_b^2) + 1/(4 m_c w_c^2), the response of all else at rest.
    """
    m, w = pair.casing.modal_mass, pair.casing.omega
    S = pair.compliance + 1.0 / (pair.blade.modal_mass * pair.blade.omega**2) + 1.0 / (4.0 * m * w**2)
    return float(1.0 / (4.0 * m * w) / S)


def rows(quick: bool) -> list[Row]:
    """B6 and its neighbours; all are quick."""
    found = ct.stability.of_contact(B6.contact(), np.linspace(52.0, 54.0, 401))
    six = "6-state eigenvalues"
    low, high = found.bands_hz[0]
    lines = [
        check("B6 pair n = 8, peak growth [1/s]", six, 3.7883, found.peak_growth, 0.001),
        check("B6 pair n = 8, speed of the peak [Hz]", six, 52.844, found.peak_speed_hz, 0.0014),
        check("B6 pair n = 8, unstable from [Hz]", six, 52.693, low, 0.0014),
        check("B6 pair n = 8, unstable to [Hz]", six, 52.994, high, 0.0014),
        check("B6 pair n = 8, formula's growth [1/s]", "closed form", 3.7868, loaded(B6).growth, 5e-4),
        check("B6 pair n = 8, growth at 22.5 Hz, the difference [1/s]", six, 0.0,
              float(growth(B6.contact(), np.array([22.5]))[0]), 1e-6),
    ]  # fmt: skip
    pushed = ct.stability.of_contact(B6.contact(), np.linspace(20.0, 40.0, 3))
    low, high = pushed.bands_hz[0]
    formula = pushed_wave(B6)
    lines += [
        check("B6 pair n = 8, growth of the wave that the blade pushes [1/s]", "closed form", formula,
              pushed.peak_growth, 2.4e-5),
        check("B6 pair n = 8, width of its band [Hz]", "closed form", 2.0 * formula / (2.0 * np.pi * 8), high - low,
              3e-5),
    ]  # fmt: skip
    for name, pair in OTHERS.items():
        peak, by_hand = around(pair), loaded(pair)
        lines.append(
            check(f"B6 pair {name}, peak growth [1/s]", "closed form", by_hand.growth, peak.peak_growth, 0.085)
        )
        lines.append(check(f"B6 pair {name}, speed [Hz]", "closed form", by_hand.speed_hz, peak.peak_speed_hz, 5e-4))
    disk = ct.gaps.disk_contact(
        ct.gaps.ModalPair(n=5, freq_hz=300.0, modal_mass=2.0), ct.gaps.ModalPair(n=5, freq_hz=120.0,
        modal_mass=1.0),
        stiffness=1e3, blades=22,
    )  # fmt: skip
    peak = ct.stability.of_contact(disk, np.linspace(80.0, 88.0, 401))
    lines.append(
        check("Legrand disk in casing, n = 5, unstable speed [Hz]", "f_c + f_b = n f", 84.0, peak.peak_speed_hz, 0.5)
    )
    return lines


def digging(friction: float, lean_deg: float, zeta: float = 1e-3) -> ct.gaps.HandPair:
    """B6, damped, with friction and lean."""
    return replace(
        B6,
        casing=replace(B6.casing, zeta=zeta),
        blade=replace(B6.blade, zeta=zeta),
        friction=friction,
        lean_deg=lean_deg,
    )
