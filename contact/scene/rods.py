"""Scene files of kind "rods"."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from contact.io.tables import Number, Positive, table_of, value_of
from contact.model.bodies.body import Body, PointMass, Rod, Wall
from contact.model.bodies.chain import assemble
from contact.scene.parts import RecordTable
from contact.scene.problems import Problems
from contact.scene.scheme import Built, SceneFile, SchemeTable, Table


@table_of(Rod)
class RodTable(Table):
    """[[rod]]: the fields of `Rod`."""


@table_of(PointMass)
class MassTable(Table):
    """[[mass]]: the fields of `PointMass`."""


@table_of(Wall)
class WallTable(Table):
    """[wall] or [[wall]]."""


class RodsHead(Table):
    """[scene] of kind "rods"; gravity > 0 pulls towards -x."""

    kind: Literal["rods"] = Field(description="kind of scene")
    t_end: Positive = Field(description="time at which the run ends [s]")
    gravity: Number = Field(default=0.0, description="acceleration of gravity towards -x [m/s^2]")


def _listed(value: object) -> object:
    return [value] if isinstance(value, dict) else value


class RodsFile(SceneFile):
    """A scene of rods, masses and walls on one axis."""

    scene: RodsHead = Field(description="kind of the scene and end of the run")
    rod: list[RodTable] = Field(default_factory=list, description="tables [[rod]]: elastic rods")
    mass: list[MassTable] = Field(default_factory=list, description="tables [[mass]]: rigid masses")
    wall: Annotated[list[WallTable], BeforeValidator(_listed)] = Field(
        default_factory=list, description="rigid wall, or several [[wall]]"
    )
    scheme: SchemeTable = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="stored samples; every step if left out")

    def built(self, folder: Path, problems: Problems) -> Built:
        """The object that the table describes; raises SceneError."""
        bodies: list[Body] = []
        with problems.at():
            bodies += [value_of(mass, PointMass) for mass in self.mass]
            bodies += [value_of(rod, Rod) for rod in self.rod]
            bodies += [value_of(wall, Wall) for wall in self.wall]
            assemble(bodies, gravity=self.scene.gravity)
        with problems.at("scheme"):
            law, scheme = self.scheme.method()
        problems.check()
        return bodies, law, scheme
