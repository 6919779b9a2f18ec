"""Foundations of an update: exact derivatives, run time of a step, and several models of the measured blade.

`python -m reports.verification.updating.checks [--quick] [--out DIR]`. First table: derivatives of the frequencies of
single modes, and of mean and split vector of doublets, against extrapolated differences of modes solved anew, relative
to the largest of the parameter, and the uncertainty of the differences themselves
(`reports.verification.updating.derivatives`). Second: seconds of a step with five parameters and 40 modes, by part.
Third: the fan blade of Olson and Lindberg under several families of models: RMS error after the update, error of rows
left out, and the model error that explains the remainder.
"""

import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import casingfem as cf
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.updating.problem import Problem
from reports.tables import DATA, Row, command_line, show, write
from reports.verification.updating.derivatives import sensitivities
from reports.verification.updating.twin import TRUTH, VARY, begun, twin


def costs(quick: bool) -> list[Row]:
    """Seconds of one step near the solution, and of a whole update, by part."""
    mesh = ShellMesh(order=6, rows=1, around=13) if quick else None
    count = 20 if quick else 36
    shell = replace(twin(TRUTH), mesh=mesh)
    found = cf.modes(shell, count)
    table = cf.FrequencyTable.from_arrays(
        freq_hz=found.freq, sigma_hz=1e-3 * found.freq, n=found.nodal_diameters, angle_deg=found.angle_deg
    )
    problem = Problem(shell, table, VARY, count + 4, 0.5)
    problem.data_jacobian(problem.start)
    problem.seconds.clear()
    started = time.perf_counter()
    problem.jac(problem.start * (1.0 + 1e-4 * np.array([1, -1, 1, -1, 1])))
    rows: list[Row] = [{"what": "one step", "evaluations": 1, "seconds": time.perf_counter() - started}]
    rows[0] |= by_part(problem.seconds)
    started = time.perf_counter()
    fit = cf.update(replace(begun(), mesh=shell.mesh), table, VARY)
    whole: Row = {"what": "whole update", "evaluations": len(fit.history), "seconds": time.perf_counter() - started}
    return [*rows, whole | by_part(fit.seconds)]


def by_part(seconds: dict[str, float]) -> Row:
    """The parts of a run time that are reported."""
    names = ("coarse", "assemble", "factor", "solve", "sensitivities", "pairing")
    return {name: float(seconds.get(name, 0.0)) for name in names}


PRIORS = {
    "shell.thickness": (2.7e-3, 3.4e-3, 5e-5),
    "material.E": (180e9, 235e9, 4e9),
    "chart.radius": (0.5, 0.72, 0.015),
    "taper.along.2": (0.7, 1.4, 0.02),
    "taper.across.2": (0.7, 1.4, 0.02),
}
ROOT = cf.Parameter(name="support.root.k_face", lower=1e12, upper=1e17, sigma=1.0, log=True)
FAMILIES: tuple[tuple[tuple[str, ...], bool, bool], ...] = (
    (("shell.thickness",), False, True),
    (("material.E",), False, True),
    (("shell.thickness",), True, True),
    (("shell.thickness", "chart.radius"), True, True),
    (("shell.thickness", "taper.along.2"), True, False),
    (("shell.thickness", "taper.across.2"), True, False),
)


def blade(quick: bool) -> list[Row]:
    """Families of blade models: the varied parameters, with or without the clamp, with or without priors."""
    table = cf.FrequencyTable.from_csv(DATA / "experiments" / "olson_lindberg.csv")
    shell = cf.Shell(
        chart=cf.Panel(radius=0.6096, length=0.3048, angle=0.5),
        thickness=3.048e-3,
        material=cf.Material(E=206.85e9, nu=0.3, rho=7857.2),
        supports={"root": cf.ElasticEdge(k_face=1e14)},
        taper=cf.Taper(along=(1.0, 1.0), across=(1.0, 1.0, 1.0)),
        mesh=ShellMesh(order=8, rows=1, around=1) if quick else None,
    )
    rows: list[Row] = []
    for names, clamp, prior in FAMILIES[:2] if quick else FAMILIES:
        vary = [
            cf.Parameter(
                name=name, lower=PRIORS[name][0], upper=PRIORS[name][1], sigma=PRIORS[name][2] if prior else None
            )
            for name in names
        ]
        fit = cf.update(shell, table, [*vary, ROOT] if clamp else vary, model_error=0.01)
        left = cf.updating.leave_one_out(fit)
        rows.append(
            {
                "varied": ", ".join(names) + (", clamp" if clamp else ""),
                "priors": "yes" if prior else "no",
                "RMS %": 100.0 * fit.rms_after,
                "left out %": 100.0 * left.rms,
                "left out sigma": left.rms_sigma,
                "own error %": 100.0 * fit.model_floor,
                "on a bound": "; ".join(fit.saturated) or "-",
            }
        )
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the three tables."""
    exact = sensitivities(quick)
    show("derivatives against extrapolated differences, relative", exact)
    cost = costs(quick)
    show("seconds of an update with five parameters", cost)
    families = blade(quick)
    show("the measured fan blade: 7 rows, 1 Hz and 1 % of each allowed", families)
    write(out / "update_sensitivities.csv", exact)
    write(out / "update_cost.csv", cost)
    write(out / "update_blade.csv", families)
    return [*exact, *cost, *families]


if __name__ == "__main__":
    command_line(__doc__, main)
