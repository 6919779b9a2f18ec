"""Tuning of the rig's blade: frequencies at which n nodal diameters lead the motion of a contact that grows.

The bodies are those of the run, reduced, and the casing turns. The growth of a contact that stays closed is the real
part of its leading pole, and the motion that grows is the shape of that pole (`contact.stability.closed_contact`).
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import root_scalar

import casingfem as cf
import contact as ct
from casingfem.io.arrays import BoolArray, FloatArray
from contact.stability.closed_contact import first_order
from contact.stability.split_casing import perfect_mean

REACH = 0.06  # of the free coincidence, to both sides
STEPS = 49  # frequencies in that range
HALVINGS = 12  # of a step at an end of the band


@dataclass(frozen=True, slots=True, kw_only=True)
class RubPlan:
    """Settings of the rub: [tuning] and [rub] of rig.toml."""

    n: int
    speed_hz: float
    into_band: float
    t_end: float
    dt: float
    friction: float
    lean_deg: float
    advance: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Tuning:
    """Tuning of the blade's first mode [Hz]: free coincidence, band, target in the band, leading motion."""

    coincidence: float
    low: float
    high: float
    target: float
    thickness: float
    grows: "Leading"


class Leading(NamedTuple):
    """The leading pole of a closed contact: growth [1/s], frequency [Hz], level of n over the next n [dB]."""

    growth: float
    freq_hz: float
    excess_db: float

    @property
    def of_n(self) -> bool:
        """Whether the motion grows and its largest radial motion is at n."""
        return self.growth > 0.0 and self.excess_db > 0.0


def leading(casing: ct.ModalBody, blade: ct.ModalBody, plan: RubPlan, blade_hz: float | None = None) -> Leading:
    """The motion that grows fastest in a closed contact, its blade's first mode at `blade_hz` (its own if left out)."""
    if blade_hz is not None:
        blade = replace(blade, omega=np.r_[2.0 * np.pi * blade_hz, blade.omega[1:]])
    rim = ct.RotatingRim(
        casing, blade, clearance=0.0, speed_hz=plan.speed_hz, lean_deg=plan.lean_deg, turning="casing"
    )  # fmt: skip
    contact = ct.gaps.rim_contact(rim, mu=plan.friction)
    poles, shapes = np.linalg.eig(first_order(contact, 2.0 * np.pi * plan.speed_hz).closed())
    lead = int(poles.real.argmax())
    N = casing.n_max
    radial = np.abs(casing.rows[: 2 * N + 1] @ shapes[: contact.casing, lead]) ** 2
    power = radial[: N + 1] + np.finfo(float).tiny
    power[1:] += radial[N + 1 :]
    over = power[plan.n] / np.delete(power, plan.n).max()
    return Leading(
        growth=float(poles[lead].real), freq_hz=float(abs(poles[lead].imag)) / (2.0 * np.pi),
        excess_db=float(10.0 * np.log10(over)),
    )  # fmt: skip


def band_of_n(casing: ct.ModalBody, blade: ct.ModalBody, plan: RubPlan, coincidence: float) -> tuple[float, float]:
    """Blade frequencies [Hz] between which n leads the motion that grows: the band in which it grows fastest.

    It is searched for within 6 % of the free coincidence f_b = f_c - n f. Raises ValueError where there is none.
    """
    mean = perfect_mean(casing)
    looks = coincidence * np.linspace(1.0 - REACH, 1.0 + REACH, STEPS)
    found = [leading(mean, blade, plan, float(hz)) for hz in looks]
    own = np.array([one.of_n for one in found])
    if not own.any():
        raise ValueError(
            f"n = {plan.n}: found no blade frequency from {looks[0]:.2f} to {looks[-1]:.2f} Hz at which it leads the "
            f"motion that grows at {plan.speed_hz:g} Hz, expected one: choose another speed or nodal diameter"
        )
    best = int(np.where(own, [one.growth for one in found], -np.inf).argmax())
    low, high = (_edge(mean, blade, plan, looks, own, best, way) for way in (-1, 1))
    return low, high


def _edge(
    casing: ct.ModalBody, blade: ct.ModalBody, plan: RubPlan, looks: FloatArray, own: BoolArray, best: int, way: int
) -> float:  # fmt: skip
    """The end of a band on one side of a frequency within it, by bisection."""
    place = best
    while 0 <= place + way < looks.size and own[place + way]:
        place += way
    if not 0 <= place + way < looks.size:
        return float(looks[place])
    inside, outside = float(looks[place]), float(looks[place + way])
    for _ in range(HALVINGS):
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if leading(casing, blade, plan, middle).of_n else (inside, middle)
    return inside


def tuned(blade: cf.Shell, target: float) -> cf.Shell:
    """The blade with the thickness at which its first mode is at `target` [Hz]."""

    def error(scale: float) -> float:
        """Frequencies grow nearly as the thickness: of their logarithms a secant meets the root in a few steps."""
        return float(np.log(cf.modes(replace(blade, thickness=scaled(scale)), 1).freq[0] / target))

    def scaled(scale: float) -> float:
        return float(blade.thickness * np.exp(np.clip(scale, -wide, wide)))

    wide = np.log(3.0)
    found = root_scalar(error, x0=0.0, x1=-error(0.0), method="secant", xtol=1e-11, maxiter=20)
    if not found.converged or abs(found.root) >= wide:
        low, high = scaled(-wide), scaled(wide)
        raise ValueError(f"no thickness from {low:.3g} to {high:.3g} m puts the blade's first mode at {target:.2f} Hz")
    return replace(blade, thickness=scaled(found.root))
