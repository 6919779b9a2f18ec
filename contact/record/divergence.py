"""What is said of a run that outgrew its model."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Divergence:
    """Which limit a run passed after `step` steps, at `time` [s], and how it got there.

    `limit`: "wall" half of its thickness, "radius" a tenth of it, "gap" of contacts on the ground, "energy", or
    "overflow". `reached` and `allowed` in metres, of the energy in joules, nan of an overflow. `growth` [1/s] of the
    force's variation just before, nan where too few samples tell it; `theory` [1/s] of a contact that stays closed at
    this speed, nan where no poles tell it. `words`: all this, and what ends such a motion in reality.

    >>> Divergence(limit="wall", step=5, time=1e-3, reached=2e-3, allowed=1.5e-3, words="").to_dict()["growth_1_s"]
    """

    limit: str
    step: int
    time: float
    reached: float
    allowed: float
    words: str
    growth: float = math.nan
    theory: float = math.nan

    def to_dict(self) -> dict[str, object]:
        """JSON-ready."""
        named = {"reached": self.reached, "allowed": self.allowed, "growth_1_s": self.growth, "theory_1_s": self.theory}
        found: dict[str, object] = {name: value if math.isfinite(value) else None for name, value in named.items()}
        return {"limit": self.limit, "step": self.step, "time": self.time, **found, "words": self.words}
