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

    length: Positive = Field(description="length [m]")
    area: Positive = Field(description="cross-section [m^2]")
    E: Positive = Field(description="Young's modulus [Pa]")
    rho: Positive = Field(description="density [kg/m^3]")
    elements: Annotated[int, Field(ge=1)] = Field(default=100, description="number of elements")
    x: FiniteFloat = Field(default=0.0, description="left end at t = 0 [m]")
    velocity: FiniteFloat = Field(default=0.0, description="at t = 0 [m/s]")
    fixed: Literal["none", "left", "right"] = Field(default="none", description="which end is held")
    end_mass: NotNegative = Field(default=0.0, description="at the end that faces its neighbour [kg]")
    damping: NotNegative = Field(default=0.0, description="of its mass [1/s]")


class MassTable(Table):
    """[[mass]]: the fields of `PointMass`."""

    mass: Positive = Field(description="mass [kg]")
    x: FiniteFloat = Field(default=0.0, description="place at t = 0 [m]")
    velocity: FiniteFloat = Field(default=0.0, description="at t = 0 [m/s]")
    stiffness: NotNegative = Field(default=0.0, description="of a spring to the ground [N/m]")
    anchor: FiniteFloat | None = Field(
        default=None, description="where that spring is without force [m]; x if left out"
    )
    damping: NotNegative = Field(default=0.0, description="of a dashpot to the ground [N s/m]")
    force: FiniteFloat = Field(default=0.0, description="amplitude of a harmonic force [N]")
    force_hz: NotNegative = Field(default=0.0, description="its frequency [Hz]")
    force_deg: FiniteFloat = Field(default=0.0, description="its phase [degrees]")


class WallTable(Table):
    """[wall] or [[wall]]."""

    x: FiniteFloat = Field(default=0.0, description="where it stands [m]")


class RodsHead(Table):
    """[scene] of kind "rods"; gravity > 0 pulls towards -x."""

    kind: Literal["rods"] = Field(description="which kind of scene this is")
    t_end: Positive = Field(description="time at which the run ends [s]")
    gravity: FiniteFloat = Field(default=0.0, description="towards -x [m/s^2]")


def _listed(value: object) -> object:
    return [value] if isinstance(value, dict) else value


class RodsFile(Table):
    """A scene of rods, masses and walls on one axis."""

    scene: RodsHead = Field(description="what this scene is")
    rod: list[RodTable] = Field(default_factory=list, description="tables [[rod]]")
    mass: list[MassTable] = Field(default_factory=list, description="tables [[mass]]")
    wall: Annotated[list[WallTable], BeforeValidator(_listed)] = Field(
        default_factory=list, description="a table [wall], or several [[wall]]"
    )
    scheme: SchemeTable = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="what is stored; every step if left out")


class RimHead(RunHead):
    """[scene] of kind "rim"."""

    kind: Literal["rim"] = Field(description="which kind of scene this is")


class CasingTable(Table):
    """[casing]: modal basis file of kind "rim", relative to the scene file; `scatter` detunes its modes at random."""

    basis: str = Field(description="modal basis of kind rim, npz, relative to this file")
    scatter: Annotated[FiniteFloat, Field(ge=0, le=0.2)] = Field(
        default=0.0, description="standard deviation of a random relative detuning of its modes [-]"
    )
    seed: Annotated[int, Field(ge=0)] = Field(default=0, description="of that detuning")


class BladeTable(Table):
    """[blade]: modal basis file of kind "point" with channels span and flap; lean in degrees; `freq_hz` retunes it."""

    basis: str = Field(description="modal basis of kind point, with channels span and flap, relative to this file")
    freq_hz: Positive | None = Field(
        default=None, description="first frequency it is tuned to [Hz]; as it is if left out"
    )
    lean_deg: Annotated[FiniteFloat, Field(gt=-90, lt=90)] = Field(
        default=0.0, description="lean from the radius, into the motion [degrees]"
    )


