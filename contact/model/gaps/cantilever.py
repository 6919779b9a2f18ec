"""A clamped beam whose tip may meet a stop: modes in closed form, and the compliance of those left out.

E I w,xxxx + rho A w,tt = p,  w = w,x = 0 at the clamp; cos(b) cosh(b) = -1, omega = b^2/L^2 sqrt(E I/(rho A)),
X = cosh(b x/L) - cos(b x/L) - s (sinh(b x/L) - sin(b x/L)) (Blevins, Formulas for Natural Frequency and Mode Shape,
1979, table 8-1).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, require_not_negative, require_positive
from contact.base.errors import InputError
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.gap import PointGap, Side


@dataclass(frozen=True, slots=True, kw_only=True)
class Cantilever:
    """Uniform beam clamped at one end, bending along `height`; lengths [m], E [Pa], rho [kg/m^3], `zeta` of all modes.

    Raises InputError for values that are not physical.

    >>> beam = Cantilever(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0)
    >>> (beam.modes(3).omega / (2 * np.pi)).round(2).tolist()
    [16.76, 105.06, 294.16]
    """

    length: float
    width: float
    height: float
    E: float
    rho: float
    zeta: float = 0.0

    def __post_init__(self) -> None:
        require_positive(length=self.length, width=self.width, height=self.height, E=self.E, rho=self.rho)
        require_not_negative(zeta=self.zeta)

    @property
    def line_mass(self) -> float:
        """Mass per length [kg/m]."""
        return self.rho * self.width * self.height

    @property
    def EI(self) -> float:
        """Bending stiffness [N m^2]."""
        return self.E * self.width * self.height**3 / 12.0

    def modes(self, count: int = 20) -> ModalBody:
        """First modes with the channels "tip" (its displacement) and "uniform" (integral of w, moved by a line load).

        S is what the modes left out give under static loads: L^3/(3 E I) and so on, less the kept modes.
        """
        if not 1 <= count <= 200:
            raise InputError(f"modes: found {count!r}, expected a whole number from 1 to 200")
        b, s = roots(count)
        L = self.length
        omega = (b / L) ** 2 * math.sqrt(self.EI / self.line_mass)
        rows = np.stack([2.0 * (-1.0) ** np.arange(count), 2.0 * L * s / b]) / math.sqrt(self.line_mass * L)
        static = np.array([[L**3 / 3.0, L**4 / 8.0], [L**4 / 8.0, L**5 / 20.0]]) / self.EI
        return ModalBody(
            omega=omega, zeta=np.full(count, self.zeta), channels=("tip", "uniform"), rows=rows,
            S=static - (rows / omega**2) @ rows.T,
        )  # fmt: skip

    def before_stop(self, *, clearance: float, load: float = 0.0, velocity: float = 0.0, modes: int = 20) -> PointGap:
        """The tip `clearance` [m] from a rigid stop; line `load` [N/m] and `velocity` [m/s] of all points towards it.

        At rest it is a propped cantilever: the stop bears 3 load L/8 - 3 E I clearance/L^3 where that is positive.

        >>> beam = Cantilever(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0)
        >>> beam.before_stop(clearance=1e-3, load=10.0).sides[0].sign
        -1
        """
        body = self.modes(modes)
        uniform = body.rows[1]
        side = Side(
            body=body, channel="tip", sign=-1, load=load * uniform, velocity=velocity * self.line_mass * uniform
        )
        return PointGap(sides=(side,), clearance=max(clearance - float(body.S[0, 1]) * load, 0.0))


def roots(count: int) -> tuple[Array, Array]:
    """Roots of cos b = -1/cosh b and the shape factors s = (sinh b - sin b)/(cosh b + cos b), (count,) each."""
    b: Array = (np.arange(count, dtype=np.float64) + 0.5) * math.pi
    for _ in range(30):
        small = 1.0 / np.cosh(b)
        b -= (np.cos(b) + small) / (-np.sin(b) - small * np.tanh(b))
    fade = np.exp(-b)  # free of overflow
    return b, np.asarray((1.0 - fade**2 - 2.0 * fade * np.sin(b)) / (1.0 + fade**2 + 2.0 * fade * np.cos(b)))
