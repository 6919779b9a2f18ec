"""Scene files of kinds "beam" and "cantilever"."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from contact.io.tables import Positive, table_of, value_of
from contact.model.bodies.beam import BeamInCircle, HingedBeam
from contact.model.bodies.modal_body import ModalBody
from contact.model.bodies.ring_modes import ThinRing, ring_modes
from contact.model.gaps.rod_modes import Cantilever
from contact.scene.parts import RecordTable, read_basis
from contact.scene.problems import Problems
from contact.scene.scheme import MODAL, Built, Distance, Force, Name, SceneFile, SchemeTable, Table, Velocity

SECTION = ("width", "height", "E", "rho")  # of a ring that no basis gives


class BeamHead(Table):
    """[scene] of kind "beam"."""

    kind: Literal["beam"] = Field(description="kind of scene")
    t_end: Positive = Field(description="time at which the run ends [s]")


@table_of(HingedBeam)
class BeamTable(Table):
    """[beam]: the fields of `HingedBeam`."""


@table_of(BeamInCircle)
class CircleTable(Table):
    """[circle]: radius, and offset of its centre from the hinge [m]."""

    radius: float
    offset: float


@table_of(ThinRing, optional=SECTION)
class RingTable(Table):
    """[ring]: an elastic ring instead of the rigid circle: the section of `ThinRing`, or a modal basis file."""

    basis: Name | None = Field(
        default=None, description="file of a modal basis of kind rim (npz), instead of a section"
    )
    n_max: Annotated[int, Field(ge=1, le=200)] = Field(default=20, description="highest number of nodal diameters")

    @model_validator(mode="after")
    def _whole(self) -> RingTable:
        given = [name for name in SECTION if getattr(self, name) is not None]
        if (self.basis is None) != (len(given) == 4) or (self.basis is not None and given):
            expected = "a basis, or all of width, height, E, rho"
            raise ValueError(f"{', '.join(given) or 'nothing'} found, expected {expected}")
        return self

    def body(self, folder: Path, radius: float) -> ModalBody:
        """The ring from its file, or from its section and the circle's radius."""
        if self.basis is not None:
            return read_basis(folder / self.basis)
        return ring_modes(value_of(self, ThinRing, radius=radius), self.n_max)


class BeamFile(SceneFile):
    """A hinged beam in an eccentric circle, which is rigid or an elastic ring."""

    scene: BeamHead = Field(description="kind of the scene and end of the run")
    beam: BeamTable = Field(description="beam")
    circle: CircleTable = Field(description="rigid circle")
    ring: RingTable | None = Field(default=None, description="elastic ring instead of the rigid circle")
    scheme: SchemeTable = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="stored samples")

    def files(self) -> list[str]:
        """Files that the scene uses, besides its own."""
        return [] if self.ring is None or self.ring.basis is None else [self.ring.basis]

    def built(self, folder: Path, problems: Problems) -> Built:
        """The object that the table describes; raises SceneError."""
        circle = self.circle
        with problems.at("beam"):
            beam = value_of(self.beam, HingedBeam)
        with problems.at("ring"):
            ring = None if self.ring is None else self.ring.body(folder, circle.radius)
        with problems.at("scheme"):
            law, scheme = self.scheme.method()
        problems.check()
        with problems.at():
            what = BeamInCircle(beam, radius=circle.radius, offset=circle.offset, ring=ring)
        problems.check()
        return what, law, scheme


class CantileverHead(Table):
    """[scene] of kind "cantilever"."""

    kind: Literal["cantilever"] = Field(description="kind of scene")
    t_end: Positive = Field(description="time at which the run ends [s]")


@table_of(Cantilever)
class UniformBeamTable(Table):
    """The fields of `Cantilever`."""


class CantileverTable(UniformBeamTable):
    """[beam] of a cantilever: the fields of `Cantilever`, a line load [N/m] and a velocity [m/s] towards the stop."""

    load: Force = Field(default=0.0, description="line load towards the stop [N/m]")
    velocity: Velocity = Field(default=0.0, description="velocity of the whole beam at t = 0, towards the stop [m/s]")


class StopTable(Table):
    """[stop]: its distance from the tip of the straight beam [m]."""

    clearance: Distance = Field(description="clearance between the stop and the tip of the straight beam [m]")


class CantileverFile(SceneFile):
    """A clamped beam whose tip meets a stop."""

    scene: CantileverHead = Field(description="kind of the scene and end of the run")
    beam: CantileverTable = Field(description="beam")
    stop: StopTable = Field(description="rigid stop")
    scheme: SchemeTable = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="stored samples")

    @model_validator(mode="after")
    def _modal(self) -> CantileverFile:
        if self.scheme.kind not in MODAL:
            raise ValueError(f"scheme.kind {self.scheme.kind!r} found, expected one of {', '.join(map(repr, MODAL))}")
        return self

    def built(self, folder: Path, problems: Problems) -> Built:
        """The object that the table describes; raises SceneError."""
        given = self.beam
        with problems.at():
            beam = Cantilever(**given.model_dump(exclude={"load", "velocity"}))
            gap = beam.before_stop(
                clearance=self.stop.clearance, load=given.load, velocity=given.velocity, modes=self.scheme.modes or 20
            )
        with problems.at("scheme"):
            law, scheme = self.scheme.method()
        problems.check()
        return gap, law, scheme
