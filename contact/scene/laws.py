"""[law] and [coating] of a scene: compliance of its contacts; without either they are rigid."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from contact.io.tables import NotNegative, Positive, table_of, value_of
from contact.model.law import Abradable, Coulomb, Law, Unilateral
from contact.model.laws.force_law import ForceLaw, ForceTable, Hertz, Response, spring
from contact.scene.scheme import Table
from contact.stability.on_springs import slope_of


@table_of(Abradable)
class CoatingTable(Table):
    """[coating] of a rim: the fields of `Abradable`, whose friction is that of [contact]."""

    tip: float
    machined: float


class SpringLaw(Table):
    """[law] of kind "spring": force = stiffness depth + damping rate in every contact."""

    kind: Literal["spring"] = Field(description="linear spring in the contact")
    stiffness: Positive = Field(description="stiffness of the spring [N/m]")
    damping: NotNegative = Field(default=0.0, description="damping constant of a parallel dashpot [N s/m]")

    def law(self, mu: float) -> Law:
        """The law with friction `mu`."""
        words = f"spring {self.stiffness:.3g} N/m"
        return ForceLaw(Response(spring, (self.stiffness, self.damping)), mu=mu, words=words)

    def closed_slope(self) -> float:
        """Slope of a closed contact [N/m]."""
        return self.stiffness


@table_of(Hertz)
class HertzLaw(Table):
    """[law] of kind "hertz": force = k depth^exponent (1 + dissipation rate)."""

    kind: Literal["hertz"] = Field(description="Hertz's law of two round bodies")
    closed_depth: Positive | None = Field(
        default=None, description="mean depth at which the law is linearised for stability and interactions [m]"
    )

    def law(self, mu: float) -> Law:
        """The law with friction `mu`."""
        return value_of(self, Hertz, mu=mu)

    def closed_slope(self) -> float:
        """Slope of a closed contact [N/m]; raises InputError."""
        return slope_of(self.law(0.0), self.closed_depth)


@table_of(ForceTable, "damping")
class TableLaw(Table):
    """[law] of kind "table": a bumper's force over its depth, linear between points, the last line continued."""

    kind: Literal["table"] = Field(description="measured curve of force over depth")
    depth: Annotated[list[NotNegative], Field(min_length=2)] = Field(description="depths, ascending from 0 [m]")
    force: Annotated[list[NotNegative], Field(min_length=2)] = Field(
        description="forces at these depths, from 0 and never decreasing [N]"
    )
    closed_depth: Positive | None = Field(
        default=None, description="mean depth at which the law is linearised for stability and interactions [m]"
    )

    @model_validator(mode="after")
    def _is_a_curve(self) -> TableLaw:
        ForceTable(depth=self.depth, force=self.force)
        return self

    def law(self, mu: float) -> Law:
        """The law with friction `mu`."""
        return value_of(self, ForceTable, depth=self.depth, force=self.force, mu=mu)

    def closed_slope(self) -> float:
        """Slope of a closed contact [N/m]; raises InputError."""
        return slope_of(self.law(0.0), self.closed_depth)


AnyLaw = SpringLaw | HertzLaw | TableLaw
LawTable = Annotated[AnyLaw, Field(discriminator="kind")]


def contact_law(mu: float, law: AnyLaw | None, coating: CoatingTable | None = None) -> Law:
    """The law of the contacts: coating, force-depth law, friction, or rigid without friction; raises InputError."""
    if coating is not None:
        return value_of(coating, Abradable, mu=mu)
    if law is not None:
        return law.law(mu)
    return Coulomb(mu=mu) if mu > 0.0 else Unilateral()


def require_one(law: object, coating: object) -> None:
    """Raise ValueError if a scene has both a law and a coating."""
    if law is not None and coating is not None:
        raise ValueError("law and coating found, expected one of them, since a coating is also a contact law")
