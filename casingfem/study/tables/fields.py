"""The tables of what varies over a structure: harmonics, surveys, random fields."""

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from casingfem.study.tables.table import Positive, Relative, Table


class Harmonic(Table):
    """cos p theta and sin p theta, relative."""

    p: int = Field(ge=0, le=1000, description="number of waves around")
    cos: Relative = Field(default=0.0, description="relative amplitude of cos p theta [-]")
    sin: Relative = Field(default=0.0, description="relative amplitude of sin p theta [-]")


class Wave(Table):
    """One harmonic of a random field's spectrum, relative amplitudes."""

    p: int = Field(ge=1, le=1000, description="number of waves around")
    median: Annotated[float, Field(gt=0, le=1)] = Field(description="median amplitude, relative [-]")
    high: Annotated[float, Field(gt=0, le=1)] | None = Field(
        default=None, description="90th percentile [-]; 1.82 medians if left out, as of a Rayleigh amplitude"
    )


Random = Annotated[
    Annotated[Literal["example"], Tag("name")] | Annotated[list[Wave], Tag("spectrum"), Field(min_length=1)],
    Discriminator(lambda value: "spectrum" if isinstance(value, list) else "name"),
]


class ImperfectionTable(Table):
    """[[imperfection]]: harmonics, the fit of a survey, or a random field; several of them add up."""

    of: Literal["radius", "thickness", "modulus", "density"] = Field(description="what it varies")
    harmonics: list[Harmonic] | None = Field(default=None, description="[{p, cos, sin}], relative")
    survey: str | None = Field(default=None, min_length=1, description="survey CSV, relative to this file")
    n_max: int | None = Field(default=None, ge=1, le=1000, description="highest harmonic fitted to the survey")
    degree: int | None = Field(default=None, ge=0, le=20, description="degree of the fit along z")
    robust: bool | None = Field(default=None, description="set stray points of the survey aside, and say which")
    centred: bool | None = Field(default=None, description="take the survey's points about the part's own axis")
    random: Random | None = Field(default=None, description='"example" (radius), or [{p, median, high}], relative')
    seed: int | None = Field(default=None, ge=0, description="of the random field: same seed, same field")
    scale: Positive | None = Field(default=None, description="factor on the random field's spectrum [-]")
    p_max: int | None = Field(default=None, ge=1, le=1000, description="highest harmonic of the random field")

    @model_validator(mode="after")
    def _one_source(self) -> "ImperfectionTable":
        sources = {
            "harmonics": (),
            "survey": ("n_max", "degree", "robust", "centred"),
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
