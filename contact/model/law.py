"""Contact laws, and the one place where the sign of the contact force is stated.

Sign
----
Public convention, that of the source study: gap g >= 0, contact pressure lam <= 0, g lam = 0. `Result.lam` is
in this sign. Everything else (loops, `Result.force`, impulse, files) speaks of the *force*, which is
compressive and >= 0: force = -lam.
"""

from __future__ import annotations

from dataclasses import dataclass

from contact.model.arrays import Array, require_not_negative, require_positive


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


Law = Unilateral | Penalty | AugmentedLagrangian | Coulomb
