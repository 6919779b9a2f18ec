"""Comparison of runs with Floquet multipliers: random bodies at random contacts under a harmonic force.

`python -m reports.verification.schemes.random_orbits [--count 300] [--first 0] [--quick] [--out DIR]` takes bodies of
three to six modes before one to three contacts: springs, residual compliance, rigid ones without and with rebound. A
run of 2,000 periods from rest settles on a motion that repeats after one to eight periods of the force. The orbit found
there must be stable. Its branch is followed over 30 % of the frequency, to 60 orbits at most. A run beside every orbit
with a multiplier above 1.02 must leave it: its distance must grow a thousandfold from 1e-10 of the state. Runs that do
not settle on such a motion, and branches that are refused, are counted and named.
"""

import math
import time
from collections import Counter
from pathlib import Path

import numpy as np

import contact as ct
from casingfem.io.arrays import FloatArray
from contact.cycles import Branch, DrivenBody, Orbit
from contact.cycles.branch import Course, Tangent, begun, followed
from contact.cycles.driven import Family
from contact.cycles.shooting import map_of, settled
from reports.tables import Row, command_line, show, write
from reports.verification.schemes.cycles import left

KINDS = ("springs", "compliance", "rigid", "rebounding")
CLOSES = 1e-7  # of the state: largest difference of a run from its state some periods before


def random_body(seed: int) -> DrivenBody:
    """Modes from 0.5 to 6 rad/s at contacts of a kind that the seed selects."""
    rng, kind = np.random.default_rng(seed), KINDS[seed % len(KINDS)]
    modes, k = int(rng.integers(3, 7)), int(rng.integers(1, 4))
    rows, S = rng.standard_normal((k + 1, modes)), np.zeros((k + 1, k + 1))
    if kind == "compliance":
        root: FloatArray = rng.standard_normal((k + 1, k + 1))
        S = 0.02 * (root @ root.T + np.eye(k + 1))
    body = ct.ModalBody(
        omega=np.sort(rng.uniform(0.5, 6.0, modes)), zeta=rng.uniform(0.02, 0.1, modes),
        channels=("d", *(f"stop{i}" for i in range(k))), rows=rows, S=S,
    )  # fmt: skip
    patch = ct.Patch(body=body, normal=body.channels[1:], clearance=rng.uniform(0.1, 0.5, k))
    return DrivenBody(
        patch=patch, channel="d", amplitude=rng.uniform(0.3, 1.0), shown=("d",),
        stiffness=rng.uniform(1.0, 30.0, k) if kind == "springs" else math.inf,
        restitution=rng.uniform(0.3, 0.8, k) if kind == "rebounding" else 0.0,
    )  # fmt: skip


def reached(family: Family, value: float) -> Orbit | None:
    """The orbit on which a run from rest settles within 2,000 periods; None if it does not."""
    x, start = family.begin, 0.0
    for _ in range(10):
        x, start = settled(family, value, 200, x=x, at=start)
        period, after = map_of(family, value, start), x
        for periods in range(1, 9):
            after = period(after, tangent=False).x
            if np.linalg.norm(after - x) <= CLOSES * np.linalg.norm(x):
                found = ct.cycles.orbit(family, value, guess=x, start=start, periods=periods)
                return found if np.linalg.norm(found.x - x) <= 1e3 * CLOSES * np.linalg.norm(x) else None
    return None


def branch(family: Family, first: Orbit) -> Branch:
    """The branch of an orbit towards higher frequencies, to its end or to 60 orbits."""
    size = 1e-3 * float(np.linalg.norm(first.x))
    course = Course(family=family, low=first.value, high=1.3 * first.value, size=size)
    way = begun(course, first, Tangent(np.zeros_like(first.x), 1.0), 0.05)
    return followed(course, way, longest=0.05, most=60)


def agreed(seed: int) -> Row:
    """Results of runs and multipliers for one body."""
    family = random_body(seed).over("freq_hz", freq_hz=0.3)
    value = 0.15 + 0.3 * np.random.default_rng(100_000 + seed).random()
    row: Row = {"body": seed, "kind": KINDS[seed % len(KINDS)], "periods": None, "stable": None, "points": 0,
                "beyond 1.02": 0, "left": 0, "failed": 0, "refused": ""}  # fmt: skip
    try:
        first = reached(family, value)
        if first is None:
            return row
        row |= {"periods": first.periods, "stable": first.stable, "failed": int(not first.stable)}
        points = branch(family, first).points
    except ct.NumericsError as error:
        return row | {"refused": str(error)}
    beyond = [point for point in points if point.multiplier > 1.02]
    kept = [point for point in beyond if left(family, point, 600, until=1e-6)[0] < 1e3]
    for point in [*([] if first.stable else [first]), *kept]:
        print(f"body {seed}: runs stay where {point!r}")
    return row | {
        "points": len(points), "beyond 1.02": len(beyond), "left": len(beyond) - len(kept),
        "failed": int(not first.stable) + len(kept),
    }  # fmt: skip


def main(out: Path, quick: bool = False, count: int = 300, first: int = 0) -> list[Row]:
    """Print the agreement by kind of contact; write a row for each body."""
    rows: list[Row] = []
    for seed in range(first, first + (min(count, 12) if quick else count)):
        started = time.process_time()
        rows.append(agreed(seed))
        rows[-1]["seconds"] = time.process_time() - started
    table: list[Row] = []
    for kind in KINDS:
        mine = [row for row in rows if row["kind"] == kind]
        table.append({
            "contacts": kind, "bodies": len(mine), "runs that settle": sum(row["periods"] is not None for row in mine),
            "on orbits of several periods": sum(int(str(row["periods"] or 1)) > 1 for row in mine),
            "called stable": sum(bool(row["stable"]) for row in mine),
            **{name: sum(int(str(row[name])) for row in mine) for name in ("points", "beyond 1.02", "left", "failed")},
            "refused": sum(bool(row["refused"]) for row in mine),
            "seconds": sum(float(str(row["seconds"])) for row in mine),
        })  # fmt: skip
    show("Random bodies: what runs reach is called stable, what is called unstable is left", table)
    for words, times in Counter(str(row["refused"]) for row in rows if row["refused"]).items():
        print(f"refused {times}: {words}")
    write(out / "random_orbits.csv", rows)
    return table


if __name__ == "__main__":
    command_line(__doc__, main, count=(300, "how many bodies"), first=(0, "seed of the first"))
