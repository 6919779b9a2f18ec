"""Schema of scene.toml (pydantic): imported only when a scene file is read."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, FiniteFloat, model_validator

from contact.scene.coating import CoatingTable
from contact.scene.disk import DiskFile
from contact.scene.patch import PatchFile
from contact.scene.record import RecordTable
from contact.scene.roundness import Roundness
from contact.scene.rub import RubFile
from contact.scene.scheme import Friction, NotNegative, Positive, RunHead, ScanTable, SchemeTable, Table


class RodTable(Table):
    """[[rod]]: the fields of `Rod`."""

    length: Positive
    area: Positive
    E: Positive
    rho: Positive
    elements: Annotated[int, Field(ge=1)] = 100
    x: FiniteFloat = 0.0
    velocity: FiniteFloat = 0.0
    fixed: Literal["none", "left", "right"] = "none"
    end_mass: NotNegative = 0.0
    damping: NotNegative = 0.0


class MassTable(Table):
    """[[mass]]: the fields of `PointMass`."""

    mass: Positive
    x: FiniteFloat = 0.0
    velocity: FiniteFloat = 0.0
    stiffness: NotNegative = 0.0
    anchor: FiniteFloat | None = None
    damping: NotNegative = 0.0
    force: FiniteFloat = 0.0
    force_hz: NotNegative = 0.0
    force_deg: FiniteFloat = 0.0


class WallTable(Table):
    """[wall] or [[wall]]."""

    x: FiniteFloat = 0.0


class RodsHead(Table):
    """[scene] of kind "rods"; gravity > 0 pulls towards -x."""

    kind: Literal["rods"]
    t_end: Positive
    gravity: FiniteFloat = 0.0


def _listed(value: object) -> object:
    return [value] if isinstance(value, dict) else value


class RodsFile(Table):
    """A scene of rods, masses and walls on one axis."""

    scene: RodsHead
    rod: list[RodTable] = Field(default_factory=list)
    mass: list[MassTable] = Field(default_factory=list)
    wall: Annotated[list[WallTable], BeforeValidator(_listed)] = Field(default_factory=list)
    scheme: SchemeTable
    record: RecordTable | None = None


class RimHead(RunHead):
    """[scene] of kind "rim"."""

    kind: Literal["rim"]


class CasingTable(Table):
    """[casing]: modal basis file of kind "rim", relative to the scene file; `scatter` detunes its modes at random."""

    basis: str
    scatter: Annotated[FiniteFloat, Field(ge=0, le=0.2)] = 0.0
    seed: Annotated[int, Field(ge=0)] = 0


class BladeTable(Table):
    """[blade]: modal basis file of kind "point" with channels span and flap; lean in degrees; `freq_hz` retunes it."""

    basis: str
    freq_hz: Positive | None = None
    lean_deg: Annotated[FiniteFloat, Field(gt=-90, lt=90)] = 0.0


class RimContact(Roundness):
    """[contact] of a rim: clearance [m], friction coefficient, out-of-roundness."""

    clearance: FiniteFloat
    friction: Friction = 0.0
    angle_deg: FiniteFloat = 0.0


class SpeedTable(Table):
    """[speed]: turns per second; `scan` the speeds of a growth map."""

    hz: FiniteFloat
    scan: ScanTable | None = None


class RimScheme(Table):
    """[scheme] of a rim: exact-modal."""

    kind: Literal["exact-modal"]
    law: Literal["auto", "forward", "averaged"] = "auto"
    dt: Positive


class RimFile(Table):
    """A rotating casing rim against one fixed blade."""

    scene: RimHead
    casing: CasingTable
    blade: BladeTable
    contact: RimContact
    coating: CoatingTable | None = None
    speed: SpeedTable
    scheme: RimScheme
    record: RecordTable | None = None


class BeamHead(Table):
    """[scene] of kind "beam"."""

    kind: Literal["beam"]
    t_end: Positive


class BeamTable(Table):
    """[beam]: the fields of `HingedBeam`."""

    length: Positive
    width: Positive
    height: Positive
    E: Positive
    rho: Positive
    elements: Annotated[int, Field(ge=1)] = 40
    torque: FiniteFloat = 0.0
    angle_deg: FiniteFloat = 0.0
    spin: FiniteFloat = 0.0


class CircleTable(Table):
    """[circle]: radius and offset of its centre from the hinge [m]."""

    radius: Positive
    offset: NotNegative = 0.0


class RingTable(Table):
    """[ring]: an elastic ring in place of the rigid circle: the section of `ThinRing`, or a modal basis file."""

    basis: str | None = None
    width: Positive | None = None
    height: Positive | None = None
    E: Positive | None = None
    rho: Positive | None = None
    k_r: NotNegative = 0.0
    k_t: NotNegative = 0.0
    zeta: NotNegative = 0.0
    n_max: Annotated[int, Field(ge=1, le=200)] = 20

    @model_validator(mode="after")
    def _whole(self) -> RingTable:
        given = [name for name in ("width", "height", "E", "rho") if getattr(self, name) is not None]
        if (self.basis is None) != (len(given) == 4) or (self.basis is not None and given):
            raise ValueError(
                f"{', '.join(given) or 'nothing'} found, expected a basis, or all of width, height, E, rho"
            )
        return self


class BeamFile(Table):
    """A hinged beam in an eccentric circle, rigid or an elastic ring."""

    scene: BeamHead
    beam: BeamTable
    circle: CircleTable
    ring: RingTable | None = None
    scheme: SchemeTable
    record: RecordTable | None = None


class CantileverHead(Table):
    """[scene] of kind "cantilever"."""

    kind: Literal["cantilever"]
    t_end: Positive


class CantileverTable(Table):
    """[beam] of a cantilever: the fields of `Cantilever`, a line load [N/m] and a velocity [m/s] towards the stop."""

    length: Positive
    width: Positive
    height: Positive
    E: Positive
    rho: Positive
    zeta: Annotated[FiniteFloat, Field(ge=0, lt=1)] = 0.0
    load: FiniteFloat = 0.0
    velocity: FiniteFloat = 0.0


class StopTable(Table):
    """[stop]: its distance from the tip of the straight beam [m]."""

    clearance: NotNegative


class CantileverFile(Table):
    """A clamped beam whose tip meets a stop."""

    scene: CantileverHead
    beam: CantileverTable
    stop: StopTable
    scheme: SchemeTable
    record: RecordTable | None = None

    @model_validator(mode="after")
    def _modal(self) -> CantileverFile:
        if self.scheme.kind != "exact-modal":
            raise ValueError(f"scheme.kind {self.scheme.kind!r} found, expected 'exact-modal'")
        return self


class PairHead(Table):
    """[scene] of kind "pair"."""

    kind: Literal["pair"]


class BladeModeTable(Table):
    """[blade] of a pair: one mode, its mass [kg] for unit motion along the contact's normal."""

    freq_hz: Positive
    modal_mass: Positive
    zeta: Annotated[NotNegative, Field(lt=1)] = 0.0


