"""[scheme] of a scene of rods: its keys, and the law and scheme that they select."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, model_validator

from contact.io.plausible import CHECKS, FROM_ZERO, REACH, CheckName
from contact.io.tables import NotNegative, Positive
from contact.model.law import Law, Penalty, Unilateral
from contact.model.laws.augmented import AugmentedLagrangian
from contact.problem import What
from contact.resolved import MOST_STEPS
from contact.scene.turns import MEANING, Side
from contact.scheme.events.event_driven import EventDriven
from contact.scheme.linear.alpha import HHT, Newmark, StabilisedNewmark
from contact.scheme.linear.cd_lagrange import CDLagrange
from contact.scheme.linear.central_difference import CentralDifference
from contact.scheme.linear.massless_boundary import MasslessBoundary
from contact.scheme.linear.nonsmooth_alpha import MoreauJean, NonsmoothAlpha, ProjectedAlpha
from contact.scheme.linear.paoli_schatzman import PaoliSchatzman
from contact.scheme.linear.penalty_difference import PenaltyDifference
from contact.scheme.modal.exact_modal import ExactModal
from contact.scheme.protocol import Scheme

Built = tuple[What, Law, Scheme]  # of a scene: the problem, the law and the method
Count = Annotated[int, Field(ge=1)]
WAVES = 1000  # around a rim: with more, its points would be closer than a wall is thick
Friction = Annotated[NotNegative, CHECKS["friction"]]
Ratio = Annotated[FiniteFloat, Field(ge=0, lt=1), CHECKS["zeta"]]
Modulus = Annotated[Positive, CHECKS["E"]]
Density = Annotated[Positive, CHECKS["rho"]]
Size = Annotated[Positive, CHECKS["size"]]
Thickness = Annotated[Positive, CHECKS["thickness"]]
Gap = Annotated[FiniteFloat, CHECKS["clearance"]]
Deviation = Annotated[FiniteFloat, CHECKS["roundness"]]
TurnsPerSecond = Annotated[FiniteFloat, CHECKS["speed"]]
MOST_RPM = 600_000.0  # the smallest turbochargers turn half as fast
Rpm = Annotated[FiniteFloat, Field(ge=-MOST_RPM, le=MOST_RPM)]
Frequency = Annotated[Positive, CHECKS["frequency"]]
Mass = Annotated[Positive, CHECKS["mass"]]
Stiffness = Annotated[Positive, CHECKS["stiffness"]]
Compliance = Annotated[Positive, CHECKS["compliance"]]
Velocity = Annotated[FiniteFloat, CHECKS["velocity"]]
Force = Annotated[FiniteFloat, CHECKS["force"]]
Time = Annotated[Positive, CHECKS["time"]]
Instant = Annotated[NotNegative, FROM_ZERO["time"]]
Distance = Annotated[NotNegative, REACH]
Coordinate = Annotated[FiniteFloat, REACH]
Amplitude = Annotated[Positive, CHECKS["force"]]
Springs = Annotated[NotNegative, replace(FROM_ZERO["stiffness"], unit="N/m^2")]
Detuning = Annotated[FiniteFloat, Field(gt=-1, lt=1)]
Name = Annotated[str, Field(min_length=1)]  # of a file or a channel
Unit = Annotated[FiniteFloat, Field(ge=0, le=1)]
Kind = Literal[
    "forward-lagrange", "penalty", "newmark", "hht", "moreau-jean", "cd-lagrange", "paoli-schatzman",
    "massless-boundary", "stabilised-newmark", "nonsmooth-alpha", "projected-alpha", "exact-modal", "event-driven",
]  # fmt: skip
ModalLaw = Literal["auto", "forward", "averaged", "energy"]
ContactLaw = Literal["lagrange", "penalty", "augmented-lagrangian"]

SCHEMES: dict[str, tuple[type[Scheme], tuple[str, ...]]] = {
    "forward-lagrange": (CentralDifference, ()),
    "penalty": (PenaltyDifference, ()),
    "newmark": (Newmark, ("beta", "gamma")),
    "hht": (HHT, ("alpha",)),
    "moreau-jean": (MoreauJean, ("theta", "restitution")),
    "cd-lagrange": (CDLagrange, ("restitution",)),
    "paoli-schatzman": (PaoliSchatzman, ("restitution",)),
    "massless-boundary": (MasslessBoundary, ()),
    "stabilised-newmark": (StabilisedNewmark, ()),
    "nonsmooth-alpha": (NonsmoothAlpha, ("rho_inf", "restitution")),
    "projected-alpha": (ProjectedAlpha, ("rho_inf", "restitution")),
    "exact-modal": (ExactModal, ("law", "modes")),
    "event-driven": (EventDriven, ("modes", "restitution")),
}
MODAL = ("exact-modal", "event-driven")  # the motion of modes is exact for any step
OF_LAWS = {
    "newmark": ("law", "stiffness", "updates"),
    "hht": ("law", "stiffness", "updates"),
    "penalty": ("stiffness",),
    "event-driven": ("law", "stiffness"),
}


class Table(BaseModel):
    """A table of the file: unknown keys, inf and nan are errors; only whole numbers are converted, to float."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class ChecksTable(Table):
    """[checks]: implausible values that are intended."""

    allow: list[CheckName] = Field(
        default_factory=list, description="names of checks of plausibility that are not applied to this file"
    )


