"""The side of a rim or rub that rotates: the key `turning` of [speed], and warnings about omitted effects."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import Literal

import numpy as np

from contact.base.errors import InputError
from contact.io.trust import FAST, SceneWarning
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.rub import Rub
from contact.model.gaps.rub_system import matrices_of
from contact.scene.problems import SceneError

Side = Literal["casing", "blades"]
MEANING = "rotating side, on which Coriolis forces and centrifugal stiffening of the bases act; blades if left out"


def warn_of_turning(given: Side | None, rub: Rub, file: Path) -> None:
    """Warn if `turning` is left out and matters, and of bodies that rotate fast or without their matrices.

    Raises SceneError for a body at a speed for which its matrices are not known.
    """
    if not rub.speed.hz.any():
        return
    turning = [name for name, body in zip(rub.names, rub.bodies, strict=True) if body.varies]
    if given is None and (turning or rub.forces):
        what = f"Coriolis forces and stiffening of {' and '.join(turning)}" if turning else "gravity or whirl"
        words = f"speed.turning: missing in a scene with {what}, 'blades' is assumed: the casing is at rest"
        _warn("turning-unstated", file, words)
    omega = rub.speed.fastest
    for name, body, sense in zip(rub.names, rub.bodies, matrices_of(rub).senses, strict=True):
        for hz in rub.speed.hz:
            try:
                body.require_known(2.0 * math.pi * sense * float(hz))
            except InputError as error:
                raise SceneError([f"{file}: {name}: {error}"]) from None
        if sense and (moved := moved_by_speed(body, omega)) > FAST:
            rpm = 30.0 * omega / math.pi
            found = f"found a frequency of the basis that changes by {100.0 * moved:.3g} % at {rpm:.4g} rpm"
            expected = f"expected at most {100.0 * FAST:g} %"
            _warn("turning-fast", file, f"{name}: {found}, {expected}")
    if given == "casing" and rub.casing.gyroscopic is None:
        _warn("turning-unmodelled", file, "casing: found no gyroscopic matrix in its basis with turning = 'casing'")


def moved_by_speed(body: ModalBody, omega: float) -> float:
    """Largest relative change of a frequency from the speed of the modes to `omega` [rad/s], for uncoupled modes.

    >>> body = ModalBody(omega=[3.0], zeta=[0.0], channels=("x",), rows=[[1.0]], S=[[0.0]], stiffness_by_speed=[[1.0]])
    >>> round(moved_by_speed(body, 4.0), 3)
    0.667
    """
    if body.stiffness_by_speed is None:
        return 0.0
    elastic = body.omega > 0.0
    added = (omega**2 - body.spin**2) * np.diag(body.stiffness_by_speed)[elastic] / body.omega[elastic] ** 2
    return float(np.abs(np.sqrt(np.maximum(1.0 + added, 0.0)) - 1.0).max(initial=0.0))


def _warn(code: str, file: Path, words: str) -> None:
    warnings.warn(SceneWarning(code, f"{file}: {words}"), stacklevel=4)
