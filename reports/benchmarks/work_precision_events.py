"""Repeated impacts in `work_precision`: a ball with a coefficient of restitution, and a beam of five modes on a stop.

The ball falls 5 m and loses a fifth of its speed in each of seven impacts; errors are against the closed form. The beam
meets its stop about ten times; errors are against the passage of `contact.cycles`, which locates events, too, and for
the impulse against an event-driven run with another interval of samples. `courant` is dt [s].
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

import contact as ct
from contact.cycles.driven import DrivenBody
from contact.cycles.passage import passage
from contact.model.gaps.rod_modes import Cantilever
from contact.scheme.protocol import Scheme
from reports.benchmarks.work_precision_rubs import loop_seconds
from reports.tables import Row

BALL, BEAM = "bouncing ball, restitution 0.8", "beam on a stop, 5 modes"
HEIGHT, G, E, BALL_END = 5.0, 10.0, 0.8, 7.0  # m, m/s^2, -, s
BALL_STEPS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)  # s
CLEARANCE, SPEED, MODES, BEAM_END = 1e-3, 0.5, 5, 0.05  # m, m/s, -, s
ANGLES = (0.8, 0.4, 0.1, 0.025, 0.00625)  # omega_max dt
BLADE = Cantilever(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0)
Run = Callable[[Scheme, float, int], ct.Result]


def rows(quick: bool) -> list[Row]:
    """Impulse and position at the end of both scenes, by every method that has the impact law, over steps."""
    return [*_ball(quick), *_beam(quick)]


def _ball(quick: bool) -> list[Row]:
    bodies = [ct.Wall(), ct.PointMass(mass=1.0, x=HEIGHT)]

    def ran(scheme: Scheme, dt: float, every: int) -> ct.Result:
        record = ct.Record(every=every, state_every=every)
        return ct.run(bodies, scheme=scheme, gravity=G, t_end=BALL_END, dt=dt, record=record)

    def error(result: ct.Result) -> tuple[float, float]:
        place, _ = bounced(float(result.state_time[-1]))  # at the start of the last step
        _, impulse = bounced(result.steps * result.dt)
        return abs(HEIGHT + result.state[-1, -1] - place) / HEIGHT, float(result.impulse[0]) / impulse - 1.0

    schemes: dict[str, Scheme] = {
        "Moreau-Jean, theta = 1/2": ct.MoreauJean(restitution=E),
        "CD-Lagrange": ct.scheme.CDLagrange(restitution=E),
        "Paoli-Schatzman": ct.scheme.PaoliSchatzman(restitution=E),
        "nonsmooth alpha, .8": ct.scheme.NonsmoothAlpha(rho_inf=0.8, restitution=E),
        "projected alpha, .8": ct.scheme.ProjectedAlpha(rho_inf=0.8, restitution=E),
        "event-driven": ct.scheme.EventDriven(restitution=E),
    }
    return _measured(BALL, 1, schemes, BALL_STEPS[:2] if quick else BALL_STEPS, ran, error)


def bounced(time: float) -> tuple[float, float]:
    """Height of the ball and impulse of its impacts up to a time, in closed form."""
    speed, at, impulse = math.sqrt(2.0 * G * HEIGHT), math.sqrt(2.0 * HEIGHT / G), 0.0
    while True:
        impulse += (1.0 + E) * speed
        speed *= E
        if at + 2.0 * speed / G > time:
            return (time - at) * (speed - 0.5 * G * (time - at)), impulse
        at += 2.0 * speed / G


def _beam(quick: bool) -> list[Row]:
    gap = BLADE.before_stop(clearance=CLEARANCE, velocity=SPEED, modes=MODES)
    side = gap.sides[0]
    body, tip = side.body, side.body.rows[0]

    def ran(scheme: Scheme, dt: float, every: int) -> ct.Result:
        record = ct.Record(every=every) if every > 1 else ct.Record(at=[BEAM_END])
        return ct.run(gap, scheme=scheme, t_end=BEAM_END + dt, dt=dt, record=record)

    top = float(body.omega.max())
    still = ct.run(gap, scheme=ct.scheme.EventDriven(), t_end=BEAM_END, dt=BEAM_END / 7.0)
    seen = ct.ModalBody(omega=body.omega, zeta=body.zeta, channels=("opening",), rows=-tip[None], S=body.S[:1, :1])
    driven = DrivenBody(
        patch=ct.Patch(body=seen, normal=("opening",), clearance=CLEARANCE, velocity=np.asarray(side.velocity)),
        channel="opening", amplitude=1e-30,
    )  # fmt: skip
    family = driven.over("freq_hz", freq_hz=1.0 / BEAM_END)
    motion, _ = family.at(1.0 / BEAM_END)
    place = float(tip @ passage(motion, family.begin, 0.0, BEAM_END, tangent=False).x[:MODES])

    def error(result: ct.Result) -> tuple[float, float]:
        whole = ct.run(gap, scheme=kinds[result.scheme], t_end=BEAM_END, dt=result.dt, record=ct.Record(every=1000))
        return (
            abs(float(tip @ result.state[-1]) - place) / CLEARANCE,
            float(whole.impulse[0] / still.impulse[0]) - 1.0,
        )

    schemes: dict[str, Scheme] = {
        "exact modal, forward": ct.ExactModal(law="forward"),
        "exact modal, averaged": ct.ExactModal(law="averaged"),
        "exact modal, energy": ct.ExactModal(law="energy"),
        "event-driven": ct.scheme.EventDriven(),
    }
    kinds: dict[str, Scheme] = {}

    def named(scheme: Scheme, dt: float, every: int) -> ct.Result:
        result = ran(scheme, dt, every)
        kinds[result.scheme] = scheme
        return result

    steps = tuple(BEAM_END / math.ceil(BEAM_END * top / angle) for angle in (ANGLES[:2] if quick else ANGLES))
    return _measured(BEAM, MODES, schemes, steps, named, error)


def _measured(
    scene: str, size: int, schemes: dict[str, Scheme], steps: tuple[float, ...], run: Run,
    error: Callable[[ct.Result], tuple[float, float]],
) -> list[Row]:  # fmt: skip
    """One row for each scheme and step."""
    found: list[Row] = []
    for name, scheme in schemes.items():
        for dt in steps:
            row: Row = {"scene": scene, "method": name, "elements": size, "courant": dt}
            try:
                result = run(scheme, dt, 1)
            except ct.InputError as refused:
                found.append({**row, "note": str(refused).split(",")[0]})
                continue
            spent = loop_seconds(partial(run, scheme, dt, 1000))
            gap, impulse = error(result)
            found.append({
                **row, "steps": result.steps, "seconds": spent, "gap": gap, "impulse": impulse,
                "unaccounted": abs(result.energy.unaccounted) / result.energy.scale,
                "us/step": 1e6 * spent / result.steps,
            })  # fmt: skip
    return found
