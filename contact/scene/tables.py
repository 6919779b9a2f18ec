"""Scene files of kind "rods", bodies on one axis; and scene files of every kind, imported when one is read."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, FiniteFloat

from contact.model.bodies.body import Body, PointMass, Rod, Wall
from contact.model.bodies.chain import assemble
from contact.scene.beams import BeamFile, CantileverFile
from contact.scene.pair import PairFile
from contact.scene.parts import RecordTable
from contact.scene.patch import PatchFile
from contact.scene.problems import Problems
from contact.scene.rim import DiskFile, RimFile
from contact.scene.rub import RubFile
from contact.scene.scheme import Built, NotNegative, Positive, SceneFile, SchemeTable, Table


class RodTable(Table):
    """[[rod]]: the fields of `Rod`."""

    length: Positive = Field(description="length [m]")
    area: Positive = Field(description="cross-section [m^2]")
    E: Positive = Field(description="Young's modulus [Pa]")
    rho: Positive = Field(description="density [kg/m^3]")
    elements: Annotated[int, Field(ge=1)] = Field(default=100, description="number of elements")
    x: FiniteFloat = Field(default=0.0, description="left end at t = 0 [m]")
    velocity: FiniteFloat = Field(default=0.0, description="at t = 0 [m/s]")
    fixed: Literal["none", "left", "right"] = Field(default="none", description="which end is held")
    end_mass: NotNegative = Field(default=0.0, description="at the end that faces its neighbour [kg]")
    damping: NotNegative = Field(default=0.0, description="of its mass [1/s]")


class MassTable(Table):
    """[[mass]]: the fields of `PointMass`."""

    mass: Positive = Field(description="mass [kg]")
    x: FiniteFloat = Field(default=0.0, description="place at t = 0 [m]")
    velocity: FiniteFloat = Field(default=0.0, description="at t = 0 [m/s]")
    stiffness: NotNegative = Field(default=0.0, description="of a spring to the ground [N/m]")
    anchor: FiniteFloat | None = Field(
        default=None, description="where that spring is without force [m]; x if left out"
    )
    damping: NotNegative = Field(default=0.0, description="of a dashpot to the ground [N s/m]")
    force: FiniteFloat = Field(default=0.0, description="amplitude of a harmonic force [N]")
    force_hz: NotNegative = Field(default=0.0, description="its frequency [Hz]")
    force_deg: FiniteFloat = Field(default=0.0, description="its phase [degrees]")


class WallTable(Table):
    """[wall] or [[wall]]."""

    x: FiniteFloat = Field(default=0.0, description="where it stands [m]")


class RodsHead(Table):
    """[scene] of kind "rods"; gravity > 0 pulls towards -x."""

    kind: Literal["rods"] = Field(description="which kind of scene this is")
    t_end: Positive = Field(description="time at which the run ends [s]")
    gravity: FiniteFloat = Field(default=0.0, description="towards -x [m/s^2]")


def _listed(value: object) -> object:
    return [value] if isinstance(value, dict) else value


class RodsFile(SceneFile):
    """A scene of rods, masses and walls on one axis."""

    scene: RodsHead = Field(description="what this scene is")
    rod: list[RodTable] = Field(default_factory=list, description="tables [[rod]]")
    mass: list[MassTable] = Field(default_factory=list, description="tables [[mass]]")
    wall: Annotated[list[WallTable], BeforeValidator(_listed)] = Field(
        default_factory=list, description="a table [wall], or several [[wall]]"
    )
    scheme: SchemeTable = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="what is stored; every step if left out")

    def built(self, folder: Path, problems: Problems) -> Built:
        """What the file describes; raises SceneError."""
        bodies: list[Body] = []
        with problems.at():
            bodies += [PointMass(**mass.model_dump()) for mass in self.mass]
            bodies += [Rod(**rod.model_dump()) for rod in self.rod]
            bodies += [Wall(**wall.model_dump()) for wall in self.wall]
            assemble(bodies, gravity=self.scene.gravity)
        with problems.at("scheme"):
            law, scheme = self.scheme.method()
        problems.check()
        return bodies, law, scheme


File = RodsFile | RimFile | RubFile | DiskFile | BeamFile | CantileverFile | PatchFile | PairFile
FILES: dict[str, type[File]] = {
    "rods": RodsFile, "rim": RimFile, "rub": RubFile, "disk": DiskFile, "beam": BeamFile, "cantilever": CantileverFile,
    "patch": PatchFile, "pair": PairFile,
}  # fmt: skip
