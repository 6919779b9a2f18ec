"""Result of a search for loose bolts or added masses: places with uncertainty, and alternatives."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from casingfem.experiment.correlation.matches import unpaired_words
from casingfem.io.arrays import FloatArray
from casingfem.locate.misfit import Misfit
from contact.io.columns import Column, Columns, records_of, table_lines
from contact.io.reported import Reported

NOISE = 5.0  # times the stated sigma: noise may well be understated three times, hardly more
WHOLE = 1.0  # of a bolt's stiffness: more than it has cannot go


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """One place: its number among the candidates (bolts from 1), angle [deg], value and standard deviation.

    The value is the remaining factor of a bolt's stiffness, or the mass [kg], which may be between candidates.
    """

    place: int
    angle_deg: float
    value: float
    sigma: float
    angle_sigma_deg: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Explanation:
    """Places that explain a table, and the increase of chi^2/s^2 over the best explanation."""

    found: tuple[Found, ...]
    behind: float

    @property
    def places(self) -> frozenset[int]:
        """The numbers of the places."""
        return frozenset(one.place for one in self.found)


def places_of(found: "Localisation") -> list[tuple[int, Explanation, Found]]:
    """Each place of each explanation, with the explanation and its number from 1, the best first."""
    numbered = enumerate((found.best, *found.others), 1)
    return [(k, explanation, place) for k, explanation in numbered for place in explanation.found]


def of_each(name: str) -> Callable[["Localisation"], list[Any]]:
    """Column of one value for each place."""
    return lambda found: [getattr(place, name) for _, _, place in places_of(found)]


def columns_of(value: Column, sigma: Column, angle: Literal["everywhere", "files"]) -> Columns:
    """Columns for bolts or masses; `angle` selects the tables that show the uncertainty of the angle."""
    return (
        Column("explanation", "Number of the explanation; 1 has the least chi^2.",
               lambda found: [k for k, _, _ in places_of(found)], head="no.", format="d"),
        Column("chi2_behind", "chi^2 of the explanation over that of the best one.",
               lambda found: [one.behind for _, one, _ in places_of(found)], head="chi^2 above", format=".2g"),
        Column("place", "Number of the bolt, or of the nearest candidate, from 1.", of_each("place"), format="d"),
        Column("angle_deg", "Angle of the place.", of_each("angle_deg"), head="angle", unit="deg", format=".2f"),
        value,
        sigma,
        Column("angle_sigma_deg", "Standard deviation of the angle; 0 for a bolt.", of_each("angle_sigma_deg"),
               head="sigma of angle", unit="deg", format=".2g", where=angle),
    )  # fmt: skip


BOLTS = columns_of(
    Column("value", "Part of the bolt's stiffness that is left.", of_each("value"), head="stiffness left", unit="%",
           format=".0f", scale=100.0),
    Column("sigma", "Standard deviation of this part.", of_each("sigma"), unit="%", format=".1f", scale=100.0),
    "files",
)  # fmt: skip
MASSES = columns_of(
    Column("value", "Added mass, in kg.", of_each("value"), head="mass", unit="g", format=".4g", scale=1e3),
    Column("sigma", "Standard deviation of the mass, in kg.", of_each("sigma"), unit="g", format=".2g", scale=1e3),
    "everywhere",
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False, kw_only=True, repr=False)
class Localisation(Reported):
    """The smallest set of changes that explains a table.

    Attributes
    ----------
    among
        "bolts" or "mass".
    angles_deg
        Angles of the candidates, (candidates,).
    best
        The explanation with the least chi^2.
    others
        Explanations that the table does not exclude, including rotated ones.
    chi2, chi2_start, rows
        Sum of squared weighted residuals of the best and of no change at all; number of residuals. All three, and
        `scale`, refer to the rows that pair.
    scale
        s = sqrt(max(1, chi^2/dof)): ratio of the residuals to their stated sigma; sigma includes it.
    smallest
        (candidates,) Smallest detectable change at each place alone, in the value's unit.
    alike
        Groups of places that this table cannot distinguish.
    calibrated
        Whether there was a baseline.
    misfit
        The last misfit: the calibrated model, and the table with the added uncertainty.
    unpaired
        Mode numbers of the table's rows without a computed mode; other results do not depend on them.
    baseline_unpaired
        Mode numbers of such rows of the baseline.

    Examples
    --------
    >>> import casingfem as cf
    >>> casing = cf.Shell(chart=cf.Cylinder(radius=0.3, height=0.1), thickness=4e-3,
    ...                   material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                   mesh=cf.ShellMesh(order=7, rows=1, around=14), supports={"base": cf.Bolts(count=7, k=2e8)})
    >>> loose = cf.modes(cf.updating.with_value(casing, "support.base.bolts.2.k", 6e7), 6)
    >>> table = cf.FrequencyTable.from_arrays(freq_hz=loose.freq, sigma_hz=0.05, n=loose.nodal_diameters)
    >>> found = cf.locate(casing, table, most=1)
    >>> [round(one.value, 2) for one in found.found]  # 0.3 of 2e8 N/m is left; without angles the bolts are alike
    [0.3]
    """

    among: str
    angles_deg: FloatArray
    best: Explanation
    others: tuple[Explanation, ...]
    chi2: float
    chi2_start: float
    rows: int
    scale: float
    smallest: FloatArray
    alike: tuple[tuple[int, ...], ...]
    calibrated: bool
    misfit: Misfit
    unpaired: tuple[int, ...] = ()
    baseline_unpaired: tuple[int, ...] = ()

    @property
    def found(self) -> tuple[Found, ...]:
        """The places of the best explanation."""
        return self.best.found

    def described(self) -> Columns:
        """The columns for bolts or masses."""
        return BOLTS if self.among == "bolts" else MASSES

    def to_json(self) -> dict[str, object]:
        """Plain lists and numbers for JSON."""
        explained = [{"behind": e.behind, "found": [asdict(f) for f in e.found]} for e in (self.best, *self.others)]
        return {
            "among": self.among,
            "angles_deg": self.angles_deg.tolist(),
            "found": explained[0]["found"],
            "explanations": explained,
            "chi2": self.chi2,
            "chi2_start": self.chi2_start,
            "residuals": self.rows,
            "scale": self.scale,
            "smallest": self.smallest.tolist(),
            "alike": [list(group) for group in self.alike],
            "baseline": self.calibrated,
            "unpaired": list(self.unpaired),
            "baseline_unpaired": list(self.baseline_unpaired),
        }

    def __repr__(self) -> str:
        """The best explanation, its alternatives, and the places that the table cannot distinguish."""
        one, many = {"bolts": ("loose bolt", "loose bolts"), "mass": ("added mass", "added masses")}[self.among]
        what = one if len(self.found) == 1 else many
        lines = [f"{len(self.found) or 'no'} {what} found ({'with' if self.calibrated else 'without'} a baseline)"]
        if rows := records_of(self.described(), self):
            lines += table_lines(self.described(), rows)
        lines.append(
            f"chi^2 {self.chi2_start:.4g} -> {self.chi2:.4g} over {self.rows} residuals; "
            f"they are {self.scale:.3g} times their stated sigma"
        )
        if self.scale > NOISE:
            lines.append(
                f"do not rely on this result: noise alone rarely leaves residuals above {NOISE:.0f} sigma. Check the "
                "zero and direction of angle_deg, whether table and baseline belong to this casing in the intended "
                "states, and sigma_hz; state the error of the model as model_error"
            )
        lines += unpaired_words(self.unpaired) + unpaired_words(self.baseline_unpaired, "baseline")
        explained = (self.best, *self.others)
        axes = [tuple(sorted(round(f.angle_deg % 180.0, 3) for f in e.found)) for e in explained]  # but for half turns
        if self.among == "bolts" and len(set(axes)) > 1:
            lines.append(
                f"{len(self.others) + 1} explanations fit the table equally: orientations of more pairs (angle_deg), "
                "more accurate ones, or mode shapes distinguish rotated and mirrored places"
            )
        if axes[0] in axes[1:] or (self.among == "mass" and self.others):
            lines.append("places 180 degrees apart give the same frequencies and orientations: measured shapes decide")
        lines.append(self.seen())
        return "\n".join(lines)

    def seen(self) -> str:
        """Smallest detectable size of a single change, in words; a bolt cannot lose more than its stiffness."""
        blind = ~(self.smallest < (WHOLE if self.among == "bolts" else np.inf))
        if blind.all():
            lost = {"bolts": "a missing bolt", "mass": "any mass"}[self.among]
            return (
                f"the table cannot show any change: even {lost} would stay within its uncertainty, so that a search "
                "without result proves nothing. Check that table and baseline belong to one casing and check each "
                "sigma_hz, or measure more pairs"
            )
        unit = {"bolts": "of a bolt's stiffness", "mass": "kg"}[self.among]
        seen = self.smallest[~blind]
        line = f"the smallest change that the table shows is {seen.min():.2g} to {seen.max():.2g} {unit}"
        places = ", ".join(str(k + 1) for k in np.flatnonzero(blind))
        return f"{line}; at places {places} it shows none" if places else line