class RimContact(Roundness):
    """[contact] of a rim: clearance [m], friction coefficient, out-of-roundness."""

    clearance: FiniteFloat = Field(description="between tip and round rim at rest [m]")
    friction: Friction = Field(default=0.0, description="coefficient of Coulomb friction [-]")
    angle_deg: FiniteFloat = Field(default=0.0, description="where the blade stands [degrees]")


class SpeedTable(Table):
    """[speed]: turns per second; `scan` the speeds of a growth map."""

    hz: FiniteFloat = Field(description="speed of the casing [turns/s]")
    scan: ScanTable | None = Field(default=None, description="speeds that stability and interactions look at")


class RimScheme(Table):
    """[scheme] of a rim: exact-modal."""

    kind: Literal["exact-modal"] = Field(description="the method")
    law: Literal["auto", "forward", "averaged"] = Field(
        default="auto", description="how contact is enforced in a step; auto by the model's compliance"
    )
    dt: Positive = Field(description="time step [s]")


class RimFile(Table):
    """A rotating casing rim against one fixed blade."""

    scene: RimHead = Field(description="what this scene is")
    casing: CasingTable = Field(description="the rim")
    blade: BladeTable = Field(description="the blade")
    contact: RimContact = Field(description="the gap")
    coating: CoatingTable | None = Field(default=None, description="an abradable coating of the rim")
    speed: SpeedTable = Field(description="how fast the casing turns")
    scheme: RimScheme = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="what is stored")


class BeamHead(Table):
    """[scene] of kind "beam"."""

    kind: Literal["beam"] = Field(description="which kind of scene this is")
    t_end: Positive = Field(description="time at which the run ends [s]")


class BeamTable(Table):
    """[beam]: the fields of `HingedBeam`."""

    length: Positive = Field(description="length [m]")
    width: Positive = Field(description="width of the section [m]")
    height: Positive = Field(description="height of the section in the plane of motion [m]")
    E: Positive = Field(description="Young's modulus [Pa]")
    rho: Positive = Field(description="density [kg/m^3]")
    elements: Annotated[int, Field(ge=1)] = Field(default=40, description="number of elements")
    torque: FiniteFloat = Field(default=0.0, description="on the hinge [N m]")
    angle_deg: FiniteFloat = Field(default=0.0, description="angle at t = 0 [degrees]")
    spin: FiniteFloat = Field(default=0.0, description="rate of turning at t = 0 [rad/s]")


class CircleTable(Table):
    """[circle]: radius and offset of its centre from the hinge [m]."""

    radius: Positive = Field(description="radius [m]")
    offset: NotNegative = Field(default=0.0, description="of its centre from the hinge [m]")


class RingTable(Table):
    """[ring]: an elastic ring in place of the rigid circle: the section of `ThinRing`, or a modal basis file."""

    basis: str | None = Field(default=None, description="modal basis of kind rim, npz, instead of a section")
    width: Positive | None = Field(default=None, description="width of the section along the axis [m]")
    height: Positive | None = Field(default=None, description="height of the section along the radius [m]")
    E: Positive | None = Field(default=None, description="Young's modulus [Pa]")
    rho: Positive | None = Field(default=None, description="density [kg/m^3]")
    k_r: NotNegative = Field(default=0.0, description="radial springs around [N/m^2]")
    k_t: NotNegative = Field(default=0.0, description="tangential springs around [N/m^2]")
    zeta: NotNegative = Field(default=0.0, description="damping ratio of all modes [-]")
    n_max: Annotated[int, Field(ge=1, le=200)] = Field(default=20, description="highest number of nodal diameters")

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

    scene: BeamHead = Field(description="what this scene is")
    beam: BeamTable = Field(description="the beam")
    circle: CircleTable = Field(description="the circle")
    ring: RingTable | None = Field(default=None, description="an elastic ring instead of a rigid circle")
    scheme: SchemeTable = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="what is stored")


class CantileverHead(Table):
    """[scene] of kind "cantilever"."""

    kind: Literal["cantilever"] = Field(description="which kind of scene this is")
    t_end: Positive = Field(description="time at which the run ends [s]")


