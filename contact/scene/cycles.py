"""Scene files for `casingfem cycles`: a modal body with a harmonic force, or a rim and its blades; the varied key."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, cast

import numpy as np
from pydantic import Field, model_validator

from contact.base.errors import InputError
from contact.cycles.balance_check import Agreement, balance_check, require_series
from contact.cycles.basins import Basins, basins
from contact.cycles.driven import DrivenBody, ForcedFamily, Parameter
from contact.cycles.follow import Progress, follow
from contact.cycles.result import Cycles
from contact.cycles.rubbing import RimFamily
from contact.io.toml import entries
from contact.model.bodies.patch import Patch
from contact.model.law import Law
from contact.scene.load import scene_data, scene_of
from contact.scene.patch import GroundTable, PatchBodyTable
from contact.scene.plausible import require_plausible
from contact.scene.problems import SceneError, validated
from contact.scene.scheme import Amplitude, CheckedFile, Coordinate, Frequency, Name, Stiffness, Table, Unit, Velocity
from contact.scene.turning import TURNING, BasinsTable, ContinuationTable, TurningFile

if TYPE_CHECKING:
    from contact.cycles.rubbing import Parameter as RimParameter
    from contact.model.gaps.gap import RotatingRim
    from contact.model.gaps.rub import Rub

NEAR = 6  # orbits about a value, whose states show how large random starts are


class CyclesHead(Table):
    """[scene] of periodic solutions: only the kind, since there is no end time."""

    kind: Literal["patch"] = Field(description="kind of scene")


class CyclesContact(Table):
    """[[contact]]: normal, tangent and its slide [m/s], clearance [m]; an obstacle's stiffness [N/m], or rebound."""

    normal: Name = Field(description="channel along the normal")
    tangent: Name | None = Field(default=None, description="channel along the tangent")
    slide: Velocity = Field(default=0.0, description="velocity of the ground along the tangent [m/s]")
    clearance: Coordinate = Field(default=0.0, description="gap at rest [m]")
    stiffness: Stiffness | None = Field(
        default=None, description="stiffness of an elastic obstacle [N/m]; rigid if left out"
    )
    restitution: Unit = Field(
        default=0.0, description="coefficient of restitution, speed after an impact over that before [-]"
    )


class DriveTable(Table):
    """[drive]: force amplitude [N] cos at a channel; over from_hz .. to_hz, or freq_hz and from_n .. to_n of force."""

    channel: Name = Field(description="channel at which the harmonic force acts")
    amplitude: Amplitude | None = Field(default=None, description="amplitude of the force [N]")
    freq_hz: Frequency | None = Field(
        default=None, description="frequency of the force [Hz], if its amplitude is varied"
    )
    from_hz: Frequency | None = Field(default=None, description="first frequency [Hz]")
    to_hz: Frequency | None = Field(default=None, description="last frequency [Hz]")
    from_n: Amplitude | None = Field(default=None, description="first amplitude of the force [N]")
    to_n: Amplitude | None = Field(default=None, description="last amplitude of the force [N]")

    @model_validator(mode="after")
    def _one_range(self) -> DriveTable:
        given = {name for name in self.model_fields_set if getattr(self, name) is not None} - {"channel"}
        if given not in ({"amplitude", "from_hz", "to_hz"}, {"freq_hz", "from_n", "to_n"}):
            found = ", ".join(sorted(given)) or "nothing"
            raise ValueError(f"{found} found, expected amplitude, from_hz and to_hz, or freq_hz, from_n and to_n")
        if self.from_hz == self.to_hz and self.from_n == self.to_n:
            raise ValueError("two equal ends of the range found, expected different ends")
        return self

    @property
    def parameter(self) -> Parameter:
        """The varied parameter."""
        return "freq_hz" if self.from_hz is not None else "amplitude"

    @property
    def between(self) -> tuple[float, float]:
        """First and last value of the parameter."""
        start, stop = (self.from_hz, self.to_hz) if self.from_hz is not None else (self.from_n, self.to_n)
        return start or 0.0, stop or 0.0  # the table has one of both ranges


