"""[coating] of scene files, the contact law of a rim or a rub, and what a rub with it is run by."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from pydantic import Field

from contact.model.gaps.rub import Rub
from contact.model.law import Abradable, Coulomb, Law, Unilateral
from contact.scene.problems import Problems
from contact.scene.scheme import Built, ModalScheme, NotNegative, Positive, Table
from contact.scheme.modal.exact_modal import ExactModal
from contact.scheme.modal.rub_tracks import track_tips


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


def rub_built(
    rub: Callable[[], Rub], coating: CoatingTable | None, mu: float, scheme: ModalScheme, problems: Problems
) -> Built:
    """A rub with its law, tracks of a coating checked; raises SceneError."""
    with problems.at():
        what = rub()
    with problems.at("coating"):
        law = contact_law(coating, mu)
    problems.check()
    if coating is not None:
        with problems.at():
            track_tips(what, coating.tip)
    return what, law, ExactModal(law=scheme.law)
