"""A rotor with its unbalance and its speed, as a problem to run."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from contact.base.arrays import Array, readonly, require_finite, require_not_negative, require_shape
from contact.base.errors import InputError
from contact.base.keyed import require_keyed
from contact.io.brief import brief
from contact.io.keys import Key
from contact.model.bodies.modal_body import ModalBody
from contact.model.rate import Change, Rate, changes
from contact.model.rotor.jeffcott import Jeffcott
from contact.model.rotor.shaft import Shaft
from contact.model.speed import Speed

PART = 0.1  # of the length: a larger motion of a shaft is outside linear theory
LIMIT = 2.5  # m: of a rotor whose length is not known, `PART` of the longest structure that scenes accept


@dataclass(frozen=True, slots=True, kw_only=True)
class Release:
    """Loss of mass at a given time: the additional unbalance from then on.

    `angle_deg` counts from the x axis of the rotor in the sense of rotation. The model keeps its mass.

    >>> Release(time=0.5, moment=5e-2, angle_deg=90.0).moment
    0.05
    """

    time: Annotated[float, Key("time at which the part leaves [s]", "not negative", "time or 0")]
    moment: Annotated[
        float, Key("added unbalance, mass times its distance from the axis [kg m]", "not negative", "unbalance")
    ]
    angle_deg: Annotated[
        float, Key("direction of the added unbalance, in the rotor from its x axis [degrees]", "turn")
    ] = 0.0

    def __post_init__(self) -> None:
        require_keyed(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class Unbalance:
    """Mass times eccentricity, at an angle in the rotor, and its change by a release.

    The force is U (Omega^2 - i dOmega/dt) e^(i angle(t)) in the plane x + i y, U = moment e^(i angle_deg).

    >>> part = Unbalance(moment=1e-3, release=Release(time=0.5, moment=1e-3, angle_deg=90.0))
    >>> part.after
    (0.001+0.001j)
    """

    moment: Annotated[
        float, Key("unbalance, mass times its distance from the axis [kg m]", "not negative", "unbalance")
    ] = 0.0
    angle_deg: Annotated[
        float, Key("direction of the unbalance in the rotor, from the rotor's x axis [degrees]", "turn")
    ] = 0.0
    release: Release | None = None

    def __post_init__(self) -> None:
        require_keyed(self)

    @property
    def acts(self) -> bool:
        """Whether there is any unbalance, from the start or after the release."""
        return self.before != 0.0 or self.after != 0.0

    def at(self, t: float, h: float) -> complex:
        """U in the step of length h about t [kg m]; a release counts for the part of the step after it."""
        if self.release is None:
            return self.after
        share = min(max((t - self.release.time) / h + 0.5, 0.0), 1.0)
        return self.before + share * (self.after - self.before)

    @property
    def before(self) -> complex:
        """U from the start [kg m]."""
        return cmath.rect(self.moment, math.radians(self.angle_deg))

    @property
    def after(self) -> complex:
        """U after the release [kg m]; that from the start without one."""
        added = self.release
        return self.before + (0.0 if added is None else _exact(added.moment, added.angle_deg))


def _exact(moment: float, angle_deg: float) -> complex:
    """A vector at an angle, exact at multiples of 90 degrees."""
    quarter, rest = divmod(angle_deg, 90.0)
    return 1j ** int(quarter % 4) * cmath.rect(moment, math.radians(rest))


@dataclass(frozen=True, slots=True, kw_only=True)
class Spin:
    """A rotor whose speed follows from its torques: inertia dOmega/dt = torque + torque of the contacts.

    The rotor starts at its speed. The balance includes the energy that unbalance and deformed casing take from it.
    Gyroscopic moments are known from standstill to `most_hz`; a run that goes beyond ends with an error.

    Raises InputError for an inertia or a speed that is not positive.

    >>> Spin(inertia=0.6).torque
    0.0
    """

    inertia: Annotated[float, Key("polar moment of inertia of all rotating parts [kg m^2]", "positive")]
    torque: Annotated[float, Key("torque of the drive, positive from x to y [N m]")] = 0.0
    most_hz: Annotated[
        float | None, Key("speed above which the run stops; 1.2 times the initial speed if left out [turns/s]",
                          "positive")
    ] = None  # fmt: skip

    def __post_init__(self) -> None:
        require_keyed(self)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Rotor:
    """A rotor without contact, in a frame that does not rotate.

    q'' + (C + Omega G) q' + (K + Omega H) q = rows^T f: C, K and G are `damping`, `stiffness` and `gyroscopic` of the
    `body`, beside its modes; `internal` is H (m, m), the effect of damping that rotates with the shaft. Omega > 0 turns
    from x to y. The `unbalance` acts at the channels `at`.x and `at`.y, where the orbit is measured; `gravity` [m/s^2]
    pulls towards -y and needs the body's participation. The rotor starts at rest and straight or, with `settled`, in
    its static deflection at the start speed; `displacement` and `velocity` (m,) of the modes are added.

    A run without a casing ends where a node with channels x and y is farther than `limit` [m] from its straight
    position: linear theory assumes small motions. `Rotor.of` takes a tenth of a shaft's length.

    Raises InputError for unknown channels, shapes that do not fit, and a limit that is not positive.

    >>> rotor = Rotor.of(Jeffcott(mass=10.0, stiffness=4e6, zeta=0.02), hz=80.0, unbalance=Unbalance(moment=1e-3))
    >>> rotor.at, rotor.body.omega.size
    ('disk', 2)
    """

    body: ModalBody
    speed: Speed
    at: str
    unbalance: Unbalance = Unbalance()
    internal: Array | None = None
    gravity: float = 0.0
    settled: bool = True
    displacement: ArrayLike | None = None
    velocity: ArrayLike | None = None
    limit: float = LIMIT

    __repr__ = brief

    def __post_init__(self) -> None:
        m = self.body.omega.size
        for axis in "xy":
            self.body.channel(f"{self.at}.{axis}")
        if self.internal is not None:
            object.__setattr__(self, "internal", readonly(self.internal))
            require_shape("internal", np.asarray(self.internal), (m, m))
        for name in ("displacement", "velocity"):
            given = getattr(self, name)
            values = readonly(np.zeros(m) if given is None else given)
            require_shape(name, values, (m,))
            object.__setattr__(self, name, values)
        require_finite(gravity=self.gravity)
        if not self.limit > 0.0:
            raise InputError(f"limit: found {self.limit!r}, expected a positive length in m, or inf")
        require_not_negative(gravity=self.gravity)
        if self.gravity > 0.0 and self.body.participation is None:
            raise InputError("gravity: found a body without participation factors: reduce it again, or set gravity = 0")

    @staticmethod
    def of(
        what: Jeffcott | Shaft | ModalBody,
        hz: float | Speed,
        *,
        at: float | str | None = None,
        unbalance: Unbalance | None = None,
        modes: int | None = None,
        gravity: float = 0.0,
        settled: bool = True,
        displacement: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        limit: float | None = None,
    ) -> Rotor:
        """Make a rotor from a disk on a massless shaft, a beam shaft, or a body from given matrices.

        `hz`: turns per second, or a `Speed` over time. `at`: position of the unbalance [m] on a shaft, by default its
        first disk; on a body the node, such as "6" for the channels 6.x and 6.y, by default the first. `modes`: number
        of shaft modes, by default all. `limit` [m]: largest motion, by default a tenth of a shaft's length, else 2.5 m.

        >>> from contact.model.rotor import Bearing, Disk, Piece
        >>> shaft = Shaft(pieces=[Piece(length=0.6, diameter=0.03)], disks=[Disk(at=0.3, mass=8.0)],
        ...               bearings=[Bearing(at=0.0, kxx=1e8), Bearing(at=0.6, kxx=1e8)])
        >>> Rotor.of(shaft, 50.0).at
        '3'
        """
        internal: Array | None = None
        if isinstance(what, Jeffcott):
            body, internal, node = what.body(), what.internal(), "disk"
        elif isinstance(what, Shaft):
            place = at if isinstance(at, int | float) else what.disks[0].at if what.disks else 0.0
            (body, internal), node = what.reduced(modes), str(what.node(float(place)))
        else:
            body, node = what, str(at) if at is not None else nodes_of(what)[0]
        if limit is None:
            limit = PART * what.length if isinstance(what, Shaft) else LIMIT
        speed = hz if isinstance(hz, Speed) else Speed.constant(float(hz))
        return Rotor(
            body=body, speed=speed, at=node, unbalance=unbalance or Unbalance(), internal=internal, gravity=gravity,
            settled=settled, displacement=displacement, velocity=velocity, limit=limit,
        )  # fmt: skip

    @property
    def places(self) -> Array:
        """Rows of x and y of all nodes that have both, (nodes, 2, m)."""
        at = [[self.body.channel(f"{node}.{axis}") for axis in "xy"] for node in nodes_of(self.body)]
        return np.asarray(self.body.rows[np.array(at)])

    @property
    def plane(self) -> Array:
        """Rows of x and y where the unbalance acts, (2, m)."""
        return self.body.rows[[self.body.channel(f"{self.at}.{axis}") for axis in "xy"]]

    def matrices(self, omega: float) -> tuple[Array, Array]:
        """C + Omega G [1/s] and K + Omega H [1/s^2] at a speed [rad/s], (m, m) each."""
        C, K = self.body.matrices(omega)
        return C, K if self.internal is None else K + omega * np.asarray(self.internal)

    @property
    def load(self) -> Array:
        """Weight of the modes, (m,)."""
        weight = self.body.participation
        return np.zeros(self.body.omega.size) if weight is None else -self.gravity * weight[1]

    @property
    def sagged(self) -> Array:
        """Modes in static equilibrium under the weight at the start speed, (m,); zero without gravity.

        Raises InputError for a rotor that no bearing supports.
        """
        load = self.load
        if not load.any():
            return np.zeros(load.size)
        try:
            return np.asarray(np.linalg.solve(self.matrices(self.speed.omega(0.0))[1], load))
        except np.linalg.LinAlgError:
            raise InputError("gravity: found a rotor without support, expected a bearing, or gravity = 0") from None

    def rates(self) -> tuple[Rate | Change, ...]:
        """Rates of the speed, of its change, and of the release."""
        fastest = float(np.abs(self.speed.hz).max())
        found: list[Rate | Change] = [Rate(key="speed", hz=fastest, words=f"{fastest:.6g} Hz")] if fastest else []
        if self.speed.time.size > 1:
            _, begins = changes("speed", self.speed.time.tolist(), self.speed.hz.tolist(), "Hz")
            found += begins
        if self.unbalance.release is not None:
            found.append(Change(key="unbalance.release", begins=self.unbalance.release.time))
        return tuple(found)


def nodes_of(body: ModalBody) -> Sequence[str]:
    """Nodes with the channels x and y of a body; raises InputError if there are none.

    >>> nodes_of(Jeffcott(mass=1.0, stiffness=1.0).body())
    ['disk']
    """
    heads = [name.removesuffix(".x") for name in body.channels if name.endswith(".x")]
    found = [head for head in heads if f"{head}.y" in body.channels]
    if not found:
        raise InputError(f"channels: found {', '.join(body.channels)}, expected x and y of a node, such as 6.x and 6.y")
    return found