class CheckedFile(Table):
    """A file whose numbers must be plausible, except those that it allows."""

    checks: ChecksTable = Field(default_factory=ChecksTable, description="implausible values that are intended")

    def radius(self, folder: Path) -> float:
        """Radius of the rotating rim [m]; 0 if there is none or it is unknown."""
        return 0.0


class SceneFile(CheckedFile):
    """A scene that runs: its tables."""

    def files(self) -> list[str]:
        """Files that the scene uses, besides its own."""
        return []


class RunHead(Table):
    """[scene] with limits: the end of a run, and whether passing a limit is an error or a flag."""

    t_end: Time = Field(description="time at which the run ends [s]")
    on_limit: Literal["stop", "flag"] = Field(
        default="stop",
        description="end of a run that passes a limit of its model: as an error, or not at all, with a flag",
    )


class ScanTable(Table):
    """First and last speed [Hz] and number of speeds for `casingfem stability` and `interactions`."""

    from_hz: TurnsPerSecond = Field(description="first speed [turns/s]")
    to_hz: TurnsPerSecond = Field(description="last speed [turns/s]")
    steps: Annotated[int, Field(ge=2, le=1_000_000)] = Field(default=401, description="number of speeds")

    @model_validator(mode="after")
    def _ascends(self) -> ScanTable:
        if not self.from_hz < self.to_hz:
            raise ValueError(f"from_hz = {self.from_hz!r} and to_hz = {self.to_hz!r}, expected from_hz < to_hz")
        return self


class ModalScheme(Table):
    """[scheme] of a rotating rim: exact-modal."""

    kind: Literal["exact-modal"] = Field(description="method of time integration")
    law: Literal["auto", "forward", "averaged"] = Field(
        default="auto", description="enforcement of contact in a step; auto chooses by the compliance of the model"
    )
    dt: Time = Field(description="time step [s]")
    most_steps: Count = Field(default=MOST_STEPS, description="largest number of steps of a run")


def hz_of_rpm(data: Any) -> Any:
    """The keys of [speed] with rpm converted to hz; ValueError if both are given.

    >>> hz_of_rpm({"rpm": 300.0}), hz_of_rpm({"rpm": [0.0, 60.0]})["hz"]
    ({'rpm': 300.0, 'hz': 5.0}, [0.0, 1.0])
    """
    if not isinstance(data, dict) or "rpm" not in data:
        return data
    if "hz" in data:
        raise ValueError("hz and rpm both found, expected one of them")
    rpm = data["rpm"]
    if not all(isinstance(one, int | float) for one in (rpm if isinstance(rpm, list) else [rpm])):
        return data
    return data | {"hz": [one / 60.0 for one in rpm] if isinstance(rpm, list) else rpm / 60.0}


