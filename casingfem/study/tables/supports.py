"""The tables of the supports of an edge."""

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.support import ElasticEdge
from casingfem.study.tables.fields import Harmonic
from casingfem.study.tables.shapes import MaterialTable
from casingfem.study.tables.table import Pair, Place, Size, Table
from contact.io.plausible import REACH
from contact.io.tables import NotNegative, table_of


class SpringsAround(Table):
    """[support.EDGE.around]: variation of each spring along the edge."""

    k_r: list[Harmonic] = Field(default=[], description="relative variation of the radial springs, [{p, cos, sin}]")
    k_theta: list[Harmonic] = Field(
        default=[], description="relative variation of the tangential springs, [{p, cos, sin}]"
    )
    k_z: list[Harmonic] = Field(default=[], description="relative variation of the axial springs, [{p, cos, sin}]")
    k_rot: list[Harmonic] = Field(
        default=[], description="relative variation of the rotational springs, [{p, cos, sin}]"
    )
    k_face: list[Harmonic] = Field(
        default=[], description="relative variation of the foundation of the end face, [{p, cos, sin}]"
    )


Around = Annotated[
    Annotated[list[Harmonic], Tag("all")] | Annotated[SpringsAround, Tag("each")],
    Discriminator(lambda value: "each" if isinstance(value, Mapping | SpringsAround) else "all"),
]


class ClampedTable(Table):
    """[support.EDGE] of kind "clamped"."""

    kind: Literal["clamped"] = Field(description="kind of support")


class DiaphragmTable(Table):
    """[support.EDGE] of kind "shear-diaphragm"."""

    kind: Literal["shear-diaphragm"] = Field(description="kind of support")


class FixedTable(Table):
    """[support.GROUP] of kind "fixed": fixed displacements, on imported meshes."""

    kind: Literal["fixed"] = Field(description="kind of support")
    directions: list[Literal["x", "y", "z"]] = Field(min_length=1, description="fixed directions, some of x, y, z")


class SymmetryTable(Table):
    """[support.EDGE] of kind "symmetry": the edge lies in a plane of symmetry."""

    kind: Literal["symmetry"] = Field(description="kind of support")


@table_of(ElasticEdge)
class ElasticTable(Table):
    """[support.EDGE] of kind "elastic"; `around` multiplies all springs, or each separately, by 1 + harmonics."""

    k_face: float
    kind: Literal["elastic"] = Field(description="kind of support")
    around: Around = Field(
        default=[],
        description="relative variation of the springs around, [{p, cos, sin}], or one such list for each spring",
    )


class LooseTable(Table):
    """One loose or missing bolt."""

    bolt: int = Field(ge=1, le=1000, description="number of the bolt, from 1")
    factor: float = Field(ge=0, le=1e6, description="factor of its stiffness [-], 0 for a missing bolt")


@table_of(Bolts)
class BoltsTable(Table):
    """[support.EDGE] of kind "bolts"."""

    width_deg: float | None
    kind: Literal["bolts"] = Field(description="kind of support")
    k: NotNegative | None = Field(default=None, description="stiffness of one bolt in all three directions [N/m]")
    k_r: NotNegative | None = Field(default=None, description="radial stiffness of one bolt [N/m]")
    k_theta: NotNegative | None = Field(default=None, description="tangential stiffness of one bolt [N/m]")
    k_z: NotNegative | None = Field(default=None, description="axial stiffness of one bolt [N/m]")
    width_m: Size | None = Field(
        default=None, description="width of the patch on which a bolt acts, as a length on a closed casing [m]"
    )
    loose: list[LooseTable] = Field(default=[], description="loose bolts, [{bolt, factor}]")

    @model_validator(mode="after")
    def _one_of_each(self) -> "BoltsTable":
        split = [name for name in ("k_r", "k_theta", "k_z") if getattr(self, name) is not None]
        if (self.k is None) == (not split):
            found = "neither k nor" if self.k is None else "k beside"
            raise ValueError(f"found {found} {', '.join(split or ['k_r, k_theta, k_z'])}, expected one of the two")
        if self.width_deg is not None and self.width_m is not None:
            raise ValueError("found both width_deg and width_m, expected one of them")
        bolts = [entry.bolt for entry in self.loose]
        if len(set(bolts)) < len(bolts):
            raise ValueError(f"loose: found bolts {bolts}, expected each once")
        return self


RingSupport = Annotated[ElasticTable | BoltsTable, Field(discriminator="kind")]


class SectionTable(Table):
    """Section and material of a ring: a rectangle, or a circle by its diameter."""

    width: Size | None = Field(default=None, description="radial size of the section [m]")
    depth: Size | None = Field(default=None, description="axial size of the section [m]")
    diameter: Size | None = Field(default=None, description="diameter of a round section [m]")
    material: MaterialTable | None = Field(
        default=None, description="E, nu, rho of the ring; those of the casing if left out"
    )

    @model_validator(mode="after")
    def _one_section(self) -> "SectionTable":
        sides = [name for name in ("width", "depth", "diameter") if getattr(self, name) is not None]
        if sides not in (["width", "depth"], ["diameter"]):
            raise ValueError(f"found {', '.join(sides) or 'no section'}, expected width and depth, or diameter")
        return self


class StiffenerTable(SectionTable):
    """[[stiffener]]: a ring on the wall of a closed casing, between its edges."""

    at: Place = Field(description="place along the axis or the meridian [m]")
    offset: Annotated[Pair, REACH] = Field(
        description="offset of the section's centre from the middle of the wall, [radial, axial] [m]"
    )


class RingTable(SectionTable):
    """[support.EDGE] of kind "ring": [support.EDGE.support] is its support."""

    kind: Literal["ring"] = Field(description="kind of support")
    offset: Annotated[Pair, REACH] | None = Field(
        default=None, description="offset of the section's centre from the edge, [radial, axial] [m]"
    )
    foot: Annotated[Pair, REACH] | None = Field(
        default=None, description="offset of the springs from the section's centre, [radial, axial] [m]"
    )
    support: RingSupport | None = Field(default=None, description="support of the ring: elastic or bolts")


SupportTable = Annotated[
    ClampedTable | DiaphragmTable | SymmetryTable | ElasticTable | BoltsTable | RingTable | FixedTable,
    Field(discriminator="kind"),
]
