"""Contact against exact solutions: two rods, rod on a wall, bouncing bar, by finite elements and by modes.

`python -m reports.verification.schemes.accuracy [--quick] [--out DIR]` prints the tables and writes
contact_accuracy.csv and contact_accuracy_long.csv. --quick leaves out the finest and longest runs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

import contact as ct
from contact.base.errors import DivergedError
from contact.reference.exact import (
    BarHistory,
    ExactContact,
    bar_by_characteristics,
    bouncing_bar,
    force_error,
    rod_on_wall,
    two_rods,
)
from reports.tables import Row, command_line, show, write
from reports.verification.schemes.cases import CARPENTER, GAP, SPEED

BAR = {"length": 10.0, "area": 1.0, "E": 900.0, "rho": 1.0, "x": 5.0}
PERIOD = 16.0 / 3.0
DROPS = 8
SPACING = np.pi * 30.0 / 10.0  # rad/s between the modes of the bar
COLUMNS = {
    "case": "{}", "method": "{}", "size": "{}", "step": "{:.2f}", "steps": "{}", "force L1 %": "{:.2f}",
    "windowed L1 %": "{:.2f}", "ripple %": "{:.2f}", "impulse %": "{:+.3f}", "penetration [m]": "{:.0e}",
    "duration %": "{:+.2f}", "energy loss %": "{:+.4f}", "momentum drift": "{:.0e}", "first spike": "{:.2f}",
    "tip error %": "{:.2f}", "us/step": "{:.2f}",
}  # fmt: skip


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and write it to `out`; `quick` leaves out the finest and longest runs."""
    rows = list(_rows(quick))
    table = [list(COLUMNS), *([_cell(name, row) for name in COLUMNS] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for line in table:
        print(
            "  ".join(
                cell.ljust(w) if i < 3 else cell.rjust(w) for i, (cell, w) in enumerate(zip(line, widths, strict=True))
            )
        )
    if not quick:
        long = list(_long_runs())
        show("A million steps of repeated impact, 20 modes; energy over what falls", long)
        write(out / "contact_accuracy_long.csv", long)
    write(out / "contact_accuracy.csv", [{name: row.get(name) for name in COLUMNS} for row in rows])
    return rows


def _rows(quick: bool) -> Iterator[Row]:
    meshes = (20,) if quick else (20, 100)
    for elements in meshes:
        for courant in (0.9, 0.5, 0.1):
            yield _two_rods(elements, courant)
    for elements in meshes:
        yield _two_rods(elements, 0.5, law=ct.Penalty(stiffness=3.5e8))
    for elements in meshes:
        for courant in (0.9, 0.5, 0.1):
            yield _bar_shot(f"{elements} elements", courant, elements=elements, courant=courant)
    for law, product in (
        ("forward", 0.8),
        ("forward", 2.5),
        ("forward", 3.0),
        ("averaged", 0.8),
        ("energy", 0.8),
        ("energy", 3.0),
    ):
        scheme = ct.ExactModal(law=law, modes=50, omega_h_limit=3.05)
        yield _bar_shot("50 modes + S", product, elements=1, dt=product / (49 * SPACING), scheme=scheme)
    for elements in meshes:
        yield _bar_drop(f"{elements} elements", 1, 0.9, elements=elements, courant=0.9)
    for law, modes, steps in (
        ("forward", 150, 26_000),
        ("energy", 150, 25_600),
        ("energy", 150, 26_000),
        ("averaged", 150, 76_000),
    ):
        if not quick or steps < 30_000:
            yield from _bar_drop_modal(law, modes, steps)


def _long_runs() -> Iterator[Row]:
    """One row per law and step size: a bar of 20 modes dropped again and again for a million steps, in DROPS runs.

    Repeated impact amplifies rounding errors, so runs whose steps differ by 1e-12 are random draws. `runs` counts those
    that were not stopped.
    """
    cases = [("averaged", product) for product in (0.01, 0.05, 0.1, 0.2, 0.8)] + [("energy", 0.8), ("energy", 8.0)]
    for law, product in cases:
        results = []
        for k in range(DROPS):
            dt = product * (1.0 + 1e-12 * k) / (19 * SPACING)
            run = _runner(
                [ct.Rod(**BAR), ct.Wall(x=0.0)], t_end=1e6 * dt, dt=dt, gravity=10.0, record=ct.Record(every=1000),
                scheme=ct.ExactModal(law=law, modes=20),
            )  # fmt: skip
            try:
                results.append(run())
            except DivergedError:  # a run in which contact adds more energy than there was is stopped
                continue
        if len(results) < DROPS:
            yield {"law": law, "omega dt": product, "runs": len(results)}
            continue
        drift = [(result.energy.end.total - result.energy.start.total) / 500.0 for result in results]
        yield {
            "law": law, "omega dt": product, "runs": DROPS,
            "closings": round(np.mean([len(result.intervals[0]) for result in results])),
            "energy drift": float(np.mean(drift)), "scatter": float(np.std(drift, ddof=1)),
            "unaccounted": max(abs(result.energy.unaccounted) for result in results) / 500.0,
            "us/step": min(1e6 * result.seconds / result.steps for result in results),
        }  # fmt: skip


def _measured(
    case: str, size: str, step: float, run: Callable[[], ct.Result], exact: ExactContact
) -> tuple[Row, ct.Result]:
    """Run twice, because the first run may compile, and fill the columns that every case has."""
    run()
    result = run()
    raw, windowed = result.force[:, 0], result.windowed_force()[:, 0]
    start, end = exact.intervals[0]
    inside = (result.time > start + 0.1 * (end - start)) & (result.time < end - 0.1 * (end - start))
    energy = result.energy
    return {
        "case": case, "method": _method(result.scheme),
        "size": size, "step": step, "steps": result.steps,
        "force L1 %": 100 * force_error(result.time, raw, result.dt, exact),
        "windowed L1 %": 100 * force_error(result.time, windowed, result.dt, exact),
        "ripple %": 100 * float(np.std(raw[inside] - exact(result.time[inside]))) / float(exact.force.mean()),
        "impulse %": 100 * (float(result.impulse[0]) / exact.impulse - 1.0),
        "penetration [m]": float(result.max_penetration[0]),
        "energy loss %": 100 * (1.0 - energy.end.total / energy.start.total),
        "us/step": 1e6 * result.seconds / result.steps,
    }, result  # fmt: skip


def _single(row: Row, result: ct.Result, exact: ExactContact) -> Row:
    """Add the columns of cases with a single contact."""
    (start, end), (begin, finish) = (result.intervals[0][0][0], result.intervals[0][-1][1]), exact.intervals[0]
    row["duration %"] = 100 * ((end - start) / (finish - begin) - 1.0)
    row["first spike"] = float(result.peak_force[0] / exact.force[0, 0])
    return row


def _two_rods(elements: int, courant: float, law: ct.Unilateral | ct.Penalty | None = None) -> Row:
    left = ct.Rod(**CARPENTER, elements=elements, x=-CARPENTER["length"] - GAP, velocity=SPEED)
    right = ct.Rod(**CARPENTER, elements=elements)
    exact = two_rods(right, gap=GAP, velocity=SPEED)
    row, result = _measured(
        "B1 two rods", f"{elements} elements", courant,
        lambda: ct.run([left, right], law=law, t_end=2.5e-4, courant=courant), exact,
    )  # fmt: skip
    row["momentum drift"] = abs(sum(m.momentum for m in result.motions) / (left.mass * SPEED) - 1.0)
    return _single(row, result, exact)


def _bar_shot(size: str, step: float, *, elements: int, **options: object) -> Row:
    bar = ct.Rod(**BAR, elements=elements, velocity=-10.0)
    exact = rod_on_wall(bar, gap=5.0, velocity=10.0)
    run = _runner([bar, ct.Wall(x=0.0)], t_end=2.0, **options)
    row, result = _measured("B2 (i) rod on wall", size, step, run, exact)
    return _single(row, result, exact)


def _bar_drop(size: str, periods: int, step: float, *, elements: int, **options: object) -> Row:
    bar = ct.Rod(**BAR, elements=elements)
    run = _runner(
        [bar, ct.Wall(x=0.0)], t_end=periods * PERIOD, gravity=10.0, record=ct.Record(state_every=1), **options
    )
    row, result = _measured(f"B2 (ii) {periods} period", size, step, run, bouncing_bar(2 * periods))
    row["tip error %"] = 100 * float(_tip_error(result, 5.0 + result.state[:, 1], _history(periods)).max())
    return row


def _bar_drop_modal(law: str, modes: int, steps: int) -> Iterator[Row]:
    """Ten periods; one row over the first two, one over the last two."""
    bar, dt = ct.Rod(**BAR), 10 * PERIOD / steps
    basis = ct.gaps.rod_modes(bar, modes=modes, end="left")
    scheme = ct.ExactModal(law=law, modes=modes, omega_h_limit=3.05)
    run = _runner(
        [bar, ct.Wall(x=0.0)], t_end=10 * PERIOD, dt=dt, gravity=10.0, scheme=scheme,
        record=ct.Record(state_every=1),
    )  # fmt: skip
    exact = bouncing_bar(20)
    row, result = _measured("", f"{modes} modes + S", dt * (modes - 1) * SPACING, run, exact)
    elastic = 5.0 + result.state @ basis.rows[0]
    tip = np.maximum(elastic, 0.0) if law == "energy" else elastic + basis.S[0, 0] * result.force[:, 0]
    error, windowed = _tip_error(result, tip, _history(10)), result.windowed_force()[:, 0]
    for name, part in (("1-2", result.time < 2 * PERIOD), ("9-10", result.time >= 8 * PERIOD)):
        share = {
            "case": f"B2 (ii) periods {name}", "tip error %": 100 * float(error[part].max()),
            "force L1 %": 100 * force_error(result.time[part], result.force[part, 0], dt, exact),
            "windowed L1 %": 100 * force_error(result.time[part], windowed[part], dt, exact),
        }  # fmt: skip
        yield {**row, **share, "ripple %": None}


def _runner(bodies: list[ct.Rod | ct.PointMass | ct.Wall], **options: object) -> Callable[[], ct.Result]:
    return lambda: ct.run(bodies, **options)


def _method(label: str) -> str:
    """Shorten the label of a result to the part that differs between rows."""
    first, second = label.split(", ")[:2]
    return second if first == "exact modal" else first.removeprefix("central difference + ")


def _history(periods: int) -> BarHistory:
    return bar_by_characteristics(ct.Rod(**BAR), gravity=10.0, t_end=periods * PERIOD + 1.0, cells=300)


def _tip_error(result: ct.Result, tip: np.ndarray, history: BarHistory) -> np.ndarray:
    """Distance from the exact height of the lower end, over h_0 = 5."""
    return np.abs(tip - np.interp(result.state_time, history.time, history.gap)) / 5.0


def _cell(name: str, row: Row) -> str:
    value = row.get(name)
    return "-" if value is None else COLUMNS[name].format(value)


if __name__ == "__main__":
    command_line(__doc__, main)
