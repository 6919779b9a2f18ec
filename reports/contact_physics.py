"""What each piece of physics costs a run of rods: steps per second with it and without, and what a run loads.

`python -m reports.contact_physics [--quick] [--out DIR]` prints and writes contact_physics.csv. Every row adds one
thing to a bar of 100 elements on a wall; friction, which rods lack, is the rub of `reports.speed`. The last lines
are the packages that a run of rods has loaded: no finite elements, no plotting.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import contact as ct
from contact.model.body import Body
from reports.contact_cases import BAR
from reports.tables import Row, command_line, show, write

HEAVY = ("skfem", "matplotlib", "pandas", "pydantic", "casingfem", "scipy", "numba")
RUN = "ct.run([ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, x=0.1, velocity=-1.0), ct.Wall()], t_end=3.0, courant=0.9)"


def scenes() -> dict[str, tuple[list[Body], float]]:
    """Bodies and gravity of each row."""
    bar = ct.Rod(**BAR, elements=100, velocity=-10.0)
    other = replace(bar, x=-15.0, velocity=10.0)
    driven = ct.PointMass(mass=1.0, x=-0.5, stiffness=100.0, force=10.0, force_hz=2.0)
    return {
        "bar on a wall": ([bar, ct.Wall()], 0.0),
        "with gravity": ([bar, ct.Wall()], 10.0),
        "with damping": ([replace(bar, damping=0.01), ct.Wall()], 0.0),
        "with a second bar in place of the wall": ([bar, other], 0.0),
        "with a driven oscillator in place of the wall": ([bar, driven], 0.0),
    }


def loaded(statement: str) -> str:
    """Those of HEAVY that a fresh interpreter has loaded after this statement."""
    code = f"import sys, contact as ct\n{statement}\nprint(' '.join(m for m in {HEAVY} if m in sys.modules) or 'none')"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print both tables and write the first."""
    rows, steps = [], 5_000 if quick else 50_000
    for name, (bodies, gravity) in scenes().items():
        row: Row = {"run": name}
        for label, scheme in (("explicit", ct.CentralDifference()), ("massless", ct.MasslessBoundary()),
                              ("Moreau-Jean", ct.MoreauJean())):  # fmt: skip
            best = 0.0
            for _ in range(3):
                result = ct.run(bodies, scheme=scheme, t_end=steps * 0.9 / 300.0, courant=0.9, gravity=gravity,
                                record=ct.Record(every=1000))  # fmt: skip
                best = max(best, result.steps / result.seconds)
            row[f"{label}, steps/s"] = best
        rows.append(row)
    show("Rods, 100 elements: steps per second", rows)
    show("Loaded by", [{"statement": s or "import contact", "of " + ", ".join(HEAVY): loaded(s)} for s in ("", RUN)])
    write(out / "contact_physics.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
