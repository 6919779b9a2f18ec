"""Derivatives of frequencies by each kind of parameter, against differences of modes solved anew.

Central differences have errors of the square of their step, and of round-off over their step. A single step therefore
cannot distinguish a wrong derivative from a coarse difference. Here the step is halved and extrapolated to zero
(Ridders, Adv. Eng. Software 4, 1982, 75) until the last extrapolation changes by ENOUGH or less; the change is reported
with the error. Modes are followed by their shapes; pairs give their mean and split vector too, whose turning has the
error of the adjoints' space (`modal.adjoint`): by modulus.p4.cos 1.2e-5, 7.8e-7, 5.6e-8 with depth 2, 3, 4; 3 is used.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

import casingfem as cf
from casingfem.experiment.correlation.matches import Match, Pairing
from casingfem.io.arrays import FloatArray
from casingfem.modal.neighbour import Solution, solved
from casingfem.structure.edge.section import Section
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.updating.addresses import get_value, with_value
from casingfem.updating.following import followed
from casingfem.updating.targets import jacobian, rates, values
from reports.tables import Row

FIRST = 1e-3  # of the parameter: the longest step
ENOUGH = 1e-7  # of the largest derivative of its kind
HALVINGS = 6
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
        masses={"top": [cf.edge.EdgeMass(angle=0.4, mass=0.05)]},
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
    """The members of the doublets as single modes."""
    return tuple(replace(match, rows=(k,), modes=(k,)) for match in matches for k in match.modes)


def measured(solution: Solution) -> cf.FrequencyTable:
    """A table of the modes themselves, 1 Hz of noise each."""
    found = solution.modes
    return cf.FrequencyTable.from_arrays(
        freq_hz=found.freq, sigma_hz=1.0, n=found.nodal_diameters, angle_deg=np.nan_to_num(found.angle_deg)
    )


def residuals(
    shell: cf.Shell, start: Solution, table: cf.FrequencyTable, kinds: Sequence[Sequence[Match]]
) -> FloatArray:
    """The residuals of several kinds of matches on another shell, its modes found by their shapes."""
    new = solved(shell, COUNT + 8).modes
    before = (Pairing(matches=tuple(kind), unpaired_rows=(), unpaired_modes=()) for kind in kinds)
    return np.concatenate([values(new, table, followed(p, start.modes, new, table).matches) for p in before])


def extrapolated(slope: Callable[[float], FloatArray], step: float) -> tuple[FloatArray, float]:
    """Central differences extrapolated to a zero step, and the largest change by the last extrapolation."""
    row = [slope(step)]
    best, doubt = row[0], np.inf
    for _ in range(HALVINGS):
        step /= 2.0
        new = [slope(step)]
        for order, old in enumerate(row, start=1):
            new.append(new[-1] + (new[-1] - old) / (4.0**order - 1.0))
        change = float(np.abs(new[-1] - row[-1]).max())
        if change < doubt:
            best, doubt = new[-1], change
        if doubt <= ENOUGH or change > 10.0 * doubt:
            break
        row = new
    return best, doubt


def errors(start: Solution, name: str) -> Row:
    """Errors of the derivatives by one parameter, over the largest of their kind; uncertainty of the differences."""
    shell, modes = start.modes.shell, start.modes
    table, pairs = measured(start), as_doublets(start)
    kinds = (as_singles(pairs), pairs)
    p = cf.Parameter(name=name, lower=-1e30, upper=1e30)
    parts = [jacobian(modes, table, kind, rates(modes, start, [p], table, kind))[:, 0] for kind in kinds]
    size = np.concatenate([np.full(len(part), np.abs(part).max()) for part in parts])
    x = float(np.real(get_value(shell, name)))

    def slope(step: float) -> FloatArray:
        ends = (residuals(with_value(shell, name, x + side), start, table, kinds) for side in (step, -step))
        return np.asarray(np.subtract(*ends) / (2.0 * step * size))

    numeric, doubt = extrapolated(slope, FIRST * (abs(x) or 0.01))
    off = np.abs(np.concatenate(parts) / size - numeric)
    simple, split = off[: len(parts[0])].max(), off[len(parts[0]) :].max()
    return {"parameter": name, "simple modes": float(simple), "mean and split": float(split), "differences": doubt}


def sensitivities(quick: bool) -> list[Row]:
    """Errors of the derivatives by each parameter; by three if `quick`."""
    starts = ((solved(make(), COUNT + 8), names[::12] if quick else names) for make, names in NAMES.items())
    return [errors(start, name) for start, names in starts for name in names]
