"""Common parts of scene files: basis files, [record], and the construction of a rub."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, FiniteFloat, model_validator

from contact.base.errors import InputError
from contact.io.infiles import read_text
from contact.io.plausible import CHECKS
from contact.io.tables import Number, table_of
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.rub import Rub
from contact.record.record import Record
from contact.scene.laws import AnyLaw, CoatingTable, contact_law
from contact.scene.problems import Problems
from contact.scene.scheme import Built, Instant, ModalScheme, Name, Table
from contact.scheme.modal.exact_modal import ExactModal
from contact.scheme.modal.wear_track import track_tips

Lean = Annotated[FiniteFloat, Field(gt=-90, lt=90), CHECKS["lean"]]


@table_of(Record)
class RecordTable(Table):
    """[record]: the fields of `Record`, channels as rows or as a CSV file; by default 1,000,000 samples."""

    every: int
    state_every: int
    at: Annotated[list[Instant], Field(min_length=1)] | None = Field(
        default=None, description="times at which sample and state are stored [s], instead of every"
    )
    channels: Annotated[list[list[Number]], Field(min_length=1)] | Name | None = Field(
        default=None,
        description="channels that are stored instead of the state, as rows or in a CSV file beside this file [-]",
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
        """The record; a CSV file of channels is sought in `folder`. Raises InputError."""
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
        return ModalBody.load(path)  # which states what is wrong
    return _basis_as(path, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=32)
def _basis_as(path: Path, _changed: int, _size: int) -> ModalBody:
    return ModalBody.load(path)


def radius_of(path: Path) -> float:
    """Largest radius of the rim of a basis file [m]; 0 if it has none or cannot be read."""
    try:
        body = read_basis(path)
    except InputError:
        return 0.0
    return max(body.radius, *(body.line_radius(k) for k in range(body.rim_lines))) if body.kind == "rim" else 0.0


def rub_built(
    rub: Callable[[], Rub], law: AnyLaw | None, coating: CoatingTable | None, mu: float, scheme: ModalScheme,
    problems: Problems,
) -> Built:  # fmt: skip
    """A rub with its law and checked coating tracks; raises SceneError."""
    with problems.at():
        what = rub()
    with problems.at("coating"):
        stated = contact_law(mu, law, coating)
    problems.check()
    if coating is not None:
        with problems.at():
            track_tips(what, coating.tip)
    return what, stated, ExactModal(law=scheme.law)
