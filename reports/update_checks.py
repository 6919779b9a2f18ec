"""What an update stands on: exact derivatives, what a step costs, and what the measured blade says about its model.

`python -m reports.update_checks [--quick] [--out DIR]`. First table: derivatives of the frequencies of single modes,
and of mean and split vector of doublets, against central differences of modes solved anew with Richardson's step;
relative to the largest of the parameter. Second: seconds of a step with five parameters and 40 modes, by part.
Third: the fan blade of Olson and Lindberg under several families of models: RMS error after the update, of rows left
out, and the model's own error that explains what is left.
"""

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import casingfem as cf
from casingfem.arrays import FloatArray
from casingfem.experiment.pairing import Match
from casingfem.modal.neighbour import Solution, solved
from casingfem.structure.mesh import ShellMesh
from casingfem.structure.section import Section
from casingfem.updating.parameters import get_value, with_value
from casingfem.updating.problem import Problem
from casingfem.updating.targets import jacobian, rates, values
from reports.tables import DATA, Row, command_line, show, write
from reports.update_twin import TRUTH, VARY, begun, twin

COUNT = 12
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
FRUSTUM = cf.Frustum(r_base=0.50, r_top=0.45, height=0.25)
WAVES = cf.FourierField.of({8: (0.002, 0.001), 3: (0.001, 0.001)})


def elastic() -> cf.Shell:
    """A casing without symmetry on springs, with a strip and a point mass."""
    edge = cf.ElasticEdge(k_face=5e11, k_r=1e9, k_theta=2e9, k_z=1e9, k_rot=1e5, around=cf.FourierField.of({4: 0.3}))
    return cf.Shell(
        chart=FRUSTUM, thickness=3e-3, material=STEEL, supports={"base": edge}, radius_defect=WAVES,
        thickness_defect=cf.FourierField.of({4: 0.05}), strips=(cf.Strip(start=0.1, end=0.15, thickness=5e-3),),
        masses={"top": [cf.PointMass(angle=0.4, mass=0.05)]},
        mesh=ShellMesh(order=5, rows=(0.0, 0.4, 0.6, 1.0), around=9),
    )  # fmt: skip


def bolted() -> cf.Shell:
    """A casing on a steel ring held by bolts, one of them loose."""
    ring = cf.Ring(
        section=Section.rectangle(width=0.03, depth=0.02),
        material=STEEL,
        support=cf.Bolts(count=12, k=2e8, k_rot=1e4, loose={3: 0.4}),
    )
    return cf.Shell(
        chart=FRUSTUM, thickness=3e-3, material=STEEL, supports={"base": ring}, radius_defect=WAVES,
        mesh=ShellMesh(order=5, rows=1, around=12),
    )  # fmt: skip


NAMES = {
    elastic: (
        "material.E", "material.nu", "material.rho", "shell.thickness", "chart.r_top", "radius.p8.cos",
        "radius.p3.sin", "thickness.p4.cos", "modulus.p4.cos", "density.p2.sin", "strip.1.thickness",
        "support.base.k_face", "support.base.k_r", "support.base.k_rot", "support.base.around.p4.cos",
        "mass.top.1.mass", "mass.top.1.angle",
    ),
    bolted: (
        "chart.height", "support.base.k", "support.base.bolts.3.k", "support.base.k_rot", "support.base.section.width",
        "support.base.section.I_z", "support.base.material.E", "support.base.material.rho",
    ),
}  # fmt: skip


def as_doublets(solution: Solution) -> tuple[Match, ...]:
    """The doublets of a solution that are well apart from others, as if all were measured."""
    modes = solution.modes
    return tuple(
        Match(
            rows=pair,
            modes=pair,
            n=int(modes.nodal_diameters[pair[0]]),
            confidence=1.0,
            measured_hz=(0.0, 0.0),
            computed_hz=(0.0, 0.0),
        )
        for pair in modes.doublets
        if pair[1] < COUNT
    )


def as_singles(matches: Sequence[Match]) -> tuple[Match, ...]:
    """The members of the doublets, each for itself."""
    return tuple(replace(match, rows=(k,), modes=(k,)) for match in matches for k in match.modes)


def measured(solution: Solution) -> cf.FrequencyTable:
    """A table of the modes themselves, 1 Hz of noise each."""
    found = solution.modes
    return cf.FrequencyTable.from_arrays(
        freq_hz=found.freq, sigma_hz=1.0, n=found.nodal_diameters, angle_deg=np.nan_to_num(found.angle_deg)
    )


def differences(shell: cf.Shell, name: str, table: cf.FrequencyTable, kinds: Sequence[Sequence[Match]]) -> FloatArray:
    """Central differences of the residuals of several kinds of matches, two steps extrapolated to none."""
    x = float(np.real(get_value(shell, name)))
    scale = abs(x) if x else 0.01
    slopes = []
    for step in (2e-3 * scale, 1e-3 * scale):
        plus, minus = (solved(with_value(shell, name, x + side), COUNT + 8).modes for side in (step, -step))
        ends = [np.concatenate([values(modes, table, matches) for matches in kinds]) for modes in (plus, minus)]
        slopes.append((ends[0] - ends[1]) / (2.0 * step))
    return np.asarray((4.0 * slopes[1] - slopes[0]) / 3.0)


def sensitivities(quick: bool) -> list[Row]:
    """Largest error of the derivatives for each parameter, over the largest of its derivatives of that kind."""
    rows: list[Row] = []
    for make, names in NAMES.items():
        shell = make()
        solution = solved(shell, COUNT + 8)
        table, pairs = measured(solution), as_doublets(solution)
        kinds = (as_singles(pairs), pairs)
        for name in names[::6] if quick else names:
            p = cf.Parameter(name=name, lower=-1e30, upper=1e30)
            numeric = differences(shell, name, table, kinds)
            parts = [
                jacobian(solution.modes, table, k, rates(solution.modes, solution, [p], table, k))[:, 0] for k in kinds
            ]
            error = np.abs(np.concatenate(parts) - numeric)
            first = len(parts[0])
            rows.append(
                {
                    "parameter": name,
                    "simple modes": float(error[:first].max() / np.abs(numeric[:first]).max()),
                    "mean and split": float(error[first:].max() / np.abs(numeric[first:]).max()),
                }
            )
    return rows


def costs(quick: bool) -> list[Row]:
    """Seconds of one step near the solution, and of a whole update, by part."""
    mesh = ShellMesh(order=6, rows=1, around=13) if quick else None
    count = 20 if quick else 36
    shell = replace(twin(TRUTH), mesh=mesh)  # type: ignore[arg-type]
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
    names = ("assemble", "factor", "solve", "sensitivities", "pairing")
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
    """Families of blade models: what is varied, with the clamp or without, with priors or without."""
    table = cf.FrequencyTable.from_csv(DATA / "experiments" / "olson_lindberg.csv")
    shell = cf.Shell(
        chart=cf.Panel(radius=0.6096, length=0.3048, angle=0.5),
        thickness=3.048e-3,
        material=cf.Material(E=206.85e9, nu=0.3, rho=7857.2),
        supports={"root": cf.ElasticEdge(k_face=1e14)},
        taper=cf.Taper(along=(1.0, 1.0), across=(1.0, 1.0, 1.0)),
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
        left = cf.leave_one_out(fit)
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
    show("derivatives against central differences, relative", exact)
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
