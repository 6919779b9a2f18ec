"""[coating] of scene files, and the contact law of a rim or a rub."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from contact.model.law import Abradable, Coulomb, Law, Unilateral
from contact.scene.scheme import NotNegative, Positive, Table


class CoatingTable(Table):
    """[coating] of a rim: the fields of `Abradable`, whose friction is that of [contact]."""

    E: Positive = Field(description="Young's modulus [Pa]")
    yield_stress: Positive = Field(description="stress at which it is worn [Pa]")
    hardening: NotNegative = Field(description="slope of the stress beyond that [Pa]")
    thickness: Positive = Field(description="thickness [m]")
    width: Positive = Field(description="width of the strip along the axis [m]")
    tip: Positive = Field(description="length of a tip's land around the rim [m]")
    bars: Annotated[int, Field(ge=1, le=10_000)] = Field(default=6, description="bars under a tip's land")
    machined: NotNegative = Field(
        default=0.0, description="cut before the run, from the rim's highest point to a circle [m]"
    )


def contact_law(coating: CoatingTable | None, mu: float) -> Law:
    """Coated, sliding, or neither; raises InputError."""
    if coating is not None:
        return Abradable(mu=mu, **coating.model_dump())
    return Coulomb(mu=mu) if mu > 0.0 else Unilateral()
