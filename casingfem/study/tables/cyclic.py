"""The table of a wheel of equal sectors."""

from typing import Annotated

from pydantic import Field, model_validator

from casingfem.study.tables.table import Axis, Edge, Positive, Table, Vector


class CyclicTable(Table):
    """[cyclic]: the imported mesh is one sector of a wheel; [modes] count and [reduce] modes are of each diameter."""

    sectors: int = Field(ge=2, le=1000, description="how many sectors make the wheel")
    axis: Axis | None = Field(default=None, description='"x", "y", "z" or a direction [x, y, z]; z if left out')
    point: Vector | None = Field(default=None, description="a point on the axis [m]; the origin if left out")
    faces: Annotated[list[Edge], Field(min_length=2, max_length=2)] | None = Field(
        default=None, description="groups of the two faces; found by their nodes if left out"
    )
    tolerance: Positive | None = Field(
        default=None, description="how far apart paired nodes may be [m]; a thousandth of the shortest edge if left out"
    )
    nodal_diameters: Annotated[list[int], Field(min_length=1)] | None = Field(
        default=None, description="some of 0 .. sectors/2, for casingfem modes; all if left out"
    )
    coriolis: bool = Field(default=False, description="casingfem modes gives the waves with Coriolis forces too")
    mistuning: str | list[float] | None = Field(
        default=None, description="relative deviation [-] of each blade's frequency: a list, or a CSV blade,deviation"
    )
    blade: Edge | None = Field(default=None, description="group of the cells that deviate; the sector if left out")

    @model_validator(mode="after")
    def _blade_deviates(self) -> "CyclicTable":
        if self.blade is not None and self.mistuning is None:
            raise ValueError("found blade without mistuning, expected the deviations of the blades with it")
        return self
