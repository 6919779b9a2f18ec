"""Modes of rods and clamped beams in closed form, with the exact compliance of the omitted modes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import singledispatch
from typing import Annotated

import numpy as np

from contact.base.arrays import Array, require_not_negative, require_positive
from contact.base.errors import InputError
from contact.base.keyed import require_keyed
from contact.io.keys import Key
from contact.model.bodies.body import Body, PointMass, Rod
from contact.model.bodies.chain import Chain
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.gap import PointGap, Side


def rod_modes(rod: Rod, *, modes: int = 50, zeta: float = 0.0, end: str | None = None) -> ModalBody:
    """Modes of a continuous rod with its contact end as channel (`end`, or the free end of a fixed rod).

    Free: phi = cos(beta xi), tan beta = -alpha beta, plus the rigid mode; fixed: phi = sin(beta xi),
    cot beta = alpha beta; alpha = end_mass/(rho A L), omega = beta c/L, xi measured from the far end.
    S = static compliance (free: L/(3 E A (1 + alpha)^2) with inertia relief; fixed: L/(E A)) minus
    sum phi(1)^2/omega^2 of the elastic modes kept. `modes` counts the rigid mode.

    >>> rod_modes(Rod(length=10.0, area=1.0, E=900.0, rho=1.0), modes=50, end="left").channels
    ('left',)
    """
    require_positive(modes=modes)
    require_not_negative(zeta=zeta)
    free = rod.fixed == "none"
    name = end or rod.contact_end(has_left=True, has_right=True)
    alpha = rod.end_mass / rod.mass
    beta = _roots(alpha, modes, free=free)
    tip = np.cos(beta) if free else np.sin(beta)
    far = np.ones(modes) if free else np.zeros(modes)
    ripple = np.sinc(2.0 * beta / math.pi) / 2.0  # of the mean of cos^2 or sin^2 over the length
    norm = np.sqrt(rod.mass * ((0.5 + ripple if free else 0.5 - ripple) + alpha * tip**2))
    omega = beta * rod.wave_speed / rod.length
    compliance = rod.length / (rod.E * rod.area)
    static = compliance / (3.0 * (1.0 + alpha) ** 2) if free else compliance
    elastic = omega > 0.0
    S = static - float(np.sum((tip[elastic] / norm[elastic] / omega[elastic]) ** 2))
    return ModalBody(
        omega=omega, zeta=np.full(modes, zeta), channels=(name,), rows=(tip / norm)[None],
        S=np.array([[max(S, 0.0)]]), recovery=(far / norm)[None],
    )  # fmt: skip


def _roots(alpha: float, count: int, *, free: bool) -> Array:
    """First roots of the frequency equation, by bisection on branches that contain one root each."""
    k = np.arange(count, dtype=np.float64)
    if alpha == 0.0:
        return k * math.pi if free else (k + 0.5) * math.pi
    low, high = ((k - 0.5) * math.pi, k * math.pi) if free else (k * math.pi, (k + 0.5) * math.pi)

    def value(beta: Array) -> Array:
        if free:
            return np.asarray(np.sin(beta) + alpha * beta * np.cos(beta))
        return np.asarray(np.cos(beta) - alpha * beta * np.sin(beta))

    sign = np.sign(value(high))
    for _ in range(100):
        middle = 0.5 * (low + high)
        above = np.sign(value(middle)) == sign
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    roots = 0.5 * (low + high)
    if free:
        roots[0] = 0.0
    return roots


def chain_gap(chain: Chain, *, modes: int) -> PointGap:
    """Two bodies of a chain (or one and a wall) as modal bodies at their contact.

    Raises InputError if the chain has more than one contact.
    """
    if len(chain.bodies) != 2:
        raise InputError(f"bodies: found {len(chain.bodies)}, expected two for the exact-modal scheme")
    low, high = chain.bodies
    pairs = ((low, "right", -1), (high, "left", 1))
    sides = tuple(
        side(body, face, sign, modes=modes, gravity=chain.gravity) for body, face, sign in pairs if body.moves
    )
    return PointGap(sides=sides, clearance=high.x - low.end)


@singledispatch
def side(body: Body, face: str, sign: int, *, modes: int, gravity: float) -> Side:
    """One body of a chain as a side of the contact at its `face`; a class of your own registers its function."""
    name = type(body).__name__
    raise InputError(f"bodies: found {name} without modes, expected a rod or a mass for the exact-modal scheme")


def _require_undamped(damping: float) -> None:
    if damping:
        raise InputError("damping: found viscous damping of a body, expected none for ExactModal")


@side.register
def _(body: PointMass, face: str, sign: int, *, modes: int, gravity: float) -> Side:
    _require_undamped(body.damping)
    root = math.sqrt(body.mass)
    if body.force:
        raise InputError("force: found a varying force, expected a constant force for ExactModal")
    point = ModalBody(
        omega=np.array([math.sqrt(body.stiffness) / root]), zeta=np.zeros(1), channels=(face,),
        rows=np.array([[1.0 / root]]), S=np.zeros((1, 1)),
    )  # fmt: skip
    return Side(
        body=point, channel=face, sign=sign, velocity=np.array([root * body.velocity]),
        load=np.array([-root * gravity - body.stiffness * body.stretch / root]), name="mass", mass=body.mass,
        potential=body.mass * gravity * body.x + 0.5 * body.stiffness * body.stretch**2,
    )  # fmt: skip


@side.register
def _(body: Rod, face: str, sign: int, *, modes: int, gravity: float) -> Side:
    _require_undamped(body.damping)
    if body.fixed == face:
        raise InputError(f"fixed: found {face!r} on the rod's contact end, expected the other end or 'none'")
    basis = rod_modes(body, modes=modes, end=face)
    momentum = _momentum(body, basis)
    tip = body.x if face == "left" else body.end
    return Side(
        body=basis, channel=face, sign=sign, velocity=body.velocity * momentum, load=-gravity * momentum,
        name="rod", mass=body.mass + body.end_mass,
        potential=gravity * (body.mass * (body.x + 0.5 * body.length) + body.end_mass * tip),
    )  # fmt: skip


def _momentum(rod: Rod, basis: ModalBody) -> Array:
    """Modal amplitudes of a uniform unit velocity: integral of phi dm."""
    beta = basis.omega * rod.length / rod.wave_speed
    if rod.fixed == "none":
        rigid = np.zeros(beta.size)
        rigid[0] = math.sqrt(rod.mass + rod.end_mass)
        return rigid
    scale = basis.rows[0] / np.sin(beta)
    return np.asarray(scale * (rod.mass * (1.0 - np.cos(beta)) / beta) + rod.end_mass * basis.rows[0])


@dataclass(frozen=True, slots=True, kw_only=True)
class Cantilever:
    """Uniform beam clamped at one end, bending along `height`; lengths [m], E [Pa], rho [kg/m^3], `zeta` of all modes.

    E I w,xxxx + rho A w,tt = p,  w = w,x = 0 at the clamp; cos(b) cosh(b) = -1, omega = b^2/L^2 sqrt(E I/(rho A)),
    X = cosh(b x/L) - cos(b x/L) - s (sinh(b x/L) - sin(b x/L)) (Blevins, Formulas for Natural Frequency and Mode Shape,
    1979, table 8-1).
    Raises InputError for values that are not physical.

    >>> beam = Cantilever(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0)
    >>> (beam.modes(3).omega / (2 * np.pi)).round(2).tolist()
    [16.76, 105.06, 294.16]
    """

    length: Annotated[float, Key("length [m]", "positive", "size")]
    width: Annotated[float, Key("width of the section [m]", "positive", "thickness")]
    height: Annotated[float, Key("height of the section in the plane of motion [m]", "positive", "thickness")]
    E: Annotated[float, Key("Young's modulus [Pa]", "positive", "E")]
    rho: Annotated[float, Key("density [kg/m^3]", "positive", "rho")]
    zeta: Annotated[float, Key("damping ratio of all modes [-]", "ratio", "zeta")] = 0.0

    def __post_init__(self) -> None:
        require_keyed(self)

    @property
    def line_mass(self) -> float:
        """Mass per length [kg/m]."""
        return self.rho * self.width * self.height

    @property
    def EI(self) -> float:
        """Bending stiffness [N m^2]."""
        return self.E * self.width * self.height**3 / 12.0

    def modes(self, count: int = 20) -> ModalBody:
        """First modes with the channels "tip" (its displacement) and "uniform" (integral of w, driven by a line load).

        S is the static compliance of the omitted modes: L^3/(3 E I) and so on, minus that of the kept modes.
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
        """The beam with its tip `clearance` [m] from a rigid stop.

        `load` [N/m] is a uniform line load, `velocity` [m/s] the initial velocity of all points; both towards the stop.

        At rest it is a propped cantilever: the reaction of the stop is 3 load L/8 - 3 E I clearance/L^3 if that is
        positive.

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
