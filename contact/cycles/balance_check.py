"""How far harmonic balance agrees with the orbits of `follow`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, require_count
from contact.base.errors import InputError, NumericsError
from contact.cycles.balance import HARMONICS, Balanced
from contact.cycles.balance_branch import Equations, Point
from contact.cycles.driven import Family
from contact.cycles.harmonics import reals, response
from contact.cycles.orbit_series import gaps_of
from contact.cycles.result import Cycles
from contact.cycles.shooting import Orbit
from contact.io.brief import brief
from contact.io.threads import with_one_thread

NEAR = 0.1  # relative difference of a motion that still counts as the orbit's


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Agreement:
    """Difference of harmonic balance from the orbits of branches: one value an orbit, in the order of the branches.

    `amplitude` the largest relative difference of an amplitude, `parameter` that of the parameter, relative to its
    largest value on the branch, both NaN where harmonic balance finds no motion near the orbit; `value` the parameter,
    `harmonics` those of a period of the forcing.

    >>> one = Agreement(name="freq_hz", harmonics=30, value=np.array([0.1, 0.2]), amplitude=np.array([1e-5, 2e-4]),
    ...                 parameter=np.array([0.0, 1e-6]))
    >>> one.words
    'harmonic balance (30 harmonics) agrees within 0.02 % in amplitude and 0.0001 % in freq_hz at 2 of 2 orbits'
    """

    name: str
    harmonics: int
    value: Array
    amplitude: Array
    parameter: Array

    __repr__ = brief

    @property
    def found(self) -> int:
        """Number of orbits near which harmonic balance finds a motion."""
        return int(np.isfinite(self.amplitude).sum())

    @property
    def worst(self) -> tuple[float, float, float]:
        """Largest relative differences of amplitude and parameter, the parameter of the first; NaN if none found."""
        if not self.found:
            return np.nan, np.nan, np.nan
        at = int(np.nanargmax(self.amplitude))
        return float(self.amplitude[at]), float(np.nanmax(self.parameter)), float(self.value[at])

    @property
    def words(self) -> str:
        """The agreement in one sentence."""
        amplitude, parameter, _ = self.worst
        by, orbits = f"harmonic balance ({self.harmonics} harmonics)", f"{self.value.size} orbits"
        if not self.found:
            return f"{by} finds no motion near any of {orbits}: take more harmonics"
        size = f"{100.0 * amplitude:.2g} % in amplitude and {100.0 * parameter:.2g} % in {self.name}"
        rest = "" if self.found == self.value.size else ", and finds no motion near the others: take more harmonics"
        return f"{by} agrees within {size} at {self.found} of {orbits}{rest}"

    def to_dict(self) -> dict[str, object]:
        """The entry `harmonic_balance` of the document of `casingfem cycles --check N --json`."""
        amplitude, parameter, at = (None if np.isnan(one) else one for one in self.worst)
        return {
            "harmonics": self.harmonics, "orbits": int(self.value.size), "found": self.found,
            "amplitude_difference": amplitude, f"{self.name}_difference": parameter, f"{self.name}_of_largest": at,
        }  # fmt: skip


def require_series(family: Family, value: float, harmonics: int) -> None:
    """Raise InputError if harmonic balance does not apply: at rigid contacts, or with too few harmonics."""
    require_count(harmonics=harmonics)
    response(family.at(value)[0], harmonics, 1)


@with_one_thread
def balance_check(family: Family, found: Cycles, *, harmonics: int = HARMONICS) -> Agreement:
    """Compare every orbit of `follow` with harmonic balance: a second opinion by other equations.

    Near each orbit the equations of `balance` are solved on the plane normal to the branch, so that the motions are
    compared at folds, too. `harmonics` are those of a period of the forcing. A motion that differs by more than 10 %
    counts as not found: short touches need more harmonics. Raises InputError for rigid contacts, and for a forcing
    above the last harmonic.

    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> family = driven.over("freq_hz", freq_hz=0.16)
    >>> found = ct.cycles.follow(family, (0.15, 0.16), longest=0.5)
    >>> agreement = ct.cycles.balance_check(family, found)
    >>> agreement.found == len(found.branches[0].points), bool(agreement.worst[0] < 1e-3)
    (True, True)
    """
    points = [branch.points for branch in found.branches]
    require_series(family, points[0][0].value, harmonics)
    rows = [row for orbits in points for row in _differences(family, orbits, harmonics)]
    amplitude, parameter = np.array(rows).T
    value = np.array([orbit.value for orbits in points for orbit in orbits])
    return Agreement(name=found.name, harmonics=harmonics, value=value, amplitude=amplitude, parameter=parameter)


def _differences(family: Family, orbits: tuple[Orbit, ...], harmonics: int) -> list[tuple[float, float]]:
    """Relative differences of amplitude and parameter at the orbits of a branch."""
    values = [orbit.value for orbit in orbits]
    periods = orbits[0].periods
    equations = Equations(
        family=family, harmonics=harmonics * periods, periods=periods, span=max(values) - min(values) or abs(values[0])
    )
    at = [Point(reals(gaps_of(family, orbit, equations.harmonics)), orbit.value) for orbit in orbits]
    rows = []
    for k, (orbit, here) in enumerate(zip(orbits, at, strict=True)):
        along = at[min(k + 1, len(at) - 1)].plus(at[max(k - 1, 0)], -1.0) if len(at) > 1 else Point(here.v, 0.0)
        ways = (equations.unit(along, here), Point(0.0 * here.v, equations.span))
        motions = (_motion(equations, here, way) for way in ways)
        one = next((motion for motion in motions if motion is not None), None)
        rows.append((np.nan, np.nan) if one is None else _difference(one, orbit, float(np.abs(values).max())))
    return rows


def _motion(equations: Equations, here: Point, along: Point) -> Balanced | None:
    """The motion on the plane through a point normal to a direction; None where there is none within the range."""
    near = equations.corrected(here, along)
    try:
        return None if near is None else equations.solution(near[0], near[2])
    except (InputError, NumericsError):
        return None


def _difference(one: Balanced, orbit: Orbit, most: float) -> tuple[float, float]:
    """Differences of amplitude, and of the parameter relative to its largest value; NaN for another motion."""
    sizes = [abs(one.amplitude[name] - size) / size for name, size in orbit.amplitude.items() if size > 0.0]
    away = max(sizes, default=0.0), abs(one.value - orbit.value) / most
    return away if max(away) <= NEAR else (np.nan, np.nan)
