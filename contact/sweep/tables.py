"""Schema of [sweep] in scene.toml (pydantic); imported only when a sweep is read."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, FiniteFloat, model_validator

from contact.scene.scheme import Table

MOST_RUNS = 1_000_000


class VaryTable(Table):
    """[[sweep.vary]]: a key of the scene file, and its values: a list, from .. to in steps, or random draws between."""

    key: Annotated[str, Field(min_length=1)] = Field(
        description="key of the scene that is varied, such as speed.hz or rod[1].velocity"
    )
    values: list[FiniteFloat | str] | None = Field(
        default=None, description="list of values in the unit of the key [of the key]"
    )
    from_: FiniteFloat | None = Field(
        default=None, alias="from", description="first value, or least of the draws [of the key]"
    )
    to: FiniteFloat | None = Field(default=None, description="last value, or largest of the draws [of the key]")
    steps: Annotated[int, Field(ge=1, le=MOST_RUNS)] | None = Field(
        default=None, description="number of values from first to last"
    )
    log: bool = Field(default=False, description="whether values are evenly spaced, or drawn, in the logarithm")

    @model_validator(mode="after")
    def _fits(self) -> VaryTable:
        between = (self.from_ is None, self.to is None)
        if self.values is not None and (not all(between) or self.steps is not None or self.log):
            raise ValueError("values found with from, to, steps or log, expected values alone, or from, to and steps")
        if self.values is not None and not self.values:
            raise ValueError("values: found none, expected at least one")
        if self.values is None and any(between):
            raise ValueError("found neither values nor both from and to, expected values, or from, to and steps")
        if self.log and not (self.from_ is not None and self.to is not None and self.from_ > 0.0 and self.to > 0.0):
            raise ValueError("log found with from or to <= 0, expected both > 0")
        return self


class SweepTable(Table):
    """[sweep]: every combination (grid), the n-th values of all keys together (list), or seeded draws (random)."""

    kind: Literal["grid", "list", "random"] = Field(
        default="grid", description="every combination, the n-th values of all keys together, or random draws"
    )
    draws: Annotated[int, Field(ge=1, le=MOST_RUNS)] | None = Field(default=None, description="number of random draws")
    seed: Annotated[int, Field(ge=0)] | None = Field(default=None, description="seed of the draws")
    vary: Annotated[list[VaryTable], Field(min_length=1)] = Field(description="tables [[sweep.vary]]")

    @model_validator(mode="after")
    def _fits(self) -> SweepTable:
        random = self.kind == "random"
        given = [name for name in ("draws", "seed") if getattr(self, name) is not None]
        if len(given) != (2 if random else 0):
            found = f"{' and '.join(given) or 'neither draws nor seed'} found with kind = {self.kind!r}"
            raise ValueError(f"{found}, expected both with kind = 'random' and none otherwise")
        for vary in self.vary:
            if random and vary.steps is not None:
                raise ValueError(f"{vary.key}: steps found with kind = 'random', expected only from and to")
            if not random and vary.values is None and vary.steps is None:
                raise ValueError(f"{vary.key}: steps missing, expected the number of values between from and to")
        keys = [vary.key for vary in self.vary]
        if len(set(keys)) < len(keys):
            raise ValueError("vary: found a key twice, expected each once")
        return self