class CyclesFile(CheckedFile):
    """A modal body under a harmonic force, with contacts."""

    scene: CyclesHead = Field(description="kind of the scene and end of the run")
    body: PatchBodyTable = Field(description="elastic body")
    contact: Annotated[list[CyclesContact], Field(min_length=1)] = Field(
        description="tables [[contact]]: points of contact"
    )
    ground: GroundTable = Field(default_factory=GroundTable, description="rigid ground")
    drive: DriveTable = Field(description="harmonic force and varied parameter")
    continuation: ContinuationTable = Field(
        default_factory=ContinuationTable, description="settings of the continuation of branches"
    )
    basins: BasinsTable | None = Field(default=None, description="motions that are reached from random initial states")

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
            pressed=self.body.pressed(body, [contact.normal for contact in contacts]),
        )  # fmt: skip
        return DrivenBody(
            patch=patch, channel=drive.channel, amplitude=drive.amplitude or drive.between[0],
            stiffness=[contact.stiffness or math.inf for contact in contacts],
            restitution=[contact.restitution for contact in contacts], mu=self.ground.friction,
            shown=tuple(self.continuation.channels),
        )  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class CyclesScene:
    """A continuation: periodic motion, range and settings; random starts if requested."""

    family: ForcedFamily | RimFamily
    between: tuple[float, float]
    how: ContinuationTable
    ask: BasinsTable | None = None

    def solve(self, progress: Progress | None = None, checkpoint: str | Path | None = None) -> Cycles:
        """The branches; raises the errors of `follow`."""
        how = self.how
        return follow(
            self.family, self.between, longest=how.longest_step, most=how.most_points, doublings=how.doublings,
            checkpoint=checkpoint, progress=progress,
        )  # fmt: skip

    def require_check(self, harmonics: int) -> None:
        """Raise InputError if harmonic balance does not apply: at rigid contacts, or with too few harmonics."""
        require_series(self.family, self.between[0], harmonics)

    def checked(self, found: Cycles, harmonics: int) -> Agreement:
        """How far harmonic balance agrees with the orbits; raises as `require_check`."""
        return balance_check(self.family, found, harmonics=harmonics)

    def reached(self, found: Cycles, progress: Callable[[int], None] | None = None) -> Basins | None:
        """Motions reached from random starts, if requested; the starts have the size of the states of nearby orbits."""
        ask = self.ask
        if ask is None:
            return None
        points = [point for branch in found.branches for point in branch.points]
        near = sorted(points, key=lambda point: abs(point.value - ask.at))[:NEAR]
        size = ask.spread * np.max([np.abs(point.x) for point in near], axis=0)
        return basins(self.family, ask.at, size, starts=ask.starts, seed=ask.seed, settle=ask.settle, progress=progress)


def load_cycles(path: str | Path) -> CyclesScene:
    """Read a scene of kind "patch" with [drive], or of kind "rim", "rub" or "disk" with a range.

    Raises SceneError, which lists every problem with file, key, what was found and what is expected.

    >>> import contact as ct
    >>> scene = ct.scene.load_cycles("data/scenes/cycles/bouncing_ball.toml")
    >>> type(scene).__name__
    'CyclesScene'
    """
    file = Path(path)
    data, _ = scene_data(file)
    kind = str(entries(data.get("scene")).get("kind"))
    try:
        return _turning(data, file, TURNING[kind]) if kind in TURNING else _driven(data, file)
    except SceneError:
        raise
    except InputError as error:
        raise SceneError([f"{file}: {error}"]) from error


def _driven(data: dict[str, Any], file: Path) -> CyclesScene:
    table = validated(CyclesFile, data, file)
    require_plausible(table, file)
    drive = table.drive
    about = drive.freq_hz or 0.5 * sum(drive.between)
    family = table.driven(file.parent).over(drive.parameter, freq_hz=about, looks=table.continuation.looks)
    return CyclesScene(family=family, between=_asked(table.basins, drive.between), how=table.continuation,
                       ask=table.basins)  # fmt: skip


def _turning(data: dict[str, Any], file: Path, model: type[TurningFile]) -> CyclesScene:
    """The bodies of a run, without its time."""
    try:
        table = validated(model, data, file)
    except SceneError as error:
        if "scheme" not in data and "t_end" not in data["scene"]:
            raise
        remedy = "remove scene.t_end and [scheme], and give speed.from_hz and speed.to_hz"
        more = f"{file}: found a scene of a time simulation, expected one of periodic motions: {remedy}"
        raise SceneError([*error.problems, more]) from None
    require_plausible(table, file)
    speed, vary = table.speed, table.vary
    bodies = {key: part for key, part in data.items() if key not in ("vary", "continuation", "basins")}
    turns = {"hz": speed.hz or speed.from_hz} | ({} if speed.turning is None else {"turning": speed.turning})
    run = scene_of(
        {**bodies, "scene": {**data["scene"], "t_end": 1.0}, "speed": turns,
         "scheme": {"kind": "exact-modal", "dt": 1.0}}, file,
    )  # fmt: skip
    assert run.law is not None  # those of a rim and a rub
    between, name = (speed.from_hz or 0.0, speed.to_hz or 0.0), "speed_hz"
    if vary is not None:
        between, name = vary.between, "clearance" if vary.clearance is not None else "friction"
    family = RimFamily(
        rim=cast("RotatingRim | Rub", run.what), name=cast("RimParameter", name), mu=run.law.mu,
        stiffness=_under_tips(table, run.law), looks=table.continuation.looks,
    )  # fmt: skip
    return CyclesScene(family=family, between=_asked(table.basins, between), how=table.continuation, ask=table.basins)


def _under_tips(table: TurningFile, law: Law) -> float:
    """Stiffness under a tip [N/m]: of a spring, a coating, or the rim itself."""
    if table.law is not None:
        return table.law.stiffness
    return math.inf if law.coating is None else law.coating.under_tip


def _asked(table: BasinsTable | None, between: tuple[float, float]) -> tuple[float, float]:
    """The range; raises InputError if random starts are requested outside it."""
    if table is not None and not min(between) <= table.at <= max(between):
        raise InputError(f"basins.at: found {table.at:g}, expected a value from {min(between):g} to {max(between):g}")
    return between
