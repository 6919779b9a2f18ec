"""A disk on a massless shaft."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from contact.base.arrays import Array
from contact.base.keyed import require_keyed
from contact.io.keys import Key
from contact.model.bodies.modal_body import ModalBody


@dataclass(frozen=True, slots=True, kw_only=True)
class Jeffcott:
    """The Jeffcott rotor: m r'' + c_e r' + c_i (r' - i Omega r) + k r = f, r = x + i y.

    `mass` m, `stiffness` k; c_e = 2 `zeta` sqrt(k m) acts on the motion in space, c_i = 2 `zeta_internal` sqrt(k m) on
    the motion seen from the shaft. On isotropic bearings the motion grows above
    Omega = sqrt(k/m) (1 + zeta/zeta_internal).

    Raises InputError for a mass or a stiffness that is not positive, a negative ratio of damping.

    >>> rotor = Jeffcott(mass=10.0, stiffness=4e6, zeta=0.02)
    >>> rotor.body().channels, round(float(rotor.body().omega[0]), 3)
    (('disk.x', 'disk.y'), 632.456)
    """

    mass: Annotated[float, Key("mass of the disk [kg]", "positive", "mass")]
    stiffness: Annotated[
        float, Key("stiffness of the shaft at the disk, in both directions [N/m]", "positive", "stiffness")
    ]
    zeta: Annotated[float, Key("damping ratio of external, non-rotating damping [-]", "ratio", "zeta")] = 0.0
    zeta_internal: Annotated[float, Key("damping ratio of internal, rotating damping [-]", "ratio", "zeta")] = 0.0

    def __post_init__(self) -> None:
        require_keyed(self)

    @property
    def omega(self) -> float:
        """The critical speed sqrt(k/m) [rad/s]."""
        return math.sqrt(self.stiffness / self.mass)

    def body(self) -> ModalBody:
        """Two modes with the channels disk.x and disk.y."""
        pair = np.ones(2)
        return ModalBody(
            omega=self.omega * pair, zeta=(self.zeta + self.zeta_internal) * pair, channels=("disk.x", "disk.y"),
            rows=np.eye(2) / math.sqrt(self.mass), S=np.zeros((2, 2)),
            participation=math.sqrt(self.mass) * np.eye(3, 2),
        )  # fmt: skip

    def internal(self) -> Array | None:
        """Stiffness per unit speed due to internal damping, (2, 2) [1/s]; None without it."""
        if self.zeta_internal == 0.0:
            return None
        return 2.0 * self.zeta_internal * self.omega * np.array([[0.0, 1.0], [-1.0, 0.0]])
