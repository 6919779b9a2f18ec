"""Scene files of kind "patch": a modal body on points of rigid ground, with stick and slip."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, FiniteFloat, model_validator

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.plausible import CHECKS
from contact.io.tables import NotNegative, Number
from contact.model.bodies.modal_body import ModalBody
from contact.model.bodies.patch import Patch
from contact.scene.laws import LawTable, contact_law
from contact.scene.parts import RecordTable, read_basis
from contact.scene.problems import Problems
from contact.scene.scheme import (
    Built,
    Coordinate,
    Force,
    Friction,
    Name,
    Ratio,
    RunHead,
    SceneFile,
    Table,
    Time,
    Unit,
    Velocity,
)
from contact.scheme.events.event_driven import EventDriven
from contact.scheme.modal.exact_modal import ExactModal
from contact.scheme.protocol import Scheme

OMEGA = replace(CHECKS["frequency"], unit="rad/s", upper=2.0 * np.pi * CHECKS["frequency"].upper)
Seen = Annotated[FiniteFloat, Field(ge=-1e6, le=1e6)]  # of a mode of 1e-12 kg, the least that [checks] knows


class PatchHead(RunHead):
    """[scene] of kind "patch"."""

    kind: Literal["patch"] = Field(description="kind of scene")


class PatchBodyTable(Table):
    """[body]: a modal basis file, or its modes here; modal displacement and velocity at t = 0; load [N] by channel."""

    basis: Name | None = Field(default=None, description="file of a modal basis (npz), relative to this file")
    omega: Annotated[list[Annotated[NotNegative, OMEGA]], Field(min_length=1)] | None = Field(
        default=None, description="angular frequencies of the modes [rad/s], instead of a basis"
    )
    zeta: list[Ratio] | None = Field(default=None, description="damping ratios of the modes [-]")
    channels: Annotated[list[Name], Field(min_length=1)] | None = Field(
        default=None, description="names of the displacements at the interface"
    )
    rows: list[list[Seen]] | None = Field(
        default=None, description="displacement of each channel in each mode [kg^(-1/2)]"
    )
    S: list[list[Number]] | None = Field(default=None, description="residual compliance of the channels [m/N]")
    displacement: list[Number] | None = Field(default=None, description="modal coordinates at t = 0 [m kg^(1/2)]")
    velocity: list[Number] | None = Field(default=None, description="modal velocities at t = 0 [m kg^(1/2)/s]")
    load: dict[str, Force] = Field(default_factory=dict, description="constant forces [N], by channel")

    @model_validator(mode="after")
    def _whole(self) -> PatchBodyTable:
        given = [name for name in ("omega", "zeta", "channels", "rows", "S") if getattr(self, name) is not None]
        own = {"omega", "channels", "rows"} <= set(given)
        if (self.basis is None) != own or (self.basis is not None and given):
            found = ", ".join([*(["basis"] if self.basis else []), *given]) or "nothing"
            raise ValueError(f"{found} found, expected a basis, or omega, channels and rows (with zeta, S)")
        return self

    def modes(self, folder: Path) -> ModalBody:
        """The basis file, or the modes given in the table, by default undamped and with S = 0."""
        if self.basis is not None:
            return read_basis(folder / self.basis)
        omega, channels = np.array(self.omega), tuple(self.channels or ())
        zeta = np.zeros(omega.size) if self.zeta is None else np.array(self.zeta)
        S = np.zeros((len(channels), len(channels))) if self.S is None else _matrix("S", self.S)
        return ModalBody(omega=omega, zeta=zeta, channels=channels, rows=_matrix("rows", self.rows or []), S=S)

    def modal_load(self, body: ModalBody) -> Array:
        """Modal forces of the load, (m,)."""
        load = np.zeros(body.omega.size)
        for channel, force in self.load.items():
            load += force * body.rows[body.channel(channel)]
        return load

    def pressed(self, body: ModalBody, channels: list[str]) -> Array:
        """Static displacement of the channels by the load through the residual compliance, (channels,) [m]."""
        at = [body.channel(name) for name in channels]
        return np.asarray(sum((f * body.S[at, body.channel(c)] for c, f in self.load.items()), np.zeros(len(at))))


class PatchContact(Table):
    """[[contact]]: channels along normal and tangents, clearance [m], velocity of the ground along the tangents."""

    normal: Name = Field(description="channel along the normal")
    tangent: Annotated[list[Name], Field(max_length=2)] = Field(
        default_factory=list, description="channels along the tangents, at most two"
    )
    clearance: Coordinate = Field(default=0.0, description="gap at rest [m]")
    slide: list[Velocity] = Field(default_factory=list, description="velocity of the ground along the tangents [m/s]")

    @model_validator(mode="after")
    def _fits(self) -> PatchContact:
        if len(self.slide) not in (0, len(self.tangent)):
            raise ValueError(f"{len(self.slide)} slide found, expected {len(self.tangent)}, one for each tangent")
        return self


class GroundTable(Table):
    """[ground]: the friction coefficient."""

    friction: Friction = Field(default=0.0, description="coefficient of Coulomb friction [-]")


class PatchScheme(Table):
    """[scheme] of a patch: exact-modal, or event-driven with a coefficient of restitution."""

    kind: Literal["exact-modal", "event-driven"] = Field(description="method of time integration")
    dt: Time = Field(description="time step; of event-driven, the interval of the samples [s]")
    restitution: Unit = Field(
        default=0.0, description="coefficient of restitution of rigid contacts, for event-driven [-]"
    )

    @model_validator(mode="after")
    def _fits(self) -> PatchScheme:
        if self.restitution and self.kind != "event-driven":
            raise ValueError(f"restitution found with kind = {self.kind!r}, expected none")
        return self

    def method(self) -> Scheme:
        """The scheme."""
        return EventDriven(restitution=self.restitution) if self.kind == "event-driven" else ExactModal()


class PatchFile(SceneFile):
    """A modal body on points of rigid ground, with stick and slip."""

    scene: PatchHead = Field(description="kind of the scene and end of the run")
    body: PatchBodyTable = Field(description="elastic body")
    contact: Annotated[list[PatchContact], Field(min_length=1)] = Field(
        description="tables [[contact]]: points of contact"
    )
    ground: GroundTable = Field(default_factory=GroundTable, description="rigid ground")
    law: LawTable | None = Field(default=None, description="compliance of the contacts; rigid if left out")
    scheme: PatchScheme = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="stored samples")

    @model_validator(mode="after")
    def _alike(self) -> PatchFile:
        if len({len(contact.tangent) for contact in self.contact}) > 1:
            raise ValueError("contacts with different numbers of tangents found, expected 0, 1 or 2 in all")
        if self.ground.friction and not self.contact[0].tangent:
            raise ValueError("ground.friction found without tangents, expected one or two in each contact")
        return self

    def files(self) -> list[str]:
        """Files that the scene uses, besides its own."""
        return [] if self.body.basis is None else [self.body.basis]

    def built(self, folder: Path, problems: Problems) -> Built:
        """The scene that the file describes; raises SceneError."""
        with problems.at("body"):
            patch = self.patch(folder)
        problems.check()
        return patch, contact_law(self.ground.friction, self.law), self.scheme.method()

    def patch(self, folder: Path) -> Patch:
        """The patch; a basis file is sought in `folder`. Raises InputError."""
        body, contacts, width = self.body.modes(folder), self.contact, len(self.contact[0].tangent)
        return Patch(
            body=body, normal=tuple(contact.normal for contact in contacts),
            tangent=tuple(tuple(contact.tangent) for contact in contacts) if width else (),
            clearance=[contact.clearance for contact in contacts],
            slide=[contact.slide or [0.0] * width for contact in contacts] if width else 0.0,
            displacement=self.body.displacement, velocity=self.body.velocity,
            load=self.body.modal_load(body),
            pressed=self.body.pressed(body, [contact.normal for contact in contacts]),
        )  # fmt: skip


def _matrix(name: str, rows: list[list[float]]) -> Array:
    if len({len(row) for row in rows}) > 1:
        raise InputError(f"{name}: found rows of different lengths, expected a matrix")
    return np.array(rows)
