"""Scene files for `casingfem cycles`: a modal body and a harmonic force, or a rim and its blade; what is varied."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, cast

from pydantic import Field, FiniteFloat, ValidationError, model_validator

from contact.base.errors import InputError
from contact.growth.cycles.driven import DrivenBody, ForcedFamily, Parameter
from contact.growth.cycles.follow import Progress, follow
from contact.growth.cycles.result import Cycles
from contact.growth.cycles.rubbing import RimFamily
from contact.io.toml import entries
from contact.model.bodies.patch import Patch
from contact.model.gaps.gap import RotatingRim
from contact.scene.load import SceneError, problem_text, scene_data, scene_of
from contact.scene.patch import GroundTable, PatchBodyTable
from contact.scene.scheme import Positive, Table, Unit
from contact.scene.tables import BladeTable, CasingTable, RimContact


class CyclesHead(Table):
    """[scene] of periodic solutions: the kind alone, for nothing ends."""

    kind: Literal["patch"] = Field(description="which kind of scene this is")


class CyclesContact(Table):
    """[[contact]]: normal, tangent and its slide [m/s], clearance [m]; an obstacle's stiffness [N/m], or rebound."""

    normal: str = Field(description="channel along the normal")
    tangent: str | None = Field(default=None, description="channel along the tangent")
    slide: FiniteFloat = Field(default=0.0, description="velocity of the ground along the tangent [m/s]")
    clearance: FiniteFloat = Field(default=0.0, description="gap at rest [m]")
    stiffness: Positive | None = Field(default=None, description="of an elastic obstacle [N/m]; rigid if left out")
    restitution: Unit = Field(default=0.0, description="speed after an impact over that before [-]")


class DriveTable(Table):
    """[drive]: force amplitude [N] cos at a channel; over from_hz .. to_hz, or freq_hz and from_n .. to_n of force."""

    channel: str = Field(description="where the harmonic force acts")
    amplitude: Positive | None = Field(default=None, description="of the force [N]")
    freq_hz: Positive | None = Field(default=None, description="of the force [Hz], where its amplitude is varied")
    from_hz: Positive | None = Field(default=None, description="first frequency [Hz]")
    to_hz: Positive | None = Field(default=None, description="last frequency [Hz]")
    from_n: Positive | None = Field(default=None, description="first amplitude of the force [N]")
    to_n: Positive | None = Field(default=None, description="last amplitude [N]")

    @model_validator(mode="after")
    def _one_range(self) -> DriveTable:
        given = {name for name in self.model_fields_set if getattr(self, name) is not None} - {"channel"}
        if given not in ({"amplitude", "from_hz", "to_hz"}, {"freq_hz", "from_n", "to_n"}):
            found = ", ".join(sorted(given)) or "nothing"
            raise ValueError(f"{found} found, expected amplitude, from_hz and to_hz, or freq_hz, from_n and to_n")
        if self.from_hz == self.to_hz and self.from_n == self.to_n:
            raise ValueError("a range without length found, expected two different ends")
        return self

    @property
    def parameter(self) -> Parameter:
        """What is varied."""
        return "freq_hz" if self.from_hz is not None else "amplitude"

    @property
    def between(self) -> tuple[float, float]:
        """From where to where."""
        start, stop = (self.from_hz, self.to_hz) if self.from_hz is not None else (self.from_n, self.to_n)
        return start or 0.0, stop or 0.0  # the table has one of both ranges


class ContinuationTable(Table):
    """[continuation]: longest step, most points, looks at gaps in a period, doublings followed, channels shown."""

    longest_step: Annotated[FiniteFloat, Field(gt=0, le=1)] = Field(
        default=0.02, description="of the parameter's range [-]"
    )
    most_points: Annotated[int, Field(ge=2)] = Field(default=1000, description="points of a branch at most")
    looks: Annotated[int, Field(ge=8)] | None = Field(default=None, description="looks at the gaps in a period")
    doublings: Annotated[int, Field(ge=0)] = Field(default=0, description="period doublings that are followed")
    channels: list[str] = Field(
        default_factory=list, description="channels whose amplitudes are shown; all if left out"
    )


