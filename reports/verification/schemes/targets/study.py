"""Statements of the source study about contact of rods, each compared with a computed figure."""

from __future__ import annotations

import numpy as np

import contact as ct
from reports.tables import Row
from reports.verification.schemes.cases import GAP, Method, errors, rod_wall_case, run, two_rods_case
from reports.verification.schemes.rod_wall import rate
from reports.verification.schemes.targets.rods import FORWARD, target

CONFIRMED, NOT = "confirmed", "NOT confirmed"


def rows(quick: bool) -> list[Row]:
    """One row a statement."""
    sizes = [25, 100] if quick else [25, 50, 100, 200]
    return [*_penalty(sizes), *_pairs(sizes), _limit(), *_orders()]


def statement(words: str, asked: float, reached: float, *, at_least: bool = False) -> Row:
    """A target whose verdict is a word on a statement."""
    row = target(f"study: {words}", asked, reached, at_least=at_least, missed=NOT)
    return row | {"verdict": CONFIRMED if row["verdict"] == "pass" else NOT}


def _l1(scheme: Method, elements: int) -> float:
    return float(str(errors(rod_wall_case(), run(rod_wall_case(), scheme, elements, 0.5))["force L1"]))


def _penalty(sizes: list[int]) -> list[Row]:
    case = two_rods_case()
    soft = Method(name="penalty", scheme=ct.scheme.PenaltyDifference(), law=ct.Penalty(stiffness=2e9))
    found = {
        m.name: [float(str(errors(case, run(case, m, n, 0.5))["force L1"])) for n in sizes] for m in (FORWARD, soft)
    }
    depth = run(case, soft, sizes[-1], 0.5).max_penetration[0]
    return [
        statement("Lagrange force error falls with the mesh, rate", 0.7, rate(sizes, found[FORWARD.name]),
                  at_least=True),
        statement("penalty 2e9 N/m force error does not, rate", 0.2, rate(sizes, found["penalty"])),
        statement("penalty over Lagrange, force error on the finest mesh", 3.0,
                  found["penalty"][-1] / found[FORWARD.name][-1], at_least=True),
        statement("Lagrange does not penetrate, depth/gap", 1e-12,
                  float(run(case, FORWARD, sizes[-1], 0.5).max_penetration[0]) / GAP),
        statement("penalty does, depth/gap", 0.01, float(depth) / GAP, at_least=True),
    ]  # fmt: skip


def _pairs(sizes: list[int]) -> list[Row]:
    bad = Method(name="bad", scheme=ct.scheme.Newmark(beta=0.25, gamma=0.55))
    good = Method(name="good", scheme=ct.scheme.Newmark(beta=0.5, gamma=0.55))
    case = rod_wall_case()
    wild, calm = ([_l1(method, n) for n in sizes] for method in (bad, good))
    a, b = (run(case, method, sizes[-1], 0.5) for method in (good, FORWARD))
    impulse = abs(float(a.impulse[0] / b.impulse[0]) - 1.0)
    shift = np.abs(a.windowed_force(0.05)[:, 0] - np.interp(a.time, b.time, b.windowed_force(0.05)[:, 0])).max() / 300.0
    return [
        statement("Newmark (.25, .55) does not converge in force, rate", 0.1, rate(sizes, wild)),
        statement("Newmark (.25, .55) oscillates, force L1 on the finest mesh", 1.0, wild[-1], at_least=True),
        statement("Newmark (.5, .55) converges in force, rate", 0.7, rate(sizes, calm), at_least=True),
        statement("Newmark (.5, .55) agrees with explicit: impulse", 0.01, impulse),
        statement("Newmark (.5, .55) agrees with explicit: force averaged over .05 s", 0.1, float(shift)),
    ]


def _limit() -> Row:
    """Energy of a contact run at exactly the free limit, Courant 1, over that of the motion."""
    case = rod_wall_case()
    result = run(case, FORWARD, 100, 1.0)
    return statement("the explicit limit is not lowered by Lagrange contact: energy gained at Courant 1", 1e-9,
                     (result.energy.end.total - result.energy.start.total) / case.energy)  # fmt: skip


def _orders() -> list[Row]:
    """Fitted orders of a free oscillator, omega = 1, after 1.5 s."""
    rows = []
    for beta, gamma, order in ((0.25, 0.5, 2.0), (0.25, 0.55, 1.0), (0.5, 0.55, 1.0)):
        steps = 0.01 * 0.5 ** np.arange(4)  # small enough for (gamma - 1/2) h to outweigh h^2
        errors_ = [abs(_swing(ct.scheme.Newmark(beta=beta, gamma=gamma), float(dt)) - np.cos(1.5)) for dt in steps]
        slope = float(np.polyfit(np.log(steps), np.log(errors_), 1)[0])
        rows.append(statement(f"Newmark ({beta:g}, {gamma:g}) has order {order:g}: distance of the fitted one", 0.2,
                              abs(slope - order)))  # fmt: skip
    return rows


def _swing(scheme: ct.scheme.Newmark, dt: float) -> float:
    count = round(1.5 / dt)
    ball = ct.PointMass(mass=1.0, x=1.0, anchor=0.0, stiffness=1.0)
    result = ct.run([ct.Wall(x=-50.0), ball], scheme=scheme, t_end=(count + 1) * dt, dt=dt,
                    record=ct.Record(state_every=1))  # fmt: skip
    return 1.0 + float(result.state[count, 1])
