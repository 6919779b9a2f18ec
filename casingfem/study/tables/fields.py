"""Tables of fields on a structure: harmonics, surveys, random fields; deviations between sectors of a wheel."""

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from casingfem.study.tables.table import Axis, Edge, Relative, Table, Vector
from contact.io.tables import Positive


class Harmonic(Table):
    """cos p theta and sin p theta, relative."""

    p: int = Field(ge=0, le=1000, description="number of waves around")
    cos: Relative = Field(default=0.0, description="relative amplitude of cos p theta [-]")
    sin: Relative = Field(default=0.0, description="relative amplitude of sin p theta [-]")


class Wave(Table):
    """One harmonic of a random field's spectrum, relative amplitudes."""

    p: int = Field(ge=1, le=1000, description="number of waves around")
    median: Annotated[float, Field(ge=1e-9, le=1)] = Field(description="median amplitude, relative [-]")
    high: Annotated[float, Field(gt=0, le=1)] | None = Field(
        default=None,
        description="90th percentile, relative [-]; 1.82 medians if left out, as of a Rayleigh distribution",
    )


Name = Annotated[str, Field(min_length=1)]


def kind_of_random(value: object) -> str:
    """Which of the forms of `random` a value has."""
    if not isinstance(value, list):
        return "name"
    return "surveys" if value and all(isinstance(each, str) for each in value) else "spectrum"


Random = Annotated[
    Annotated[Literal["example"], Tag("name")]
    | Annotated[list[Wave], Tag("spectrum"), Field(min_length=1)]
    | Annotated[list[Name], Tag("surveys"), Field(min_length=1)],
    Discriminator(kind_of_random),
]


class ImperfectionTable(Table):
    """[[imperfection]]: harmonics, the fit of a survey, or a random field; several of them are added."""

    of: Literal["radius", "thickness", "modulus", "density"] = Field(description="quantity that varies")
    harmonics: list[Harmonic] | None = Field(
        default=None, description="harmonics around, [{p, cos, sin}], with relative amplitudes"
    )
    survey: str | None = Field(default=None, min_length=1, description="CSV file of the survey, relative to this file")
    n_max: int | None = Field(default=None, ge=1, le=1000, description="highest harmonic fitted to the survey")
    degree: int | None = Field(default=None, ge=0, le=20, description="degree of the fitted polynomial along z")
    robust: bool | None = Field(
        default=None, description="whether outliers of the survey are left out of the fit and named"
    )
    centred: bool | None = Field(
        default=None, description="whether the survey's points are taken about the part's own axis"
    )
    outside: Literal["fit", "nearest", "zero", "refuse"] | None = Field(
        default=None,
        description="shape beyond the survey's lowest and highest point: the fitted polynomial (fit), that of the"
        " nearest height (nearest), a decrease to zero (zero), or an error (refuse); fit if left out, nearest where"
        " the points cover less than half of the shell",
    )
    random: Random | None = Field(
        default=None,
        description='spectrum of a random field, "example" (of the radius), [{p, median, high}] with relative'
        " amplitudes, or a list of survey CSV files",
    )
    seed: int | None = Field(
        default=None, ge=0, description="seed of the random field; the same seed gives the same field"
    )
    scale: Positive | None = Field(default=None, description="factor on the random field's spectrum [-]")
    p_max: int | None = Field(default=None, ge=1, le=1000, description="highest harmonic of the random field")

    @property
    def waves(self) -> list[Wave]:
        """The spectrum that `random` states; none of another form."""
        return [each for each in self.random or [] if isinstance(each, Wave)]

    @property
    def surveys(self) -> list[str]:
        """The surveys that `random` names; none of another form."""
        return [each for each in self.random if isinstance(each, str)] if isinstance(self.random, list) else []

    @model_validator(mode="after")
    def _one_source(self) -> "ImperfectionTable":
        sources = {
            "harmonics": (),
            "survey": ("n_max", "degree", "robust", "centred", "outside"),
            "random": ("seed", "scale", "p_max"),
        }
        given = [name for name in sources if getattr(self, name) is not None]
        if len(given) != 1:
            found = "neither harmonics nor survey nor random" if not given else " beside ".join(given)
            raise ValueError(f"found {found}, expected one of {', '.join(sources)}")
        for name, own in sources.items():
            astray = [key for key in own if getattr(self, key) is not None and name != given[0]]
            if astray:
                raise ValueError(f"found {', '.join(astray)} beside {given[0]}, expected with {name} only")
        if self.random is not None and self.seed is None:
            raise ValueError("found random without seed, expected a whole number: the same seed gives the same field")
        if self.random == "example" and self.of != "radius":
            raise ValueError(f'found random = "example" of {self.of}, expected a spectrum of your own: [{{p, median}}]')
        return self


class CyclicTable(Table):
    """[cyclic]: the imported mesh is one sector of a wheel; [modes] count and [reduce] modes are per diameter."""

    sectors: int = Field(ge=2, le=1000, description="number of sectors of the wheel")
    axis: Axis | None = Field(
        default=None, description='axis, as "x", "y", "z" or a direction [x, y, z]; z if left out'
    )
    point: Vector | None = Field(default=None, description="a point on the axis [m]; the origin if left out")
    faces: Annotated[list[Edge], Field(min_length=2, max_length=2)] | None = Field(
        default=None, description="names of the groups of the two faces; found from the nodes if left out"
    )
    tolerance: Positive | None = Field(
        default=None, description="largest distance of paired nodes [m]; 1/1000 of the shortest edge if left out"
    )
    nodal_diameters: Annotated[list[int], Field(min_length=1)] | None = Field(
        default=None, description="nodal diameters that casingfem modes computes, from 0 to sectors/2; all if left out"
    )
    coriolis: bool = Field(
        default=False, description="whether casingfem modes also computes travelling waves with Coriolis forces"
    )
    mistuning: Annotated[str, Field(min_length=1)] | list[float] | None = Field(
        default=None,
        description="relative frequency deviation of each blade [-], a list or a CSV file with blade and deviation",
    )
    blade: Edge | None = Field(
        default=None, description="group of cells that are mistuned; the whole sector if left out"
    )

    @model_validator(mode="after")
    def _blade_deviates(self) -> "CyclicTable":
        if self.blade is not None and self.mistuning is None:
            raise ValueError("found blade without mistuning, expected also mistuning, the deviations of the blades")
        return self
