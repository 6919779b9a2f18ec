"""Verification rows of contact in one dimension: published and exact values B1 to B5, each by the scheme named."""

from __future__ import annotations

import numpy as np

import contact as ct
from contact.reference.exact import Bounces, stopped_period
from reports.tables import Row, check
from reports.verification.schemes.cases import methods, rod_wall_case, run, two_rods_case

MASSLESS = methods(1.0)[1]


def rows(quick: bool) -> list[Row]:
    """All rows; none is long."""
    return [*_two_rods(), *_bar(), *_ball(), _oscillator(), *_st_venant(quick)]


def _two_rods() -> list[Row]:
    case = two_rods_case()
    result = run(case, MASSLESS, 100, 0.95)
    begin, end = result.intervals[0][0][0], result.intervals[0][-1][1]
    middle = (result.time > 0.8e-4) & (result.time < 1.2e-4)
    source = "Carpenter et al. 1991"
    return [
        check("B1 two rods, closing [us]", source, 49.456, 1e6 * begin, 5e-5),
        check("B1 two rods, duration [us]", source, 98.928, 1e6 * (end - begin), 0.5),
        check(
            "B1 two rods, force [N], 15 002 lbf published",
            source,
            66732.0,
            float(result.force[middle, 0].mean()),
            0.0038,
        ),
        check(
            "B1 two rods, speed handed on [m/s], 202.2 in/s published",
            source,
            5.13588,
            result.motions[1].mean_velocity,
            0.25,
        ),
    ]


def _bar() -> list[Row]:
    shot = run(rod_wall_case(), MASSLESS, 100, 0.95)
    drop = ct.run([ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, x=5.0), ct.Wall()], scheme=MASSLESS.scheme,
                  t_end=16.0 / 3.0, courant=0.95, gravity=10.0)  # fmt: skip
    source = "Doyen et al. 2011"
    return [
        check("B2 bar on wall, impulse [N s]", source, 200.0, float(shot.impulse[0]), 0.24),
        check("B2 bouncing bar, impulse of two impacts [N s]", source, 533.333, float(drop.impulse[0]), 0.24),
        check("B2 bouncing bar, second closing [s]", source, 11.0 / 3.0, drop.merged_intervals()[0][1][0], 0.24),
    ]


def _ball() -> list[Row]:
    exact = Bounces(height=1.0, gravity=9.81, restitution=0.8)
    ball = [ct.PointMass(mass=1.0, x=1.0), ct.Wall()]
    scheme = ct.MoreauJean(restitution=0.8)
    first = ct.run(ball, scheme=scheme, t_end=0.6, dt=1e-4, gravity=9.81)
    long = ct.run(ball, scheme=scheme, t_end=5.0, dt=1e-4, gravity=9.81)
    rest = long.time > 4.2
    rebound = float(first.impulse[0]) - exact.gravity * exact.first
    return [
        check("B3 ball, first impact [s]", "closed form", 0.451524, first.intervals[0][0][0], 0.025),
        check("B3 ball, rebound [m/s]", "closed form", 3.543558, rebound, 0.025),
        check("B3 ball, force at rest [N]", "closed form", 9.81, float(long.force[rest, 0].mean()), 0.025),
    ]


def _oscillator() -> Row:
    bodies = [ct.PointMass(mass=1.0, x=-2.0, anchor=0.0, stiffness=1.0), ct.Wall(x=1.0)]
    result = ct.run(bodies, scheme=ct.MoreauJean(restitution=1.0), t_end=80.0, dt=1e-3)
    closings = np.array([start for start, _ in result.intervals[0]])
    exact = stopped_period(1.0, 1.0, 2.0)
    return check(
        "B4 oscillator against a stop, period [s]", "closed form", exact, float(np.diff(closings).mean()), 0.0075
    )


def _st_venant(quick: bool) -> list[Row]:
    rod = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=100 if quick else 400, fixed="right")
    result = ct.run([ct.PointMass(mass=1.0, velocity=1.0), rod], scheme=MASSLESS.scheme, t_end=4.0, courant=0.95)
    window = 0.1  # after the jump at 2 L/c, read past its overshoot: F = 2.135335 exp(-s) (1 + ...) there
    late = (result.time > 2.0 + 0.5 * window) & (result.time < 2.0 + 1.5 * window)
    s = result.time[late] - 2.0
    # F = e^-t + 2 (1 - (t - 2)) e^-(t-2) for 2 < t < 4
    exact = np.exp(-result.time[late]) + 2.0 * (1.0 - s) * np.exp(-s)
    jump = float(np.mean(result.force[late, 0] - exact)) + 2.0 + np.exp(-2.0)
    limit = 2.0 if quick else 0.3
    return [
        check("B5 St Venant, force after one round trip over Z V", "St Venant", 2.135335, jump, limit),
        check("B5 St Venant, end of contact [L/c]", "St Venant", 3.067668, result.merged_intervals()[0][-1][1], limit),
        check("B5 St Venant, rebound over V", "St Venant", -0.687619, result.motions[0].mean_velocity, limit),
    ]
