"""Scenes with exact solutions and methods to run them by, shared by the reports on contact in one dimension."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import contact as ct
from contact.model.bodies.body import Body
from contact.model.law import Law
from contact.reference.exact import bar_by_characteristics, bouncing_bar, force_error, rod_on_wall, two_rods
from contact.reference.waves import impact_by_characteristics
from contact.scheme.protocol import Scheme
from reports.tables import Row

Array = NDArray[np.float64]
# Carpenter, Taylor, Katona 1991, published in inch, pound and second: length 10 in, area 1 in^2, E = 30e6 psi, density
# 7.34e-4 lbf s^2/in^4, speed 202.2 in/s, gap 0.01 in
CARPENTER = {"length": 0.254, "area": 6.4516e-4, "E": 206.8427e9, "rho": 7844.181}
SPEED, GAP = 5.13588, 2.54e-4  # m/s, m
BAR = {"length": 10.0, "area": 1.0, "E": 900.0, "rho": 1.0, "x": 5.0}
UNIT = {"length": 1.0, "area": 1.0, "E": 1.0, "rho": 1.0}
PERIOD = 16.0 / 3.0


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Case:
    """Bodies by the number of elements, and their exact solution.

    `height` [m] scales errors of the gap, `energy` [J], that of the motion, the change of energy.
    """

    name: str
    bodies: Callable[[int], list[Body]]
    t_end: float
    force: Callable[[Array], Array]
    impulse: float
    gap: tuple[Array, Array]
    height: float
    energy: float
    gravity: float = 0.0
    plateau: float = math.nan  # the first value of the force


@dataclass(frozen=True, slots=True, kw_only=True)
class Method:
    """A scheme and the contact law that it uses."""

    name: str
    scheme: Scheme
    law: Law = ct.Unilateral()  # noqa: RUF009 - a frozen value


def methods(stiffness: float) -> list[Method]:
    """Every scheme; `stiffness` [N/m] of contact springs, a thousand times larger for augmented Lagrangians."""
    return [
        Method(name="forward Lagrange", scheme=ct.CentralDifference()),
        Method(name="massless boundary", scheme=ct.scheme.MasslessBoundary()),
        Method(name="CD-Lagrange", scheme=ct.scheme.CDLagrange()),
        Method(name="Paoli-Schatzman, e = 0", scheme=ct.scheme.PaoliSchatzman()),
        Method(name="Moreau-Jean, theta = 1/2", scheme=ct.MoreauJean()),
        Method(name="stabilised Newmark", scheme=ct.scheme.StabilisedNewmark()),
        Method(name="nonsmooth alpha, .8", scheme=ct.scheme.NonsmoothAlpha(rho_inf=0.8)),
        Method(name="projected alpha, .8", scheme=ct.scheme.ProjectedAlpha(rho_inf=0.8)),
        Method(name="HHT (-.3)", scheme=ct.scheme.HHT(alpha=-0.3)),
        Method(
            name="HHT (-.3), augmented",
            scheme=ct.scheme.HHT(alpha=-0.3),
            law=ct.laws.AugmentedLagrangian(stiffness=1e3 * stiffness),
        ),
        Method(name="Newmark (.5, .55)", scheme=ct.scheme.Newmark(beta=0.5, gamma=0.55)),
        Method(name="Newmark (.25, .55)", scheme=ct.scheme.Newmark(beta=0.25, gamma=0.55)),
        Method(name="Newmark (.25, .5)", scheme=ct.scheme.Newmark()),
        Method(name="HHT (-.3), penalty", scheme=ct.scheme.HHT(alpha=-0.3), law=ct.Penalty(stiffness=stiffness)),
        Method(name="explicit penalty", scheme=ct.scheme.PenaltyDifference(), law=ct.Penalty(stiffness=stiffness)),
    ]


def two_rods_case() -> Case:
    """B1: two identical rods, one thrown at the other."""
    rod = ct.Rod(**CARPENTER)
    start, exact = GAP / SPEED, two_rods(rod, gap=GAP, velocity=SPEED)
    impact = impact_by_characteristics(
        ct.Rod(**CARPENTER, x=-rod.length, velocity=SPEED),
        rod,
        dt=rod.length / rod.wave_speed / 100,
        t_end=2.5e-4 - start,
    )
    gap = (np.concatenate(([0.0], impact.time + start)), np.concatenate(([GAP], impact.gap)))
    return Case(
        name="two rods", t_end=2.5e-4, force=exact, impulse=exact.impulse, gap=gap, height=GAP,
        energy=0.5 * rod.mass * SPEED**2,
        plateau=float(exact.force[0, 0]),
        bodies=lambda n: [
            ct.Rod(**CARPENTER, elements=n, x=-rod.length - GAP, velocity=SPEED), ct.Rod(**CARPENTER, elements=n)
        ],
    )  # fmt: skip


def rod_wall_case() -> Case:
    """B2 (i): bar thrown at a wall."""
    bar = ct.Rod(**BAR, velocity=-10.0)
    exact, history = (
        rod_on_wall(bar, gap=5.0, velocity=10.0),
        bar_by_characteristics(bar, gravity=0.0, t_end=2.1, cells=300),
    )
    return Case(
        name="rod on wall", t_end=2.0, force=exact, impulse=exact.impulse, gap=(history.time, history.gap), height=5.0,
        energy=500.0, plateau=300.0, bodies=lambda n: [ct.Rod(**BAR, elements=n, velocity=-10.0), ct.Wall()],
    )  # fmt: skip


def bouncing_case(periods: int = 3) -> Case:
    """B2 (ii): bar dropped on a wall, two impacts a period."""
    exact = bouncing_bar(2 * periods)
    history = bar_by_characteristics(ct.Rod(**BAR), gravity=10.0, t_end=periods * PERIOD + 0.1, cells=300)
    return Case(
        name=f"bouncing bar, {2 * periods} impacts", t_end=periods * PERIOD, force=exact, impulse=exact.impulse,
        gap=(history.time, history.gap), height=5.0, energy=500.0, gravity=10.0, plateau=300.0,
        bodies=lambda n: [ct.Rod(**BAR, elements=n), ct.Wall()],
    )  # fmt: skip


def _by_waves(name: str, t_end: float, bodies: Callable[[int], list[Body]]) -> Case:
    left, right = bodies(1)
    assert isinstance(left, ct.Rod | ct.PointMass)
    impact = impact_by_characteristics(left, right, dt=1e-3, t_end=t_end + 0.1)
    until = impact.time[:-1] < t_end
    energy = 0.5 * left.mass * left.velocity**2
    return Case(
        name=name, t_end=t_end, force=impact, impulse=float(impact.step_force[until].sum()) * 1e-3,
        gap=(impact.time, impact.gap), height=1.0, energy=energy, plateau=float(impact.force[0]),
        bodies=bodies,
    )  # fmt: skip


def cases() -> list[Case]:
    """All scenes with an exact solution."""
    short = {**UNIT, "area": 4.0, "x": -1.0, "velocity": 1.0}
    mass = ct.PointMass(mass=1.0, velocity=1.0)
    return [
        two_rods_case(), rod_wall_case(), bouncing_case(),
        _by_waves("unequal rods", 10.0,
                  lambda n: [ct.Rod(**short, elements=n), ct.Rod(**{**UNIT, "length": 8.0}, elements=8 * n)]),
        _by_waves("mass on a fixed rod", 4.0, lambda n: [mass, ct.Rod(**UNIT, elements=n, fixed="right")]),
        _by_waves("mass on a free rod", 4.0, lambda n: [mass, ct.Rod(**UNIT, elements=n)]),
    ]  # fmt: skip


def spring(case: Case, elements: int) -> float:
    """A contact spring as stiff as one element of the case's softest rod [N/m]: stable at Courant .5."""
    rods = [body for body in case.bodies(elements) if isinstance(body, ct.Rod)]
    return min(rod.E * rod.area * rod.elements / rod.length for rod in rods)


