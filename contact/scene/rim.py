"""Scene files of kind "rim": a turning casing rim against one fixed blade."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, FiniteFloat

from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.gap import RotatingRim
from contact.scene.parts import CoatingTable, RecordTable, contact_law, read_basis
from contact.scene.problems import Problems
from contact.scene.roundness import GapTable
from contact.scene.scheme import Built, ModalScheme, Positive, RunHead, SceneFile, SpeedTable, Table
from contact.scheme.modal.exact_modal import ExactModal


class RimHead(RunHead):
    """[scene] of kind "rim"."""

    kind: Literal["rim"] = Field(description="which kind of scene this is")


class CasingTable(Table):
    """[casing]: modal basis file of kind "rim", relative to the scene file; `scatter` detunes its modes at random."""

    basis: str = Field(description="modal basis of kind rim, npz, relative to this file")
    scatter: Annotated[FiniteFloat, Field(ge=0, le=0.2)] = Field(
        default=0.0, description="standard deviation of a random relative detuning of its modes [-]"
    )
    seed: Annotated[int, Field(ge=0)] = Field(default=0, description="of that detuning")

    def body(self, folder: Path) -> ModalBody:
        """The rim, detuned."""
        body = read_basis(folder / self.basis)
        return body.detuned(self.scatter, seed=self.seed) if self.scatter > 0.0 else body


class BladeTable(Table):
    """[blade]: modal basis file of kind "point" with channels span and flap; lean in degrees; `freq_hz` retunes it."""

    basis: str = Field(description="modal basis of kind point, with channels span and flap, relative to this file")
    freq_hz: Positive | None = Field(
        default=None, description="first frequency it is tuned to [Hz]; as it is if left out"
    )
    lean_deg: Annotated[FiniteFloat, Field(gt=-90, lt=90)] = Field(
        default=0.0, description="lean from the radius, into the motion [degrees]"
    )

    def body(self, folder: Path) -> ModalBody:
        """The blade, retuned."""
        body = read_basis(folder / self.basis)
        return body if self.freq_hz is None else body.retuned(self.freq_hz)


class RimContact(GapTable):
    """[contact] of a rim: clearance [m], friction coefficient, out-of-roundness."""

    angle_deg: FiniteFloat = Field(default=0.0, description="where the blade stands [degrees]")


class RimFile(SceneFile):
    """A rotating casing rim against one fixed blade."""

    scene: RimHead = Field(description="what this scene is")
    casing: CasingTable = Field(description="the rim")
    blade: BladeTable = Field(description="the blade")
    contact: RimContact = Field(description="the gap")
    coating: CoatingTable | None = Field(default=None, description="an abradable coating of the rim")
    speed: SpeedTable = Field(description="how fast the casing turns")
    scheme: ModalScheme = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="what is stored")

    def files(self) -> list[str]:
        """Files the scene is made of, beside its own."""
        return [self.casing.basis, self.blade.basis]

    def built(self, folder: Path, problems: Problems) -> Built:
        """What the file describes; raises SceneError."""
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
            )  # fmt: skip
        with problems.at("coating"):
            law = contact_law(self.coating, contact.friction)
        problems.check()
        return rim, law, ExactModal(law=self.scheme.law)
