"""Energy and angular momentum of a rotor whose speed follows from its torques."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from contact.base.arrays import Array

SUMS = ("drive", "friction", "rotation", "unbalance", "gyroscopic", "released", "missed", "on_friction", "on_others")
DRIVE, FRICTION, ROTATION, UNBALANCE, GYROSCOPIC, RELEASED, MISSED, ON_FRICTION, ON_OTHERS = range(len(SUMS))


@dataclass(frozen=True, slots=True, kw_only=True)
class SpinBudget:
    """end - start = drive + friction + rotation + unbalance + gyroscopic + missed: the energy J Omega^2/2 [J].

    Speeds are averages over the step before the given time. Each entry is the work of one torque on the rotor: of the
    `drive`, of `friction` at the radius of the rim, of normal forces whose point moves over the rim (`rotation`), of
    the `unbalance`, of gyroscopic moments that follow the speed. `shared_start` and `shared_end` are the kinetic energy
    that the unbalance adds to that of disk and rotor, Re(conj(x') u'); `released` is its gain when U changed. `missed`
    is zero unless the rotor nearly stopped. `on_friction` and `on_others` [N m s] are the impulses of the torques,
    `momentum_start` and `momentum_end` J Omega.

    >>> budget = SpinBudget(
    ...     start=8.0, end=2.0, momentum_start=4.0, momentum_end=2.0, drive=1.0, friction=-7.0, rotation=0.0,
    ...     unbalance=0.0, gyroscopic=0.0, released=0.0, missed=0.0, on_friction=-2.5, on_others=0.5,
    ...     shared_start=0.0, shared_end=0.0)
    >>> budget.unaccounted, budget.momentum_unaccounted
    (0.0, 0.0)
    """

    start: float
    end: float
    momentum_start: float
    momentum_end: float
    drive: float
    friction: float
    rotation: float
    unbalance: float
    gyroscopic: float
    released: float
    missed: float
    on_friction: float
    on_others: float
    shared_start: float
    shared_end: float

    @staticmethod
    def of(inertia: float, start: float, end: float, shared: tuple[float, float], sums: Array) -> SpinBudget:
        """The budget from speeds [rad/s], the shared energies at both ends and the sums of the loop."""
        return SpinBudget(
            start=0.5 * inertia * start**2, end=0.5 * inertia * end**2, momentum_start=inertia * start,
            momentum_end=inertia * end, shared_start=shared[0], shared_end=shared[1],
            **dict(zip(SUMS, np.asarray(sums).tolist(), strict=True)),
        )  # fmt: skip

    @property
    def unaccounted(self) -> float:
        """Change of the energy minus all work [J]: round-off."""
        work = self.drive + self.friction + self.rotation + self.unbalance + self.gyroscopic + self.missed
        return self.end - self.start - work

    @property
    def momentum_unaccounted(self) -> float:
        """Change of the angular momentum minus all impulses [N m s]: round-off."""
        return self.momentum_end - self.momentum_start - self.on_friction - self.on_others

    @property
    def words(self) -> str:
        """Energies and works of the spin in one line."""
        return (
            f"{self.start:.6g} J at the start, {self.end:.6g} J at the end; drive {self.drive:.4g}, friction "
            f"{self.friction:.4g}, unbalance {self.unbalance:.4g}, out-of-round casing {self.rotation:.4g}, "
            f"unaccounted {self.unaccounted / max(self.start, self.end, 1e-300):.1e} of the largest"
        )

    def to_dict(self) -> dict[str, float]:
        """JSON-ready."""
        return {field.name: getattr(self, field.name) for field in fields(self)} | {"unaccounted": self.unaccounted}
