"""Out-of-roundness of a rim in scene files: given harmonics, and numbered random draws from a spectrum."""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import Annotated, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator

from contact.base.errors import InputError
from contact.io.plausible import CHECKS
from contact.io.tables import Positive
from contact.model.bodies.modal_body import ModalBody
from contact.scene.scheme import WAVES, Friction, Gap, Table, Waviness

NINETY = NormalDist().inv_cdf(0.9)  # standard deviations between the median and the 90th percentile
RAYLEIGH = math.sqrt(math.log(10.0) / math.log(2.0))  # 90th percentile over median of two equal Gaussian coefficients
Terms = Annotated[
    Annotated[list[Waviness], Tag("[harmonics]")] | Annotated[Literal["basis"], Tag("[name]")],
    Discriminator(lambda value: "[harmonics]" if isinstance(value, list) else "[name]"),
]
Whole = Annotated[int, Field(ge=0)]


class SpectrumLine(Table):
    """One random harmonic: the amplitudes [m] that half and a tenth of all draws exceed."""

    p: Annotated[int, Field(ge=1, le=WAVES)] = Field(description="number of waves around")
    median: Annotated[Positive, CHECKS["roundness"]] = Field(description="amplitude that half of all draws exceed [m]")
    high: Annotated[Positive, CHECKS["roundness"]] = Field(description="amplitude that a tenth of all draws exceed [m]")

    @model_validator(mode="after")
    def _ordered(self) -> SpectrumLine:
        if self.high < self.median:
            raise ValueError(f"high = {self.high:g} found below median = {self.median:g}, expected at least as much")
        return self


class RandomRoundness(Table):
    """[contact.random_out_of_roundness]: d(theta) = sum_p a_p cos(p theta - phi_p) by seed and number of the draw.

    a_p is lognormal with the median and 90th percentile of `spectrum`, phi_p uniform. The same seed, draw and spectrum
    give the same numbers as casingfem's RandomField. `harmonics` instead have one median and the ratio of a Rayleigh
    distribution. `rms` [m] scales every draw to this root mean square around the rim.

    >>> table = RandomRoundness(seed=7, harmonics=[2, 3], rms=1e-4)
    >>> terms = table.terms(0)
    >>> round(sum(t["cos"] ** 2 + t["sin"] ** 2 for t in terms) / 2.0, 15), terms == table.terms(1)
    (1e-08, False)
    """

    seed: Whole = Field(description="seed of the draws; the same seed gives the same draws")
    spectrum: Annotated[list[SpectrumLine], Field(min_length=1)] | None = Field(
        default=None, description="spectrum of the amplitudes, tables {p, median, high}"
    )
    harmonics: Annotated[list[Annotated[int, Field(ge=1, le=WAVES)]], Field(min_length=1)] | None = Field(
        default=None, description="numbers of waves with equal amplitudes, instead of a spectrum"
    )
    rms: Annotated[Positive, CHECKS["roundness"]] | None = Field(
        default=None, description="root mean square around the rim to which every draw is scaled [m]"
    )

    @model_validator(mode="after")
    def _fits(self) -> RandomRoundness:
        if (self.spectrum is None) == (self.harmonics is None):
            found = "neither" if self.spectrum is None else "both"
            raise ValueError(f"spectrum and harmonics: found {found}, expected one of them")
        if self.harmonics is not None and self.rms is None:
            raise ValueError("harmonics found without rms, expected the size of the deviation [m]")
        p = [line.p for line in self._lines()]
        if p != sorted(set(p)):
            raise ValueError(f"harmonics {p} found, expected each once, ascending")
        return self

    def _lines(self) -> list[SpectrumLine]:
        return self.spectrum or [SpectrumLine(p=p, median=1.0, high=RAYLEIGH) for p in self.harmonics or ()]

    def terms(self, draw: int) -> list[dict[str, float]]:
        """Harmonics {p, cos, sin} [m] of one draw; it depends on its number alone."""
        lines = self._lines()
        size, turn = np.random.default_rng([self.seed, 0, draw]).random((len(lines), 2)).T
        normal = np.array([NormalDist().inv_cdf(float(u)) for u in np.clip(size, 1e-300, None)])
        spread = np.log([line.high / line.median for line in lines])
        amplitude = np.array([line.median for line in lines]) * np.exp(spread * normal / NINETY)
        if self.rms is not None:
            amplitude *= self.rms / math.sqrt(0.5 * float(amplitude @ amplitude))
        cos, sin = amplitude * np.cos(2.0 * np.pi * turn), amplitude * np.sin(2.0 * np.pi * turn)
        return [{"p": line.p, "cos": float(a), "sin": float(b)} for line, a, b in zip(lines, cos, sin, strict=True)]


class Roundness(Table):
    """Shape of a rim in [contact]: `out_of_roundness`, and `draw`, an added random shape.

    `out_of_roundness` lists harmonics {p, cos, sin} [m], or is "basis": the surveyed shape in the casing's basis.
    """

    out_of_roundness: Terms = Field(
        default_factory=list,
        description='deviation of the rim from a circle, tables {p, cos, sin}, or "basis" for the surveyed one',
    )
    random_out_of_roundness: RandomRoundness | None = Field(
        default=None, description="random deviation of the rim from a circle, which is added"
    )
    draw: Whole | None = Field(default=None, description="number of the random draw")

    @model_validator(mode="after")
    def _draws_of_something(self) -> Roundness:
        if self.draw is not None and self.random_out_of_roundness is None:
            raise ValueError(
                "draw found without random_out_of_roundness, expected [contact.random_out_of_roundness] too"
            )
        return self

    def terms(self, casing: ModalBody) -> list[dict[str, float]]:
        """Harmonics {p, cos, sin} [m], first the given, then the drawn ones; equal harmonics add up.

        "basis" takes those of the casing's rim line. Raises InputError if its basis has none, or several lines, which
        may differ.
        """
        if self.out_of_roundness == "basis":
            if casing.rim_lines > 1:
                found = f"'basis' with {casing.rim_lines} rim lines, which may differ"
                raise InputError(f"out_of_roundness: found {found}, expected one line, or harmonics")
            given = casing.roundness()
        else:
            given = [term.model_dump() for term in self.out_of_roundness]
        drawn = self.random_out_of_roundness
        return given if drawn is None else given + drawn.terms(self.draw or 0)


class GapTable(Roundness):
    """[contact]: clearance [m], friction coefficient, out-of-roundness."""

    clearance: Gap = Field(description="between tips and round rim at rest [m]")
    friction: Friction = Field(default=0.0, description="coefficient of Coulomb friction [-]")
