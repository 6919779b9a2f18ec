"""Base of all tables of a study file: strict values, and numbers with physical limits."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from contact.io.plausible import CHECKS, REACH
from contact.io.tables import Length, Positive

Size = Annotated[Length, REACH]
Place = Annotated[float, Field(ge=-1e3, le=1e3), REACH]
Thickness = Annotated[Length, CHECKS["thickness"]]
Modulus = Annotated[Positive, CHECKS["E"]]
Density = Annotated[Positive, CHECKS["rho"]]
Poisson = Annotated[float, Field(gt=-1, lt=0.5), CHECKS["nu"]]
Relative = Annotated[float, Field(ge=-1, le=1)]
Angle = Annotated[float, Field(ge=-360, le=360)]
Edge = str
Pair = Annotated[list[float], Field(min_length=2, max_length=2)]
Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Axis = Annotated[
    Annotated[Literal["x", "y", "z"], Tag("name")] | Annotated[Vector, Tag("vector")],
    Discriminator(lambda value: "name" if isinstance(value, str) else "vector"),
]


class Table(BaseModel):
    """A table of the file: unknown keys, inf and nan are errors; nothing is converted."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)
