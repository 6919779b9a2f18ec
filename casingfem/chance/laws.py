"""Distributions of single numbers: a clearance, a coefficient of friction, the frequency of a blade."""

import math
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from scipy.special import ndtr, ndtri

from casingfem.io.arrays import FloatArray
from contact.io.keys import Key

CUT = 4.0  # standard deviations at which a normal law is cut: beyond, parts are rejected
WIDE = math.sqrt(3.0)  # standard deviations from the mean to the ends of a uniform law
Kind = Literal["normal", "uniform", "lognormal"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Law:
    """Distribution of a random number by its mean and standard deviation.

    >>> law = Law(deviation=2e-5)
    >>> law.quantile(np.array([0.5]), mean=1e-3).tolist(), round(law.lowest(1e-3), 8)
    ([0.001], 0.00092)
    """

    deviation: Annotated[float, Key("standard deviation [of the number]", "not negative")]
    law: Annotated[Kind, Key("normal (cut at 4 standard deviations), uniform, or lognormal")] = "normal"
    mean: Annotated[float | None, Key("mean [of the number]; the value of the scene if left out")] = None

    def centre(self, mean: float) -> float:
        """Mean of the distribution: its own, else the one given."""
        return mean if self.mean is None else self.mean

    def lowest(self, mean: float) -> float:
        """Smallest possible value."""
        centre = self.centre(mean)
        return {
            "normal": centre - CUT * self.deviation,
            "uniform": centre - WIDE * self.deviation,
            "lognormal": 0.0,
        }[self.law]

    def quantile(self, u: FloatArray, mean: float) -> FloatArray:
        """Values at probabilities u."""
        centre = self.centre(mean)
        if self.law == "uniform":
            return np.asarray(centre + WIDE * self.deviation * (2.0 * u - 1.0))
        if self.law == "normal":
            tail = float(ndtr(-CUT))
            return np.asarray(centre + self.deviation * ndtri(tail + u * (1.0 - 2.0 * tail)))
        spread = math.sqrt(math.log1p((self.deviation / centre) ** 2))
        return np.asarray(centre * np.exp(spread * ndtri(u) - 0.5 * spread**2))