class SpeedTable(Table):
    """[speed]: turns per second, or per minute; `turning`: the side that rotates; `scan`: the speeds to examine."""

    hz: TurnsPerSecond = Field(description="speed of rotation, or rpm [turns/s]")
    rpm: Rpm | None = Field(default=None, description="speed of rotation, instead of hz [rpm]")
    turning: Side | None = Field(default=None, description=MEANING)
    scan: ScanTable | None = Field(default=None, description="range of speeds of stability and interactions")

    _hz = model_validator(mode="before")(hz_of_rpm)


class Waviness(Table):
    """One harmonic of the rim's radius [m], positive where the gap is larger."""

    p: Annotated[int, Field(ge=0, le=WAVES)] = Field(description="number of waves around")
    cos: Deviation = Field(default=0.0, description="amplitude of cos p theta [m]")
    sin: Deviation = Field(default=0.0, description="amplitude of sin p theta [m]")


class SchemeTable(Table):
    """[scheme]: kind and step; each kind has its own keys, listed in `SCHEMES` and `OF_LAWS`."""

    kind: Kind = Field(description="method of time integration")
    courant: Positive | None = Field(
        default=None, description="time step over the largest stable one [-], instead of dt"
    )
    dt: Positive | None = Field(default=None, description="time step [s]")
    most_steps: Count = Field(default=MOST_STEPS, description="largest number of steps of a run")
    stiffness: Positive | None = Field(
        default=None, description="stiffness of a penalty or an augmented Lagrangian [N/m]"
    )
    updates: Count | None = Field(
        default=None, description="largest number of updates of an augmented Lagrangian in a step"
    )
    modes: Count | None = Field(default=None, description="number of modes of a bar on a wall")
    law: ModalLaw | ContactLaw | None = Field(default=None, description="enforcement of contact in a step")
    beta: Positive | None = Field(default=None, description="Newmark's beta [-]")
    gamma: Positive | None = Field(default=None, description="Newmark's gamma [-]")
    alpha: FiniteFloat | None = Field(default=None, description="alpha of the HHT method [-], from -1/3 to 0")
    theta: Unit | None = Field(default=None, description="theta of the Moreau-Jean method [-], from 1/2 to 1")
    rho_inf: Unit | None = Field(default=None, description="spectral radius at high frequencies [-]")
    restitution: Unit | None = Field(
        default=None, description="coefficient of restitution, speed after an impact over that before [-]"
    )

    @model_validator(mode="after")
    def _fits(self) -> SchemeTable:
        if self.courant is not None and self.dt is not None:
            raise ValueError("courant and dt both given, expected one of them")
        if self.courant is None and self.dt is None and self.kind not in MODAL:
            raise ValueError("neither courant nor dt given, expected one of them")
        allowed = ("kind", "courant", "dt", "most_steps", *SCHEMES[self.kind][1], *OF_LAWS.get(self.kind, ()))
        for key in self.model_fields_set:
            if key not in allowed:
                raise ValueError(f"{key} found with kind = {self.kind!r}, expected {', '.join(allowed[1:])}")
        laws = get_args(ModalLaw if self.kind == "exact-modal" else ContactLaw)
        if self.law is not None and self.law not in laws:
            raise ValueError(f"law {self.law!r} found with kind = {self.kind!r}, expected {', '.join(laws)}")
        soft = self.kind == "penalty" or self.law in ("penalty", "augmented-lagrangian")
        if soft != (self.stiffness is not None):
            raise ValueError(
                f"stiffness {'missing' if soft else 'found'}, expected one in N/m with kind = 'penalty', law = "
                "'penalty' "
                "or law = 'augmented-lagrangian', and none otherwise"
            )
        return self

    def method(self) -> tuple[Law, Scheme]:
        """Law and scheme; raises InputError for values the scheme refuses."""
        kind, names = SCHEMES[self.kind]
        given = {name: getattr(self, name) for name in names if getattr(self, name) is not None}
        return self._contact_law(), kind(**given)

    def _contact_law(self) -> Law:
        if self.stiffness is None:
            return Unilateral()
        if self.law == "augmented-lagrangian":
            given = {} if self.updates is None else {"updates": self.updates}
            return AugmentedLagrangian(stiffness=self.stiffness, **given)
        return Penalty(stiffness=self.stiffness)
