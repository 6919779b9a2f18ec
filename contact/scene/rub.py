"""Scene files of kind "rub": tips of one or more blades at a rotating casing, with the laws of the run."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, FiniteFloat, model_validator

from contact.base.arrays import readonly
from contact.base.errors import InputError
from contact.io.infiles import TextError, read_text
from contact.io.names import hint
from contact.io.plausible import CHECKS
from contact.io.tables import Angle, NotNegative, Number, table_of, value_of
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.body_force import BodyForce
from contact.model.gaps.rub import ContactPoint, Rub, Stiffening
from contact.model.gaps.rub_laws import Closing, RimProfile, Whirl
from contact.model.gaps.rub_system import settled
from contact.model.speed import Speed
from contact.scene.laws import CoatingTable, LawTable, require_one
from contact.scene.parts import Lean, RecordTable, radius_of, read_basis, rub_built
from contact.scene.problems import Problems
from contact.scene.roundness import GapTable
from contact.scene.scheme import (
    Built,
    Gap,
    ModalScheme,
    Name,
    Rpm,
    RunHead,
    ScanTable,
    SceneFile,
    Table,
    Thickness,
    Time,
    TurnsPerSecond,
    hz_of_rpm,
)
from contact.scene.turns import MEANING, Side

Whirling = Annotated[FiniteFloat, replace(CHECKS["frequency"], lower=-CHECKS["frequency"].upper)]
Orders = Annotated[FiniteFloat, Field(ge=-1000, le=1000)]
Along = Annotated[FiniteFloat, replace(CHECKS["gravity"], lower=-CHECKS["gravity"].upper)]


class RubHead(RunHead):
    """[scene] of kind "rub"."""

    kind: Literal["rub"] = Field(description="kind of scene")


class RubCasing(Table):
    """[casing]: modal basis of a rim, and the thickness of its wall [m]; a run is flagged beyond half of it."""

    basis: Name = Field(description="file of a modal basis of kind rim (npz), relative to this file")
    thickness: Thickness | None = Field(
        default=None,
        description="wall thickness [m], half of which limits the rim's deflection; that of the basis if left out",
    )


@table_of(ContactPoint)
class RubNode(Table):
    """[[blade.node]]: channels of one place, its angle from the blade's, its rim line, its own clearance [m].

    The node wears the coating strip number `track` of its rim line. By default the k-th node of a blade on this line
    wears the k-th strip.
    """

    line: int
    axial: str | None
    angle_deg: float
    track: int | None
    span: Name = Field(description="channel of the basis along the span")
    flap: Name = Field(description="channel of the basis along the flap")


class RubBlade(Table):
    """[[blade]]: a modal basis, `count` equal blades evenly around from `angle_deg`, lean, and the contact places.

    Without nodes: the place with channels span and flap, or all of node0, node1, ...; `axial` lets them also slide
    along the axis. The basis of a wheel has the places of all its sectors; nodes name those of one sector.
    """

    basis: Name = Field(description="file of a modal basis of kind point (npz), relative to this file")
    angle_deg: Angle = Field(default=0.0, description="angle of the first blade [degrees]")
    count: Annotated[int, Field(ge=1, le=1000)] = Field(default=1, description="number of equal blades around")
    lean_deg: Lean = Field(
        default=0.0, description="lean of the blade from the radius, positive in the direction of its motion [degrees]"
    )
    axial: bool = Field(default=False, description="whether the contact points slide along the axis too")
    stiffening: bool = Field(
        default=False, description="whether rotation stiffens the blade, by the arrays of its basis"
    )
    node: list[RubNode] = Field(
        default_factory=list,
        description="tables [[blade.node]]: points of contact; all of the basis if left out",
    )

    def nodes(self, body: ModalBody) -> list[RubNode]:
        """The given nodes, or those of the basis; for a wheel those of one sector, repeated in each of its sectors."""
        head = "sector0." if body.sectors else ""
        names = [name.removeprefix(head) for name in body.channels if name.startswith(head)]
        chord = [name.removesuffix(".span") + "." for name in names if name.endswith(".span")] or [""]
        axial = "chord" if self.axial else None
        names_of = ({"span": f"{at}span", "flap": f"{at}flap", "axial": axial and f"{at}{axial}"} for at in chord)
        found = list(map(RubNode.model_validate, names_of))
        own = self.node or found
        return [node for j in range(body.sectors) for node in turned(own, j, body.sectors)] or own

    def require_channels(self, body: ModalBody, nodes: list[RubNode]) -> None:
        """Raise InputError with the name of the basis if it lacks channels of the contact places."""
        if body.kind != "point":
            raise InputError(f"blade.basis: {self.basis}: found a basis of kind {body.kind!r}, expected 'point'")
        named = [name for node in nodes for name in (node.span, node.flap, node.axial) if name is not None]
        missing = next((name for name in named if name not in body.channels), None)
        if missing is None:
            return
        there = ", ".join(body.channels)
        if self.node:
            near = hint(missing, body.channels)
            raise InputError(f"blade.node: found {missing!r}, expected a channel of {self.basis}: {there}{near}")
        expected = f"{', '.join(named)}; or give a [[blade.node]] for each place, with its channels along span and flap"
        raise InputError(f"blade.basis: {self.basis}: found the channels {there}, expected {expected}")


def turned(nodes: list[RubNode], j: int, sectors: int) -> list[RubNode]:
    """The nodes of one sector in sector j of a wheel; the k-th on a rim line wears its k-th strip in every sector."""
    tracks = [sum(other.line == node.line for other in nodes[:k]) for k, node in enumerate(nodes)]
    return [
        node.model_copy(update={
            "span": f"sector{j}.{node.span}", "flap": f"sector{j}.{node.flap}",
            "axial": node.axial and f"sector{j}.{node.axial}", "angle_deg": node.angle_deg + 360.0 * j / sectors,
            "track": track if node.track is None else node.track,
        })
        for node, track in zip(nodes, tracks, strict=True)
    ]  # fmt: skip


class RubContact(GapTable):
    """[contact]: clearance [m], friction, out-of-roundness as harmonics and as a CSV file theta_deg,depth_m."""

    profile: Name | None = Field(
        default=None,
        description="CSV file of the rim's profile with columns theta_deg and depth_m, relative to this file",
    )


class RubSpeed(Table):
    """[speed]: turns per second or per minute, one number, or as many as there are times [s], linear between them.

    `turning` names the side that rotates; `scan` gives the speeds of `casingfem interactions`.
    """

    hz: TurnsPerSecond | list[TurnsPerSecond] = Field(
        description="speed of rotation, or rpm, one number or one for each time [turns/s]"
    )
    rpm: Rpm | list[Rpm] | None = Field(default=None, description="speed of rotation, instead of hz [rpm]")
    time: list[Number] | None = Field(default=None, description="times of the listed speeds [s]")
    turning: Side | None = Field(default=None, description=MEANING)
    scan: ScanTable | None = Field(default=None, description="range of speeds of interactions")

    _hz = model_validator(mode="before")(hz_of_rpm)

    @model_validator(mode="after")
    def _fits(self) -> RubSpeed:
        found = np.shape(self.hz)
        if found != np.shape(self.time if self.time is not None else 0.0):
            many = found[0] if found else "one"
            raise ValueError(f"{many} hz and {len(self.time or [])} time found, expected equal numbers, or one hz")
        return self

    @property
    def side(self) -> Side:
        """The side that rotates."""
        return self.turning or "blades"

    def law(self) -> Speed:
        """The speed over time."""
        if self.time is not None:
            return Speed(readonly(self.time), readonly(self.hz))
        return Speed.constant(float(np.ravel(self.hz)[0]))


class RubClosing(Table):
    """[closing]: reduction of the gap [m], by (1 - exp(-t/time_constant)), or piecewise linear over `time`."""

    by: Gap | list[Gap] = Field(description="reduction of the gap at the end, or at each time [m]")
    time_constant: Time | None = Field(default=None, description="time constant of an exponential reduction [s]")
    time: list[Number] | None = Field(default=None, description="times of the listed reductions [s]")

    @model_validator(mode="after")
    def _one(self) -> RubClosing:
        listed = np.ndim(self.by) > 0
        if listed == (self.time is None) or listed == (self.time_constant is not None):
            raise ValueError("found other keys, expected one number by with time_constant, or lists by and time")
        return self

    def law(self) -> Closing:
        """The closing over time."""
        if self.time is not None:
            return Closing(readonly(self.time), readonly(self.by))
        return Closing.exponential(float(np.ravel(self.by)[0]), self.time_constant or 1.0)


@table_of(Whirl)
class RubWhirl(Table):
    """[[whirl]]: the fields of `Whirl`; `shakes` names the side that moves on this circle, with acceleration r w^2."""

    hz: Whirling = Field(default=0.0, description="additional rate of the motion [turns/s]")
    shakes: Literal["casing", "blades"] | None = Field(
        default=None, description="side that this motion accelerates with its mass; neither if left out"
    )

    def law(self) -> Whirl:
        """The whirl."""
        return value_of(self, Whirl, hz=self.hz)


class RubGravity(Table):
    """[gravity] on all bodies [m/s^2]: towards `down_deg` at t = 0 in the casing's angles, `axial` along its axis.

    With `settled`, bodies start in equilibrium with it and with the whirl that shakes them; else undeformed.
    """

    acceleration: Annotated[NotNegative, CHECKS["gravity"]] = Field(
        default=9.80665, description="acceleration of gravity [m/s^2]"
    )
    down_deg: Angle = Field(
        default=-90.0, description="direction of gravity at t = 0, as an angle of the casing [degrees]"
    )
    axial: Along = Field(default=0.0, description="component along the axis [m/s^2]")
    settled: bool = Field(default=True, description="whether bodies start in equilibrium under gravity")


class RubFile(SceneFile):
    """Blades that rub on a casing in relative rotation, each tip in one or more places, with stick and slip."""

    scene: RubHead = Field(description="kind of the scene and end of the run")
    casing: RubCasing = Field(description="casing, by its rim")
    blade: Annotated[list[RubBlade], Field(min_length=1)] = Field(description="tables [[blade]]: blades")
    contact: RubContact = Field(description="gap between tips and rim")
    coating: CoatingTable | None = Field(default=None, description="abradable coating of the rim")
    law: LawTable | None = Field(default=None, description="compliance of the contacts, instead of a coating")
    speed: RubSpeed = Field(description="speed of rotation")
    closing: RubClosing | None = Field(default=None, description="reduction of the gap over time")
    whirl: list[RubWhirl] = Field(default_factory=list, description="tables [[whirl]]: circular motions of a centre")
    gravity: RubGravity | None = Field(default=None, description="gravity, which acts on all bodies")
    scheme: ModalScheme = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="stored samples")

    @model_validator(mode="after")
    def _one_law(self) -> RubFile:
        require_one(self.law, self.coating)
        return self

    def files(self) -> list[str]:
        """Files that the scene uses, besides its own."""
        names = [self.casing.basis, *(blade.basis for blade in self.blade), self.contact.profile]
        return [name for name in names if name]

    def radius(self, folder: Path) -> float:
        """Radius of the rotating rim [m]; 0 if unknown."""
        return radius_of(folder / self.casing.basis)

    def built(self, folder: Path, problems: Problems) -> Built:
        """The scene that the file describes; raises SceneError."""
        rub = partial(self.rub, folder)
        return rub_built(rub, self.law, self.coating, self.contact.friction, self.scheme, problems)

    def rub(self, folder: Path) -> Rub:
        """The rub; basis and profile files are sought in `folder`. Raises InputError."""
        blades, tips, stiff = blades_of(self.blade, folder)
        casing = read_basis(folder / self.casing.basis)
        rub = Rub(
            casing, tuple(blades), tuple(tips), clearance=self.contact.clearance,
            speed=self.speed.law(), turning=self.speed.side, profile=profile_of(self.contact, folder, casing),
            stiffening=tuple(stiff),
            closing=Closing.none() if self.closing is None else self.closing.law(),
            whirl=tuple(whirl.law() for whirl in self.whirl), forces=self._forces(),
            thickness=math.inf if self.casing.thickness is None else self.casing.thickness,
        )  # fmt: skip
        return settled(rub) if self.gravity is not None and self.gravity.settled else rub

    def _forces(self) -> tuple[BodyForce, ...]:
        turning = self.speed.side
        forces = [
            BodyForce.of_whirl(whirl.law(), whirl.shakes, turning=turning) for whirl in self.whirl if whirl.shakes
        ]
        if self.gravity is not None:
            forces.append(BodyForce.gravity(turning=turning, **self.gravity.model_dump(exclude={"settled"})))
        return tuple(forces)


def blades_of(
    tables: list[RubBlade], folder: Path
) -> tuple[list[ModalBody], list[ContactPoint], list[Stiffening]]:  # fmt: skip
    """Blades, contact places, stiffening by speed; basis files are sought in `folder`. Raises InputError."""
    blades: list[ModalBody] = []
    tips: list[ContactPoint] = []
    stiff: list[Stiffening] = []
    for table in tables:
        body = read_basis(folder / table.basis)
        if body.sectors and table.count > 1:
            raise InputError(f"blade.count: found {table.count} of a wheel, whose basis has {body.sectors} blades")
        nodes = table.nodes(body)
        table.require_channels(body, nodes)
        for k in range(table.count):
            angle = table.angle_deg + 360.0 * k / table.count
            if table.stiffening:
                stiff.append(Stiffening.of(body, len(blades)))
            for node in nodes:
                given = node.model_dump() | {"angle_deg": angle + node.angle_deg}
                tips.append(ContactPoint(blade=len(blades), lean_deg=table.lean_deg, **given))
            blades.append(body)
    return blades, tips, stiff


def profile_of(gap: RubContact, folder: Path, casing: ModalBody) -> RimProfile:
    """Out-of-roundness of a rim: harmonics and a file, which is sought in `folder`. Raises InputError."""
    terms = RimProfile.fourier(gap.terms(casing)).terms
    if gap.profile is None:
        return RimProfile(terms)
    theta, depth = read_profile(folder / gap.profile)
    return RimProfile(terms, theta=readonly(np.radians(theta)), depth=readonly(depth))


def read_profile(path: Path) -> tuple[list[float], list[float]]:
    """Angles [deg] and depths [m] of a CSV file with header theta_deg,depth_m; raises InputError with the line."""
    try:
        lines = read_text(path).splitlines()
    except (OSError, TextError) as error:
        reason = getattr(error, "strerror", error)  # the text of an OSError would repeat the path
        raise InputError(f"profile: {path}: {reason}") from error
    rows = [(n, line.split(",")) for n, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if not rows or [cell.strip() for cell in rows[0][1]] != ["theta_deg", "depth_m"]:
        raise InputError(f"profile: {path}: found no header theta_deg,depth_m")
    theta: list[float] = []
    depth: list[float] = []
    for n, cells in rows[1:]:
        try:
            angle, value = (float(cell) for cell in cells)
        except ValueError as error:
            raise InputError(f"profile: {path}: line {n}: found {','.join(cells)!r}, expected two numbers") from error
        if not (math.isfinite(angle) and math.isfinite(value)):
            raise InputError(f"profile: {path}: line {n}: found {','.join(cells)!r}, expected two finite numbers")
        if theta and angle <= theta[-1]:
            raise InputError(f"profile: {path}: line {n}: found {angle:g} deg after {theta[-1]:g}, expected ascending")
        theta.append(angle)
        depth.append(value)
    if not theta:
        raise InputError(f"profile: {path}: found no line below the header")
    return theta, depth