def run(case: Case, method: Method, elements: int, courant: float, *, every: int = 1) -> ct.Result:
    """Run a case with stored displacements; a run that gains energy is a row too."""
    return ct.run(
        case.bodies(elements), law=method.law, scheme=method.scheme, t_end=case.t_end, courant=courant,
        gravity=case.gravity, record=ct.Record(every=every, state_every=every), on_limit="flag",
    )  # fmt: skip


def errors(case: Case, result: ct.Result) -> Row:
    """Errors of force, impulse, displacement and energy against the exact solution, and the run time."""
    time, force = result.time, result.force[:, 0]
    energy = result.energy
    return {
        "steps": result.steps,
        "force L1": force_error(time, force, result.dt, case.force),
        "force L2": force_error(time, force, result.dt, case.force, norm=2),
        "windowed L1": force_error(time, result.windowed_force()[:, 0], result.dt, case.force),
        "peak/exact": float(result.peak_force[0]) / case.plateau,
        "impulse": float(result.impulse[0]) / case.impulse - 1.0,
        "gap": gap_error(case, result),
        "energy": (energy.end.total - energy.start.total) / case.energy,
        "unaccounted": abs(energy.unaccounted) / energy.scale,
        "us/step": 1e6 * result.seconds / result.steps,
    }


def gap_error(case: Case, result: ct.Result) -> float | None:
    """Largest error of the gap over the run, over the case's height; two bodies, lower first. None of modes."""
    if len(result.blocks) != 2:
        return None
    first, second = sorted(result.blocks, key=lambda block: block[1])
    gap = case.gap[1][0] + result.state[:, second[1]] - result.state[:, first[2] - 1]
    return float(np.abs(gap - np.interp(result.state_time, *case.gap)).max()) / case.height