class CantileverTable(Table):
    """[beam] of a cantilever: the fields of `Cantilever`, a line load [N/m] and a velocity [m/s] towards the stop."""

    length: Positive = Field(description="length [m]")
    width: Positive = Field(description="width of the section [m]")
    height: Positive = Field(description="height of the section in the plane of motion [m]")
    E: Positive = Field(description="Young's modulus [Pa]")
    rho: Positive = Field(description="density [kg/m^3]")
    zeta: Annotated[FiniteFloat, Field(ge=0, lt=1)] = Field(default=0.0, description="damping ratio of all modes [-]")
    load: FiniteFloat = Field(default=0.0, description="line load towards the stop [N/m]")
    velocity: FiniteFloat = Field(default=0.0, description="of all of it at t = 0, towards the stop [m/s]")


class StopTable(Table):
    """[stop]: its distance from the tip of the straight beam [m]."""

    clearance: NotNegative = Field(description="from the tip of the straight beam [m]")


class CantileverFile(Table):
    """A clamped beam whose tip meets a stop."""

    scene: CantileverHead = Field(description="what this scene is")
    beam: CantileverTable = Field(description="the beam")
    stop: StopTable = Field(description="the stop")
    scheme: SchemeTable = Field(description="method and time step")
    record: RecordTable | None = Field(default=None, description="what is stored")

    @model_validator(mode="after")
    def _modal(self) -> CantileverFile:
        if self.scheme.kind != "exact-modal":
            raise ValueError(f"scheme.kind {self.scheme.kind!r} found, expected 'exact-modal'")
        return self


class PairHead(Table):
    """[scene] of kind "pair"."""

    kind: Literal["pair"] = Field(description="which kind of scene this is")


class BladeModeTable(Table):
    """[blade] of a pair: one mode, its mass [kg] for unit motion along the contact's normal."""

    freq_hz: Positive = Field(description="frequency [Hz]")
    modal_mass: Positive = Field(description="for unit motion along the contact's normal [kg]")
    zeta: Annotated[NotNegative, Field(lt=1)] = Field(default=0.0, description="damping ratio [-]")


class CasingPairTable(BladeModeTable):
    """[casing] of a pair: n nodal diameters, and what a blade mode has."""

    n: Annotated[int, Field(ge=1)] = Field(description="number of nodal diameters")


class PairContact(Table):
    """[contact] of a pair: stiffness [N/m] or compliance [m/N], friction, lean of the blade into the motion."""

    stiffness: Positive | None = Field(default=None, description="of the contact [N/m]")
    compliance: Positive | None = Field(default=None, description="of the contact [m/N], instead of its stiffness")
    friction: NotNegative = Field(default=0.0, description="coefficient of Coulomb friction [-]")
    lean_deg: Annotated[FiniteFloat, Field(gt=-90, lt=90)] = Field(
        default=0.0, description="lean of the blade into the motion [degrees]"
    )

    @model_validator(mode="after")
    def _one_of_both(self) -> PairContact:
        if (self.stiffness is None) == (self.compliance is None):
            found = "neither stiffness nor compliance" if self.stiffness is None else "stiffness and compliance both"
            raise ValueError(f"{found} given, expected one of them")
        return self


class PairFile(Table):
    """One casing pair against one blade mode, contact closed: for `casingfem stability`."""

    scene: PairHead = Field(description="what this scene is")
    casing: CasingPairTable = Field(description="one pair of the casing")
    blade: BladeModeTable = Field(description="one mode of the blade")
    contact: PairContact = Field(description="what lies between")
    speed: ScanTable = Field(description="speeds looked at")


File = RodsFile | RimFile | RubFile | DiskFile | BeamFile | CantileverFile | PatchFile | PairFile
FILES: dict[str, type[File]] = {
    "rods": RodsFile, "rim": RimFile, "rub": RubFile, "disk": DiskFile, "beam": BeamFile, "cantilever": CantileverFile,
    "patch": PatchFile, "pair": PairFile,
}  # fmt: skip
