"""A rotating rim is a rub with one tip: the same scene in the words of the other."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.rub import ContactPoint, Rub, Start
from contact.model.gaps.rub_laws import RimProfile, Speed


@singledispatch
def rub_of(what: object) -> Any:
    """The rub that a problem is, a rotating rim one with one tip; None of other problems.

    >>> import numpy as np
    >>> import contact as ct
    >>> casing = ct.ModalBody(
    ...     omega=[700.0], zeta=[0.0], channels=("radial.cos0", "tangential.cos0"), rows=[[1.0], [0.0]],
    ...     S=np.zeros((2, 2)), kind="rim", n_max=0, radius=0.45,
    ... )
    >>> blade = ct.ModalBody(
    ...     omega=[900.0], zeta=[0.0], channels=("span", "flap"), rows=[[0.0], [1.0]], S=np.zeros((2, 2))
    ... )
    >>> rub_of(ct.RotatingRim(casing, blade, clearance=1e-4, speed_hz=5.0, lean_deg=10.0)).tips[0].lean_deg
    10.0
    """
    return None


@rub_of.register
def _(rub: Rub) -> Rub:
    return rub


@rub_of.register
def _(rim: RotatingRim) -> Rub:
    return Rub(
        rim.casing, (rim.blade,), (ContactPoint(angle_deg=rim.angle_deg, lean_deg=rim.lean_deg),),
        clearance=rim.clearance, speed=Speed.constant(rim.speed_hz), profile=RimProfile.fourier(rim.out_of_roundness),
        casing_start=Start(velocity=rim.casing_velocity), blade_starts=(Start(velocity=rim.blade_velocity),),
    )  # fmt: skip
