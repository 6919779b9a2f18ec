"""Contact targets of modal runs: a rod on a wall in 50 modes, ten periods of bouncing, a million steps, speed."""

from __future__ import annotations

import numpy as np

import contact as ct
from contact.reference.exact import bar_by_characteristics, bouncing_bar, force_error, rod_on_wall
from reports.tables import Row
from reports.verification.schemes.cases import BAR, PERIOD
from reports.verification.schemes.targets.rods import A_TIME, target

SPACING = np.pi * 30.0 / 10.0  # rad/s between the bar's modes


def rows(quick: bool) -> list[Row]:
    """All lines; `quick` omits the long runs."""
    lines = [line for product in (0.8, 3.0) for line in _shot(product)]
    return lines if quick else [*lines, *_ten_periods(), *_million(), *_speed()]


def _dropped(law: str, modes: int, dt: float, t_end: float, record: ct.Record) -> ct.Result:
    scheme = ct.ExactModal(law=law, modes=modes, omega_h_limit=3.05)
    return ct.run([ct.Rod(**BAR), ct.Wall()], t_end=t_end, dt=dt, gravity=10.0, scheme=scheme, record=record)


def _shot(product: float) -> list[Row]:
    bar = ct.Rod(**BAR, velocity=-10.0)
    scheme = ct.ExactModal(law="forward", modes=50, omega_h_limit=3.05)
    result = ct.run([bar, ct.Wall()], t_end=2.0, dt=product / (49 * SPACING), scheme=scheme)
    exact, force, energy = rod_on_wall(bar, gap=5.0, velocity=10.0), result.force[:, 0], result.energy
    inside = (result.time > 0.55) & (result.time < 1.1)
    head = f"rod on wall, 50 modes, omega_max dt {product:g}, forward law"
    return [
        target(f"{head}: force L1", 0.025, force_error(result.time, force, result.dt, exact)),
        target(f"{head}: ripple rms", 0.01, float(np.std(force[inside])) / 300.0),
        target(f"{head}: energy lost", 0.016, 1.0 - energy.end.total / energy.start.total),
        target(f"{head}: unaccounted", 1e-10, abs(energy.unaccounted) / energy.scale),
    ]


def _ten_periods() -> list[Row]:
    steps, modes = 25_600, 150
    record = ct.Record(state_every=1)
    result = _dropped("energy", modes, 10 * PERIOD / steps, 10 * PERIOD, record)
    bar, exact = ct.Rod(**BAR), bouncing_bar(20)
    history = bar_by_characteristics(bar, gravity=10.0, t_end=10 * PERIOD + 1.0, cells=300)
    tip = np.maximum(5.0 + result.state @ ct.gaps.rod_modes(bar, modes=modes, end="left").rows[0], 0.0)
    error = np.abs(tip - np.interp(result.state_time, history.time, history.gap)) / 5.0
    lines = []
    for name, part, far, strong in (
        ("1-2", result.time < 2 * PERIOD, 0.01, 0.02), ("9-10", result.time >= 8 * PERIOD, 0.03, 0.06),
    ):  # fmt: skip
        force = force_error(result.time[part], result.force[part, 0], result.dt, exact)
        head = f"bouncing bar, 150 modes, 25 600 steps, energy law, periods {name}"
        lines += [
            target(f"{head}: displacement", far, float(error[part].max())),
            target(f"{head}: force L1", strong, force),
        ]
    drift = abs(result.energy.end.total / result.energy.start.total - 1.0)
    return [
        *lines, target("the same: seconds", 1.0, result.seconds),
        target("the same: energy drift over 20 impacts", 1e-11, drift),
    ]  # fmt: skip


def _million() -> list[Row]:
    """Drift of the energy; for the averaged law the mean of several runs, because rounding changes single ones."""
    lines = []
    for law, product, limit, runs in (("energy", 0.8, 1e-9, 1), ("averaged", 0.05, 1e-3, 16)):
        drifts, impacts = [], []
        for k in range(runs):
            dt = product * (1.0 + 1e-12 * k) / (19 * SPACING)
            result = _dropped(law, 20, dt, 1e6 * dt, ct.Record(every=1000))
            drifts.append((result.energy.end.total - result.energy.start.total) / 500.0)
            impacts.append(len(result.intervals[0]))
        head = f"a million steps, {round(np.mean(impacts))} impacts, {law} law, omega_max dt {product:g}"
        head += "" if runs == 1 else f", mean of {runs} runs"
        lines.append(target(f"{head}: energy drift", limit, abs(float(np.mean(drifts)))))
    return lines


def _speed() -> list[Row]:
    dt = 0.8 / (49 * SPACING)
    results = [_dropped("forward", 50, dt, 2e5 * dt, ct.Record(every=1000)) for _ in range(5)]
    best = max(result.steps / result.seconds for result in results)
    return [target("50 modes, one contact: steps per second", 5e5, best, at_least=True, missed=A_TIME)]
