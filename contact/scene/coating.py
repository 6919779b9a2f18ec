"""[coating] of scene files, and the contact law of a rim or a rub."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from contact.model.law import Abradable, Coulomb, Law, Unilateral
from contact.scene.scheme import NotNegative, Positive, Table


class CoatingTable(Table):
    """[coating] of a rim: the fields of `Abradable`, whose friction is that of [contact]."""

    E: Positive
    yield_stress: Positive
    hardening: NotNegative
    thickness: Positive
    width: Positive
    tip: Positive
    bars: Annotated[int, Field(ge=1, le=10_000)] = 6
    machined: NotNegative = 0.0


def contact_law(coating: CoatingTable | None, mu: float) -> Law:
    """Coated, sliding, or neither; raises InputError."""
    if coating is not None:
        return Abradable(mu=mu, **coating.model_dump())
    return Coulomb(mu=mu) if mu > 0.0 else Unilateral()
