"""Results of the draws: splits, growth over speed, Sobol indices, and the casings with the largest growth."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from casingfem.chance.estimates import Estimate, probability, quantile
from casingfem.chance.evaluate import dangerous, severity
from casingfem.chance.importance import Importance
from casingfem.chance.replaced import IN_FULL, PURE
from casingfem.chance.run import Drawn
from casingfem.io.arrays import FloatArray, IntArray
from contact.io.columns import Column, records_of, table_lines
from contact.io.outfiles import finite
from contact.io.reported import Reported

LEVELS = (0.5, 0.9, 0.99)
METHODS = ("map", "full solution")


def level_columns(name: str, head: str, text: str, scale: float, unit: str, digits: str) -> list[Column]:
    """Columns of the quantiles of a value of each pair."""

    def values(at: float) -> Any:
        return lambda found: [quantile(part, at).value for part in found.of_pairs(name)]

    return [
        Column(f"{name}_{100 * at:.0f}", f"{text}: {100 * at:.0f} % of the casings are below it.", values(at),
               head=f"{head} {100 * at:.0f}", unit=unit, format=digits, scale=scale)
        for at in LEVELS
    ]  # fmt: skip


PAIRS = (
    Column("n", "Nodal diameters.", lambda found: found.drawn.n, format="d"),
    Column("m", "Meridional rank.", lambda found: found.drawn.rank, format="d"),
    Column("freq_hz", "Frequency in the perfect casing.", lambda found: found.drawn.freq, head="freq", unit="Hz",
           format=".2f"),
    *level_columns("split", "split", "Relative split of the pair", 100.0, "%", ".4f"),
    *level_columns("shift", "shift", "Relative shift of the pair's mean frequency", 100.0, "%", ".3f"),
    Column("mixed", "Share of the casings in which the pair is mixed with another, so that its split is undefined.",
           lambda found: np.mean(found.drawn.lot["share"] < PURE, axis=0), unit="%", format=".1f", scale=100.0),
)  # fmt: skip
SPEEDS = (
    Column("speed_hz", "Speed of rotation.", lambda found: found.drawn.given.speed_hz, head="speed", unit="Hz",
           format=".4g"),
    Column("probability", "Probability that the rim touches and that the motion grows with the contact closed.",
           lambda found: [one.value for one in found.by_speed], unit="%", format=".3g", scale=100.0),
    Column("low", "Lower end of its 95 % interval.", lambda found: [one.low for one in found.by_speed], unit="%",
           format=".3g", scale=100.0),
    Column("high", "Upper end of its 95 % interval.", lambda found: [one.high for one in found.by_speed], unit="%",
           format=".3g", scale=100.0),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Chance(Reported):
    """Results over all draws of a scene.

    Attributes
    ----------
    drawn : all draws
    any_speed : probability that some speed of the range is dangerous
    by_speed : probability at each speed
    worst : numbers of the worst casings, the worst first
    """

    COLUMNS: ClassVar = PAIRS

    drawn: Drawn
    any_speed: Estimate
    by_speed: tuple[Estimate, ...]
    worst: IntArray

    @classmethod
    def of(cls, drawn: Drawn) -> "Chance":
        """The results over all draws; a speed is dangerous if the rim touches and closed contact grows."""
        hit = dangerous(drawn.lot, drawn.floor)
        order = np.lexsort((np.arange(len(hit)), -drawn.lot["split"].max(axis=1), -severity(drawn.lot)))
        return cls(
            drawn=drawn,
            any_speed=probability(hit.any(axis=1)),
            by_speed=tuple(probability(column) for column in hit.T),
            worst=order[: drawn.given.table.worst],
        )

    def of_pairs(self, name: str) -> FloatArray:
        """Splits or shifts of each pair over the casings, (pairs, draws)."""
        lot = self.drawn.lot
        return np.asarray((lot["split"] if name == "split" else lot["freq"] / self.drawn.freq - 1.0).T)

    def draws(self) -> list[dict[str, Any]]:
        """One row for each casing: inputs, gap, worst growth and its speed, largest split and its pair, method."""
        drawn, lot = self.drawn, self.drawn.lot
        at, pair = lot["growth"].argmax(axis=1), lot["split"].argmax(axis=1)
        columns = {
            "draw": np.arange(len(at)),
            **{name: lot[name] for name in drawn.given.means},
            "gap_m": lot["gap"],
            "growth_1_s": lot["growth"].max(axis=1),
            "at_hz": np.asarray(drawn.given.speed_hz)[at],
            "split_rel": lot["split"].max(axis=1),
            "n": drawn.n[pair],
            "m": drawn.rank[pair],
            "by": np.array(METHODS)[lot["by"].astype(int)],
        }
        return [
            dict(zip(columns, row, strict=True)) for row in zip(*(c.tolist() for c in columns.values()), strict=True)
        ]

    def summary(self) -> list[dict[str, Any]]:
        """One row for each pair."""
        return records_of(PAIRS, self)

    def speeds(self) -> list[dict[str, Any]]:
        """One row for each speed."""
        return records_of(SPEEDS, self)

    def importance(self) -> list[dict[str, Any]]:
        """One row for each result and input."""
        rows = ((name, row) for name, part in self.drawn.importance.items() for row in part)
        return [{"result": name, **{key: getattr(row, key) for key in Importance.__slots__}} for name, row in rows]

    @property
    def words(self) -> str:
        """Probabilities in sentences."""
        return "\n".join(self.facts.values())

    @property
    def facts(self) -> dict[str, str]:
        """Sentences by their subject: the probability of a dangerous speed, speed, touch, sample, importance."""
        drawn, lot = self.drawn, self.drawn.lot
        speeds = np.asarray(drawn.given.speed_hz)
        touches = probability(lot["gap"] <= 0.0)
        found = {
            "Dangerous": f"Some speed is dangerous in {per_cent(self.any_speed)} of the casings: the rim touches, and "
            "the motion grows with the contact closed."
        }
        if self.any_speed.value > 0.0:
            k = int(np.argmax([one.value for one in self.by_speed]))
            at = f"{speeds[k]:.4g} Hz ({60 * speeds[k]:,.0f} rpm)"
            found["Speed"] = f"The most likely dangerous speed is {at}: {per_cent(self.by_speed[k])}."
        found["Touch"] = f"The rim touches in {per_cent(touches)} of the casings."
        found |= {
            " ".join(name.capitalize().split()[:2]): largest_effect(name, rows)
            for name, rows in drawn.importance.items()
            if rows
        }
        found["Sample"] = (
            f"{len(lot['gap']):,} casings at {len(speeds)} speeds from {speeds[0]:.4g} to {speeds[-1]:.4g} Hz "
            f"({60 * speeds[0]:,.0f} to {60 * speeds[-1]:,.0f} rpm). {self.solved}"
        )
        return found

    @property
    def solved(self) -> str:
        """Number of casings that were solved again, and the result of the checks."""
        by, apart = (self.drawn.lot[name] for name in ("by", "difference"))
        full = int(np.sum(by == IN_FULL))
        count = f"{full} casing{' was' if full == 1 else 's were'} solved in full"
        checks = int(np.isfinite(apart).sum())
        if not checks:
            return f"{count}."
        return f"{count}, {checks} of them as a check: splits differ by {100 * np.nanmax(apart):.2g} % of the largest."

    def __repr__(self) -> str:
        return "\n".join([*table_lines(PAIRS, self.summary()), self.words])

    def to_dict(self) -> dict[str, Any]:
        """The document of `casingfem chance --json`."""
        return {
            "casings": len(self.drawn.lot["gap"]),
            "dangerous": self.any_speed._asdict(),
            "pairs": [finite(row) for row in self.summary()],
            "speeds": [finite(row) for row in self.speeds()],
            "importance": [finite(row) for row in self.importance()],
            "worst": self.worst.tolist(),
            "resumed": self.drawn.resumed,
            "in_full": int(np.sum(self.drawn.lot["by"] == IN_FULL)),
            "largest_difference": float(np.nanmax(self.drawn.lot["difference"], initial=0.0)),
            "words": self.words,
            "source": self.drawn.given.source,
        }


def largest_effect(name: str, rows: Sequence[Importance]) -> str:
    """The input with the largest effect on a result, and the others whose intervals overlap with its own.

    >>> from dataclasses import replace
    >>> rows = [Importance("a", 0.5, 0.4, 0.6, 0.8, 0.7, 0.9), Importance("b", 0.1, 0.0, 0.2, 0.3, 0.2, 0.4)]
    >>> largest_effect("largest split", rows)
    'Largest split: a has the largest effect (total Sobol index 0.80, 95 %: 0.70 to 0.90).'
    >>> largest_effect("largest split", [replace(rows[0], total_low=0.3), rows[1]])
    'Largest split: a and b have the largest effects. Their intervals overlap; more chance.importance narrows them.'
    """
    most, *others = sorted(rows, key=lambda row: -row.total)
    equal = [row.group for row in others if row.total_high >= most.total_low]
    if equal:
        names = " and ".join(filter(None, [", ".join([most.group, *equal[:-1]]), equal[-1]]))
        words = f"{names} have the largest effects. Their intervals overlap; more chance.importance narrows them"
    else:
        interval = f"95 %: {most.total_low:.2f} to {most.total_high:.2f}"
        words = f"{most.group} has the largest effect (total Sobol index {most.total:.2f}, {interval})"
    return f"{name.capitalize()}: {words}."


def per_cent(one: Estimate) -> str:
    """A probability in per cent with its interval.

    >>> per_cent(Estimate(0.021, 0.0152, 0.0283))
    '2.1 % (95 %: 1.52 to 2.83 %)'
    """
    return f"{100 * one.value:.3g} % (95 %: {100 * one.low:.3g} to {100 * one.high:.3g} %)"
