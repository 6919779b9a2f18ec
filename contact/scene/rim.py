"""Scene files of kinds "rim" (a rotating casing rim against one blade) and "disk" (against a disk of blades)."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, FiniteFloat, model_validator

from contact.base.arrays import readonly
from contact.io.plausible import FROM_ZERO
from contact.io.tables import Angle, NotNegative, table_of, value_of
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.bladed_disk import BladedDisk, pair_rim
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import ModalPair
from contact.model.gaps.rub import Rub, Start
from contact.model.gaps.rub_laws import RimProfile
from contact.model.speed import Speed
from contact.scene.laws import CoatingTable, LawTable, contact_law, require_one
from contact.scene.pair import CasingPairTable
from contact.scene.parts import Lean, RecordTable, radius_of, read_basis, rub_built
from contact.scene.problems import Problems
from contact.scene.roundness import GapTable, Whole
from contact.scene.scheme import (
    Built,
    Detuning,
    Frequency,
    ModalScheme,
    Name,
    RunHead,
    SceneFile,
    Size,
    SpeedTable,
    Table,
    Thickness,
    Velocity,
)
from contact.scheme.modal.exact_modal import ExactModal

Soft = Annotated[NotNegative, FROM_ZERO["compliance"]]
Coupling = Annotated[FiniteFloat, Field(ge=0, le=100)]


class RimHead(RunHead):
    """[scene] of kind "rim"."""

    kind: Literal["rim"] = Field(description="kind of scene")


class CasingTable(Table):
    """[casing]: modal basis file of kind "rim", relative to the scene file; `scatter` detunes its modes at random."""

    basis: Name = Field(description="file of a modal basis of kind rim (npz), relative to this file")
    scatter: Annotated[FiniteFloat, Field(ge=0, le=0.2)] = Field(
        default=0.0, description="standard deviation of a random relative detuning of the modes [-]"
    )
    seed: Whole = Field(default=0, description="seed of this detuning")

    def body(self, folder: Path) -> ModalBody:
        """The rim, detuned."""
        body = read_basis(folder / self.basis)
        return body.detuned(self.scatter, seed=self.seed) if self.scatter > 0.0 else body


class BladeTable(Table):
    """[blade]: modal basis file of kind "point" with channels span and flap; lean in degrees; `freq_hz` retunes it."""

    basis: Name = Field(
        description="file of a modal basis of kind point (npz) with channels span and flap, relative to this file"
    )
    freq_hz: Frequency | None = Field(
        default=None, description="first frequency to which the blade is tuned [Hz]; that of the basis if left out"
    )
    lean_deg: Lean = Field(
        default=0.0, description="lean of the blade from the radius, positive in the direction of its motion [degrees]"
    )

    def body(self, folder: Path) -> ModalBody:
        """The blade, retuned."""
        body = read_basis(folder / self.basis)
        return body if self.freq_hz is None else body.retuned(self.freq_hz)


class RimContact(GapTable):
    """[contact] of a rim: clearance [m], friction coefficient, out-of-roundness."""

    angle_deg: Angle = Field(default=0.0, description="angle of the blade [degrees]")


class RimFile(SceneFile):
    """A rotating casing rim against one fixed blade."""

    scene: RimHead = Field(description="kind of the scene and end of the run")
    casing: CasingTable = Field(description="casing, by its rim")
    blade: BladeTable = Field(description="blade")
    contact: RimContact = Field(description="gap between tips and rim")
    coating: CoatingTable | None = Field(default=None, description="abradable coating of the rim")
    law: LawTable | None = Field(default=None, description="compliance of the contacts, instead of a coating")
    speed: SpeedTable = Field(description="speed of rotation, and rotating side")
    scheme: ModalScheme = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="stored samples")

    @model_validator(mode="after")
    def _one_law(self) -> RimFile:
        require_one(self.law, self.coating)
        return self

    def files(self) -> list[str]:
        """Files that the scene uses, besides its own."""
        return [self.casing.basis, self.blade.basis]

    def radius(self, folder: Path) -> float:
        """Radius of the rotating rim [m]; 0 if unknown."""
        return radius_of(folder / self.casing.basis)

    def built(self, folder: Path, problems: Problems) -> Built:
        """The scene that the file describes; raises SceneError."""
        with problems.at("casing.basis"):
            casing = self.casing.body(folder)
        with problems.at("blade.basis"):
            blade = self.blade.body(folder)
        problems.check()
        contact = self.contact
        with problems.at():
            rim = RotatingRim(
                casing, blade, clearance=contact.clearance, speed_hz=self.speed.hz, lean_deg=self.blade.lean_deg,
                out_of_roundness=contact.terms(casing), angle_deg=contact.angle_deg,
                turning=self.speed.turning or "blades",
            )  # fmt: skip
        with problems.at("coating"):
            law = contact_law(contact.friction, self.law, self.coating)
        problems.check()
        return rim, law, ExactModal(law=self.scheme.law)


class DiskHead(RunHead):
    """[scene] of kind "disk"."""

    kind: Literal["disk"] = Field(description="kind of scene")


class DiskPairTable(CasingPairTable):
    """[casing.pair]: a casing reduced to its pair of n diameters; `kick`: modal velocity of its cosine at t = 0."""

    radius: Size = Field(description="radius of the rim [m]")
    thickness: Thickness | None = Field(
        default=None, description="wall thickness [m]; the run stops where the rim deflects by more than half of it"
    )
    kick: Velocity = Field(default=0.0, description="modal velocity of the cosine mode at t = 0 [m kg^(1/2)/s]")


class DiskCasingTable(Table):
    """[casing]: a modal basis file of kind "rim", or a pair."""

    basis: Name | None = Field(
        default=None, description="file of a modal basis of kind rim (npz), relative to this file"
    )
    pair: DiskPairTable | None = Field(default=None, description="one pair of casing modes, instead of a basis")

    @model_validator(mode="after")
    def _one_of_both(self) -> DiskCasingTable:
        if (self.basis is None) == (self.pair is None):
            raise ValueError(
                f"{'nothing' if self.basis is None else 'basis and pair'} found, expected one of basis and pair"
            )
        return self

    def radius(self, folder: Path) -> float:
        """Radius of the rim [m]; 0 if unknown."""
        return radius_of(folder / str(self.basis)) if self.pair is None else self.pair.radius

    def modes(self, folder: Path) -> ModalBody:
        """The casing; a basis file is sought in `folder`. Raises InputError."""
        if self.pair is None:
            return read_basis(folder / str(self.basis))
        pair = ModalPair(**self.pair.model_dump(exclude={"radius", "thickness", "kick"}))
        return replace(pair_rim(pair, radius=self.pair.radius), thickness=self.pair.thickness or 0.0)


@table_of(BladedDisk)
class DiskTable(Table):
    """[disk]: the fields of `BladedDisk`."""

    mistuning: list[Detuning] | None = Field(
        default=None, description="relative deviation of each blade's frequency [-]"
    )


class DiskFile(SceneFile):
    """A disk of blades and a rotating casing."""

    scene: DiskHead = Field(description="kind of the scene and end of the run")
    casing: DiskCasingTable = Field(description="casing, by its rim")
    disk: DiskTable = Field(description="bladed disk")
    contact: GapTable = Field(description="gap between tips and rim")
    coating: CoatingTable | None = Field(default=None, description="abradable coating of the rim")
    law: LawTable | None = Field(default=None, description="compliance of the contacts, instead of a coating")
    speed: SpeedTable = Field(description="speed of rotation, and rotating side")
    scheme: ModalScheme = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="stored samples")

    @model_validator(mode="after")
    def _one_law(self) -> DiskFile:
        require_one(self.law, self.coating)
        return self

    def files(self) -> list[str]:
        """The basis file, if the casing has one."""
        return [] if self.casing.basis is None else [self.casing.basis]

    def radius(self, folder: Path) -> float:
        """Radius of the rotating rim [m]; 0 if unknown."""
        return self.casing.radius(folder)

    def built(self, folder: Path, problems: Problems) -> Built:
        """The scene that the file describes; raises SceneError."""
        rub = partial(self.rub, folder)
        return rub_built(rub, self.law, self.coating, self.contact.friction, self.scheme, problems)

    def rub(self, folder: Path) -> Rub:
        """The rub; a basis file is sought in `folder`. Raises InputError."""
        mistuning = self.disk.mistuning
        casing = self.casing.modes(folder)
        disk = value_of(self.disk, BladedDisk, mistuning=None if mistuning is None else np.array(mistuning))
        kick = np.zeros(casing.omega.size)
        kick[0] = 0.0 if self.casing.pair is None else self.casing.pair.kick
        return Rub(
            casing, (disk.body(),), disk.tips(), clearance=self.contact.clearance,
            speed=Speed.constant(self.speed.hz), profile=RimProfile.fourier(self.contact.terms(casing)),
            casing_start=Start(velocity=readonly(kick)), turning=self.speed.turning or "blades",
        )  # fmt: skip