class CyclesFile(Table):
    """A modal body under a harmonic force before contacts."""

    scene: CyclesHead = Field(description="what this scene is")
    body: PatchBodyTable = Field(description="the body")
    contact: Annotated[list[CyclesContact], Field(min_length=1)] = Field(description="tables [[contact]]")
    ground: GroundTable = Field(default_factory=GroundTable, description="the rigid ground")
    drive: DriveTable = Field(description="the harmonic force and what is varied")
    continuation: ContinuationTable = Field(default_factory=ContinuationTable, description="how branches are followed")

    @model_validator(mode="after")
    def _alike(self) -> CyclesFile:
        if len({contact.tangent is None for contact in self.contact}) > 1:
            raise ValueError("contacts with and without tangent found, expected a tangent in all or none")
        return self

    def driven(self, folder: Path) -> DrivenBody:
        """The body and its force; a basis file is found in `folder`. Raises InputError."""
        body, contacts, drive = self.body.modes(folder), self.contact, self.drive
        patch = Patch(
            body=body, normal=tuple(contact.normal for contact in contacts),
            tangent=tuple((contact.tangent,) for contact in contacts if contact.tangent is not None),
            slide=[[contact.slide] for contact in contacts], clearance=[contact.clearance for contact in contacts],
            displacement=self.body.displacement,
            velocity=self.body.velocity, load=self.body.modal_load(body),
        )  # fmt: skip
        return DrivenBody(
            patch=patch, channel=drive.channel, amplitude=drive.amplitude or drive.between[0],
            stiffness=[contact.stiffness or math.inf for contact in contacts],
            restitution=[contact.restitution for contact in contacts], mu=self.ground.friction,
            shown=tuple(self.continuation.channels),
        )  # fmt: skip


class SpeedRange(Table):
    """[speed] of a rim: from where to where [Hz]."""

    from_hz: FiniteFloat = Field(description="first speed [turns/s]")
    to_hz: FiniteFloat = Field(description="last speed [turns/s]")

    @model_validator(mode="after")
    def _one_sense(self) -> SpeedRange:
        if not self.from_hz * self.to_hz > 0.0 or self.from_hz == self.to_hz:
            raise ValueError(f"{self.from_hz:g} to {self.to_hz:g} found, expected two different speeds of one sense")
        return self


class RimCyclesHead(Table):
    """[scene] of a rim: the kind alone."""

    kind: Literal["rim"] = Field(description="which kind of scene this is")


class RimCyclesFile(Table):
    """A turning rim against its blade, over speed."""

    scene: RimCyclesHead = Field(description="what this scene is")
    casing: CasingTable = Field(description="the rim")
    blade: BladeTable = Field(description="the blade")
    contact: RimContact = Field(description="the gap")
    speed: SpeedRange = Field(description="range of speeds")
    continuation: ContinuationTable = Field(default_factory=ContinuationTable, description="how branches are followed")


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class CyclesScene:
    """What is followed, from where to where, and how."""

    family: ForcedFamily | RimFamily
    between: tuple[float, float]
    how: ContinuationTable

    def solve(self, progress: Progress | None = None) -> Cycles:
        """The branches."""
        how = self.how
        return follow(
            self.family, self.between, longest=how.longest_step, most=how.most_points, doublings=how.doublings,
            progress=progress,
        )  # fmt: skip


def load_cycles(path: str | Path) -> CyclesScene:
    """Read a scene of kind "patch" with [drive], or of kind "rim" with a range of speed.

    Raises SceneError, which lists every problem with file, key, what was found and what is expected.
    """
    file = Path(path)
    data, _ = scene_data(file)
    rim = entries(data.get("scene")).get("kind") == "rim"
    model = RimCyclesFile if rim else CyclesFile
    try:
        return _rim(data, file) if rim else _driven(CyclesFile.model_validate(data), file)
    except ValidationError as error:
        raise SceneError([problem_text(file, detail, data, model) for detail in error.errors()]) from error
    except SceneError:
        raise
    except InputError as error:
        raise SceneError([f"{file}: {error}"]) from error


def _driven(table: CyclesFile, file: Path) -> CyclesScene:
    drive = table.drive
    about = drive.freq_hz or 0.5 * sum(drive.between)
    family = table.driven(file.parent).over(drive.parameter, freq_hz=about, looks=table.continuation.looks)
    return CyclesScene(family=family, between=drive.between, how=table.continuation)


def _rim(data: dict[str, Any], file: Path) -> CyclesScene:
    """The bodies as a run has them, without its time."""
    table = RimCyclesFile.model_validate(data)
    if table.continuation.channels:
        raise InputError("continuation.channels: found with a rim, which shows casing, span and flap")
    between, how = (table.speed.from_hz, table.speed.to_hz), table.continuation
    still = {key: data[key] for key in ("scene", "casing", "blade", "contact")}
    run = scene_of(
        {**still, "scene": {**still["scene"], "t_end": 1.0}, "speed": {"hz": between[0]},
         "scheme": {"kind": "exact-modal", "dt": 1.0}}, file,
    )  # fmt: skip
    rim = cast(RotatingRim, run.what)
    return CyclesScene(
        family=RimFamily(rim=rim, mu=run.law.mu if run.law else 0.0, looks=how.looks), between=between, how=how
    )
