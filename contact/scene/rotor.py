"""Scene files of kind "rotor": a rotor under its unbalance, without contact."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, FiniteFloat, model_validator

from contact.base.arrays import readonly
from contact.base.errors import InputError
from contact.io.plausible import CHECKS
from contact.io.tables import NotNegative, Number, table_of, value_of
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.rub_laws import Speed
from contact.model.law import Unilateral
from contact.model.rotor.jeffcott import Jeffcott
from contact.model.rotor.rotor import Release, Rotor, Unbalance
from contact.model.rotor.shaft import Bearing, Disk, Piece, Shaft
from contact.resolved import MOST_STEPS
from contact.scene.parts import RecordTable, read_basis
from contact.scene.problems import Problems
from contact.scene.scheme import (
    Built,
    Count,
    Mass,
    Name,
    RunHead,
    SceneFile,
    Stiffness,
    Table,
    Time,
    TurnsPerSecond,
)
from contact.scheme.modal.exact_modal import ExactModal

MOST_RPM = 600_000.0  # the smallest turbochargers turn half as fast
Rpm = Annotated[FiniteFloat, Field(ge=-MOST_RPM, le=MOST_RPM)]
MODES = 24  # of a shaft that are kept where nothing is said


class RotorHead(RunHead):
    """[scene] of kind "rotor"."""

    kind: Literal["rotor"] = Field(description="which kind of scene this is")


@table_of(Jeffcott, "zeta", "zeta_internal")
class RotorTable(Table):
    """[rotor]: a disk on a massless shaft by its mass and stiffness, or a modal basis; with [[shaft]] only `modes`."""

    mass: Mass | None = Field(default=None, description="of the disk [kg]")
    stiffness: Stiffness | None = Field(default=None, description="of the shaft at the disk, both directions [N/m]")
    basis: Name | None = Field(default=None, description="modal basis of the rotor at rest, npz, relative to this file")
    node: Name | None = Field(
        default=None,
        description="node of the basis with the unbalance; the first with channels x and y if left out",
    )
    modes: Annotated[int, Field(ge=1, le=400)] | None = Field(
        default=None, description=f"modes of a [[shaft]] that are kept; {MODES}, or all if they are fewer, if left out"
    )

    @property
    def given(self) -> list[str]:
        """Its keys that stand in the file."""
        return [name for name in type(self).model_fields if name in self.model_fields_set]


@table_of(Piece)
class ShaftTable(Table):
    """[[shaft]]: a piece of the shaft; pieces follow each other along the axis."""


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
    """[unbalance] of the rotor: mass times eccentricity, where, and what a release adds."""

    at: NotNegative | None = Field(
        default=None, description="its place on a [[shaft]], from the first end; that of the first disk if left out [m]"
    )
    release: ReleaseTable | None = Field(default=None, description="a part leaves; none if left out")

    def value(self) -> Unbalance:
        """The unbalance over time."""
        return value_of(self, Unbalance, release=None if self.release is None else value_of(self.release, Release))


class RotorSpeed(Table):
    """[speed]: hz or rpm, one number, or as many as there are times [s], straight between them."""

    hz: TurnsPerSecond | list[TurnsPerSecond] | None = Field(
        default=None, description="speed, one number or one for each time [turns/s]"
    )
    rpm: Rpm | list[Rpm] | None = Field(default=None, description="the same in turns a minute, instead of hz [rpm]")
    time: list[Number] | None = Field(default=None, description="instants of a list of speeds [s]")

    @model_validator(mode="after")
    def _fits(self) -> RotorSpeed:
        if (self.hz is None) == (self.rpm is None):
            raise ValueError(f"{'neither hz nor rpm' if self.hz is None else 'hz and rpm both'} found, expected one")
        name = "hz" if self.rpm is None else "rpm"
        speeds, times = (
            np.shape(np.asarray(self.hz if self.rpm is None else self.rpm)),
            np.shape(0.0 if self.time is None else self.time),
        )
        if speeds != times:
            many = speeds[0] if speeds else "one"
            raise ValueError(f"{many} {name} and {len(self.time or [])} time found, expected as many or one {name}")
        return self

    @property
    def turns(self) -> list[float]:
        """Turns per second."""
        given = np.ravel(np.asarray(self.hz if self.rpm is None else self.rpm, dtype=float))
        return [float(one) for one in (given if self.rpm is None else given / 60.0)]

    def law(self) -> Speed:
        """The speed over time."""
        if self.time is not None:
            return Speed(readonly(self.time), readonly(self.turns))
        return Speed.constant(self.turns[0])


class RotorGravity(Table):
    """[gravity] of a rotor: its weight along -y; it starts at rest under it where it is `settled`."""

    acceleration: Annotated[NotNegative, CHECKS["gravity"]] = Field(default=9.80665, description="gravity [m/s^2]")
    settled: bool = Field(default=True, description="whether the rotor starts at rest under it")


class RotorScheme(Table):
    """[scheme] of a rotor: exact-modal."""

    kind: Literal["exact-modal"] = Field(description="the method")
    dt: Time = Field(description="time step [s]")
    most_steps: Count = Field(default=MOST_STEPS, description="a run of more steps is refused")


class RotorFile(SceneFile):
    """A rotor under its unbalance, without contact."""

    scene: RotorHead = Field(description="what this scene is")
    rotor: RotorTable = Field(
        default_factory=RotorTable, description="a disk on a massless shaft or a modal basis; left out with [[shaft]]"
    )
    shaft: list[ShaftTable] = Field(default_factory=list, description="tables [[shaft]]: pieces of a beam shaft")
    disk: list[RotorDiskTable] = Field(default_factory=list, description="tables [[disk]]: rigid disks on the shaft")
    bearing: list[BearingTable] = Field(default_factory=list, description="tables [[bearing]]: what supports the shaft")
    unbalance: UnbalanceTable = Field(default_factory=UnbalanceTable, description="the unbalance; none if left out")
    speed: RotorSpeed = Field(description="how fast it turns")
    gravity: RotorGravity | None = Field(default=None, description="the weight; none if left out")
    scheme: RotorScheme = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="what is stored")

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
        if others := [name for name in self.rotor.given if name not in allowed]:
            raise ValueError(f"rotor.{others[0]} found beside {kinds[0]}, expected only {', '.join(sorted(allowed))}")
        if not self.shaft and (self.disk or self.bearing or self.unbalance.at is not None):
            found = "[[disk]]" if self.disk else "[[bearing]]" if self.bearing else "unbalance.at"
            raise ValueError(f"{found} found without [[shaft]], expected pieces of a shaft beside it")
        return self

    def files(self) -> list[str]:
        """Files the scene is made of, beside its own."""
        return [] if self.rotor.basis is None else [self.rotor.basis]

    def built(self, folder: Path, problems: Problems) -> Built:
        """What the file describes; raises SceneError."""
        with problems.at("speed"):
            speed = self.speed.law()
        problems.check()
        with problems.at():
            rotor = self.model(folder, speed)
        problems.check()
        return rotor, Unilateral(), ExactModal()

    def model(self, folder: Path, speed: Speed) -> Rotor:
        """The rotor; a basis file is found in `folder`. Raises InputError."""
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
        return Rotor.of(what, speed, at=at, unbalance=unbalance, modes=modes, gravity=gravity, settled=settled)

    def _shaft(self) -> Shaft:
        return Shaft(
            pieces=[value_of(piece, Piece) for piece in self.shaft],
            disks=[value_of(disk, Disk) for disk in self.disk],
            bearings=[value_of(bearing, Bearing) for bearing in self.bearing],
            places=() if self.unbalance.at is None else (self.unbalance.at,),
        )
