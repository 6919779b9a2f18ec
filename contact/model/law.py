"""Contact laws, and the one place where the sign of the contact force is stated.

Sign
----
Public convention, that of the source study: gap g >= 0, contact pressure lam <= 0, g lam = 0. `Result.lam` is
in this sign. Everything else (loops, `Result.force`, impulse, files) speaks of the *force*, which is
compressive and >= 0: force = -lam.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

from contact.base.arrays import Array, require_not_negative, require_positive
from contact.base.errors import InputError

Depth = TypeVar("Depth", float, Array)


def pressure(force: Array) -> Array:
    """Contact pressure in the public sign, lam = -force <= 0."""
    return -force


@dataclass(frozen=True, slots=True, kw_only=True)
class Unilateral:
    """Rigid frictionless contact: g >= 0, lam <= 0, g lam = 0 (Signorini).

    >>> Unilateral()
    Unilateral()
    """


@dataclass(frozen=True, slots=True, kw_only=True)
class Penalty:
    """Contact spring: force = stiffness <-g>, so the gap becomes negative; `stiffness` [N/m] > 0.

    >>> Penalty(stiffness=1e9).stiffness
    1000000000.0
    """

    stiffness: float

    def __post_init__(self) -> None:
        require_positive(stiffness=self.stiffness)


@dataclass(frozen=True, slots=True, kw_only=True)
class AugmentedLagrangian:
    """Penalty with multiplier updates: force <- <force - stiffness g>, at most `updates` times a step.

    Each update is solved with the motion of the step in it, so any `stiffness` [N/m] > 0 converges, a stiffer one
    faster; it stops when neither gap nor force violates the law by more than `tolerance` [m] (Simo, Laursen,
    Comput. Struct. 42, 1992, 97). For implicit schemes.

    >>> AugmentedLagrangian(stiffness=1e6).updates
    50
    """

    stiffness: float
    updates: int = 50
    tolerance: float = 1e-12

    def __post_init__(self) -> None:
        require_positive(stiffness=self.stiffness, updates=self.updates, tolerance=self.tolerance)


@dataclass(frozen=True, slots=True, kw_only=True)
class Coulomb:
    """Rigid contact with slip friction of coefficient `mu` >= 0: tangential force = -mu force sgn(v_t).

    Slip only: the sign is that of the sliding speed one half step before, there is no stick. On a rim the
    surface speed R Omega exceeds vibration speeds, so the sign does not change; contact steps in which it
    did are counted in `Result.reversals`.

    >>> Coulomb(mu=0.3).mu
    0.3
    """

    mu: float

    def __post_init__(self) -> None:
        require_not_negative(mu=self.mu)


@dataclass(frozen=True, slots=True, kw_only=True)
class Abradable:
    """Coating of a rim: bars side by side around it, elastic-plastic with linear hardening; plastic flow is wear.

    A bar of length `thickness` whose surface the tip has pressed by d carries the stress E (d - w)/thickness. Where
    that exceeds `yield_stress` + `hardening` w/thickness it flows and its worn depth w grows (M. Legrand, A. Batailly,
    C. Pierre, J. Comput. Nonlinear Dyn. 7, 2012, 011018). At w = thickness the casing is bare: what the tip meets
    there is as stiff as the bars, and flows no more.

    `E`, `yield_stress`, `hardening` [Pa]; `thickness` [m]; the tip covers `width` [m] along the axis and `tip` [m]
    around, `bars` of them; `machined` [m] is cut before the run, from the rim's highest point to a
    circle; `mu` of friction, sliding as for `Coulomb`, at the tips of a `Rub` with stick.

    >>> coating = Abradable(E=1e9, yield_stress=5e6, hardening=1e8, thickness=2e-3, width=0.04, tip=2e-3)
    >>> coating.stress(1e-4), round(coating.dissipated(1e-4))
    (10000000.0, 750)
    """

    E: float
    yield_stress: float
    hardening: float
    thickness: float
    width: float
    tip: float
    bars: int = 6
    machined: float = 0.0
    mu: float = 0.0

    def __post_init__(self) -> None:
        require_positive(E=self.E, yield_stress=self.yield_stress, thickness=self.thickness, width=self.width)
        require_positive(tip=self.tip)
        require_not_negative(hardening=self.hardening, machined=self.machined, mu=self.mu)
        if self.machined > self.thickness:
            raise InputError(
                f"machined: found {self.machined:g} m, expected at most the thickness {self.thickness:g} m"
            )
        if not isinstance(self.bars, int) or not 1 <= self.bars <= 10_000:
            raise InputError(f"bars: found {self.bars!r}, expected a whole number under the tip from 1 to 10,000")

    def stress(self, worn: Depth) -> Depth:
        """Stress at which a bar of this worn depth [m] flows [Pa]."""
        return self.yield_stress + self.hardening * worn / self.thickness

    def dissipated(self, worn: Depth) -> Depth:
        """Energy that wears a bar to this depth, over its area [J/m^2]: integral of the stress over the depth."""
        return worn * self.stress(0.5 * worn)


Law = Unilateral | Penalty | AugmentedLagrangian | Coulomb | Abradable


def friction(law: Law) -> float:
    """Coefficient of sliding friction of any law, 0 for those without.

    >>> friction(Unilateral()), friction(Coulomb(mu=0.3))
    (0.0, 0.3)
    """
    return law.mu if isinstance(law, Coulomb | Abradable) else 0.0
