"""Scene files of kind "pair": one casing pair and one blade mode by hand, for `casingfem stability`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from contact.io.tables import table_of
from contact.model.gaps.permanent import ModalPair
from contact.scene.parts import Lean
from contact.scene.scheme import (
    WAVES,
    CheckedFile,
    Compliance,
    Friction,
    ScanTable,
    Stiffness,
    Table,
)


class PairHead(Table):
    """[scene] of kind "pair"."""

    kind: Literal["pair"] = Field(description="kind of scene")


@table_of(ModalPair, "freq_hz", "modal_mass", "zeta")
class BladeModeTable(Table):
    """[blade] of a pair: one mode, its mass [kg] for unit motion along the contact normal."""


class CasingPairTable(BladeModeTable):
    """[casing] of a pair: n nodal diameters, and the same numbers as for a blade mode."""

    n: Annotated[int, Field(ge=1, le=WAVES)] = Field(description="number of nodal diameters")


class PairContact(Table):
    """[contact] of a pair: stiffness [N/m] or compliance [m/N], friction, lean of the blade into the motion."""

    stiffness: Stiffness | None = Field(default=None, description="stiffness of the contact [N/m]")
    compliance: Compliance | None = Field(
        default=None, description="compliance of the contact [m/N], instead of its stiffness"
    )
    friction: Friction = Field(default=0.0, description="coefficient of Coulomb friction [-]")
    lean_deg: Lean = Field(
        default=0.0, description="lean of the blade from the radius, positive in the direction of its motion [degrees]"
    )

    @model_validator(mode="after")
    def _one_of_both(self) -> PairContact:
        if (self.stiffness is None) == (self.compliance is None):
            found = "neither stiffness nor compliance" if self.stiffness is None else "stiffness and compliance both"
            raise ValueError(f"{found} given, expected one of them")
        return self


class PairFile(CheckedFile):
    """One casing pair against one blade mode, contact closed: for `casingfem stability`."""

    scene: PairHead = Field(description="kind of the scene and end of the run")
    casing: CasingPairTable = Field(description="one pair of casing modes")
    blade: BladeModeTable = Field(description="one blade mode")
    contact: PairContact = Field(description="stiffness or compliance, and friction of the contact")
    speed: ScanTable = Field(description="range of speeds")
