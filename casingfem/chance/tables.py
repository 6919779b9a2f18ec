"""The table [chance] of scene.toml."""

from typing import Annotated

from pydantic import Field, model_validator

from casingfem.chance.laws import Law
from casingfem.study.tables.table import Table
from contact.io.tables import table_of, value_of

MOST = 10_000_000  # draws


@table_of(Law)
class LawTable(Table):
    """A random number of the scene: its distribution, mean and standard deviation."""


class ChanceTable(Table):
    """[chance]: the random casings, the number of draws, and the other random numbers of the scene."""

    study: Annotated[str, Field(min_length=1)] = Field(
        description="study file of the casing with random imperfections and [reduce], relative to this file"
    )
    draws: int = Field(default=4096, ge=32, le=MOST, description="number of casings")
    seed: int = Field(ge=0, description="seed of all draws; the same seed gives the same casings")
    runs: int = Field(
        default=0,
        ge=0,
        le=1_000_000,
        description="number of time simulations, of the first casings that are dangerous at some speed",
    )
    turns: Annotated[float, Field(gt=0, le=1e6)] | None = Field(
        default=None, description="length of a run [turns]; t_end of the scene if left out"
    )
    worst: int = Field(default=10, ge=0, le=1000, description="number of the worst casings, written as studies")
    importance: int = Field(
        default=0, ge=0, le=1 << 20, description="size of the design for Sobol indices, a power of 2; none if 0"
    )
    blade: LawTable | None = Field(default=None, description="frequencies of the blades over those of the scene [-]")
    clearance: LawTable | None = Field(default=None, description="clearance [m]")
    friction: LawTable | None = Field(default=None, description="coefficient of friction [-]")
    closing: LawTable | None = Field(default=None, description="reduction of the gap, for a scene of kind rub [m]")

    @property
    def laws(self) -> dict[str, Law]:
        """The distributions of the random numbers that are given, by name."""
        tables = {"blade": self.blade, "clearance": self.clearance, "friction": self.friction, "closing": self.closing}
        return {name: value_of(table, Law) for name, table in tables.items() if table is not None}

    @model_validator(mode="after")
    def _power(self) -> "ChanceTable":
        if self.importance & (self.importance - 1) or self.importance == 1:
            raise ValueError(f"found importance = {self.importance}, expected 0 or a power of 2, at least 2")
        return self