class CasingPairTable(BladeModeTable):
    """[casing] of a pair: n nodal diameters, and what a blade mode has."""

    n: Annotated[int, Field(ge=1)]


class PairContact(Table):
    """[contact] of a pair: stiffness [N/m] or compliance [m/N], friction, lean of the blade into the motion."""

    stiffness: Positive | None = None
    compliance: Positive | None = None
    friction: NotNegative = 0.0
    lean_deg: Annotated[FiniteFloat, Field(gt=-90, lt=90)] = 0.0

    @model_validator(mode="after")
    def _one_of_both(self) -> PairContact:
        if (self.stiffness is None) == (self.compliance is None):
            found = "neither stiffness nor compliance" if self.stiffness is None else "stiffness and compliance both"
            raise ValueError(f"{found} given, expected one of them")
        return self


class PairFile(Table):
    """One casing pair against one blade mode, contact closed: for `casingfem stability`."""

    scene: PairHead
    casing: CasingPairTable
    blade: BladeModeTable
    contact: PairContact
    speed: ScanTable


File = RodsFile | RimFile | RubFile | DiskFile | BeamFile | CantileverFile | PatchFile | PairFile
FILES: dict[str, type[File]] = {
    "rods": RodsFile, "rim": RimFile, "rub": RubFile, "disk": DiskFile, "beam": BeamFile, "cantilever": CantileverFile,
    "patch": PatchFile, "pair": PairFile,
}  # fmt: skip
