"""Whether the sign of the pole predicts growth of closed contact: speeds and blade frequencies, by poles and in time.

`python -m reports.verification.rubs.interaction [--quick] [--out DIR]` prints the coincidences of the hand calculation,
then one row for each speed and blade frequency: growth by the poles, growth in a run of the same pair pressed together,
and whether the signs agree. Rows with |growth| below .05 1/s are marked, because a run of one or two seconds cannot
show such a small growth.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from casingfem.modal.interaction import interactions
from contact.io.outfiles import write_atomic
from contact.stability.closed_contact import growth
from contact.stability.coincidence import coincidences, loaded
from reports.tables import Row, command_line, show, write
from reports.verification.interaction import B6, OTHERS, around, digging
from reports.verification.rubs.closed_run import confirming_run

SMALL = 0.05  # 1/s
SPEEDS = np.array([1.0, 60.0])  # turns/s


def signs(quick: bool) -> list[Row]:
    """Pairs of speed and blade frequency about the sum, with damping by which some decay."""
    rows: list[Row] = []
    damped = digging(0.0, 0.0, zeta=4e-4)
    for freq in (110.0, 120.0) if quick else (100.0, 110.0, 120.0, 130.0, 140.0):
        pair = replace(damped, blade=replace(damped.blade, freq_hz=freq))
        sum_hz, low = loaded(pair).speed_hz, coincidences(pair.contact(), SPEEDS)
        difference = next(c.speed_hz for c in low if c.branch == "backward" and c.speed_hz > 0.0)
        for speed in (sum_hz - 1.0, sum_hz - 0.1, sum_hz, sum_hz + 0.08, sum_hz + 1.0, difference, 40.0):
            rate = float(growth(pair.contact(), np.array([speed]))[0])
            seen = confirming_run(pair, float(speed)).run
            rows.append(
                {
                    "blade Hz": freq, "speed Hz": float(speed), "pole 1/s": rate, "run 1/s": seen,
                    "signs": "too small" if abs(rate) < SMALL else "agree" if rate * seen > 0.0 else "DIFFER",
                }
            )  # fmt: skip
    return rows


def friction() -> list[Row]:
    """Growth at the sum and at the difference by friction and lean, by poles and in time."""
    rows: list[Row] = []
    for mu, lean in ((0.0, 10.0), (0.1, 10.0), (0.3, 10.0), (0.3, -10.0)):
        row: Row = {
            "mu": mu,
            "lean deg": lean,
            "mu > tan(lean)": "yes" if 0.0 < np.tan(np.radians(lean)) < mu else "no",
        }
        for c in coincidences(digging(mu, lean).contact(), SPEEDS):
            if c.speed_hz > 0.0:
                speed = np.linspace(c.speed_hz - c.half_hz, c.speed_hz + c.half_hz, 201)
                rates = growth(digging(mu, lean).contact(), speed)
                at, peak = float(speed[rates.argmax()]), float(rates.max())
                row |= {f"{c.branch} Hz": at, f"{c.branch} 1/s": peak}
                row[f"{c.branch} run 1/s"] = confirming_run(digging(mu, lean), at).run
        rows.append({name: row.get(name) for name in ("mu", "lean deg", "mu > tan(lean)", "sum Hz", "sum 1/s",
                     "sum run 1/s", "backward Hz", "backward 1/s", "backward run 1/s")})  # fmt: skip
    return rows


def peaks() -> list[Row]:
    """Peak of three pairs by eigenvalues, by formula, and in time."""
    rows: list[Row] = []
    for name, pair in {"B6": B6, **OTHERS}.items():
        found, formula = around(pair), loaded(pair)
        seen = confirming_run(pair, found.peak_speed_hz).run
        rows.append(
            {
                "pair": name, "speed Hz": found.peak_speed_hz, "formula Hz": formula.speed_hz,
                "free sum Hz": (pair.casing.freq_hz + pair.blade.freq_hz) / pair.casing.n,
                "off %": 100.0 * (found.peak_speed_hz / formula.speed_hz - 1.0),
                "pole 1/s": found.peak_growth, "formula 1/s": formula.growth, "run 1/s": seen,
                "formula off %": 100.0 * (formula.growth / found.peak_growth - 1.0),
                "run off %": 100.0 * (seen / found.peak_growth - 1.0),
            }
        )  # fmt: skip
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the tables, write them and two pictures."""
    from casingfem.plot.interaction import figure_campbell, figure_zzenf
    from casingfem.plot.style import png

    show("Peak growth of closed contact", peaks())
    show("B6 with 1e-3 of damping: friction and lean", friction())
    rows = signs(quick)
    show("Sign of the pole against growth in time", rows)
    words = [str(row["signs"]) for row in rows]
    print(f"{len(rows)} pairs: " + ", ".join(f"{words.count(word)} {word}" for word in dict.fromkeys(words)))
    casing = {n: [300.0 * (0.55 + 0.02 * (n - 5) ** 2)] for n in range(2, 11)}
    found = interactions(casing, [120.0], speed_hz=(0.0, 90.0))
    print(f"\n{found!r}")
    write(out / "interaction.csv", rows)
    for name, figure in (("campbell", figure_campbell(found, [120.0])), ("safe", figure_zzenf(found, [120.0], 60.0))):
        write_atomic(out / f"interaction_{name}.png", png(figure))
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
