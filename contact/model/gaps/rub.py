"""A rub: tips of one or more blades against one casing in relative rotation, each a contact that may stick."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass, field
from typing import Annotated, Any, Literal

import numpy as np

from contact.base.arrays import Array, is_whole, keep_readonly, require_count, require_finite, require_shape
from contact.base.errors import InputError
from contact.io.brief import brief
from contact.io.keys import Key
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.body_force import BodyForce
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.limits import FAR, require_near
from contact.model.gaps.rub_laws import Closing, RimProfile, Whirl
from contact.model.gaps.turning import casing_turns
from contact.model.rate import Change, Rate, changes
from contact.model.rotor.rotor import Rotor, Spin
from contact.model.speed import Speed


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactPoint:
    """One possible contact: a place on blade number `blade` before rim line number `line` of the casing.

    `span`, `flap` and `axial` name channels of the blade: radial without lean, along +theta, along the casing's axis
    (if left out, the contact slides along theta only). `angle_deg` is its angle at t = 0 in the casing's frame,
    `lean_deg` as in `RotatingRim`, `clearance` [m] added to that of the rub. `track` is the number of the coating strip
    that it wears on its rim line; tips at the same axial place share a strip. The default is its number among its
    blade's tips on that line.

    >>> ContactPoint(angle_deg=90.0).span
    'span'
    """

    blade: int = 0
    line: Annotated[int, Key("number of the rim's line that the point touches, from 0", least=0)] = 0
    span: str = "span"
    flap: str = "flap"
    axial: Annotated[str | None, Key("channel along the axis, for sliding in this direction")] = None
    angle_deg: Annotated[float, Key("angle relative to that of the blade [degrees]", "turn")] = 0.0
    lean_deg: float = 0.0
    clearance: Annotated[float, Key("clearance of this point, added to that of the contact [m]", check="clearance")] = (
        0.0
    )
    track: Annotated[int | None, Key("number of the strip of coating that the point wears, from 0", least=0)] = None

    def __post_init__(self) -> None:
        if self.track is not None:
            require_count(0, track=self.track)
        require_finite(angle_deg=self.angle_deg, clearance=self.clearance)
        if not -90.0 < self.lean_deg < 90.0:
            raise InputError(f"lean_deg: found {self.lean_deg!r}, expected an angle between -90 and 90")

    def directions(self, blade: ModalBody) -> Array:
        """Normal, tangential (and axial) directions over the channels of its blade, (2 or 3, channels)."""
        a = math.radians(self.lean_deg)
        weights = np.zeros((2 if self.axial is None else 3, len(blade.channels)))
        span, flap = blade.channel(self.span), blade.channel(self.flap)
        weights[0, [span, flap]] = math.cos(a), math.sin(a)
        weights[1, [span, flap]] = -math.sin(a), math.cos(a)
        if self.axial is not None:
            weights[2, blade.channel(self.axial)] = 1.0
        return weights


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Start:
    """Motion at t = 0 and constant loads of one body, modal (m,) each; zero if left out.

    >>> Start(velocity=np.array([0.1])).velocity.tolist(), Start().displacement
    ([0.1], None)
    """

    displacement: Array | None = None
    velocity: Array | None = None
    load: Array | None = None


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Stiffening:
    """Change of one blade's modal stiffness with speed: K(Omega) = diag(omega^2) + (Omega^2 - at^2) stiffness_by_speed.

    `stiffness_by_speed` (m, m) symmetric [-], such as Phi^T (K_G - M_spin) Phi per unit Omega^2; `at_hz` is the speed
    at which the blade's basis was computed. The mode shapes of the basis are kept, and are coupled through
    stiffness_by_speed.

    >>> import numpy as np
    >>> part = Stiffening(blade=0, stiffness_by_speed=np.array([[1.7]]), at_hz=0.0)
    >>> part.stiffness_by_speed.tolist(), part.at_hz
    ([[1.7]], 0.0)
    """

    blade: int = 0
    stiffness_by_speed: Array = field(default_factory=lambda: np.zeros((0, 0)))
    at_hz: float = 0.0

    def __post_init__(self) -> None:
        keep_readonly(self, "stiffness_by_speed")
        require_finite(at_hz=self.at_hz)

    @staticmethod
    def of(body: ModalBody, blade: int = 0) -> Stiffening:
        """The stiffening of a rotating body's own basis.

        Raises InputError if the basis was computed at rest, without an axis.
        """
        if body.stiffness_by_speed is None:
            raise InputError(
                f"blades[{blade}]: found a basis without stiffness_by_speed, expected one of a rotating shell"
            )
        return Stiffening(blade=blade, stiffness_by_speed=body.stiffness_by_speed, at_hz=body.spin / (2.0 * math.pi))


@dataclass(frozen=True, eq=False, slots=True)
class Rub:
    """K tips and one casing in relative rotation: tip j is at phi_j = its angle - angle(t) in the casing.

    g_j = clearance + clearance_j + d(phi_j) - closing(t) + whirl + u_r(phi_j) - n_j.u_blade, the laws of `rub_laws`;
    slip R Omega + v_theta - t_j.v_blade around, v_z - v_blade,z along the axis. All contacts are solved together, with
    the residual compliances that couple them. `thickness` of the wall [m], that of the casing's basis where it is left
    out, limits the deflection in the linear model: a run stops at half of it, or gets a flag. `forces`: gravity and
    whirl on the kept modes, without the static response of the others. `turning`: the side that rotates. Its bodies are
    described in their own frame, with the gyroscopic matrix and the stiffness by speed of their bases at that speed;
    blades rotate opposite to the angle of the tips in the casing. `stiffening` gives rotating blades another stiffness.
    `rotor`: the rotor of the blades, whose modes are the last ones of `casing`; `rotor_rub` makes such a rub. With
    `spin` one more mode follows: sqrt(inertia) times the angle by which the rotor leads constant rotation at its speed
    at t = 0.

    Raises InputError for bases of the wrong kind, channels that are missing, tips that differ in their directions,
    blades at rest with a stiffening, or a clearance, closing, whirl or profile beyond a tenth of the radius.

    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5)
    >>> seen = {"channels": ("span", "flap"), "rows": [[0.0], [1.0]], "S": np.zeros((2, 2))}
    >>> blade = ct.ModalBody(omega=[900.0], zeta=[0.01], **seen)
    >>> tips = tuple(ct.ContactPoint(angle_deg=angle) for angle in (0.0, 180.0))
    >>> ct.Rub(casing, (blade,), tips, clearance=1e-3, speed=ct.Speed.constant(5.0)).names
    ('casing', 'blade')
    """

    casing: ModalBody
    blades: tuple[ModalBody, ...]
    tips: tuple[ContactPoint, ...] = (ContactPoint(),)
    _: KW_ONLY
    clearance: float = 0.0
    speed: Speed = field(default_factory=lambda: Speed.constant(0.0))
    profile: RimProfile = field(default_factory=RimProfile)
    closing: Closing = field(default_factory=Closing.none)
    whirl: tuple[Whirl, ...] = ()
    stiffening: tuple[Stiffening, ...] = ()
    casing_start: Start = field(default_factory=Start)
    blade_starts: tuple[Start, ...] = ()
    thickness: float = math.inf
    forces: tuple[BodyForce, ...] = ()
    turning: Literal["casing", "blades"] = "blades"
    rotor: Rotor | None = None
    spin: Spin | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        if self.casing.kind != "rim":
            raise InputError(f"casing: found a basis of kind {self.casing.kind!r}, expected 'rim'")
        for name in ("blades", "tips", "whirl", "stiffening", "blade_starts", "forces"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        if not self.blades or not self.tips:
            raise InputError(f"tips: found {len(self.tips)} on {len(self.blades)} blades, expected one or more")
        if not self.blade_starts:
            object.__setattr__(self, "blade_starts", (Start(),) * len(self.blades))
        if len(self.blade_starts) != len(self.blades):
            raise InputError(f"blade_starts: found {len(self.blade_starts)}, expected one for each blade or none")
        for b, blade in enumerate(self.blades):
            if blade.kind != "point":
                raise InputError(f"blades[{b}]: found a basis of kind {blade.kind!r}, expected 'point'")
        for j, tip in enumerate(self.tips):
            self._require_tip(j, tip)
        for body, start, name in zip(self.bodies, self.starts, self.names, strict=True):
            _require_start(name, body, start)
        for stiff in self.stiffening:
            if not _counts(stiff.blade, len(self.blades)):
                raise InputError(f"stiffening: found blade {stiff.blade}, expected 0 .. {len(self.blades) - 1}")
            m = self.blades[stiff.blade].omega.size
            require_shape("stiffness_by_speed", stiff.stiffness_by_speed, (m, m))
        turns = casing_turns(self.turning)
        if turns and self.stiffening:
            raise InputError(
                "blade.stiffening: found stiffening by the speed with turning = 'casing', where the blades are at "
                "rest, expected turning = 'blades' or no stiffening"
            )
        if self.rotor is not None and (turns or self.flexible < 0):
            found = f"turning = {self.turning!r} and a casing of {self.casing.omega.size} modes"
            raise InputError(f"rotor: found {found}, expected a rub from ct.rotor.rotor_rub with turning blades")
        for one in self.forces:
            if one.casing_turns != turns:
                found = f"a force with turning = '{'casing' if one.casing_turns else 'blades'}'"
                raise InputError(f"forces: found {found}, expected turning = {self.turning!r} as in the rub")
        for force in self.forces:
            self._require_participation(force)
        radius = min(self.casing.line_radius(tip.line) for tip in self.tips)
        require_near(radius, closing=float(self.closing.by[np.abs(self.closing.by).argmax()]))
        require_near(radius, whirl=sum(whirl.amplitude for whirl in self.whirl), out_of_roundness=self.profile.farthest)
        if not self.thickness > 0.0:
            raise InputError(f"thickness: found {self.thickness!r}, expected metres > 0")
        if math.isfinite(self.thickness):
            require_near(radius, thickness=self.thickness)

    def _require_participation(self, force: BodyForce) -> None:
        for k, (name, body) in enumerate(zip(self.names, self.bodies, strict=True)):
            if body.participation is None and (force.on == "both" or (force.on == "casing") == (k == 0)):
                found = "a basis without participation factors, which gravity and whirl need"
                raise InputError(f"{name}: found {found}, expected a basis from casingfem reduce")

    def _require_tip(self, j: int, tip: ContactPoint) -> None:
        if not _counts(tip.blade, len(self.blades)):
            raise InputError(f"tips[{j}].blade: found {tip.blade}, expected 0 .. {len(self.blades) - 1}")
        if not _counts(tip.line, self.casing.rim_lines):
            raise InputError(f"tips[{j}].line: found {tip.line}, expected 0 .. {self.casing.rim_lines - 1}")
        try:
            tip.directions(self.blades[tip.blade])
        except InputError as error:
            raise InputError(f"tips[{j}]: {error}") from error
        if (tip.axial is None) != (self.tips[0].axial is None):
            found = f"{tip.axial!r} beside {self.tips[0].axial!r}"
            raise InputError(f"tips[{j}].axial: found {found}, expected an axial channel for all tips or none")
        if tip.axial is not None and self.casing.directions < 3:
            raise InputError(f"tips[{j}].axial: found a casing basis without axial channels, expected Rim(axial=True)")
        radius, total = self.casing.line_radius(tip.line), self.clearance + tip.clearance
        if not (radius > 0.0 and abs(total) <= FAR * radius):
            found = f"{total:g} m at tip {j} on a radius of {radius:g} m"
            raise InputError(f"clearance: found {found}, expected at most a tenth of the radius")

    def rates(self) -> tuple[Rate | Change, ...]:
        """Rates of whirl, gravity and the points of a measured profile as they pass.

        Ramps of speed and the closing gap.
        """
        omega, found = self.speed.fastest, list[Rate | Change]()
        turning = [(f"whirl[{k}]", one.per_rev, one.hz) for k, one in enumerate(self.whirl, 1)]
        turning += [(f"a force on {one.on}", one.per_rev, one.hz) for one in self.forces]
        for key, per_rev, hz in turning:
            rate = abs(per_rev) * omega / (2.0 * math.pi) + abs(hz)
            found += [Rate(key=key, hz=rate, words=f"{rate:.6g} Hz")] if rate > 0.0 else []
        if self.profile.theta is not None and omega > 0.0:
            least = float(np.diff(self.profile.theta).min()) / omega
            found.append(Rate.of_passage("the time between two points of the profile", least, f"{least:.3g} s"))
        if self.rotor is not None:
            found += self.rotor.rates()
        for key, table, values, unit in (
            ("speed", self.speed.time, self.speed.hz, "Hz"), ("closing", self.closing.time, self.closing.by, "m"),
        ):  # fmt: skip
            rates, begins = changes(key, table.tolist(), values.tolist(), unit)
            found += [*rates, *begins]
        return tuple(found)

    @property
    def flexible(self) -> int:
        """Number of modes of `casing` that are the casing's own; those of a rotor follow."""
        others = 0 if self.rotor is None else self.rotor.body.omega.size + (0 if self.spin is None else 1)
        return int(self.casing.omega.size) - others

    def turned(self, time: Array, q: Array) -> Array:
        """Angles turned at times (ns,), with spin from the casing's modal coordinates (ns, m), (ns,) [rad]."""
        angle = self.speed.angles(time)
        return angle if self.spin is None else angle - q[:, -1] / math.sqrt(self.spin.inertia)

    @property
    def wall(self) -> float:
        """Thickness of the wall [m]: as given, else the casing's least on the tips' lines; infinite if unknown."""
        if math.isfinite(self.thickness):
            return self.thickness
        return min(self.casing.line_wall(tip.line) or math.inf for tip in self.tips)

    @property
    def repeats(self) -> int:
        """How many times in a turn the gaps of undeflected bodies repeat, from the rim's shape and tips that are alike.

        >>> import contact as ct
        >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5)
        >>> disk = ct.gaps.BladedDisk(blades=9, freq_hz=115.0, modal_mass=0.1, compliance=5e-5)
        >>> shape = ct.gaps.RimProfile(((2, 1e-5, 0.0),))
        >>> rub = ct.Rub(casing, (disk.body(),), disk.tips(), profile=shape, speed=ct.Speed.constant(5.0))
        >>> rub.repeats
        18
        """
        loads = any(start.load is not None for start in self.starts)
        if self.rotor is not None or self.whirl or self.forces or loads:
            return 1
        angles = np.sort([tip.angle_deg % 360.0 for tip in self.tips])
        apart = np.diff(angles, append=angles[0] + 360.0)
        alike = len({(tip.line, tip.lean_deg, tip.clearance) for tip in self.tips}) == 1
        tips = angles.size if alike and np.ptp(apart) < 1e-6 else 1
        return math.lcm(tips, self.profile.repeats or 1)

    @property
    def dimensions(self) -> int:
        """Directions of every contact: 2, or 3 with axial friction."""
        return 2 if self.tips[0].axial is None else 3

    def blade_normal(self) -> tuple[str, Array]:
        """Name of the first blade that touches, and the row of its motion along the contact normal, (m,)."""
        tip = self.tips[0]
        body = self.blades[tip.blade]
        return self.names[1 + tip.blade], np.asarray(tip.directions(body)[0] @ body.rows)

    @property
    def bodies(self) -> tuple[ModalBody, ...]:
        """Casing, then blades."""
        return (self.casing, *self.blades)

    @property
    def starts(self) -> tuple[Start, ...]:
        """Motion at t = 0 and loads of the bodies."""
        return (self.casing_start, *self.blade_starts)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies: casing and blade, or blade 1, blade 2, ..."""
        if len(self.blades) == 1:
            return ("casing", "blade")
        return ("casing", *(f"blade {b + 1}" for b in range(len(self.blades))))


def _counts(number: object, count: int) -> bool:
    """Whether a value is an index from 0 to below a count."""
    return is_whole(number) and number in range(count)


def _require_start(name: str, body: ModalBody, start: Start) -> None:
    for what in ("displacement", "velocity", "load"):
        values = getattr(start, what)
        if values is not None:
            require_shape(f"{name}.{what}", np.asarray(values, dtype=float), (body.omega.size,))


def rub_of(what: object) -> Any:
    """The problem as a rub; a rotating rim is a rub with one tip; None for other problems.

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
    if isinstance(what, RotatingRim):
        return _of_rim(what)
    return what if isinstance(what, Rub) else None


def _of_rim(rim: RotatingRim) -> Rub:
    return Rub(
        rim.casing, (rim.blade,), (ContactPoint(angle_deg=rim.angle_deg, lean_deg=rim.lean_deg),),
        clearance=rim.clearance, speed=Speed.constant(rim.speed_hz), profile=RimProfile.fourier(rim.out_of_roundness),
        turning=rim.turning,
        casing_start=Start(displacement=rim.casing_displacement, velocity=rim.casing_velocity),
        blade_starts=(Start(displacement=rim.blade_displacement, velocity=rim.blade_velocity),),
    )  # fmt: skip
