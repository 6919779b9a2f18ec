"""Large linear bodies: elastic blocks dropped on points of their foot, matrices kept as bands and as entries.

`python -m reports.verification.schemes.sparse_body [--quick] [--out DIR]` prints and writes sparse_body.csv. Cubes of
8-node bricks are assembled by scikit-fem, outside `contact`; plane grids of springs are beside them. Small bodies run
in both forms, which shows the size from which entries are faster, and that results are equal. The largest body runs
only with entries. Run times are of the step loop, best of three; "fill" counts places of the band, or entries of the
factor, per entry of K.
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from scipy.sparse import csr_array, diags_array, eye_array, kron
from skfem import Basis, BilinearForm, ElementHex1, ElementVector, MeshHex
from skfem.helpers import dot
from skfem.models.elasticity import lame_parameters, linear_elasticity

import contact as ct
from contact.model.bodies import linear_system
from contact.scheme.linear.stepper import LinearStepper
from reports.tables import Row, command_line, show, write

SCHEMES = {"explicit": ct.CentralDifference(), "Moreau-Jean": ct.MoreauJean()}
ALWAYS, NEVER = 0, 10**9  # places per entry above which entries are used


def cube(cells: int, points: int) -> ct.LinearBody:
    """A unit cube, E = 1, nu = .3, rho = 1, thrown at the ground; points x points of its foot may touch."""
    grid = np.linspace(0.0, 1.0, cells + 1)
    basis = Basis(MeshHex.init_tensor(grid, grid, grid), ElementVector(ElementHex1()), intorder=2)
    K = linear_elasticity(*lame_parameters(1.0, 0.3)).assemble(basis)
    mass = BilinearForm(lambda u, v, _: dot(u, v)).assemble(basis).sum(axis=1)
    where = basis.mesh.p
    chosen = grid[np.round(np.linspace(0, cells, points)).astype(int)]
    foot = np.flatnonzero((where[2] == 0.0) & np.isin(where[0], chosen) & np.isin(where[1], chosen))
    up = basis.nodal_dofs[2]
    velocity = np.zeros(basis.N)
    velocity[up] = -0.1
    Q = csr_array((np.ones(foot.size), (np.arange(foot.size), up[foot])), shape=(foot.size, basis.N))
    return ct.LinearBody(M=np.asarray(mass).ravel(), K=csr_array(0.5 * (K + K.T)), Q=Q, gap0=np.full(foot.size, 0.01),
                         velocity=velocity)  # fmt: skip


def net(points: int) -> ct.LinearBody:
    """Points x points unit masses in a plane net of unit springs, thrown at three stops."""
    line = diags_array([np.full(points - 1, -1.0), np.full(points, 2.0), np.full(points - 1, -1.0)], offsets=[-1, 0, 1])
    K, n = csr_array(kron(line, eye_array(points)) + kron(eye_array(points), line)), points**2
    Q = csr_array((np.ones(3), (np.arange(3), n - 1 - np.arange(3))), shape=(3, n))
    return ct.LinearBody(M=np.ones(n), K=K, Q=Q, gap0=np.full(3, 0.02), velocity=-np.ones(n))


def ran(body: ct.LinearBody, scheme: str, steps: int, dt: float, empty: int) -> tuple[ct.Result, LinearStepper, float]:
    """Fastest of three runs with its end state in `state`, its stepper, and the seconds to prepare it."""
    before, linear_system.EMPTY = linear_system.EMPTY, empty
    try:
        started = time.perf_counter()
        stepper = SCHEMES[scheme].prepare(body, ct.Unilateral(), dt=dt, courant=None)
        seconds = time.perf_counter() - started
        record = ct.Record(at=[steps * dt])
        runs = [ct.run(body, scheme=SCHEMES[scheme], t_end=steps * dt, dt=dt, record=record) for _ in range(3)]
    finally:
        linear_system.EMPTY = before
    assert isinstance(stepper, LinearStepper)
    return min(runs, key=lambda run: run.seconds), stepper, seconds


def measured(name: str, body: ct.LinearBody, scheme: str, steps: int, both: bool) -> Row:
    """One body by one scheme: with entries, and with bands if memory suffices."""
    dt = 0.9 / linear_system.omega_max(linear_system.linear_system(body))
    lists, stepper, seconds = ran(body, scheme, steps, dt, ALWAYS)
    entries = stepper.parts.K.sparse.value.size
    row: Row = {
        "body": name, "scheme": scheme, "unknowns": body.size, "entries": entries,
        "factor fill": stepper.parts.A.sparse.value.size / entries, "prepare s": seconds,
        "us/step": 1e6 * lists.seconds / lists.steps, "unaccounted": abs(lists.energy.unaccounted) / lists.energy.scale,
        "band fill": None, "band us/step": None, "band/entries": None, "difference": None,
    }  # fmt: skip
    if both:
        bands, banded, _ = ran(body, scheme, steps, dt, NEVER)
        size = float(np.abs(bands.state).max())
        row |= {
            "band fill": banded.parts.K.off.size / entries, "band us/step": 1e6 * bands.seconds / bands.steps,
            "band/entries": bands.seconds / lists.seconds,
            "difference": float(np.abs(bands.state - lists.state).max()) / size,
        }  # fmt: skip
    return row


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and write it."""
    bodies = [(f"net of {n} x {n}", net(n), 400, True) for n in ((12, 20) if quick else (6, 12, 20, 30, 45))]
    cells = (3,) if quick else (4, 7)
    bodies += [(f"cube of {n}^3 bricks", cube(n, 2), 200, True) for n in cells]
    if not quick:
        bodies.append(("cube of 18^3 bricks", cube(18, 5), 40, False))
    rows = [measured(*body[:2], scheme, *body[2:]) for body in bodies for scheme in SCHEMES]
    show("Linear bodies as entries and as bands", rows)
    write(out / "sparse_body.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
