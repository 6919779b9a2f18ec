"""Which side of a rim or rub turns: the key [speed] turning, and warnings of what a scene leaves out."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Literal

from contact.io.trust import SceneWarning
from contact.model.gaps.rub import Rub

Side = Literal["casing", "blades"]
MEANING = (
    "which side turns; bodies on it have the Coriolis forces and the stiffening of their bases; blades if left out"
)


def warn_of_turning(given: Side | None, rub: Rub, file: Path) -> None:
    """Warn where `turning` is left out and matters to the result, or where the casing turns without its matrices."""
    if not rub.speed.hz.any():
        return
    turning = [
        name
        for name, body in zip(rub.names, rub.bodies, strict=True)
        if body.gyroscopic is not None or body.stiffness_by_speed is not None
    ]
    if given is None and (turning or rub.forces):
        what = f"Coriolis forces and stiffening of {' and '.join(turning)}" if turning else "gravity or whirl"
        words = f"speed.turning: left out in a scene with {what}, taken as 'blades': the casing is at rest"
        _warn("turning-unstated", file, words)
    if given == "casing" and rub.casing.gyroscopic is None:
        _warn("turning-unmodelled", file, "casing: found no gyroscopic matrix in its basis beside turning = 'casing'")


def _warn(code: str, file: Path, words: str) -> None:
    warnings.warn(SceneWarning(code, f"{file}: {words}"), stacklevel=4)
