"""One lot of draws: splits, rims, and the growth of closed contact over the speeds."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from casingfem.chance.casings import AROUND, Casings
from casingfem.chance.load import ChanceScene
from casingfem.chance.points import REPLICATES, points
from casingfem.chance.replaced import checked, replaced
from casingfem.io.arrays import Array, BoolArray, FloatArray
from casingfem.study.mistuning import is_checked
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.rub import Rub, rub_of
from contact.stability.closed_contact import FLOOR
from contact.stability.varied import Cases, growth_of_cases

Lot = dict[str, FloatArray]
RESULTS = ("largest split", "worst growth where the rim touches")


@dataclass(frozen=True, eq=False, kw_only=True)
class Drawing:
    """Converts random numbers into casings, gaps and growth rates.

    Attributes
    ----------
    given : the scene
    casings : those of its study
    """

    given: ChanceScene
    casings: Casings

    @classmethod
    def of(cls, given: ChanceScene) -> "Drawing":
        """The drawing of a scene, for which the perfect casing is solved."""
        table = given.study.file.reduce
        assert table is not None
        return cls(given=given, casings=Casings.of(given.study.shell, given.rim, table.modes, table.zeta))

    @cached_property
    def groups(self) -> dict[str, slice]:
        """Inputs by name, with their columns in the random numbers."""
        found, first = dict[str, slice](), 0
        sizes = {f"{name} field": size for name, size in self.casings.random.groups.items()}
        for name, size in [*sizes.items(), *((name, 1) for name in self.given.laws)]:
            found[name] = slice(first, first + size)
            first += size
        return found

    @property
    def dimension(self) -> int:
        """Number of random numbers for a draw."""
        return max(int(columns.stop) for columns in self.groups.values())

    def drawn(self, draws: range) -> Lot:
        """Results of some draws; for some of them full solutions check and replace the results."""
        u = points(self.given.table.seed, draws, self.dimension)
        return self.lot(u, [draw - draws.start for draw in draws if is_checked(draw)])

    def point(self, draw: int) -> FloatArray:
        """Random numbers of one draw, (1, dimension)."""
        return points(self.given.table.seed, range(draw - draw % REPLICATES, draw + 1), self.dimension)[-1:]

    def series(self, u: FloatArray) -> Array:
        """Series of the fields at points u."""
        return self.casings.random.series(u[:, : self.casings.random.dimension])

    def lot(self, u: FloatArray, checks: Sequence[int] = ()) -> Lot:
        """Results of points u (draws, dimension): splits and frequencies of pairs, inputs, gap, growth by speed.

        `checks` are indices of the points that are also solved in full.
        """
        series, difference = self.series(u), np.full(len(u), np.nan)
        found = replaced(self.casings, series, self.casings.pairs.splits(series))
        for place in checks:
            found, difference[place] = checked(self.casings, series, found, place)
        pairs, inputs = found.pairs, self.inputs(u)
        gap = self.gap(inputs, series)
        cases = Cases(casing=self.casings.ratios(pairs.freq), blade=inputs["blade"], mu=inputs["friction"])
        growth = growth_of_cases(self.perfect, self.given.speed_hz, cases)
        return {
            "split": pairs.split, "freq": pairs.freq, "angle_deg": pairs.angle_deg, "share": pairs.share,
            "gap": gap, "growth": growth, "by": found.by, "difference": difference, **inputs,
        }  # fmt: skip

    def inputs(self, u: FloatArray) -> dict[str, FloatArray]:
        """Values of the scene's numbers, drawn or not, (draws,) each."""
        return {
            name: self.given.laws[name].quantile(u[:, self.groups[name].start], mean)
            if name in self.given.laws
            else np.full(len(u), mean)
            for name, mean in self.given.means.items()
        }

    @cached_property
    def perfect(self) -> RotatingRim | Rub:
        """The bodies of the scene with the perfect casing."""
        what = self.given.scene.what
        assert isinstance(what, RotatingRim | Rub)
        return replace(what, casing=self.casings.perfect)

    @cached_property
    def floor(self) -> float:
        """Growth [1/s] below which it is only round-off."""
        return FLOOR * float(self.casings.perfect.omega.max())

    def gap(self, inputs: dict[str, FloatArray], series: Array) -> FloatArray:
        """Smallest clearance between rim and blade [m], (draws,); they touch if it is not positive."""
        return np.asarray(inputs["clearance"] - inputs.get("closing", 0.0) + self.lowest_rim(series))

    def lowest_rim(self, series: Array) -> FloatArray:
        """Least deviation of each rim's radius [m], (draws,), where a tip comes nearest."""
        d = self.casings.deviation(series)
        waves = np.zeros((len(d), AROUND // 2 + 1), dtype=complex)
        top = min(d.shape[1], waves.shape[1])
        waves[:, :top] = d[:, :top]
        fixed = self.fixed_rim(2.0 * np.pi * np.arange(AROUND) / AROUND)
        return np.asarray((0.5 * AROUND * np.fft.irfft(waves, AROUND) + fixed).min(axis=1))

    def fixed_rim(self, angles: FloatArray) -> FloatArray:
        """Deviation of the radius that the scene states [m]."""
        profile = rub_of(self.given.scene.what).profile
        return np.array([float(profile(angle)) for angle in angles.tolist()])

    def results(self, u: FloatArray) -> FloatArray:
        """The two results for which Sobol indices are computed, (points, 2)."""
        lot = self.lot(u)
        return np.stack([lot["split"].max(axis=1), severity(lot)], axis=1)


def dangerous(lot: Lot, floor: float) -> BoolArray:
    """Whether the rim touches and closed contact grows faster than `floor` [1/s], (draws, speeds)."""
    return np.asarray((lot["growth"] > floor) & (lot["gap"] <= 0.0)[:, None])


def severity(lot: Lot) -> FloatArray:
    """Largest growth [1/s] over the speeds of each casing that touches; 0 for others and if nothing grows, (draws,)."""
    return np.where(lot["gap"] <= 0.0, np.maximum(lot["growth"].max(axis=1), 0.0), 0.0)
