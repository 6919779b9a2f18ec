"""Schema of [sweep] in scene.toml (pydantic): imported only when a sweep is read."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, FiniteFloat, model_validator

from contact.scene.scheme import Table

MOST_RUNS = 1_000_000


class VaryTable(Table):
    """[[sweep.vary]]: a key of the scene file, and its values: listed, or from .. to in steps, or drawn between."""

    key: Annotated[str, Field(min_length=1)]
    values: list[FiniteFloat | str] | None = None
    from_: FiniteFloat | None = Field(default=None, alias="from")
    to: FiniteFloat | None = None
    steps: Annotated[int, Field(ge=1, le=MOST_RUNS)] | None = None
    log: bool = False

    @model_validator(mode="after")
    def _fits(self) -> VaryTable:
        between = (self.from_ is None, self.to is None)
        if self.values is not None and (not all(between) or self.steps is not None or self.log):
            raise ValueError("values found beside from, to, steps or log, expected one or the other")
        if self.values is not None and not self.values:
            raise ValueError("values: found none, expected at least one")
        if self.values is None and any(between):
            raise ValueError("found neither values nor both from and to, expected one or the other")
        if self.log and not (self.from_ is not None and self.to is not None and self.from_ > 0.0 and self.to > 0.0):
            raise ValueError("log found with from or to <= 0, expected both > 0")
        return self


class SweepTable(Table):
    """[sweep]: every combination (grid), the n-th values of all keys together (list), or seeded draws (random)."""

    kind: Literal["grid", "list", "random"] = "grid"
    draws: Annotated[int, Field(ge=1, le=MOST_RUNS)] | None = None
    seed: Annotated[int, Field(ge=0)] | None = None
    vary: Annotated[list[VaryTable], Field(min_length=1)]

    @model_validator(mode="after")
    def _fits(self) -> SweepTable:
        random = self.kind == "random"
        if random != (self.draws is not None) or random != (self.seed is not None):
            raise ValueError("draws and seed belong to kind = 'random', which needs both")
        for vary in self.vary:
            if random and vary.steps is not None:
                raise ValueError(f"{vary.key}: steps found with kind = 'random', which draws between from and to")
            if not random and vary.values is None and vary.steps is None:
                raise ValueError(f"{vary.key}: steps missing, expected how many from .. to")
        keys = [vary.key for vary in self.vary]
        if len(set(keys)) < len(keys):
            raise ValueError("vary: found a key twice, expected each once")
        return self
