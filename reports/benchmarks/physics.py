"""Cost of each piece of physics in a run: steps per second with and without it, and the packages that a run loads.

`python -m reports.benchmarks.physics [--quick] [--out DIR]` prints and writes contact_physics.csv and
contact_physics_modal.csv. Every row adds one thing: to a bar of 100 elements on a wall; to a blade pressed on a ring of
41 modes that does not change, both undamped; to four points of a plate of 50 modes pressed on the ground. The last
lines are the packages that a run of rods has loaded: no finite elements, no plotting.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

import contact as ct
from contact.model.bodies.body import Body
from reports.tables import Row, command_line, show, write
from reports.verification.schemes.cases import BAR

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


def ring(zeta: float = 0.0) -> ct.ModalBody:
    """A steel ring of radius .5 m on an elastic bed, n to 20."""
    return ct.bodies.ring_modes(
        ct.bodies.ThinRing(radius=0.5, width=0.02, height=3e-3, E=210e9, rho=7800.0, k_r=1e7, k_t=1e7, zeta=zeta), 20
    )


def blade(zeta: float = 0.0) -> ct.ModalBody:
    """Flap and span of a blade tip, one mode each."""
    rows, S = np.diag([3.0, 3.0]), np.diag([1e-9, 1e-9])
    return ct.ModalBody(omega=[800.0, 9000.0], zeta=[zeta, zeta], channels=("flap", "span"), rows=rows, S=S)


def plate(dimensions: int, zeta: float = 0.0) -> ct.Patch:
    """Fifty modes pressed on the ground at four points and dragged."""
    rng = np.random.default_rng(31)
    rows = rng.standard_normal((12, 50))
    omega = np.concatenate([np.zeros(6), np.sort(rng.uniform(100.0, 5000.0, 44))])
    names = tuple(f"{direction}{k}" for k in range(4) for direction in "nst")
    body = ct.ModalBody(omega=omega, zeta=np.full(50, zeta), channels=names, rows=rows, S=np.zeros((12, 12)))
    tangent = tuple(names[3 * k + 1 : 3 * k + dimensions] for k in range(4)) if dimensions > 1 else ()
    slide = [0.05, 0.02][: max(dimensions - 1, 1)] if dimensions > 1 else 0.0
    return ct.Patch(body=body, normal=names[::3], tangent=tangent, slide=slide, load=-5.0 * rows[::3].sum(axis=0))


def modal_runs() -> dict[str, Callable[[float], ct.Result]]:
    """Runs of a given number of steps."""

    def rub(speed: float, mu: float = 0.0, zeta: float = 0.0, wave: float = 0.0) -> Callable[[float], ct.Result]:
        rim = ct.RotatingRim(
            ring(zeta), blade(zeta), clearance=-1e-5, speed_hz=speed, lean_deg=20.0,
            out_of_roundness=[{"p": 2, "cos": wave}] if wave else [],
        )  # fmt: skip
        law, record = (ct.Coulomb(mu=mu) if mu else ct.Unilateral()), ct.Record(every=1000)
        scheme = ct.ExactModal(law="forward")
        return lambda steps: ct.run(rim, law=law, scheme=scheme, t_end=steps * 5e-6, dt=5e-6, record=record)

    def press(dimensions: int, mu: float, zeta: float = 0.0) -> Callable[[float], ct.Result]:
        law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
        return lambda steps: ct.run(plate(dimensions, zeta), law=law, scheme=ct.ExactModal(), t_end=steps * 1e-4,
                                    dt=1e-4, record=ct.Record(every=1000))  # fmt: skip

    return {
        "blade on a ring that does not change": rub(0.0), "with damping": rub(0.0, zeta=0.002),
        "with rotation": rub(5.0), "with rotation and out-of-roundness": rub(5.0, wave=2e-5),
        "with rotation and sliding friction": rub(5.0, mu=0.3),
        "plate on four points, no friction": press(1, 0.0), "the same with damping": press(1, 0.0, zeta=0.002),
        "with friction along a line": press(2, 0.3), "with friction in a plane": press(3, 0.3),
    }  # fmt: skip


def modal_rows(steps: int) -> list[Row]:
    """Steps per second of each, best of three, and the share of steps in contact."""
    rows: list[Row] = []
    for name, run in modal_runs().items():
        results = [run(steps) for _ in range(3)]
        share = float(results[0].contact_steps.mean()) / results[0].steps
        rows.append({"run": name, "steps/s": max(r.steps / r.seconds for r in results), "in contact": share})
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print both tables and write the first."""
    rows, steps = [], 5_000 if quick else 50_000
    for name, (bodies, gravity) in scenes().items():
        row: Row = {"run": name}
        for label, scheme in (("explicit", ct.CentralDifference()), ("massless", ct.scheme.MasslessBoundary()),
                              ("Moreau-Jean", ct.MoreauJean())):  # fmt: skip
            best = 0.0
            for _ in range(3):
                result = ct.run(bodies, scheme=scheme, t_end=steps * 0.9 / 300.0, courant=0.9, gravity=gravity,
                                record=ct.Record(every=1000))  # fmt: skip
                best = max(best, result.steps / result.seconds)
            row[f"{label}, steps/s"] = best
        rows.append(row)
    show("Rods, 100 elements: steps per second", rows)
    modal = modal_rows(steps)
    show("Modal bodies: steps per second", modal)
    write(out / "contact_physics_modal.csv", modal)
    show("Loaded by", [{"statement": s or "import contact", "of " + ", ".join(HEAVY): loaded(s)} for s in ("", RUN)])
    write(out / "contact_physics.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
