"""What scene files of several kinds share: basis files, [record], [coating], the contact law, how a rub is built."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, FiniteFloat, model_validator

from contact.base.errors import InputError
from contact.io.infiles import read_text
from contact.io.plausible import CHECKS, REACH
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.rub import Rub
from contact.model.law import Abradable, Coulomb, Law, Unilateral
from contact.record.record import Record
from contact.scene.problems import Problems
from contact.scene.roundness import Whole
from contact.scene.scheme import (
    Built,
    Instant,
    ModalScheme,
    Modulus,
    Name,
    NotNegative,
    Number,
    Positive,
    Table,
    Thickness,
)
from contact.scheme.modal.exact_modal import ExactModal
from contact.scheme.modal.wear_track import track_tips

Lean = Annotated[FiniteFloat, Field(gt=-90, lt=90), CHECKS["lean"]]


class RecordTable(Table):
    """[record]: the fields of `Record`, channels as rows or as a CSV file of them; left out, 1,000,000 samples."""

    every: Annotated[int, Field(ge=1)] = Field(default=1, description="one of so many steps is stored as a sample")
    state_every: Whole = Field(default=0, description="one of so many steps stores the state; 0 for none")
    at: Annotated[list[Instant], Field(min_length=1)] | None = Field(
        default=None, description="instants at which sample and state are stored [s], instead of every"
    )
    channels: Annotated[list[list[Number]], Field(min_length=1)] | Name | None = Field(
        default=None,
        description="rows of channels, or a CSV file of them beside this file: stored instead of the state [-]",
    )

    @model_validator(mode="after")
    def _fits(self) -> RecordTable:
        Record(every=self.every, state_every=self.state_every, at=self.at)
        if self.channels is not None and self.at is None and self.state_every == 0:
            raise ValueError("channels found without state_every or at, expected one of them")
        if isinstance(self.channels, list) and len({len(row) for row in self.channels}) > 1:
            raise ValueError("channels of different lengths found, expected one number for each coordinate in all")
        return self

    def record(self, folder: Path) -> Record:
        """The record; a CSV file of channels is found in `folder`. Raises InputError."""
        channels: object = self.channels
        if isinstance(channels, str):
            path = folder / channels
            try:
                channels = np.loadtxt(read_text(path).splitlines(), delimiter=",", comments="#", ndmin=2)
            except (OSError, ValueError) as error:
                reason = getattr(error, "strerror", f"{error}, expected rows of numbers")
                raise InputError(f"channels: {path}: {reason}") from error
        given: dict[str, Any] = self.model_dump(exclude={"channels"}) | {"channels": channels}
        return Record(**given)


def read_basis(path: Path) -> ModalBody:
    """The body of a basis file; raises InputError."""
    try:
        stat = path.stat()
    except (OSError, ValueError):  # the latter of a name with a zero byte
        return ModalBody.load(path)  # which says what is wrong
    return _basis_as(path, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=32)
def _basis_as(path: Path, _changed: int, _size: int) -> ModalBody:
    return ModalBody.load(path)


def radius_of(path: Path) -> float:
    """Largest radius of the rim of a basis file [m]; 0 where it has none, or cannot be read."""
    try:
        body = read_basis(path)
    except InputError:
        return 0.0
    return max(body.radius, *(body.line_radius(k) for k in range(body.rim_lines))) if body.kind == "rim" else 0.0


class CoatingTable(Table):
    """[coating] of a rim: the fields of `Abradable`, whose friction is that of [contact]."""

    E: Modulus = Field(description="Young's modulus [Pa]")
    yield_stress: Annotated[Positive, CHECKS["stress"]] = Field(description="stress at which it is worn [Pa]")
    hardening: Annotated[NotNegative, CHECKS["stress"]] = Field(description="slope of the stress beyond that [Pa]")
    thickness: Thickness = Field(description="thickness [m]")
    width: Annotated[Positive, REACH] = Field(description="width of the strip along the axis [m]")
    tip: Annotated[Positive, REACH] = Field(description="length of a tip's land around the rim [m]")
    bars: Annotated[int, Field(ge=1, le=10_000)] = Field(default=6, description="bars under a tip's land")
    machined: Annotated[NotNegative, CHECKS["clearance"]] = Field(
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
