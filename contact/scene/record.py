"""[record] of a scene file: what is stored, with channels in the file or in a CSV beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, FiniteFloat, model_validator

from contact.base.errors import InputError
from contact.record.record import Record
from contact.scene.scheme import NotNegative, Table


class RecordTable(Table):
    """[record]: the fields of `Record`, channels as rows or as a CSV file of them; left out, 1,000,000 samples."""

    every: Annotated[int, Field(ge=1)] = Field(default=1, description="one of so many steps is stored as a sample")
    state_every: Annotated[int, Field(ge=0)] = Field(
        default=0, description="one of so many steps stores the state; 0 for none"
    )
    at: Annotated[list[NotNegative], Field(min_length=1)] | None = Field(
        default=None, description="instants at which sample and state are stored [s], instead of every"
    )
    channels: Annotated[list[list[FiniteFloat]], Field(min_length=1)] | str | None = Field(
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
                channels = np.loadtxt(path, delimiter=",", comments="#", ndmin=2)
            except (OSError, ValueError) as error:
                raise InputError(f"channels: {path}: {error}, expected rows of numbers") from error
        given: dict[str, Any] = self.model_dump(exclude={"channels"}) | {"channels": channels}
        return Record(**given)
