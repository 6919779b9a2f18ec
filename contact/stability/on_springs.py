"""Closed contact with a compliant law: the slope of the law is a spring between each tip and the rim."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from contact.base.arrays import require_positive
from contact.base.errors import InputError
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.rub import ContactPoint, Rub
from contact.model.law import Law

Turning = TypeVar("Turning", bound=RotatingRim | Rub)


def slope_of(law: Law, depth: float | None = None) -> float:
    """Slope [N/m] of a force-depth law in closed contact at a mean `depth` [m].

    A law with constant slope needs no depth. Raises InputError if it is missing, and for a law without a response.

    >>> import contact as ct
    >>> round(slope_of(ct.laws.Hertz(k=1e9), 1e-4)), slope_of(ct.Penalty(stiffness=2e6))
    (15000000, 2000000.0)
    """
    if law.response is None:
        raise InputError(
            f"law: found {law.words}, expected a law with a response: Hertz, ForceTable, ForceLaw or Penalty"
        )
    if depth is not None:
        require_positive(depth=depth)
        return law.response(depth)[1]
    low, high = (law.response(at)[1] for at in (1e-9, 1e-3))
    if not np.isclose(low, high, rtol=1e-9):
        found = f"{law.words}, whose slope is {low:.3g} N/m at a depth of 1e-9 m and {high:.3g} N/m at 1e-3 m"
        raise InputError(f"depth: found none with {found}, expected the mean depth of the closed contact [m]")
    return low


def on_springs(what: Turning, stiffness: float) -> Turning:
    """The same rim or rub with a spring [N/m] along the normal of every tip, as part of its blade's compliance.

    >>> from contact.model.gaps.bladed_disk import pair_rim
    >>> from contact.model.gaps.permanent import ModalPair
    >>> casing = pair_rim(ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5)
    >>> blade = ModalBody(omega=[9.0], zeta=[0.0], channels=("span", "flap"), rows=[[0.0], [1.0]], S=[[0.0, 0.0]] * 2)
    >>> on_springs(RotatingRim(casing, blade, clearance=0.0, speed_hz=1.0), 1e6).blade.S.tolist()
    [[1e-06, 0.0], [0.0, 0.0]]
    """
    require_positive(stiffness=stiffness)
    if isinstance(what, RotatingRim):
        return replace(what, blade=_sprung(what.blade, [ContactPoint(lean_deg=what.lean_deg)], stiffness))
    own = ([tip for tip in what.tips if tip.blade == b] for b in range(len(what.blades)))
    return replace(what, blades=tuple(_sprung(*part, stiffness) for part in zip(what.blades, own, strict=True)))


def _sprung(blade: ModalBody, tips: list[ContactPoint], stiffness: float) -> ModalBody:
    normals = np.array([tip.directions(blade)[0] for tip in tips]).reshape(-1, len(blade.channels))
    return replace(blade, S=blade.S + normals.T @ normals / stiffness)
