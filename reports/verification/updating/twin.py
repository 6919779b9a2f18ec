"""Check of the updater's standard deviations: a twin of the same model family, noise on every row, many draws.

`python -m reports.verification.updating.twin [--quick] [--out DIR]`. A steel frustum on an elastic base with harmonics
8 and 16 in its radius; 20 frequencies, 0.1 % noise on the mean of each pair and on both components of its split vector,
which is noise on frequencies and angles; five parameters. Without noise the fit recovers the parameters from a start 13
% off. The draws give the share of 95 % intervals that contain the truth (a correct interval has 92 to 98 % in 200
draws), and the scatter of the estimates over the Cramer-Rao bound, the sigma of the noise-free fit. The first draws
begin 13 % off, the others at the noise-free solution: the result of a draw does not depend on its start. Order 6, one
row of 13 elements.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np

import casingfem as cf
from casingfem.experiment.grouping import Doublet
from casingfem.io.arrays import FloatArray
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.updating.problem import Problem
from casingfem.updating.solve import covariance, solve
from casingfem.updating.targets import split_vector
from reports.tables import Row, command_line, show, write

ROWS, NOISE, OFF, FAR = 20, 1e-3, 0.13, 20
MESH = ShellMesh(order=6, rows=1, around=13)
TRUTH = {
    "material.E": 205e9,
    "shell.thickness": 3.05e-3,
    "support.base.k_face": 3e12,
    "radius.p8.cos": 7e-4,
    "radius.p8.sin": -4e-4,
}
VARY = (
    cf.Parameter(name="material.E", lower=150e9, upper=250e9),
    cf.Parameter(name="shell.thickness", lower=2e-3, upper=4e-3),
    cf.Parameter(name="support.base.k_face", lower=1e11, upper=1e15, log=True),
    cf.Parameter(name="radius.p8.cos", lower=-0.01, upper=0.01),
    cf.Parameter(name="radius.p8.sin", lower=-0.01, upper=0.01),
)


class Draw(NamedTuple):
    """One fit: estimates and sigma in the solver's variables, misfit, evaluations."""

    x: FloatArray
    sigma: FloatArray
    misfit: float
    evaluations: int


def twin(values: dict[str, float], mesh: ShellMesh = MESH) -> cf.Shell:
    """The casing with five parameters."""
    return cf.Shell(
        chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),
        thickness=values["shell.thickness"],
        material=cf.Material(E=values["material.E"], nu=0.3, rho=7800.0),
        supports={"base": cf.ElasticEdge(k_face=values["support.base.k_face"])},
        radius_defect=cf.FourierField.of(
            {8: (values["radius.p8.cos"], values["radius.p8.sin"]), 16: 3e-4, 3: (5e-4, 3e-4)}
        ),
        mesh=mesh,
    )


def begun() -> cf.Shell:
    """The start: every parameter 13 % off, up and down in turn."""
    return twin({name: value * (1.0 + OFF * (-1.0) ** k) for k, (name, value) in enumerate(TRUTH.items())})


def measured(rows: int = ROWS, mesh: ShellMesh = MESH) -> cf.FrequencyTable:
    """The table of a test without noise."""
    found = cf.modes(twin(TRUTH, mesh), rows + 4)
    return cf.FrequencyTable.from_arrays(
        freq_hz=found.freq[:rows],
        sigma_hz=NOISE * found.freq[:rows],
        n=found.nodal_diameters[:rows],
        angle_deg=found.angle_deg[:rows],
        synthetic=True,
    )


def noisy(table: cf.FrequencyTable, seed: int) -> cf.FrequencyTable:
    """One draw: noise on means and split vectors, converted to frequencies and angles."""
    random = np.random.default_rng(seed)
    freq, angle = table.freq_hz.copy(), table.angle_deg.copy()
    for group in table.groups():
        rows = list(group.rows)
        sigma = table.sigma_hz[rows]
        if not isinstance(group, Doublet):
            freq[rows] += sigma * random.standard_normal()
            continue
        wide, squares = float(np.hypot(*sigma)), table.freq_hz[rows] ** 2
        mean = np.sqrt(squares.mean())
        phase = 2.0 * group.n * np.radians(angle[rows[0]])
        vector = split_vector(float(np.diff(squares)[0] / (2.0 * mean)), phase) + wide * random.standard_normal(2)
        mean += 0.5 * wide * random.standard_normal()
        split = np.hypot(*vector)
        freq[rows] = np.sqrt(mean**2 + mean * split * np.array([-1.0, 1.0]))
        lower = np.degrees(np.arctan2(vector[1], vector[0])) / (2.0 * group.n)
        angle[rows] = np.mod(lower + np.array([0.0, 90.0 / group.n]), 180.0 / group.n)
    numbers = {"mode": table.mode, "n": table.n, "sigma_hz": table.sigma_hz}
    return cf.FrequencyTable.from_arrays(freq_hz=freq, angle_deg=angle, synthetic=True, **numbers)


def drawn(fit: cf.updating.UpdateResult, table: cf.FrequencyTable, far: bool) -> Draw:
    """The update of one draw, from the far start or from the noise-free solution."""
    whole = fit.problem
    problem = Problem(whole.shell, table, whole.vary, whole.count, whole.reach)
    problem.anchor = None if far else whole.anchor
    x, _ = solve(problem, fit.lower, fit.upper, 30, begin=None if far else fit.x)
    state, sigma = problem.state(x), np.sqrt(np.diag(covariance(problem.jac(x))))
    free = len(state.values) - len(x)
    return Draw(x, sigma, float(np.sqrt(np.sum(state.values**2) / free)), len(problem.history))


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the noise-free fit and the draws, a row for each parameter."""
    table = measured()
    fit = cf.update(begun(), table, VARY)
    far, count = (1, 8) if quick else (FAR, 200)
    draws = [drawn(fit, noisy(table, 7000 + k), k < far) for k in range(count)]
    true = np.array([p.to_internal(TRUTH[p.name]) for p in VARY])
    x, sigma = np.array([draw.x for draw in draws]), np.array([draw.sigma for draw in draws])
    covered = np.abs(x - true) <= 1.96 * sigma
    scatter = np.sqrt(np.mean((x - true) ** 2, axis=0))
    unit = np.where([p.log for p in VARY], 1.0, np.abs(true))  # decades for log parameters
    rows: list[Row] = [
        {
            "parameter": p.name,
            "noise-free error": float(abs(fit.value[k] / TRUTH[p.name] - 1.0)),
            "Cramer-Rao": float(fit.sigma[k] / unit[k]),
            "scatter": float(scatter[k] / unit[k]),
            "over the bound": float(scatter[k] / fit.sigma[k]),
            "covered %": float(100.0 * covered[:, k].mean()),
        }
        for k, p in enumerate(VARY)
    ]
    show(f"{len(draws)} draws of {ROWS} rows with {NOISE:.1%} noise (relative; decades for the embedding)", rows)
    steps = [draw.evaluations for draw in draws[:far]]
    misfits = np.array([draw.misfit for draw in draws])
    print(
        f"from {OFF:.0%} off: {len(fit.history)} evaluations without noise, at most {max(steps)} with; "
        f"misfit {misfits.mean():.3f} +- {misfits.std():.3f} sigma"
    )
    write(out / "update_twin.csv", rows)
    held = 100.0 * covered.mean(axis=0)
    write(
        out / "update_twin_summary.csv", [{"least covered %": float(held.min()), "most covered %": float(held.max())}]
    )
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
