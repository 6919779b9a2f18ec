"""A penalty with multiplier updates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from contact.base.arrays import require_positive


@dataclass(frozen=True, slots=True, kw_only=True)
class AugmentedLagrangian:
    """Penalty with multiplier updates: force <- <force - stiffness g>, at most `updates` times a step.

    Each update includes the motion of the step, so any `stiffness` [N/m] > 0 converges, a larger one faster. The
    updates stop when neither gap nor force violates the law by more than `tolerance` [m] (Simo, Laursen, Comput.
    Struct. 42, 1992, 97). For implicit schemes.

    >>> AugmentedLagrangian(stiffness=1e6).updates
    50
    """

    stiffness: float
    updates: int = 50
    tolerance: float = 1e-12
    words: ClassVar[str] = "augmented Lagrangian"
    mu: ClassVar[float] = 0.0
    coating: ClassVar[None] = None
    response: ClassVar[None] = None

    def __post_init__(self) -> None:
        require_positive(stiffness=self.stiffness, updates=self.updates, tolerance=self.tolerance)
