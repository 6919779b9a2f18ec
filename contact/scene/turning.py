"""Scene files for `casingfem cycles` of a rotating rim: the tables of its bodies, and a range instead of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, FiniteFloat, model_validator

from contact.base.arrays import MANY
from contact.io.tables import Number, Positive
from contact.scene.laws import CoatingTable, SpringLaw, require_one
from contact.scene.parts import radius_of
from contact.scene.rim import BladeTable, CasingTable, DiskCasingTable, DiskTable, RimContact
from contact.scene.roundness import GapTable
from contact.scene.rub import RubBlade, RubCasing, RubContact, RubWhirl
from contact.scene.scheme import CheckedFile, Friction, Gap, Table, TurnsPerSecond
from contact.scene.turns import MEANING, Side

TWO = Field(min_length=2, max_length=2)


class ContinuationTable(Table):
    """[continuation]: longest step, most points, evaluations of the gaps in a period, doublings, channels shown."""

    longest_step: Annotated[FiniteFloat, Field(ge=1e-6, le=1)] = Field(
        default=0.02, description="longest step, as a part of the parameter's range [-]"
    )
    most_points: Annotated[int, Field(ge=2, le=MANY)] = Field(
        default=1000, description="largest number of points of a branch"
    )
    looks: Annotated[int, Field(ge=8)] | None = Field(
        default=None, description="number of evaluations of the gaps in a period"
    )
    doublings: Annotated[int, Field(ge=0)] = Field(
        default=0, description="number of period doublings that are followed"
    )
    channels: list[str] = Field(
        default_factory=list, description="channels whose amplitudes are shown; all if left out"
    )


class BasinsTable(Table):
    """[basins]: runs from random starts at one value of the parameter, to find the motions that they reach."""

    at: Number = Field(description="value of the parameter, within the range [unit of the parameter]")
    starts: Annotated[int, Field(ge=1, le=100_000)] = Field(default=100, description="number of runs")
    seed: Annotated[int, Field(ge=0)] = Field(description="seed of the random initial states")
    spread: Annotated[Positive, Field(le=1e3)] = Field(
        default=1.0, description="deviation of the initial states, relative to the states of the orbits there [-]"
    )
    settle: Annotated[int, Field(ge=1)] = Field(default=300, description="number of periods of each run")


class SpeedRange(Table):
    """[speed] of a rim: first and last speed [Hz], or a single one if another parameter is varied."""

    from_hz: TurnsPerSecond | None = Field(default=None, description="first speed [turns/s]")
    to_hz: TurnsPerSecond | None = Field(default=None, description="last speed [turns/s]")
    hz: TurnsPerSecond | None = Field(
        default=None, description="speed of rotation, if [vary] names another parameter [turns/s]"
    )
    turning: Side | None = Field(default=None, description=MEANING)

    @model_validator(mode="after")
    def _one_sense(self) -> SpeedRange:
        given = self.from_hz, self.to_hz, self.hz
        if self.from_hz is not None and self.to_hz is not None and self.hz is None:
            if not self.from_hz * self.to_hz > 0.0 or self.from_hz == self.to_hz:
                expected = "two different speeds of one sense"
                raise ValueError(f"from_hz = {self.from_hz:g} and to_hz = {self.to_hz:g} found, expected {expected}")
        elif not self.hz or given[:2] != (None, None):
            found = ", ".join(name for name, one in zip(("from_hz", "to_hz", "hz"), given, strict=True) if one)
            raise ValueError(f"{found or 'nothing'} found, expected from_hz and to_hz, or hz with [vary]")
        return self


class VaryTable(Table):
    """[vary] of a rim: first and last clearance [m], or first and last coefficient of friction."""

    clearance: Annotated[list[Gap], TWO] | None = Field(default=None, description="first and last clearance [m]")
    friction: Annotated[list[Friction], TWO] | None = Field(
        default=None, description="first and last coefficient of friction [-]"
    )

    @model_validator(mode="after")
    def _one_range(self) -> VaryTable:
        if (self.clearance is None) == (self.friction is None) or len(set(self.between)) < 2:
            raise ValueError("expected one of clearance and friction with two different ends")
        return self

    @property
    def between(self) -> tuple[float, float]:
        """First and last value of the parameter."""
        first, last = self.clearance or self.friction or (0.0, 0.0)
        return first, last


class TurningHead(Table):
    """[scene] of a rim or a rub: only the kind, since there is no end time."""

    kind: Literal["rim", "rub", "disk"] = Field(description="kind of scene")


class TurningFile(CheckedFile):
    """Tables that scenes with a rotating rim share: the range, the coating, settings of the continuation."""

    scene: TurningHead = Field(description="kind of the scene and end of the run")
    coating: CoatingTable | None = Field(default=None, description="compliant coating of the rim, without wear")
    law: SpringLaw | None = Field(default=None, description="spring at each tip, instead of a coating")
    speed: SpeedRange = Field(description="range of speeds, or the speed")
    vary: VaryTable | None = Field(default=None, description="parameter that is varied instead of the speed")
    continuation: ContinuationTable = Field(
        default_factory=ContinuationTable, description="settings of the continuation of branches"
    )
    basins: BasinsTable | None = Field(default=None, description="motions that are reached from random initial states")

    @model_validator(mode="after")
    def _one_parameter(self) -> TurningFile:
        if (self.vary is None) == (self.speed.hz is not None):
            found = "a range of speeds with" if self.speed.hz is None else "speed.hz without"
            raise ValueError(f"{found} [vary] found, expected speed.from_hz and speed.to_hz, or speed.hz with [vary]")
        if self.continuation.channels:
            raise ValueError(
                "continuation.channels found with a rim, expected none: the channels are casing, span and flap"
            )
        if self.coating is not None and self.coating.machined > 0.0:
            raise ValueError(
                "coating.machined found, expected 0: give the machined profile as contact.out_of_roundness"
            )
        require_one(self.law, self.coating)
        if self.law is not None and self.law.damping > 0.0:
            raise ValueError("law.damping found, expected 0 for periodic motions: simulate with casingfem rub")
        return self


class RimCyclesFile(TurningFile):
    """A rotating rim against its blade."""

    casing: CasingTable = Field(description="casing, by its rim")
    blade: BladeTable = Field(description="blade")
    contact: RimContact = Field(description="gap between tips and rim")

    def radius(self, folder: Path) -> float:
        """Radius of the rotating rim [m]; 0 if unknown."""
        return radius_of(folder / self.casing.basis)


class RubCyclesFile(TurningFile):
    """Blades at a rotating rim, each tip in one or more places, sliding along the rim."""

    casing: RubCasing = Field(description="casing, by its rim")
    blade: Annotated[list[RubBlade], Field(min_length=1)] = Field(description="tables [[blade]]: blades")
    contact: RubContact = Field(description="gap between tips and rim")
    whirl: list[RubWhirl] = Field(default_factory=list, description="tables [[whirl]]: circular motions of a centre")

    def radius(self, folder: Path) -> float:
        """Radius of the rotating rim [m]; 0 if unknown."""
        return radius_of(folder / self.casing.basis)


class DiskCyclesFile(TurningFile):
    """A disk of blades at a rotating rim."""

    casing: DiskCasingTable = Field(description="casing, by its rim")
    disk: DiskTable = Field(description="bladed disk")
    contact: GapTable = Field(description="gap between tips and rim")

    def radius(self, folder: Path) -> float:
        """Radius of the rotating rim [m]; 0 if unknown."""
        return self.casing.radius(folder)


TURNING: dict[str, type[TurningFile]] = {"rim": RimCyclesFile, "rub": RubCyclesFile, "disk": DiskCyclesFile}
