"""Scene files of kind "rotor": a rotor under its unbalance, alone or with blades that rub on a casing."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from contact.base.arrays import readonly
from contact.base.errors import InputError
from contact.io.plausible import CHECKS
from contact.io.tables import Angle, Length, NotNegative, Number, table_of, value_of
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.rub import ContactPoint, Rub, Stiffening
from contact.model.law import Unilateral
from contact.model.rotor.jeffcott import Jeffcott
from contact.model.rotor.rotor import Release, Rotor, Spin, Unbalance
from contact.model.rotor.rotor_rub import rigid_casing, rigid_tip, rotor_rub
from contact.model.rotor.shaft import Bearing, Disk, Piece, Shaft
from contact.model.speed import Speed
from contact.resolved import MOST_STEPS
from contact.scene.laws import CoatingTable, LawTable, require_one
from contact.scene.parts import RecordTable, read_basis, rub_built
from contact.scene.problems import Problems
from contact.scene.rub import RubBlade, RubContact, blades_of, profile_of
from contact.scene.scheme import (
    Built,
    Count,
    Mass,
    ModalScheme,
    Name,
    Ratio,
    Rpm,
    RunHead,
    ScanTable,
    SceneFile,
    Stiffness,
    Table,
    Thickness,
    Time,
    TurnsPerSecond,
)
from contact.scheme.modal.exact_modal import ExactModal

MODES = 24  # of a shaft that are kept where nothing is stated


class RotorHead(RunHead):
    """[scene] of kind "rotor"."""

    kind: Literal["rotor"] = Field(description="kind of scene")


@table_of(Jeffcott, "zeta", "zeta_internal")
class RotorTable(Table):
    """[rotor]: a disk on a massless shaft by mass and stiffness, or a modal basis; with [[shaft]] only `modes`."""

    mass: Mass | None = Field(default=None, description="mass of the disk [kg]")
    stiffness: Stiffness | None = Field(
        default=None, description="stiffness of the shaft at the disk, in both directions [N/m]"
    )
    basis: Name | None = Field(
        default=None, description="file of a modal basis of the rotor at rest (npz), relative to this file"
    )
    node: Name | None = Field(
        default=None,
        description="node of the basis at which the unbalance acts; the first with channels x and y if left out",
    )
    modes: Annotated[int, Field(ge=1, le=400)] | None = Field(
        default=None, description=f"modes of a [[shaft]] that are kept; {MODES}, or all if they are fewer, if left out"
    )

    limit: Length | None = Field(
        default=None,
        description="motion without a casing above which the run stops [m]; if left out, a tenth of the length of a"
        " [[shaft]], 2.5 m for other rotors",
    )

    @property
    def given(self) -> list[str]:
        """The keys that are in the file."""
        return [name for name in type(self).model_fields if name in self.model_fields_set]


@table_of(Piece)
class ShaftTable(Table):
    """[[shaft]]: a piece of the shaft; pieces follow one another along the axis."""


@table_of(Disk)
class RotorDiskTable(Table):
    """[[disk]]: a rigid disk on the shaft."""


@table_of(Bearing)
class BearingTable(Table):
    """[[bearing]]: a bearing between shaft and ground, with cross-coupling."""


@table_of(Release)
class ReleaseTable(Table):
    """unbalance.release: a part leaves the rotor, such as a blade; its unbalance is added from then on."""


@table_of(Unbalance)
class UnbalanceTable(Table):
    """[unbalance] of the rotor: mass times eccentricity, angle, and its change by a release."""

    at: NotNegative | None = Field(
        default=None, description="position on a [[shaft]] from its first end; that of the first disk if left out [m]"
    )
    release: ReleaseTable | None = Field(default=None, description="loss of a part during the run; none if left out")

    def value(self) -> Unbalance:
        """The unbalance over time."""
        return value_of(self, Unbalance, release=None if self.release is None else value_of(self.release, Release))


class RotorSpeed(Table):
    """[speed]: hz or rpm, one number, or as many as there are times [s], linear between them."""

    hz: TurnsPerSecond | list[TurnsPerSecond] | None = Field(
        default=None, description="speed of rotation, one number or one for each time [turns/s]"
    )
    rpm: Rpm | list[Rpm] | None = Field(default=None, description="speed of rotation, instead of hz [rpm]")
    time: list[Number] | None = Field(default=None, description="times of the listed speeds [s]")
    scan: ScanTable | None = Field(
        default=None,
        description="range of speeds of stability and interactions; up to twice the highest speed if left out",
    )

    @model_validator(mode="after")
    def _fits(self) -> RotorSpeed:
        if (self.hz is None) == (self.rpm is None):
            raise ValueError(
                f"{'neither hz nor rpm' if self.hz is None else 'hz and rpm both'} found, expected one of them"
            )
        name = "hz" if self.rpm is None else "rpm"
        speeds, times = (
            np.shape(np.asarray(self.hz if self.rpm is None else self.rpm)),
            np.shape(0.0 if self.time is None else self.time),
        )
        if speeds != times:
            many = speeds[0] if speeds else "one"
            raise ValueError(
                f"{many} {name} and {len(self.time or [])} time found, expected equal numbers, or one {name}"
            )
        return self

    @property
    def turns(self) -> list[float]:
        """Speed in turns per second."""
        given = np.ravel(np.asarray(self.hz if self.rpm is None else self.rpm, dtype=float))
        return [float(one) for one in (given if self.rpm is None else given / 60.0)]

    def law(self) -> Speed:
        """The speed over time."""
        if self.time is not None:
            return Speed(readonly(self.time), readonly(self.turns))
        return Speed.constant(self.turns[0])


class RotorCasing(Table):
    """[casing] around the rotor: a modal basis, or a rigid ring on mounts by `radius`, `mass` and `stiffness`."""

    basis: Name | None = Field(
        default=None, description="file of a modal basis of kind rim (npz), relative to this file"
    )
    radius: Length | None = Field(default=None, description="radius of a rigid ring [m]")
    mass: Mass | None = Field(default=None, description="mass of a rigid ring [kg]")
    stiffness: Stiffness | None = Field(default=None, description="stiffness of the mounts, in both directions [N/m]")
    zeta: Ratio = Field(default=0.0, description="damping ratio of a rigid ring on its mounts [-]")
    thickness: Thickness | None = Field(
        default=None,
        description="wall thickness [m], half of which limits the rim's deflection; that of the basis if left out",
    )

    @model_validator(mode="after")
    def _one(self) -> RotorCasing:
        ring = [name for name in ("radius", "mass", "stiffness") if getattr(self, name) is not None]
        if (self.basis is None) == (not ring) or 0 < len(ring) < 3:
            found = " and ".join(([] if self.basis is None else ["basis"]) + ring) or "none"
            raise ValueError(f"{found} found, expected basis, or radius, mass and stiffness of a rigid ring")
        return self

    def body(self, folder: Path) -> ModalBody:
        """The casing; a basis file is sought in `folder`. Raises InputError."""
        if self.basis is not None:
            return read_basis(folder / self.basis)
        return rigid_casing(
            radius=self.radius or 0.0, mass=self.mass or 0.0, stiffness=self.stiffness or 0.0, zeta=self.zeta
        )


class RotorTips(Table):
    """[tips]: blades that do not deform, in place of [[blade]] tables."""

    count: Annotated[int, Field(ge=1, le=1000)] = Field(description="number of equal blades around")
    angle_deg: Angle = Field(default=0.0, description="angle of the first blade at t = 0 [degrees]")


class RotorContact(RubContact):
    """[contact] of a rotor: that of a rub, and the blades that are lost."""

    lost: list[Annotated[int, Field(ge=0)]] = Field(
        default_factory=list, description="numbers of blades without contact, from 0, such as the one that leaves"
    )


@table_of(Spin)
class SpinTable(Table):
    """[spin]: the speed follows from friction and the drive; if left out, it is that of [speed]."""


class RotorGravity(Table):
    """[gravity] of a rotor: its weight along -y; with `settled` it starts in static equilibrium."""

    acceleration: Annotated[NotNegative, CHECKS["gravity"]] = Field(
        default=9.80665, description="acceleration of gravity [m/s^2]"
    )
    settled: bool = Field(default=True, description="whether the rotor starts in equilibrium under gravity")


class RotorScheme(Table):
    """[scheme] of a rotor: exact-modal."""

    kind: Literal["exact-modal"] = Field(description="method of time integration")
    dt: Time = Field(description="time step [s]")
    most_steps: Count = Field(default=MOST_STEPS, description="largest number of steps of a run")


class RotorFile(SceneFile):
    """A rotor under its unbalance; with [casing] and [contact] its blades may rub."""

    scene: RotorHead = Field(description="kind of the scene and end of the run")
    rotor: RotorTable = Field(
        default_factory=RotorTable,
        description="disk on a massless shaft, or modal basis of the rotor; not needed with [[shaft]]",
    )
    shaft: list[ShaftTable] = Field(default_factory=list, description="tables [[shaft]]: pieces of a beam shaft")
    disk: list[RotorDiskTable] = Field(default_factory=list, description="tables [[disk]]: rigid disks on the shaft")
    bearing: list[BearingTable] = Field(default_factory=list, description="tables [[bearing]]: bearings of the shaft")
    unbalance: UnbalanceTable = Field(default_factory=UnbalanceTable, description="unbalance; none if left out")
    speed: RotorSpeed = Field(description="speed of rotation")
    gravity: RotorGravity | None = Field(default=None, description="gravity; none if left out")
    casing: RotorCasing | None = Field(default=None, description="casing around the rotor; no contact if left out")
    tips: RotorTips | None = Field(default=None, description="rigid blades")
    blade: list[RubBlade] = Field(default_factory=list, description="tables [[blade]]: blades by their modal bases")
    contact: RotorContact | None = Field(default=None, description="gap between tips and casing")
    coating: CoatingTable | None = Field(default=None, description="abradable coating of the rim")
    law: LawTable | None = Field(default=None, description="compliance of the contacts, instead of a coating")
    spin: SpinTable | None = Field(default=None, description="inertia and drive torque of a rotor whose speed changes")
    scheme: RotorScheme = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="stored samples")

    @model_validator(mode="after")
    def _one_rotor(self) -> RotorFile:
        jeffcott = self.rotor.mass is not None or self.rotor.stiffness is not None
        kinds = [
            name
            for name, found in (
                ("rotor.mass and rotor.stiffness", jeffcott), ("rotor.basis", self.rotor.basis is not None),
                ("[[shaft]]", bool(self.shaft)),
            ) if found
        ]  # fmt: skip
        if len(kinds) != 1:
            expected = "one of rotor.mass with rotor.stiffness, rotor.basis, [[shaft]]"
            raise ValueError(f"{' and '.join(kinds) or 'no rotor'} found, expected {expected}")
        if jeffcott and (self.rotor.mass is None or self.rotor.stiffness is None):
            lacks = "rotor.mass" if self.rotor.mass is None else "rotor.stiffness"
            raise ValueError(f"{lacks}: missing, expected mass and stiffness together")
        allowed = {"[[shaft]]": {"modes"}, "rotor.basis": {"basis", "node"}}.get(
            kinds[0], {"mass", "stiffness", "zeta", "zeta_internal"}
        )
        if others := [name for name in self.rotor.given if name not in allowed | {"limit"}]:
            raise ValueError(f"rotor.{others[0]} found with {kinds[0]}, expected only {', '.join(sorted(allowed))}")
        if self.rotor.limit is not None and self.casing is not None:
            raise ValueError(
                "rotor.limit found with [casing], expected none: the radius of the casing limits the motion"
            )
        if not self.shaft and (self.disk or self.bearing or self.unbalance.at is not None):
            found = "[[disk]]" if self.disk else "[[bearing]]" if self.bearing else "unbalance.at"
            raise ValueError(f"{found} found without [[shaft]], expected both")
        return self

    @model_validator(mode="after")
    def _whole_contact(self) -> RotorFile:
        require_one(self.law, self.coating)
        around = {
            "[casing]": self.casing is not None, "[contact]": self.contact is not None,
            "[tips] or [[blade]]": self.tips is not None or bool(self.blade),
        }  # fmt: skip
        if any(around.values()) and not all(around.values()):
            found, missing = ([name for name, there in around.items() if there == which] for which in (True, False))
            raise ValueError(f"{', '.join(found)} found without {', '.join(missing)}, expected all of them or none")
        if self.tips is not None and self.blade:
            raise ValueError("[tips] found with [[blade]], expected one of them")
        alone = [name for name in ("coating", "law", "spin") if getattr(self, name) is not None]
        if alone and self.casing is None:
            raise ValueError(f"[{alone[0]}] found without [casing], expected both")
        if any(table.axial for table in self.blade):
            raise ValueError(
                "blade.axial = true found on a rotor, expected false: the disk does not move along the axis"
            )
        return self

    def files(self) -> list[str]:
        """Files that the scene uses, besides its own."""
        names = [self.rotor.basis, None if self.casing is None else self.casing.basis]
        names += [table.basis for table in self.blade]
        names += [None if self.contact is None else self.contact.profile]
        return [name for name in names if name]

    def built(self, folder: Path, problems: Problems) -> Built:
        """The scene that the file describes; raises SceneError."""
        with problems.at("speed"):
            speed = self.speed.law()
        problems.check()
        with problems.at():
            rotor = self.model(folder, speed)
        problems.check()
        if self.contact is None:
            return rotor, Unilateral(), ExactModal()
        rub = partial(self.rub, folder, rotor)
        scheme = ModalScheme(kind="exact-modal", dt=self.scheme.dt)
        return rub_built(rub, self.law, self.coating, self.contact.friction, scheme, problems)

    def rub(self, folder: Path, rotor: Rotor) -> Rub:
        """The rotor in its casing; files are sought in `folder`. Raises InputError."""
        assert self.casing is not None
        assert self.contact is not None
        casing, stiff = self.casing.body(folder), list[Stiffening]()
        if self.tips is not None:
            n, first = self.tips.count, self.tips.angle_deg
            blades = [rigid_tip()] * n
            tips = [ContactPoint(blade=j, angle_deg=first + 360.0 * j / n) for j in range(n)]
        else:
            blades, tips, stiff = blades_of(self.blade, folder)
        if gone := [j for j in self.contact.lost if j >= len(blades)]:
            raise InputError(f"contact.lost: found blade {gone[0]}, expected 0 to {len(blades) - 1}")
        kept = [tip for tip in tips if tip.blade not in self.contact.lost]
        if not kept:
            raise InputError(f"contact.lost: found all {len(blades)} blades, expected one or more left")
        return rotor_rub(
            rotor, casing, blades, kept, clearance=self.contact.clearance, stiffening=stiff,
            profile=profile_of(self.contact, folder, casing),
            thickness=math.inf if self.casing.thickness is None else self.casing.thickness,
            spin=None if self.spin is None else value_of(self.spin, Spin),
        )  # fmt: skip

    def model(self, folder: Path, speed: Speed) -> Rotor:
        """The rotor; a basis file is sought in `folder`. Raises InputError."""
        unbalance, weight = self.unbalance.value(), self.gravity
        gravity, settled = (0.0, True) if weight is None else (weight.acceleration, weight.settled)
        what: Jeffcott | Shaft | ModalBody
        at: float | str | None = None
        modes: int | None = None
        if self.rotor.basis is not None:
            what, at = read_basis(folder / self.rotor.basis), self.rotor.node
        elif self.shaft:
            what, at = self._shaft(), self.unbalance.at
            unknowns = 4 * what.nodes.size
            modes = min(MODES, unknowns) if self.rotor.modes is None else self.rotor.modes
            if modes > unknowns:
                raise InputError(f"rotor.modes: found {modes}, expected 1 to {unknowns}, the modes of the shaft")
        else:
            what = Jeffcott(**self.rotor.model_dump(include={"mass", "stiffness", "zeta", "zeta_internal"}))
        return Rotor.of(
            what, speed, at=at, unbalance=unbalance, modes=modes, gravity=gravity, settled=settled,
            limit=self.rotor.limit,
        )  # fmt: skip

    def _shaft(self) -> Shaft:
        return Shaft(
            pieces=[value_of(piece, Piece) for piece in self.shaft],
            disks=[value_of(disk, Disk) for disk in self.disk],
            bearings=[value_of(bearing, Bearing) for bearing in self.bearing],
            places=() if self.unbalance.at is None else (self.unbalance.at,),
        )
